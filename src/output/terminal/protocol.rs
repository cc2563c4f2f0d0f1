//! Pictures of pixels, by the protocols that terminals have for them.
//!
//! A new protocol is a file here, a variant and its line in `Protocol::way`.
//! Inside tmux and screen none is offered: they hide what they do not know, and
//! one that lets it through does not know where on the screen it lands. Who asks
//! for one by name gets its bytes as they are, not wrapped: a multiplexer that
//! draws the protocol itself understands them, another drops them.

use std::str::FromStr;

use super::cells::Area;
use super::colours::push_number;
use super::{iterm2, kitty, sixel};
use crate::frame::EncodedImage;
use crate::output::OutputError;

/// A picture of pixels at rest over cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PixelPicture {
    /// The pixels. Kitty and iTerm2 fit them to the area; sixel shows them as
    /// they are, so their size is to be the area's in the terminal's pixels.
    pub(crate) levels: EncodedImage,
    /// Cells that the picture covers. It does not reach the screen's last row,
    /// under which some terminals go on to a new one.
    pub(crate) area: Area,
}

/// A way to show pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// "Terminal graphics protocol" of kitty, also of Ghostty, Konsole, WezTerm.
    Kitty,
    /// Inline images of iTerm2, also of WezTerm, mintty.
    Iterm2,
    /// DEC's sixels: xterm, foot, mlterm, Windows Terminal and others.
    Sixel,
}

/// What a protocol's file says of it.
pub(super) struct Way {
    /// The name a user gives.
    pub(super) name: &'static str,
    /// Draws at the cursor.
    pub(super) draw: fn(&PixelPicture) -> Result<Vec<u8>, OutputError>,
    /// Takes the picture away; empty where cells that are written do.
    pub(super) remove: &'static [u8],
}

impl Protocol {
    /// All there are.
    pub const ALL: [Self; 3] = [Self::Kitty, Self::Iterm2, Self::Sixel];

    const fn way(self) -> &'static Way {
        match self {
            Self::Kitty => &kitty::WAY,
            Self::Iterm2 => &iterm2::WAY,
            Self::Sixel => &sixel::WAY,
        }
    }

    /// The name that a user gives.
    pub fn name(self) -> &'static str {
        self.way().name
    }

    /// Bytes that show a picture at its place, whatever the cursor and the
    /// colours are; the cursor may be anywhere afterwards.
    ///
    /// # Errors
    /// If the picture is too large to be encoded.
    pub(crate) fn encode(self, picture: &PixelPicture) -> Result<Vec<u8>, OutputError> {
        let mut bytes = b"\x1b[".to_vec();
        push_number(picture.area.row.saturating_add(1), &mut bytes);
        bytes.push(b';');
        push_number(picture.area.column.saturating_add(1), &mut bytes);
        bytes.push(b'H');
        bytes.extend((self.way().draw)(picture)?);
        Ok(bytes)
    }

    /// Bytes that take the picture away.
    pub(crate) fn remove(self) -> &'static [u8] {
        self.way().remove
    }

    /// Whether the picture stands in the cells themselves, which then have to be
    /// written to be seen again, and not over them.
    pub(crate) fn replaces_cells(self) -> bool {
        self.remove().is_empty()
    }
}

/// The name is no protocol's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnknownProtocol;

impl FromStr for Protocol {
    type Err = UnknownProtocol;

    fn from_str(name: &str) -> Result<Self, UnknownProtocol> {
        let mut all = Self::ALL.into_iter();
        all.find(|protocol| protocol.name() == name)
            .ok_or(UnknownProtocol)
    }
}

/// A tiny picture in the third column of the second row.
#[cfg(test)]
pub(super) fn tiny(width: u32, height: u32, bytes: &[u8]) -> PixelPicture {
    PixelPicture {
        levels: EncodedImage::of_bytes(width, height, bytes.to_vec()).unwrap(),
        area: Area {
            column: 2,
            row: 1,
            columns: 3,
            rows: 2,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        for protocol in Protocol::ALL {
            assert_eq!(protocol.name().parse(), Ok(protocol));
        }
        assert_eq!("cells".parse::<Protocol>(), Err(UnknownProtocol));
    }
}
