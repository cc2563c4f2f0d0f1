//! The terminal's modes, by DEC's private numbers as xterm has them
//! (<https://invisible-island.net/xterm/ctlseqs/ctlseqs.html>).

/// Plain colours; another screen (1049), no cursor (25), no lines that wrap (7),
/// for what is one column too long would move all; the mouse's buttons and drags
/// (1002) with numbers that have no end (1006).
pub(super) const ENTER: &[u8] = b"\x1b[?1049h\x1b[m\x1b[?25l\x1b[?7l\x1b[?1002h\x1b[?1006h";

/// Ends whatever was cut: a sequence by CAN, a string by ST, a frame by its mark.
pub(super) const CUT: &[u8] = b"\x18\x1b\\\x1b[?2026l";

/// [`ENTER`] backwards.
pub(super) const LEAVE: &[u8] = b"\x1b[?1006l\x1b[?1002l\x1b[?7h\x1b[?25h\x1b[m\x1b[?1049l";
