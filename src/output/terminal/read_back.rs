//! Frames read by a terminal that somebody else wrote: it shows exactly the cells
//! that were given, whatever changed from frame to frame.

use std::num::NonZeroU16;

use vt100::{Color, Parser};

use super::colours::Shown;
use super::{Area, Cell, CellEncoder, Cells, Colours};
use crate::maths::hash::hash3;

/// Colours that chance picks from: few, so that runs and equal halves come up.
const PALETTE: [[u8; 3]; 4] = [[0; 3], [255, 95, 0], [9, 100, 30], [238; 3]];

fn terminal(columns: u16, rows: u16) -> Parser {
    let size = |number| NonZeroU16::new(number).unwrap();
    Parser::new(size(rows), size(columns), 0)
}

fn any_cell(seed: u32, index: u32) -> Cell {
    let pick = |dimension, count| hash3(seed, index, dimension) % count;
    let colour = |dimension| match pick(dimension + 7, 8) {
        0 => hash3(seed, index, dimension).to_be_bytes()[1..]
            .try_into()
            .unwrap(),
        _ => PALETTE[pick(dimension, 4) as usize],
    };
    Cell {
        glyph: ['▀', '▀', '▀', '▀', '▄', '█', ' ', 'x', 'é'][pick(2, 9) as usize],
        ink: colour(0),
        paper: colour(1),
    }
}

/// Changes some cells; how many differs from seed to seed.
fn change(cells: &mut Cells, seed: u32) {
    let one_in = 1 + hash3(seed, 0, 20) % 12;
    for row in 0..cells.rows() {
        for column in 0..cells.columns() {
            let index = u32::from(row) * 1_000 + u32::from(column);
            if hash3(seed, index, 21).is_multiple_of(one_in) {
                cells.set(column, row, any_cell(seed, index));
            }
        }
    }
}

/// The code that a terminal's colour has for us.
fn code(colour: Color) -> u32 {
    match colour {
        Color::Rgb(red, green, blue) => u32::from_be_bytes([0, red, green, blue]),
        Color::Idx(index) => u32::from(index),
        Color::Default => 0,
    }
}

/// A terminal's cell as the encoder would name it.
fn seen(terminal: &Parser, column: u16, row: u16, colours: Colours) -> Shown {
    let cell = terminal.screen().cell(row, column).unwrap();
    let glyph = cell.contents().chars().next().unwrap_or(' ');
    let (ink, paper) = (code(cell.fgcolor()), code(cell.bgcolor()));
    let shown = |glyph, ink, paper| Shown { glyph, ink, paper };
    if colours == Colours::Luminance {
        assert_eq!((ink, paper), (0, 0), "no colour is sent");
        return shown(glyph, 0, u32::from(cell.inverse()));
    }
    match glyph {
        ' ' => shown('▀', paper, paper),
        '█' => shown('▀', ink, ink),
        '▄' => shown('▀', paper, ink),
        glyph => shown(glyph, ink, paper),
    }
}

fn assert_shows(terminal: &Parser, cells: &Cells, colours: Colours, words: &str) {
    for row in 0..cells.rows() {
        for column in 0..cells.columns() {
            let wanted = colours.shown(cells.get(column, row).unwrap());
            let seen = seen(terminal, column, row, colours);
            assert_eq!(seen, wanted, "{colours:?} {words}: {column}, {row}");
        }
    }
}

#[test]
fn a_terminal_shows_the_cells_of_every_frame() {
    for colours in [Colours::True, Colours::Indexed256, Colours::Luminance] {
        for (columns, rows) in [(1, 1), (2, 1), (1, 3), (10, 5), (131, 40)] {
            let mut terminal = terminal(columns, rows);
            let mut cells = Cells::new(columns, rows);
            let mut encoder = CellEncoder::new(colours);
            for seed in 0..30 {
                change(&mut cells, seed);
                terminal.process(encoder.encode(&cells));
                let words = format!("{columns} x {rows}, frame {seed}");
                assert_shows(&terminal, &cells, colours, &words);
                assert_eq!(encoder.encode(&cells), b"", "{words}: nothing changed");
            }
        }
    }
}

#[test]
fn what_others_wrote_is_gone_after_forgetting() {
    let mut terminal = terminal(20, 6);
    let mut cells = Cells::new(20, 6);
    let mut encoder = CellEncoder::new(Colours::True);
    change(&mut cells, 1);
    terminal.process(encoder.encode(&cells));
    terminal.process(b"\x1b[2J\x1b[3;3H\x1b[31mnoise\x1b[?25h");
    encoder.forget();
    terminal.process(encoder.encode(&cells));
    assert_shows(&terminal, &cells, Colours::True, "after noise");
}

#[test]
fn another_size_is_sent_whole() {
    let mut encoder = CellEncoder::new(Colours::True);
    for (seed, (columns, rows)) in (0..).zip([(20, 6), (6, 20), (1, 1), (20, 6)]) {
        let mut cells = Cells::new(columns, rows);
        change(&mut cells, seed);
        let mut terminal = terminal(columns, rows);
        terminal.process(encoder.encode(&cells));
        assert_shows(&terminal, &cells, Colours::True, "after a resize");
    }
    for (columns, rows) in [(0, 0), (0, 5), (5, 0)] {
        assert_eq!(encoder.encode(&Cells::new(columns, rows)), b"");
        encoder.forget();
        encoder.forget_area(Area {
            column: 0,
            row: 0,
            columns: 9,
            rows: 9,
        });
    }
}
