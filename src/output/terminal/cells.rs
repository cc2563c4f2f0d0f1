//! A screen as characters with two colours each.

use crate::frame::EncodedImage;

/// The glyph of a picture's cell: its ink is the upper pixel, its paper the
/// lower.
pub(super) const UPPER_HALF: char = '▀';
/// What stands for a character that takes no column, or two.
const REPLACEMENT: char = '?';

/// Levels of a colour: red, green, blue.
pub(crate) type Levels = [u8; 3];

/// One character of the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cell {
    /// A character of one column.
    pub(crate) glyph: char,
    /// Colour of the glyph.
    pub(crate) ink: Levels,
    /// Colour behind the glyph.
    pub(crate) paper: Levels,
}

impl Cell {
    /// An empty cell.
    pub(crate) const BLANK: Self = Self {
        glyph: ' ',
        ink: [0; 3],
        paper: [0; 3],
    };
}

/// Cells of a screen, from column and row 0 at its upper left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Area {
    /// First column.
    pub(crate) column: u16,
    /// First row.
    pub(crate) row: u16,
    /// Columns that are covered.
    pub(crate) columns: u16,
    /// Rows that are covered.
    pub(crate) rows: u16,
}

impl Area {
    /// Whether a cell lies inside.
    pub(crate) fn holds(&self, column: u16, row: u16) -> bool {
        let inside = |at: u16, first: u16, count: u16| at >= first && at - first < count;
        inside(column, self.column, self.columns) && inside(row, self.row, self.rows)
    }
}

/// All characters of a screen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Cells {
    columns: u16,
    rows: u16,
    cells: Vec<Cell>,
}

impl Cells {
    /// Empty cells; a screen without columns or rows has none.
    pub(crate) fn new(columns: u16, rows: u16) -> Self {
        Self {
            columns,
            rows,
            cells: vec![Cell::BLANK; usize::from(columns) * usize::from(rows)],
        }
    }

