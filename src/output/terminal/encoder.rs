//! The bytes that take a terminal from the frame it shows to the next one.

use super::cells::{Area, Cells};
use super::colours::{Colours, Shown, push_number};
use super::half_blocks::{Pen, Stroke, shortest, with_pen};

/// "Synchronized output" begins: a terminal that knows it shows nothing until
/// the end mark, others ignore it.
const BEGIN_FRAME: &[u8] = b"\x1b[?2026h";
/// The mark of its end.
const END_FRAME: &[u8] = b"\x1b[?2026l";
/// Longest run of cells that did not change and is looked at for being written
/// again instead of jumped over: the jump takes four bytes.
const LONGEST_BRIDGE: usize = 3;

/// Encodes what changed from frame to frame.
///
/// Every frame is one piece of bytes that sets the cursor and the colours it
/// needs, and relies on nothing but the cells that were sent before: places are
/// absolute at the start of each row, so nothing can drift.
#[derive(Debug)]
pub(crate) struct CellEncoder {
    colours: Colours,
    columns: u16,
    rows: u16,
    /// What the terminal shows.
    sent: Vec<Shown>,
    /// A row of what it is to show.
    wanted: Vec<Shown>,
    bytes: Vec<u8>,
    pen: Pen,
    /// Column and row of the cursor, where they are known.
    cursor: Option<(u16, u16)>,
}

impl CellEncoder {
    /// An encoder that knows nothing of what the terminal shows.
    pub(crate) fn new(colours: Colours) -> Self {
        Self {
            colours,
            columns: 0,
            rows: 0,
            sent: Vec::new(),
            wanted: Vec::new(),
            bytes: Vec::new(),
            pen: Pen::at_start(colours),
            cursor: None,
        }
    }

    /// Bytes that make the terminal show the cells; none if it does already.
    /// Another size than that of the frame before sends every cell.
    pub(crate) fn encode(&mut self, cells: &Cells) -> &[u8] {
        self.encode_around(cells, None)
    }

    /// The bytes, leaving out cells that a picture of pixels covers: what is
    /// written into them would cut it.
    pub(crate) fn encode_around(&mut self, cells: &Cells, covered: Option<Area>) -> &[u8] {
        self.fit(cells);
        self.bytes.clear();
        self.pen = Pen::at_start(self.colours);
        self.cursor = None;
        for row in 0..self.rows {
            self.row(cells, row, covered);
        }
        self.finish();
        &self.bytes
    }

    /// The terminal may show anything from now on: all cells are sent next time.
    pub(crate) fn forget(&mut self) {
        self.sent.fill(Shown::UNKNOWN);
    }

    /// The terminal may show anything in an area: its cells are sent next time.
    pub(crate) fn forget_area(&mut self, area: Area) {
        let columns = usize::from(self.columns);
        for (index, sent) in self.sent.iter_mut().enumerate() {
            // Both fit: they are a column and a row.
            let (column, row) = ((index % columns) as u16, (index / columns) as u16);
            if area.holds(column, row) {
                *sent = Shown::UNKNOWN;
            }
        }
    }

    /// Takes over the size of the cells; nothing is known of another size's.
    fn fit(&mut self, cells: &Cells) {
        if (self.columns, self.rows) != (cells.columns(), cells.rows()) {
            (self.columns, self.rows) = (cells.columns(), cells.rows());
            let count = usize::from(self.columns) * usize::from(self.rows);
            self.sent = vec![Shown::UNKNOWN; count];
        }
    }

    fn row(&mut self, cells: &Cells, row: u16, covered: Option<Area>) {
        let mut wanted = std::mem::take(&mut self.wanted);
        let colours = self.colours;
        wanted.clear();
        wanted.extend(cells.row(row).iter().map(|&cell| colours.shown(cell)));
        let first = usize::from(row) * usize::from(self.columns);
        if let Some(area) = covered {
            for (column, shown) in (0..self.columns).zip(&mut wanted) {
                if area.holds(column, row) {
                    *shown = self.sent[first + usize::from(column)];
                }
            }
        }
        for column in 0..self.columns {
            let index = usize::from(column);
            let is_new = |index: usize| {
                let shown = wanted.get(index).copied();
                shown.filter(|shown| *shown != self.sent[first + index])
            };
            if let Some(shown) = is_new(index) {
                let next = is_new(index + 1);
                self.go_to(column, row, &wanted);
                self.write(shortest(shown, next, self.pen, colours));
                self.sent[first + index] = shown;
            }
        }
        self.wanted = wanted;
    }

