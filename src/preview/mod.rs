//! The interactive terminal program: a scene is lit by hand in a terminal.

#[cfg_attr(
    not(test),
    allow(dead_code, unused_imports, reason = "the program is not whole yet")
)]
mod ask;
#[cfg_attr(
    not(test),
    allow(dead_code, unused_imports, reason = "the program is not whole yet")
)]
mod screen;
