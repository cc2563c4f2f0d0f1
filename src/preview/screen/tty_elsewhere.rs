//! The terminal where there is no termios: what crossterm can do with it. It is
//! not asked, and what waits to be written is not thrown away.

use std::io::{self, IsTerminal, Write};
use std::time::Duration;

use super::ScreenError;

/// Standard input and output, which are a terminal.
pub(super) struct Tty;

/// How large the terminal is; 0 what it does not say.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub(super) columns: u16,
    pub(super) rows: u16,
    pub(super) width_px: u16,
    pub(super) height_px: u16,
}

impl Tty {
    /// Checks that there is a terminal.
    pub(super) fn open() -> Result<Self, ScreenError> {
        if !io::stdout().is_terminal() {
            return Err(ScreenError::NoTerminal("standard output"));
        }
        if !io::stdin().is_terminal() {
            return Err(ScreenError::NoTerminal("standard input"));
        }
        Ok(Self)
    }

    /// Keys come as they are hit, unechoed, Ctrl-C among them.
    pub(super) fn enter_raw(&self) -> io::Result<()> {
        crossterm::terminal::enable_raw_mode()
    }

    /// As it was when it was opened.
    pub(super) fn restore(&self) -> io::Result<()> {
        crossterm::terminal::disable_raw_mode()
    }

    /// Writes all of it.
    pub(super) fn write(&self, bytes: &[u8]) -> io::Result<()> {
        let mut output = io::stdout().lock();
        output.write_all(bytes)?;
        output.flush()
    }

    /// Writes all of it, wanted or not.
    pub(super) fn write_while(
        &self,
        bytes: &[u8],
        _is_wanted: impl Fn() -> bool,
    ) -> io::Result<bool> {
        self.write(bytes).map(|()| true)
    }

    /// Writes all of it; how long that takes, is up to the system.
    pub(super) fn write_within(&self, bytes: &[u8], _limit: Duration) -> io::Result<()> {
        self.write(bytes)
    }

    /// No bytes: events are read by crossterm alone.
    pub(super) fn read_within(&self, _limit: Duration) -> io::Result<Vec<u8>> {
        Ok(Vec::new())
    }

    /// Nothing can be thrown away.
    pub(super) fn discard_output(&self) {}

    /// Nothing can be thrown away.
    pub(super) fn discard_input(&self) {}

    /// How large it is, if it says.
    pub(super) fn size(&self) -> Option<Size> {
        let (columns, rows) = crossterm::terminal::size().ok()?;
        Some(Size {
            columns,
            rows,
            width_px: 0,
            height_px: 0,
        })
    }
}