    /// Number of columns.
    pub(crate) fn columns(&self) -> u16 {
        self.columns
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> u16 {
        self.rows
    }

    /// The cell in a column of a row, if there is one.
    #[cfg(test)]
    pub(crate) fn get(&self, column: u16, row: u16) -> Option<Cell> {
        self.index(column, row).map(|index| self.cells[index])
    }

    /// Sets a cell; one outside of the screen is nowhere. Its glyph is replaced
    /// where a terminal might give it no column, or two.
    pub(crate) fn set(&mut self, column: u16, row: u16, cell: Cell) {
        let glyph = of_one_column(cell.glyph);
        if let Some(index) = self.index(column, row) {
            self.cells[index] = Cell { glyph, ..cell };
        }
    }

    /// Writes a line of text, cut at the right border.
    pub(crate) fn text(&mut self, column: u16, row: u16, text: &str, ink: Levels, paper: Levels) {
        for (glyph, column) in text.chars().zip(column..self.columns) {
            self.set(column, row, Cell { glyph, ink, paper });
        }
    }

    /// Draws a picture of half blocks from column 0 of a row on: two pixels a
    /// cell, one over the other. What leads out of the screen is cut; a last row
    /// of an odd height has black below it.
    pub(crate) fn picture(&mut self, top_row: u16, picture: &EncodedImage) {
        let stride = 3 * picture.width() as usize;
        let mut lines = picture.bytes().chunks_exact(stride);
        for row in top_row..self.rows {
            let Some(upper) = lines.next() else {
                return;
            };
            self.half_blocks(row, upper, lines.next().unwrap_or_default());
        }
    }

    /// One row of cells from two lines of pixels.
    fn half_blocks(&mut self, row: u16, upper: &[u8], lower: &[u8]) {
        let first = usize::from(row) * usize::from(self.columns);
        let cells = &mut self.cells[first..first + usize::from(self.columns)];
        let (upper, lower) = (upper.as_chunks().0, lower.as_chunks().0);
        for (index, (cell, &ink)) in cells.iter_mut().zip(upper).enumerate() {
            *cell = Cell {
                glyph: UPPER_HALF,
                ink,
                paper: lower.get(index).copied().unwrap_or_default(),
            };
        }
    }

    /// The characters of each row, without the blanks behind them.
    pub(crate) fn lines(&self) -> Vec<String> {
        let rows = self.cells.chunks(usize::from(self.columns.max(1)));
        let line = |row: &[Cell]| row.iter().map(|cell| cell.glyph).collect::<String>();
        rows.map(|row| line(row).trim_end().to_owned()).collect()
    }

    /// Cells of a row, from the left.
    pub(super) fn row(&self, row: u16) -> &[Cell] {
        let first = usize::from(row) * usize::from(self.columns);
        self.cells
            .get(first..first + usize::from(self.columns))
            .unwrap_or_default()
    }

    fn index(&self, column: u16, row: u16) -> Option<usize> {
        let is_inside = column < self.columns && row < self.rows;
        is_inside.then(|| usize::from(row) * usize::from(self.columns) + usize::from(column))
    }
}

/// The character, or a replacement where it might not take exactly one column.
///
/// Scripts without wide letters and combining marks, box drawing and blocks pass.
/// A file's name in another script is then shown as question marks, which beats
/// a row whose cells all stand beside their places.
fn of_one_column(glyph: char) -> char {
    match glyph {
        ' '..='~' => glyph,
        // A soft hyphen has no width in some terminals.
        '\u{ad}' => '-',
        '\u{a0}'..='\u{2ff}' | '\u{370}'..='\u{482}' | '\u{48a}'..='\u{52f}' => glyph,
        '\u{2010}'..='\u{2027}' | '\u{2030}'..='\u{205e}' | '\u{20a0}'..='\u{20bf}' => glyph,
        '\u{2190}'..='\u{2199}' | '\u{2200}'..='\u{22ff}' | '\u{2500}'..='\u{25fc}' => glyph,
        _ => REPLACEMENT,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_leads_out_of_the_screen_is_cut() {
        let mut cells = Cells::new(4, 2);
        cells.text(2, 1, "abc", [1; 3], [2; 3]);
        cells.text(9, 1, "x", [1; 3], [2; 3]);
        cells.text(0, 2, "x", [1; 3], [2; 3]);
        let glyphs: String = cells.row(1).iter().map(|cell| cell.glyph).collect();
        assert_eq!(glyphs, "  ab");
        assert_eq!(cells.row(2), []);
        assert_eq!(cells.get(4, 0), None);
    }

    #[test]
    fn a_picture_has_two_pixels_a_cell() {
        let levels: Vec<u8> = (0..2 * 3 * 3).collect();
        let picture = EncodedImage::of_bytes(2, 3, levels).unwrap();
        let mut cells = Cells::new(3, 3);
        cells.picture(1, &picture);
        let half = |ink, paper| {
            Some(Cell {
                glyph: '▀',
                ink,
                paper,
            })
        };
        assert_eq!(cells.get(1, 1), half([3, 4, 5], [9, 10, 11]));
        assert_eq!(cells.get(1, 2), half([15, 16, 17], [0; 3]));
        for (column, row) in [(2, 1), (0, 0)] {
            assert_eq!(cells.get(column, row), Some(Cell::BLANK));
        }
    }

    #[test]
    fn screens_without_cells_take_everything() {
        let picture = EncodedImage::of_bytes(1, 1, vec![0; 3]).unwrap();
        for (columns, rows) in [(0, 0), (0, 3), (3, 0)] {
            let mut cells = Cells::new(columns, rows);
            cells.picture(0, &picture);
            cells.text(0, 0, "text", [0; 3], [0; 3]);
            assert_eq!(cells.get(0, 0), None);
        }
    }

    #[test]
    fn characters_of_no_or_two_columns_are_replaced() {
        let mut cells = Cells::new(7, 1);
        cells.text(0, 0, "é\u{301}日\u{1b}\n🙂→", [0; 3], [0; 3]);
        let glyphs: String = cells.row(0).iter().map(|cell| cell.glyph).collect();
        assert_eq!(glyphs, "é?????→");
    }
}
