//! Signals, heard by a thread.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;
use std::time::Duration;

use signal_hook::consts::{SIGCONT, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP, SIGWINCH};
use signal_hook::flag::register_conditional_default;
use signal_hook::iterator::{Handle, Signals};
use signal_hook::low_level::emulate_default_handler;

use super::Notice;
use super::shared::Shared;

/// Signals that end a program.
const ENDING: [i32; 4] = [SIGINT, SIGTERM, SIGHUP, SIGQUIT];
/// All that are heard.
const HEARD: [i32; 7] = [SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGCONT, SIGWINCH];
/// How long the program may take to end by itself.
const PATIENCE: Duration = Duration::from_secs(2);

/// The thread, until this is dropped.
pub(super) struct Listening(Handle);

impl Drop for Listening {
    fn drop(&mut self) {
        self.0.close();
    }
}

/// Starts to listen. Signals that end a program do so at once while the screen is
/// left: a stopped job is then ended without being let at the terminal first.
pub(super) fn listen(shared: &Arc<Shared>) -> io::Result<Listening> {
    for signal in ENDING {
        register_conditional_default(signal, Arc::clone(&shared.is_left))?;
    }
    let mut signals = Signals::new(HEARD)?;
    let handle = signals.handle();
    let shared = Arc::clone(shared);
    let thread = thread::Builder::new().name("signals".to_owned());
    thread.spawn(move || {
        let mut is_ending = false;
        for signal in signals.forever() {
            hear(signal, &shared, &mut is_ending);
        }
    })?;
    Ok(Listening(handle))
}

fn hear(signal: i32, shared: &Arc<Shared>, is_ending: &mut bool) {
    let expected = &shared.expected;
    match signal {
        SIGWINCH => (shared.notify)(Notice::Resized),
        SIGTSTP if is_expected(&expected.stops) => {}
        SIGTSTP => (shared.notify)(Notice::Stop),
        SIGCONT if is_expected(&expected.continues) => {}
        SIGCONT => (shared.notify)(Notice::Continued),
        _ if std::mem::replace(is_ending, true) => end(signal, shared),
        _ => {
            // Shells name the death by a signal so.
            let code = u8::try_from(128 + signal).unwrap_or(u8::MAX);
            (shared.notify)(Notice::End(code));
            end_soon(signal, shared);
        }
    }
}

/// Takes one off, if there is one.
fn is_expected(count: &AtomicU32) -> bool {
    let less = |count: u32| count.checked_sub(1);
    count
        .fetch_update(Ordering::Relaxed, Ordering::Relaxed, less)
        .is_ok()
}

/// Ends the program if it does not do so itself, as when it hangs.
fn end_soon(signal: i32, shared: &Arc<Shared>) {
    let shared = Arc::clone(shared);
    let watch = thread::Builder::new().spawn(move || {
        thread::sleep(PATIENCE);
        if shared.is_entered() {
            end(signal, &shared);
        }
    });
    // Without a thread the second signal still does it.
    drop(watch);
}

fn end(signal: i32, shared: &Shared) {
    shared.leave();
    // Fails only for signals that nobody knows.
    let _ = emulate_default_handler(signal);
}
