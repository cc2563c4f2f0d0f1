//! A heat map with its legend, to look at.

use tiny_skia::{
    Color, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform,
};

use super::glyphs;
use crate::compare::HeatScale;
use crate::frame::{EncodedImage, FlipMap};

/// A smaller map is shown with whole, larger pixels until it is as wide.
const LEAST_WIDTH: u32 = 256;
/// Height of everything below the map, pixels.
const LEGEND_HEIGHT: u32 = 44;
/// Around the bar of colours, pixels.
const MARGIN: f32 = 14.0;
/// Top of the bar below the map, and its height, pixels.
const BAR: [f32; 2] = [8.0, 12.0];
/// Length of a tick below the bar, pixels.
const TICK: f32 = 4.0;
/// Parts of the bar between ticks. On a map of the least width the numbers of
/// all ticks would touch.
const TICKS: u32 = 4;
/// Pixels a unit of the letters' grid.
const LETTER_UNIT: f32 = 1.5;
/// Width of letters and ticks, pixels.
const LINE_WIDTH: f32 = 1.25;
/// What the colours stand for.
const NAME: &str = "FLIP";
/// Behind the legend, and its letters.
const BACKGROUND: [u8; 3] = [24, 24, 27];
const INK: [u8; 3] = [228, 228, 231];

/// FLIP by pixel as colours (see [`HeatScale`]) over a bar that says what they
/// stand for, from 0 to a round number that no pixel exceeds. A pixel of the map
/// is a square of whole pixels of the picture.
pub fn heat_map(map: &FlipMap) -> EncodedImage {
    let scale = HeatScale::of(map);
    let zoom = LEAST_WIDTH.div_ceil(map.width());
    let (width, height) = (map.width() * zoom, map.height() * zoom);
    let mut bytes = Vec::with_capacity(3 * (width * (height + LEGEND_HEIGHT)) as usize);
    for row in map.values().chunks(map.width() as usize) {
        let colours = row.iter().map(|&error| scale.colour(f64::from(error)));
        let line: Vec<u8> = colours
            .flat_map(|colour| colour.repeat(zoom as usize))
            .collect();
        for _ in 0..zoom {
            bytes.extend_from_slice(&line);
        }
    }
    bytes.extend(legend(&scale, width));
    EncodedImage::of_bytes(width, height + LEGEND_HEIGHT, bytes)
        .expect("map and legend have the same width")
}

/// The legend's levels, row by row.
fn legend(scale: &HeatScale, width: u32) -> Vec<u8> {
    let mut pixels =
        Pixmap::new(width, LEGEND_HEIGHT).expect("a map has pixels, and at most 16,384 across");
    pixels.fill(color(BACKGROUND));
    let [top, height] = BAR;
    let name = glyphs::lines(NAME, MARGIN, top + 1.0, LETTER_UNIT);
    draw(&mut pixels, name);
    let left = (2.0 * MARGIN + glyphs::width(NAME, LETTER_UNIT)).ceil();
    let bar_width = width as f32 - MARGIN - left;
    for step in 0..bar_width as u32 {
        let value = scale.top() * f64::from(step) / f64::from(bar_width - 1.0);
        let column = Rect::from_xywh(left + step as f32, top, 1.0, height);
        if let Some(column) = column {
            let paint = paint(scale.colour(value));
            pixels.fill_rect(column, &paint, Transform::identity(), None);
        }
    }
    for tick in 0..=TICKS {
        draw_tick(&mut pixels, scale, tick, [left, bar_width]);
    }
    let opaque = pixels.pixels().iter();
    opaque
        .flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
        .collect()
}

/// A tick, every other one with its number, below a bar that begins at `left`.
fn draw_tick(pixels: &mut Pixmap, scale: &HeatScale, tick: u32, [left, bar_width]: [f32; 2]) {
    let x = left + tick as f32 / TICKS as f32 * bar_width;
    let bottom = BAR[0] + BAR[1];
    let mut line = PathBuilder::new();
    line.move_to(x, bottom);
    line.line_to(x, bottom + TICK);
    draw(pixels, line.finish());
    if !tick.is_multiple_of(2) {
        return;
    }
    let number = number(scale.top() * f64::from(tick) / f64::from(TICKS));
    let number_width = glyphs::width(&number, LETTER_UNIT);
    let number_left = if tick == TICKS {
        x - number_width
    } else {
        x - 0.5 * number_width
    };
    let top = bottom + TICK + 3.0;
    draw(
        pixels,
        glyphs::lines(&number, number_left, top, LETTER_UNIT),
    );
}

/// A number without the digits that division leaves behind.
fn number(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn draw(pixels: &mut Pixmap, path: Option<Path>) {
    let stroke = Stroke {
        width: LINE_WIDTH,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..Stroke::default()
    };
    if let Some(path) = path {
        pixels.stroke_path(&path, &paint(INK), &stroke, Transform::identity(), None);
    }
}

fn paint([red, green, blue]: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(color([red, green, blue]));
    paint
}

fn color([red, green, blue]: [u8; 3]) -> Color {
    Color::from_rgba8(red, green, blue, 255)
}
