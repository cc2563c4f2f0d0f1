//! Frames to bytes, with what the terminal shows kept in mind.

use super::shared::Frame;
use crate::output::terminal::{CellEncoder, Cells, Colours, PixelPicture, Protocol};

/// What the writer's thread knows of the terminal.
pub(super) struct Painter {
    encoder: CellEncoder,
    protocol: Option<Protocol>,
    /// The picture of pixels that is shown.
    shown: Option<PixelPicture>,
    /// Whether the terminal may still show a picture that was forgotten.
    may_show_another: bool,
}

impl Painter {
    pub(super) fn new(colours: Colours, protocol: Option<Protocol>) -> Self {
        Self {
            encoder: CellEncoder::new(colours),
            protocol,
            shown: None,
            may_show_another: false,
        }
    }

    /// The terminal may show anything.
    pub(super) fn forget(&mut self) {
        self.encoder.forget();
        self.may_show_another |= self.shown.take().is_some();
    }

    /// Bytes that show a frame. A picture of pixels that is not shown yet is left
    /// out where `is_late` says that a newer frame waits.
    pub(super) fn bytes(&mut self, frame: &Frame, is_late: impl Fn() -> bool) -> Vec<u8> {
        let Some(protocol) = self.protocol else {
            return self.encoder.encode_around(&frame.cells, None).to_vec();
        };
        if std::mem::take(&mut self.may_show_another) {
            let mut bytes = protocol.remove().to_vec();
            bytes.extend(self.bytes(frame, is_late));
            return bytes;
        }
        let wanted = frame.picture.as_ref();
        let wanted = wanted.filter(|picture| fits(picture, &frame.cells, protocol));
        if wanted.is_some() && wanted == self.shown.as_ref() {
            let area = wanted.map(|picture| picture.area);
            return self.encoder.encode_around(&frame.cells, area).to_vec();
        }
        let pixels = wanted
            .filter(|_| !is_late())
            .and_then(|picture| Some((picture, protocol.encode(picture).ok()?)));
        self.change(&frame.cells, protocol, pixels)
    }

    /// Takes the picture that is shown away and shows another one, or none. Cells
    /// come first, so that nothing older is seen behind a picture that goes.
    fn change(
        &mut self,
        cells: &Cells,
        protocol: Protocol,
        pixels: Option<(&PixelPicture, Vec<u8>)>,
    ) -> Vec<u8> {
        let gone = self.shown.take();
        if let Some(gone) = gone.as_ref().filter(|_| protocol.replaces_cells()) {
            self.encoder.forget_area(gone.area);
        }
        let area = pixels.as_ref().map(|(picture, _)| picture.area);
        let mut bytes = self.encoder.encode_around(cells, area).to_vec();
        match pixels {
            Some((picture, pixels)) => {
                bytes.extend(pixels);
                if protocol.replaces_cells() {
                    self.encoder.forget_area(picture.area);
                }
                self.shown = Some(picture.clone());
            }
            None if gone.is_some() => bytes.extend_from_slice(protocol.remove()),
            None => {}
        }
        bytes
    }
}

/// Whether a picture lies on the screen and, where the terminal goes on to the
/// line below it, above the last row.
fn fits(picture: &PixelPicture, cells: &Cells, protocol: Protocol) -> bool {
    let area = picture.area;
    let end = |first: u16, count: u16| u32::from(first) + u32::from(count);
    let last_row =
        u32::from(cells.rows()) - u32::from(protocol.replaces_cells() && cells.rows() > 0);
    area.columns > 0
        && area.rows > 0
        && end(area.column, area.columns) <= u32::from(cells.columns())
        && end(area.row, area.rows) <= last_row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::EncodedImage;
    use crate::output::terminal::Area;

    fn frame(text: &str, is_at_rest: bool) -> Frame {
        let mut cells = Cells::new(6, 3);
        cells.text(0, 0, text, [255; 3], [0; 3]);
        cells.text(0, 2, text, [255; 3], [0; 3]);
        let picture = is_at_rest.then(|| PixelPicture {
            levels: EncodedImage::of_bytes(1, 1, vec![9; 3]).unwrap(),
            area: Area {
                column: 0,
                row: 0,
                columns: 4,
                rows: 2,
            },
        });
        Frame { cells, picture }
    }

    fn painted(painter: &mut Painter, text: &str, is_at_rest: bool) -> String {
        let bytes = painter.bytes(&frame(text, is_at_rest), || false);
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn sixels_are_drawn_once_and_written_over_afterwards() {
        let mut painter = Painter::new(Colours::Luminance, Some(Protocol::Sixel));
        painted(&mut painter, "abcdef", false);
        let drawn = painted(&mut painter, "abcdef", true);
        assert!(drawn.starts_with("\x1b[1;1H\x1bP"), "{drawn:?}");
        assert_eq!(painted(&mut painter, "abcdef", true), "");
        let beside = painted(&mut painter, "xbcdeF", true);
        assert!(beside.contains("\x1b[;6HF\x1b[3HxbcdeF") || beside.contains("\x1b[;6HF\x1b[3Hx"));
        let gone = painted(&mut painter, "xbcdeF", false);
        assert_eq!(gone, "\x1b[?2026h\x1b[Hxbcd\x1b[2H    \x1b[?2026l");
    }

    #[test]
    fn kittys_picture_is_taken_away_behind_the_cells() {
        let mut painter = Painter::new(Colours::Luminance, Some(Protocol::Kitty));
        painted(&mut painter, "abcdef", true);
        let gone = painted(&mut painter, "xbcdef", false);
        assert!(gone.ends_with("\x1b[?2026l\x1b_Ga=d,d=I,i=7497068,q=2\x1b\\"));
        assert_eq!(painted(&mut painter, "xbcdef", false), "");
        assert!(painted(&mut painter, "xbcdef", true).contains("\x1b_Ga=T"));
        // A terminal that was resized may have kept the picture or not.
        painter.forget();
        let resized = painted(&mut painter, "xbcdef", false);
        assert!(
            resized.starts_with("\x1b_Ga=d,d=I,i=7497068,q=2\x1b\\"),
            "{resized:?}"
        );
    }

    #[test]
    fn a_picture_that_comes_late_or_does_not_fit_is_not_drawn() {
        let mut painter = Painter::new(Colours::True, Some(Protocol::Kitty));
        let late = painter.bytes(&frame("a", true), || true);
        assert!(!String::from_utf8(late).unwrap().contains("\x1b_G"));
        let mut outside = frame("a", true);
        outside.picture.as_mut().unwrap().area.column = 5;
        assert_eq!(painter.bytes(&outside, || false), b"");
        let mut none = Painter::new(Colours::True, None);
        let cells_alone = none.bytes(&frame("a", true), || false);
        assert!(!String::from_utf8(cells_alone).unwrap().contains("\x1b_G"));
    }
}
