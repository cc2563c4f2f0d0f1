//! Ctrl-C and SIGTERM: the first asks the job to stop cleanly, the second ends
//! the program at once.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use signal_hook::consts::{SIGINT, SIGTERM};

/// Exit code of the signal that arrived; 0 while none has.
static ARRIVED: OnceLock<Arc<AtomicUsize>> = OnceLock::new();

/// (signal, exit code).
const SIGNALS: [(i32, u8); 2] = [(SIGINT, 130), (SIGTERM, 143)];

/// Begins to listen, unless the program does already. A handler that cannot be installed leaves the system's.
pub(super) fn listen() {
    if ARRIVED.get().is_some() {
        return;
    }
    let arrived = ARRIVED.get_or_init(|| Arc::new(AtomicUsize::new(0)));
    for (signal, code) in SIGNALS {
        let again = Arc::new(AtomicBool::new(false));
        // In this order: the shutdown looks at the flag before it is set.
        let installed = signal_hook::flag::register_conditional_shutdown(
            signal,
            i32::from(code),
            Arc::clone(&again),
        )
        .and_then(|_| signal_hook::flag::register(signal, again))
        .and_then(|_| {
            signal_hook::flag::register_usize(signal, Arc::clone(arrived), usize::from(code))
        });
        if installed.is_err() {
            return;
        }
    }
}

/// Exit code of the signal that arrived, if one has.
pub(super) fn exit_code() -> Option<u8> {
    match ARRIVED.get()?.load(Ordering::Relaxed) {
        0 => None,
        code => u8::try_from(code).ok(),
    }
}