    /// Moves the cursor; within a row by what is shortest.
    fn go_to(&mut self, column: u16, row: u16, wanted: &[Shown]) {
        if self.bytes.is_empty() {
            self.bytes.extend_from_slice(BEGIN_FRAME);
        }
        match self.cursor {
            Some((at, same_row)) if same_row == row && at <= column => {
                let between = &wanted[usize::from(at)..usize::from(column)];
                if !between.is_empty() && !self.bridge(between) {
                    self.skip(at, column);
                }
            }
            _ => self.place(column, row),
        }
        self.cursor = Some((column, row));
    }

    /// Writes cells that did not change once more, if that is shorter than a jump
    /// and the pen need not change; says whether it did.
    fn bridge(&mut self, between: &[Shown]) -> bool {
        if between.len() > LONGEST_BRIDGE {
            return false;
        }
        let glyphs = between
            .iter()
            .map(|&shown| with_pen(shown, self.pen).map(|stroke| stroke.glyph));
        let Some(glyphs) = glyphs.collect::<Option<String>>() else {
            return false;
        };
        let jump = if between.len() == 1 { 3 } else { 4 };
        if glyphs.len() > jump {
            return false;
        }
        self.bytes.extend_from_slice(glyphs.as_bytes());
        true
    }

    /// Moves right in the row, by a distance or to a column: the shorter, and of
    /// two that are as short the one to a column.
    fn skip(&mut self, from: u16, to: u16) {
        let digits = |number: u16| number.checked_ilog10();
        let distance = to - from;
        self.bytes.extend_from_slice(b"\x1b[");
        if distance == 1 {
            self.bytes.push(b'C');
        } else if digits(distance) < digits(to + 1) {
            push_number(distance, &mut self.bytes);
            self.bytes.push(b'C');
        } else {
            push_number(to + 1, &mut self.bytes);
            self.bytes.push(b'G');
        }
    }

    /// Moves to a place on the screen; 1 is what is left out.
    fn place(&mut self, column: u16, row: u16) {
        self.bytes.extend_from_slice(b"\x1b[");
        if row > 0 {
            push_number(row + 1, &mut self.bytes);
        }
        if column > 0 {
            self.bytes.push(b';');
            push_number(column + 1, &mut self.bytes);
        }
        self.bytes.push(b'H');
    }

    fn write(&mut self, stroke: Stroke) {
        self.take(stroke.pen);
        let mut buffer = [0; 4];
        let glyph = stroke.glyph.encode_utf8(&mut buffer);
        self.bytes.extend_from_slice(glyph.as_bytes());
        // Behind the last column terminals differ: the cursor waits or stays.
        self.cursor = self
            .cursor
            .and_then(|(column, row)| (column + 1 < self.columns).then_some((column + 1, row)));
    }

    /// Changes the colours that are not the pen's.
    fn take(&mut self, pen: Pen) {
        let (new_ink, new_paper) = (pen.ink != self.pen.ink, pen.paper != self.pen.paper);
        if !new_ink && !new_paper {
            return;
        }
        self.bytes.extend_from_slice(b"\x1b[");
        if new_ink {
            self.colours.push_ink(pen.ink, &mut self.bytes);
        }
        if new_ink && new_paper {
            self.bytes.push(b';');
        }
        if new_paper {
            self.colours.push_paper(pen.paper, &mut self.bytes);
        }
        self.bytes.push(b'm');
        self.pen = pen;
    }

