//! The terminal graphics protocol of kitty
//! (<https://sw.kovidgoyal.net/kitty/graphics-protocol/>): an APC sequence with
//! keys and a PNG as base64, in pieces.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::protocol::{PixelPicture, Way};
use crate::output::{OutputError, encode_png};

/// Most letters of a piece, by the protocol; a multiple of four.
const MOST_OF_A_PIECE: usize = 4096;

pub(super) const WAY: Way = Way {
    name: "kitty",
    draw,
    // With the picture go its pixels (`d=I`).
    remove: b"\x1b_Ga=d,d=I,i=7497068,q=2\x1b\\",
};

/// One image, always under the same number ("rel" in letters), so that a new one
/// replaces the old. The terminal is to answer nothing (`q=2`), to leave the
/// cursor (`C=1`) and to fit the picture to the cells.
fn draw(picture: &PixelPicture) -> Result<Vec<u8>, OutputError> {
    let area = picture.area;
    let letters = STANDARD.encode(encode_png(&picture.levels)?);
    let mut bytes = Vec::with_capacity(letters.len() + letters.len() / 200 + 100);
    let mut keys = format!(
        "a=T,f=100,i=7497068,p=1,c={},r={},C=1,",
        area.columns, area.rows
    );
    let mut rest = letters.as_str();
    while !rest.is_empty() {
        let (piece, behind) = rest.split_at(rest.len().min(MOST_OF_A_PIECE));
        let more = u8::from(!behind.is_empty());
        bytes.extend_from_slice(format!("\x1b_G{keys}q=2,m={more};{piece}\x1b\\").as_bytes());
        keys.clear();
        rest = behind;
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::super::protocol::{Protocol, tiny};
    use super::*;

    fn sent(picture: &PixelPicture) -> String {
        String::from_utf8(Protocol::Kitty.encode(picture).unwrap()).unwrap()
    }

    #[test]
    fn a_tiny_picture_is_one_piece() {
        let picture = tiny(2, 1, &[255, 0, 0, 0, 0, 255]);
        let png = STANDARD.encode(encode_png(&picture.levels).unwrap());
        assert!(png.starts_with("iVBORw0KGgo"), "a PNG");
        let wanted =
            format!("\x1b[2;3H\x1b_Ga=T,f=100,i=7497068,p=1,c=3,r=2,C=1,q=2,m=0;{png}\x1b\\");
        assert_eq!(sent(&picture), wanted);
    }

    #[test]
    fn a_large_picture_comes_in_pieces() {
        let noise: Vec<u8> = (0..3 * 60 * 60)
            .map(|index| crate::maths::hash::mix(index) as u8)
            .collect();
        let picture = tiny(60, 60, &noise);
        let text = sent(&picture);
        let pieces: Vec<&str> = text.split("\x1b_G").skip(1).collect();
        assert!(pieces.len() > 2, "{}", pieces.len());
        let mut letters = String::new();
        for (index, piece) in pieces.iter().enumerate() {
            let (keys, data) = piece
                .strip_suffix("\x1b\\")
                .unwrap()
                .split_once(';')
                .unwrap();
            let more = u8::from(index + 1 < pieces.len());
            assert!(keys.ends_with(&format!("q=2,m={more}")), "{keys}");
            assert_eq!(keys.starts_with("a=T"), index == 0, "{keys}");
            assert!(data.len() <= MOST_OF_A_PIECE && data.len() % 4 == 0);
            letters.push_str(data);
        }
        let png = STANDARD.decode(letters).unwrap();
        assert_eq!(png, encode_png(&picture.levels).unwrap());
    }
}
