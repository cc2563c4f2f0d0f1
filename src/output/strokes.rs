//! Lines drawn over a picture.

use tiny_skia::{Color, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

use crate::frame::EncodedImage;

/// Black beside a line, as a share of its width: without it a light line on a
/// light wall cannot be seen.
const HALO: f32 = 1.0;
/// Widest line without black beside it, pixels: in pictures of few pixels it would
/// hide what is around the line.
const WIDEST_BARE: f32 = 1.5;

/// A line through points, in pixels, row 0 on top.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Line {
    pub(crate) points: Vec<[f32; 2]>,
    pub(crate) is_closed: bool,
    pub(crate) colour: [u8; 3],
    pub(crate) width_px: f32,
}

/// The picture with lines over it, in their order. The picture itself stays as it
/// is.
pub(crate) fn with_lines(picture: &EncodedImage, lines: &[Line]) -> EncodedImage {
    let (width, height) = (picture.width(), picture.height());
    let Some(mut pixels) = Pixmap::new(width, height) else {
        return picture.clone();
    };
    for (rgba, rgb) in pixels
        .data_mut()
        .chunks_exact_mut(4)
        .zip(picture.bytes().chunks_exact(3))
    {
        rgba[..3].copy_from_slice(rgb);
        rgba[3] = u8::MAX;
    }
    for line in lines {
        if line.width_px > WIDEST_BARE {
            draw(&mut pixels, line, [0; 3], line.width_px * (1.0 + HALO));
        }
        draw(&mut pixels, line, line.colour, line.width_px);
    }
    let opaque = pixels.data().chunks_exact(4);
    let bytes = opaque
        .flat_map(|rgba| [rgba[0], rgba[1], rgba[2]])
        .collect();
    EncodedImage::of_bytes(width, height, bytes).expect("the picture has the same size")
}

fn draw(pixels: &mut Pixmap, line: &Line, [red, green, blue]: [u8; 3], width: f32) {
    let mut path = PathBuilder::new();
    for (index, &[x, y]) in line.points.iter().enumerate() {
        if index == 0 {
            path.move_to(x, y);
        } else {
            path.line_to(x, y);
        }
    }
    if line.is_closed {
        path.close();
    }
    let Some(path) = path.finish() else {
        return;
    };
    let mut paint = Paint::default();
    paint.set_color(Color::from_rgba8(red, green, blue, u8::MAX));
    let stroke = Stroke {
        width,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Stroke::default()
    };
    pixels.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey() -> EncodedImage {
        EncodedImage::of_bytes(20, 10, vec![100; 600]).unwrap()
    }

    fn line(width_px: f32) -> Line {
        Line {
            points: vec![[2.0, 5.5], [18.0, 5.5]],
            is_closed: false,
            colour: [255, 200, 0],
            width_px,
        }
    }

    #[test]
    fn lines_cover_their_pixels_and_leave_the_others() {
        let picture = grey();
        let drawn = with_lines(&picture, &[line(1.0)]);
        let pixel = |image: &EncodedImage, x: usize, y: usize| {
            let first = 3 * (y * 20 + x);
            image.bytes()[first..first + 3].to_vec()
        };
        assert_eq!(pixel(&drawn, 10, 5), [255, 200, 0]);
        assert_eq!(pixel(&drawn, 10, 3), [100, 100, 100]);
        assert_eq!(picture, grey());
        assert_eq!(with_lines(&picture, &[]), picture);
        let wide = with_lines(&picture, &[line(2.0)]);
        assert!(pixel(&wide, 10, 3)[0] < 100, "black beside a wide line");
    }

    #[test]
    fn lines_that_leave_the_picture_or_are_none_do_no_harm() {
        let mut wild = line(1.0);
        wild.points = vec![[-1e6, 5.0], [1e6, 5.0]];
        with_lines(&grey(), &[wild.clone()]);
        wild.points = vec![[f32::NAN, 5.0], [1.0, 2.0]];
        assert_eq!(with_lines(&grey(), &[wild.clone()]), grey());
        wild.points.clear();
        assert_eq!(with_lines(&grey(), &[wild]), grey());
    }
}
