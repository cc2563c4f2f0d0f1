//! Inline images of iTerm2 (<https://iterm2.com/documentation-images.html>): an
//! OSC sequence with a whole PNG as base64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::protocol::{PixelPicture, Way};
use crate::output::{OutputError, encode_png};

pub(super) const WAY: Way = Way {
    name: "iterm2",
    draw,
    remove: b"",
};

/// The picture fits the cells whatever their shape, and the cursor stays where
/// the terminal can do that.
fn draw(picture: &PixelPicture) -> Result<Vec<u8>, OutputError> {
    let area = picture.area;
    let png = encode_png(&picture.levels)?;
    let text = format!(
        "\x1b]1337;File=inline=1;size={};width={};height={};preserveAspectRatio=0;\
         doNotMoveCursor=1:{}\x07",
        png.len(),
        area.columns,
        area.rows,
        STANDARD.encode(&png)
    );
    Ok(text.into_bytes())
}

#[cfg(test)]
mod tests {
    use super::super::protocol::{Protocol, tiny};
    use super::*;

    #[test]
    fn a_tiny_picture_is_one_sequence() {
        let picture = tiny(1, 1, &[1, 2, 3]);
        let png = encode_png(&picture.levels).unwrap();
        let wanted = format!(
            "\x1b[2;3H\x1b]1337;File=inline=1;size={};width=3;height=2;\
             preserveAspectRatio=0;doNotMoveCursor=1:{}\x07",
            png.len(),
            STANDARD.encode(&png)
        );
        let sent = Protocol::Iterm2.encode(&picture).unwrap();
        assert_eq!(String::from_utf8(sent).unwrap(), wanted);
    }
}