    /// Ends a frame in which something was written.
    fn finish(&mut self) {
        if self.bytes.is_empty() {
            return;
        }
        if self.colours == Colours::Luminance {
            self.take(Pen::at_start(self.colours));
        }
        self.bytes.extend_from_slice(END_FRAME);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::terminal::cells::Cell;

    fn half(ink: [u8; 3], paper: [u8; 3]) -> Cell {
        Cell {
            glyph: '▀',
            ink,
            paper,
        }
    }

    /// A row of cells.
    fn row(row: &[Cell]) -> Cells {
        let mut cells = Cells::new(row.len() as u16, 1);
        for (column, &cell) in (0..).zip(row) {
            cells.set(column, 0, cell);
        }
        cells
    }

    /// What is sent between the marks of a frame, as text.
    fn sent(encoder: &mut CellEncoder, cells: &Cells) -> String {
        let bytes = encoder.encode(cells);
        let inner = bytes.strip_prefix(BEGIN_FRAME).unwrap();
        let inner = inner.strip_suffix(END_FRAME).unwrap();
        String::from_utf8(inner.to_vec()).unwrap()
    }

    #[test]
    fn the_first_frame_is_sent_whole() {
        let mut encoder = CellEncoder::new(Colours::True);
        let (a, b) = ([1, 20, 255], [0, 0, 7]);
        let cells = row(&[half(a, b), half(a, b), half(b, a), half(a, a), half(b, b)]);
        assert_eq!(
            sent(&mut encoder, &cells),
            "\x1b[H\x1b[38;2;1;20;255;48;2;0;0;7m▀▀▄█ "
        );
    }

    #[test]
    fn only_changes_are_sent() {
        let mut encoder = CellEncoder::new(Colours::True);
        let mut cells = row(&[half([1; 3], [2; 3]); 30]);
        encoder.encode(&cells);
        assert_eq!(encoder.encode(&cells), b"");
        cells.set(3, 0, half([1; 3], [9; 3]));
        cells.set(4, 0, half([9; 3], [9; 3]));
        cells.set(6, 0, half([1; 3], [1; 3]));
        cells.set(20, 0, half([1; 3], [1; 3]));
        assert_eq!(
            sent(&mut encoder, &cells),
            "\x1b[;4H\x1b[38;2;1;1;1;48;2;9;9;9m▀ \x1b[C█\x1b[21G█"
        );
        cells.set(29, 0, half([3; 3], [1; 3]));
        assert_eq!(
            sent(&mut encoder, &cells),
            "\x1b[;30H\x1b[38;2;3;3;3;48;2;1;1;1m▀"
        );
    }

    #[test]
    fn short_runs_between_changes_are_written_again() {
        let mut encoder = CellEncoder::new(Colours::Luminance);
        let mut cells = Cells::new(9, 1);
        cells.text(0, 0, "abcdefghi", [255; 3], [0; 3]);
        encoder.encode(&cells);
        cells.text(0, 0, "AbcdEfghI", [255; 3], [0; 3]);
        assert_eq!(sent(&mut encoder, &cells), "\x1b[HAbcdEfghI");
    }

    #[test]
    fn the_palette_is_named_by_its_indices() {
        let mut encoder = CellEncoder::new(Colours::Indexed256);
        let cells = row(&[half([255; 3], [0; 3]), half([254; 3], [95, 0, 0])]);
        assert_eq!(
            sent(&mut encoder, &cells),
            "\x1b[H\x1b[38;5;231;48;5;16m▀\x1b[48;5;52m▀"
        );
        let alike = row(&[half([253; 3], [1; 3]), half([255; 3], [96, 0, 0])]);
        assert_eq!(
            encoder.encode(&alike),
            b"",
            "the same colours of the palette"
        );
    }

    #[test]
    fn without_colours_none_is_sent() {
        let mut encoder = CellEncoder::new(Colours::Luminance);
        let mut cells = Cells::new(3, 2);
        cells.set(0, 0, half([255; 3], [255; 3]));
        cells.set(1, 0, half([60; 3], [60; 3]));
        cells.text(0, 1, "ok ", [0; 3], [200; 3]);
        assert_eq!(
            sent(&mut encoder, &cells),
            "\x1b[H@: \x1b[2H\x1b[7mok \x1b[27m"
        );
    }

    #[test]
    fn what_is_forgotten_is_sent_again() {
        let mut encoder = CellEncoder::new(Colours::Indexed256);
        let mut cells = Cells::new(3, 2);
        cells.text(0, 0, "abc", [255; 3], [0; 3]);
        let first = encoder.encode(&cells).to_vec();
        encoder.forget();
        assert_eq!(encoder.encode(&cells), first);
        let area = Area {
            column: 1,
            row: 0,
            columns: 9,
            rows: 1,
        };
        encoder.forget_area(area);
        assert_eq!(
            sent(&mut encoder, &cells),
            "\x1b[;2H\x1b[38;5;231;48;5;16mbc"
        );
    }

    #[test]
    fn covered_cells_are_left_alone() {
        let mut encoder = CellEncoder::new(Colours::True);
        let mut cells = row(&[half([1; 3], [1; 3]); 4]);
        encoder.encode(&cells);
        let area = Area {
            column: 1,
            row: 0,
            columns: 2,
            rows: 1,
        };
        for column in 0..4 {
            cells.set(column, 0, half([2; 3], [2; 3]));
        }
        let bytes = encoder.encode_around(&cells, Some(area)).to_vec();
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(
            text,
            "\x1b[?2026h\x1b[H\x1b[48;2;2;2;2m \x1b[4G \x1b[?2026l"
        );
        assert_eq!(sent(&mut encoder, &cells), "\x1b[;2H\x1b[48;2;2;2;2m  ");
    }
}
