//! Ctrl-Z: the program stops until the shell continues it.

use std::io;
use std::sync::atomic::Ordering;

use nix::unistd::{getpgrp, getppid, getsid};
use rustix::process::{Signal, kill_current_process_group};
use signal_hook::consts::SIGTSTP;
use signal_hook::low_level::emulate_default_handler;

use super::shared::Expected;

/// Whether somebody could continue the program: a shell with jobs, which is in our
/// session and has put us into a group of our own. Of a group that is orphaned
/// the system takes no stop from a terminal either.
///
/// In a container any of these numbers may be 0, where who bears it lives outside.
/// rustix takes that for impossible, so this asks by nix.
pub(super) fn can_be_continued() -> bool {
    let parent = getppid();
    // Of process 0 the system would answer with our own session.
    let of_parent = getsid(Some(parent)).ok().filter(|_| parent.as_raw() != 0);
    getsid(None).is_ok_and(|own| of_parent == Some(own) && own != getpgrp())
}

/// Stops the process group; comes back when it is continued. The others of the
/// group, as a script that has started us, get what Ctrl-Z would have sent them;
/// ourselves, who hear that signal, the stop that cannot be heard.
pub(super) fn stop(expected: &Expected) -> io::Result<()> {
    expected.stops.store(1, Ordering::Relaxed);
    expected.continues.store(1, Ordering::Relaxed);
    kill_current_process_group(Signal::TSTP)?;
    emulate_default_handler(SIGTSTP)
}
