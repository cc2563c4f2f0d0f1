//! Bytes and time of frames of 200 x 60 cells.
//!
//! | frame | bytes | limit |
//! |---|---|---|
//! | every half another colour of 24 bits | 437,285 | 450,000 |
//! | the same, one cell in ten, anywhere | 50,652 | 60,000 |
//! | the goldens of courtyard, statues, window by day | 264,378, 258,853, 309,158 | 450,000 |
//!
//! Encoding the first takes 0.9 ms (24 bits and the palette; 0.25 ms without
//! colours) on one core of a shared machine with two, optimised, the median of
//! 101 frames; the limit is 2 ms.

use std::time::Instant;

use super::{Cell, CellEncoder, Cells, Colours};
use crate::frame::EncodedImage;
use crate::maths::hash::hash3;

const COLUMNS: u16 = 200;
const ROWS: u16 = 60;
/// Most bytes of a frame in which every cell changed.
const MOST_BYTES: usize = 450_000;
/// Most bytes of a frame in which one cell in ten changed.
const MOST_OF_A_TENTH: usize = 60_000;

/// Gives cells that a test picks new halves by chance.
fn change(cells: &mut Cells, seed: u32, is_changed: impl Fn(u32) -> bool) {
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let index = u32::from(row) * u32::from(COLUMNS) + u32::from(column);
            if !is_changed(index) {
                continue;
            }
            let [_, r, g, b] = hash3(seed, index, 0).to_be_bytes();
            let [_, red, green, blue] = hash3(seed, index, 1).to_be_bytes();
            let cell = Cell {
                glyph: '▀',
                ink: [r, g, b],
                paper: [red, green, blue],
            };
            cells.set(column, row, cell);
        }
    }
}

#[test]
fn frames_of_noise_keep_the_limits() {
    let mut cells = Cells::new(COLUMNS, ROWS);
    let mut encoder = CellEncoder::new(Colours::True);
    change(&mut cells, 1, |_| true);
    let whole = encoder.encode(&cells).len();
    change(&mut cells, 2, |index| hash3(3, index, 0).is_multiple_of(10));
    let tenth = encoder.encode(&cells).len();
    assert!(whole <= MOST_BYTES && tenth <= MOST_OF_A_TENTH);
    assert_eq!((whole, tenth), (437_285, 50_652), "the figures above");
}

/// Our own pictures, in which neighbours share colours, take less.
#[test]
fn whole_frames_of_scenes_keep_the_limit() {
    for name in ["courtyard/courtyard", "statues/statues", "window/day"] {
        let path = format!("{}/golden/scenes/{name}.png", env!("CARGO_MANIFEST_DIR"));
        let golden = image::open(path).unwrap();
        let size = (u32::from(COLUMNS), 2 * u32::from(ROWS));
        let small = golden.resize_exact(size.0, size.1, image::imageops::Triangle);
        let levels = EncodedImage::of_bytes(size.0, size.1, small.into_rgb8().into_raw());
        let mut cells = Cells::new(COLUMNS, ROWS);
        cells.picture(0, &levels.unwrap());
        let whole = CellEncoder::new(Colours::True).encode(&cells).len();
        assert!((50_000..MOST_BYTES).contains(&whole), "{name}: {whole}");
    }
}

/// The worst that can be: every level of every half has three digits, and no
/// neighbour has the same. It is above the limit by 4 %: 39 bytes a cell cannot
/// be less while every half has its exact colour.
#[test]
fn the_worst_frame_is_known() {
    let mut cells = Cells::new(COLUMNS, ROWS);
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let even = 100 + (column % 100) as u8;
            let cell = Cell {
                glyph: '▀',
                ink: [even, 100, 101 + (row % 2) as u8],
                paper: [even, 200, 100],
            };
            cells.set(column, row, cell);
        }
    }
    let whole = CellEncoder::new(Colours::True).encode(&cells).len();
    assert!((468_000..=468_500).contains(&whole), "{whole}");
}

/// Run with `--release -- --ignored --nocapture`.
#[test]
#[allow(clippy::print_stdout, reason = "figures that people read")]
#[ignore = "measures time, which other work disturbs"]
fn a_whole_frame_takes_less_than_two_milliseconds() {
    for colours in [Colours::True, Colours::Indexed256, Colours::Luminance] {
        let mut encoder = CellEncoder::new(colours);
        let mut times_ms: Vec<f64> = (0..101)
            .map(|seed| {
                let mut cells = Cells::new(COLUMNS, ROWS);
                change(&mut cells, seed, |_| true);
                let start = Instant::now();
                assert!(!encoder.encode(&cells).is_empty());
                start.elapsed().as_secs_f64() * 1e3
            })
            .collect();
        times_ms.sort_by(f64::total_cmp);
        println!("{colours:?}: {:.2} ms", times_ms[50]);
        assert!(times_ms[50] < 2.0, "{colours:?}: {:.2} ms", times_ms[50]);
    }
}
