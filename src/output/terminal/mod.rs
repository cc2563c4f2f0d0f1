//! Pictures as the bytes that a terminal shows.
//!
//! Comes in: [`Cells`] (characters with two colours, of which half blocks make
//! a picture of two pixels a cell) or a [`PixelPicture`]. Goes out: bytes. What
//! has been sent is remembered by [`CellEncoder`], so that only cells that
//! changed are sent again. Nothing here asks or changes the terminal.

mod cells;
mod colours;
mod encoder;
mod half_blocks;
mod iterm2;
mod kitty;
mod protocol;
mod sixel;

#[cfg(test)]
pub(crate) use cells::Cell;
pub(crate) use cells::{Area, Cells};
pub use colours::Colours;
pub(crate) use encoder::CellEncoder;
pub(crate) use protocol::PixelPicture;
pub use protocol::{Protocol, UnknownProtocol};

#[cfg(test)]
mod limits;
#[cfg(test)]
mod read_back;
