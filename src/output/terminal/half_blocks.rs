//! Two pixels in one character: which block is written for the fewest bytes.
//!
//! A cell of an upper and a lower colour is '▀' in the upper colour on the lower
//! one, or '▄' the other way round; a cell of one colour is a space on it or a
//! full block in it. A colour costs 7 to 19 bytes and a block three, so what
//! counts is which of them leaves the pen with colours that go on.

use super::cells::UPPER_HALF;
use super::colours::{Code, Colours, Shown, UNKNOWN};

/// Bytes of an SGR sequence around its colours: `ESC [` and `m`.
const SGR_FRAME: u32 = 3;

/// Colours that the terminal would write with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pen {
    pub(super) ink: Code,
    pub(super) paper: Code,
}

impl Pen {
    /// The pen before the first stroke of a frame. Colours are set afresh in
    /// every frame; without colours a frame leaves the pen as the screen was
    /// entered with.
    pub(super) fn at_start(colours: Colours) -> Self {
        let code = match colours {
            Colours::Luminance => 0,
            Colours::True | Colours::Indexed256 => UNKNOWN,
        };
        Self {
            ink: code,
            paper: code,
        }
    }
}

/// One way to write a cell: a glyph, and the pen that it takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stroke {
    pub(super) glyph: char,
    pub(super) pen: Pen,
}

impl Stroke {
    /// Bytes that the stroke takes with a pen.
    fn cost(self, pen: Pen, colours: Colours) -> u32 {
        let glyph = if self.glyph.is_ascii() { 1 } else { 3 };
        let change = |wanted: Code, has: Code| match wanted == has {
            true => 0,
            false => colours.length(wanted),
        };
        let ink = change(self.pen.ink, pen.ink);
        let paper = change(self.pen.paper, pen.paper);
        let both = u32::from(ink > 0 && paper > 0);
        let frame = if ink + paper > 0 { SGR_FRAME } else { 0 };
        frame + ink + both + paper + glyph
    }
}

/// The one or two strokes that show a cell.
fn strokes(shown: Shown, pen: Pen) -> (Stroke, Option<Stroke>) {
    let Shown { glyph, ink, paper } = shown;
    let stroke = |glyph, ink, paper| Stroke {
        glyph,
        pen: Pen { ink, paper },
    };
    match (glyph, ink == paper) {
        (UPPER_HALF, true) => (
            stroke(' ', pen.ink, paper),
            Some(stroke('█', ink, pen.paper)),
        ),
        (UPPER_HALF, false) => (
            stroke(UPPER_HALF, ink, paper),
            Some(stroke('▄', paper, ink)),
        ),
        _ => (stroke(glyph, ink, paper), None),
    }
}

/// The stroke that shows a cell, and the cell after it if that is written too,
/// with the fewest bytes; of two that are as short, the first.
pub(super) fn shortest(shown: Shown, next: Option<Shown>, pen: Pen, colours: Colours) -> Stroke {
    let (first, second) = strokes(shown, pen);
    let Some(second) = second else {
        return first;
    };
    let total = |stroke: Stroke| {
        let then = next.map_or(0, |next| least(next, stroke.pen, colours));
        stroke.cost(pen, colours) + then
    };
    if total(second) < total(first) {
        second
    } else {
        first
    }
}

/// Fewest bytes of a cell with a pen.
fn least(shown: Shown, pen: Pen, colours: Colours) -> u32 {
    let (first, second) = strokes(shown, pen);
    let cost = first.cost(pen, colours);
    second.map_or(cost, |second| cost.min(second.cost(pen, colours)))
}

/// The stroke that shows a cell with the pen as it is, if there is one.
pub(super) fn with_pen(shown: Shown, pen: Pen) -> Option<Stroke> {
    let (first, second) = strokes(shown, pen);
    let fits = |stroke: &Stroke| stroke.pen == pen;
    Some(first).filter(fits).or(second.filter(fits))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn halves(ink: Code, paper: Code) -> Shown {
        Shown {
            glyph: UPPER_HALF,
            ink,
            paper,
        }
    }

    fn glyph(shown: Shown, next: Option<Shown>, pen: (Code, Code)) -> char {
        let pen = Pen {
            ink: pen.0,
            paper: pen.1,
        };
        shortest(shown, next, pen, Colours::True).glyph
    }

    #[test]
    fn colours_that_the_pen_has_are_used() {
        assert_eq!(glyph(halves(1, 2), None, (1, 9)), '▀');
        assert_eq!(glyph(halves(1, 2), None, (9, 1)), '▄');
        assert_eq!(glyph(halves(1, 2), None, (2, 9)), '▄');
        assert_eq!(glyph(halves(5, 5), None, (9, 5)), ' ');
        assert_eq!(glyph(halves(5, 5), None, (5, 9)), '█');
        assert_eq!(glyph(halves(5, 5), None, (5, 5)), ' ');
    }

    #[test]
    fn colours_are_kept_for_the_next_cell() {
        // The paper would be set for a space, were it not wanted again.
        assert_eq!(glyph(halves(5, 5), Some(halves(5, 9)), (1, 9)), '█');
        assert_eq!(glyph(halves(5, 5), Some(halves(5, 9)), (9, 1)), ' ');
        // Both colours are new: the paper is to be what the space needs.
        assert_eq!(glyph(halves(1, 2), Some(halves(1, 1)), (8, 9)), '▄');
        assert_eq!(glyph(halves(1, 2), Some(halves(2, 2)), (8, 9)), '▀');
    }

    #[test]
    fn cells_that_the_pen_can_write_are_found() {
        let pen = Pen { ink: 1, paper: 2 };
        let glyph = |shown| with_pen(shown, pen).map(|stroke| stroke.glyph);
        assert_eq!(glyph(halves(1, 2)), Some('▀'));
        assert_eq!(glyph(halves(2, 1)), Some('▄'));
        assert_eq!(glyph(halves(1, 1)), Some('█'));
        assert_eq!(glyph(halves(2, 2)), Some(' '));
        assert_eq!(glyph(halves(2, 3)), None);
    }
}
