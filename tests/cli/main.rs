//! The program's contract with people and with other programs: exit codes,
//! words for mistakes, reports, components, the cache of bakes, signals.

mod components;
mod differences;
mod folded;
mod goldens;
mod info;
mod measured_reports;
mod mistakes;
mod preview;
#[path = "../program/mod.rs"]
mod program;
mod reports;
mod schemes;
#[cfg(unix)]
mod signals;
mod stored_bakes;
