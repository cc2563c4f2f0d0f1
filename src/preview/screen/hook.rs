//! A panic's message is to be read: the terminal is given back before it is
//! printed.

use std::panic;
use std::sync::{Arc, Mutex, Once, PoisonError, Weak};

use super::Notice;
use super::shared::Shared;

/// The screen that is shown.
static CURRENT: Mutex<Weak<Shared>> = Mutex::new(Weak::new());

/// Lets panics leave this screen, if it is entered when they come. Whatever hook
/// there was prints afterwards.
pub(super) fn watch(shared: &Arc<Shared>) {
    static INSTALLED: Once = Once::new();
    *CURRENT.lock().unwrap_or_else(PoisonError::into_inner) = Arc::downgrade(shared);
    INSTALLED.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            let current = CURRENT.lock().unwrap_or_else(PoisonError::into_inner);
            let shared = current.upgrade();
            drop(current);
            if let Some(shared) = shared.filter(|shared| shared.is_entered()) {
                shared.leave();
                (shared.notify)(Notice::Panicked);
            }
            before(info);
        }));
    });
}
