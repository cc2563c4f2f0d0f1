//! How a terminal is told colours: exactly, by a palette of 256, or not at all.

use super::cells::{Cell, Levels, UPPER_HALF};

/// Colours that a terminal is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colours {
    /// 24 bits.
    True,
    /// The nearest of the palette's cube of 6 x 6 x 6 colours and its 24 greys.
    /// Its first 16 colours are the user's own, so nobody knows how they look.
    Indexed256,
    /// None: a picture of characters that are the denser the brighter the cell
    /// is. For terminals without colours and for users who want none (`NO_COLOR`).
    Luminance,
}

/// What is in the terminal's mind of a colour: levels, an index of the palette,
/// or whether ink and paper are swapped.
pub(super) type Code = u32;
/// A colour that is not known.
pub(super) const UNKNOWN: Code = Code::MAX;
/// In place of a paper: the terminal swaps its own ink and paper.
const REVERSED: Code = 1;

/// A cell as it is sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shown {
    /// [`UPPER_HALF`] for every cell of halves, equal ones too.
    pub(super) glyph: char,
    pub(super) ink: Code,
    pub(super) paper: Code,
}

impl Shown {
    /// What a cell shows that nothing is known of.
    pub(super) const UNKNOWN: Self = Self {
        glyph: '\0',
        ink: UNKNOWN,
        paper: UNKNOWN,
    };
}

/// Characters from no light to full light, on dark paper. By eye, of those that
/// all fonts have; more steps than these are not told apart.
const RAMP: &[u8; 10] = b" .:-=+*#%@";

/// The palette's levels of a channel in its cube.
const CUBE: [u8; 6] = [0, 95, 135, 175, 215, 255];
/// The palette's index of the cube's black.
const FIRST_OF_CUBE: u32 = 16;
/// The palette's index of its darkest grey; grey `i` has the level 8 + 10 i.
const FIRST_GREY: u32 = 232;
/// Number of greys.
const GREY_COUNT: i32 = 24;

/// The step of [`CUBE`] that is nearest to a level; the lower of two.
const NEAREST_IN_CUBE: [u8; 256] = nearest_in_cube();
/// The grey that is nearest to a sum of three levels; the lower of two.
const NEAREST_GREY: [u8; 766] = nearest_grey();

const fn nearest_in_cube() -> [u8; 256] {
    let mut steps = [0; 256];
    let mut level = 0;
    while level < 256 {
        let mut step = 0;
        while step < 5 && 2 * level > CUBE[step] as usize + CUBE[step + 1] as usize {
            step += 1;
        }
        steps[level] = step as u8;
        level += 1;
    }
    steps
}

const fn nearest_grey() -> [u8; 766] {
    let mut greys = [0; 766];
    let mut sum: i32 = 0;
    while sum < 766 {
        // The nearest grey has the level nearest to the mean: (sum / 3 - 8) / 10,
        // rounded, in whole numbers.
        let grey = (sum - 24 + 14).div_euclid(30);
        greys[sum as usize] = if grey < 0 {
            0
        } else if grey >= GREY_COUNT {
            GREY_COUNT as u8 - 1
        } else {
            grey as u8
        };
        sum += 1;
    }
    greys
}

/// The index of the palette's colour that is nearest by the distance of levels;
/// of a colour of the cube and a grey as near, the one of the cube.
///
/// The cube is a product of its channels, so its nearest is the nearest of each;
/// the nearest grey is the nearest to the mean. Two looks into tables and one
/// comparison then find what a search through 240 colours would.
fn nearest_index(colour: Levels) -> Code {
    let steps = colour.map(|level| NEAREST_IN_CUBE[usize::from(level)]);
    let in_cube = steps.map(|step| CUBE[usize::from(step)]);
    let sum: usize = colour.iter().map(|&level| usize::from(level)).sum();
    let grey = NEAREST_GREY[sum];
    if distance(colour, [8 + 10 * grey; 3]) < distance(colour, in_cube) {
        return FIRST_GREY + u32::from(grey);
    }
    let [red, green, blue] = steps.map(u32::from);
    FIRST_OF_CUBE + 36 * red + 6 * green + blue
}

/// Square of the distance of two colours' levels.
fn distance(a: Levels, b: Levels) -> u32 {
    let square = |(a, b): (u8, u8)| u32::from(a.abs_diff(b)).pow(2);
    a.into_iter().zip(b).map(square).sum()
}

/// Luminance of encoded levels, 0 to 255: Rec. 709's weights, in whole numbers.
fn luminance(colour: Levels) -> u32 {
    let [red, green, blue] = colour.map(u32::from);
    (2_126 * red + 7_152 * green + 722 * blue) / 10_000
}

impl Colours {
    /// What a terminal is to show of a cell; two that look the same are the same.
    pub(super) fn shown(self, cell: Cell) -> Shown {
        match self {
            Self::True => halves(cell, |[red, green, blue]| {
                u32::from_be_bytes([0, red, green, blue])
            }),
            Self::Indexed256 => halves(cell, nearest_index),
            Self::Luminance => without_colours(cell),
        }
    }

    /// Appends what an SGR sequence says for a colour of ink, without its frame.
    pub(super) fn push_ink(self, code: Code, bytes: &mut Vec<u8>) {
        self.push(b"38", code, bytes);
    }

    /// Appends what an SGR sequence says for a colour of paper.
    pub(super) fn push_paper(self, code: Code, bytes: &mut Vec<u8>) {
        match self {
            Self::Luminance if code == REVERSED => bytes.extend_from_slice(b"7"),
            Self::Luminance => bytes.extend_from_slice(b"27"),
            _ => self.push(b"48", code, bytes),
        }
    }

    fn push(self, plane: &[u8], code: Code, bytes: &mut Vec<u8>) {
        match self {
            Self::True => {
                let [_, red, green, blue] = code.to_be_bytes();
                bytes.extend_from_slice(plane);
                bytes.extend_from_slice(b";2");
                for level in [red, green, blue] {
                    bytes.push(b';');
                    push_number(u16::from(level), bytes);
                }
            }
            Self::Indexed256 => {
                bytes.extend_from_slice(plane);
                bytes.extend_from_slice(b";5;");
                push_number(code as u16, bytes);
            }
            Self::Luminance => {}
        }
    }

    /// Bytes that [`push_ink`](Self::push_ink) appends for a colour; as many as
    /// for the same paper.
    pub(super) fn length(self, code: Code) -> u32 {
        match self {
            Self::True => {
                let [_, red, green, blue] = code.to_be_bytes();
                7 + digits(red) + digits(green) + digits(blue)
            }
            Self::Indexed256 => 5 + digits(code as u8),
            Self::Luminance => 2,
        }
    }
}

/// A cell whose colours are told. Half and full blocks and spaces become two
/// halves, so that the encoder is free in how it writes them.
fn halves(cell: Cell, code: impl Fn(Levels) -> Code) -> Shown {
    let (ink, paper) = (code(cell.ink), code(cell.paper));
    let (glyph, ink, paper) = match cell.glyph {
        '▄' => (UPPER_HALF, paper, ink),
        '█' => (UPPER_HALF, ink, ink),
        ' ' => (UPPER_HALF, paper, paper),
        glyph => (glyph, ink, paper),
    };
    Shown { glyph, ink, paper }
}

/// A picture's cell as a character of the [`RAMP`]; text as it is, swapped where
/// it is dark on bright, so that a status line stands out.
fn without_colours(cell: Cell) -> Shown {
    let plain = |glyph| Shown {
        glyph,
        ink: 0,
        paper: 0,
    };
    let (ink, paper) = (luminance(cell.ink), luminance(cell.paper));
    match cell.glyph {
        UPPER_HALF | '▄' => plain(of_ramp((ink + paper) / 2)),
        '█' => plain(of_ramp(ink)),
        glyph if paper > ink => Shown {
            paper: REVERSED,
            ..plain(glyph)
        },
        glyph => plain(glyph),
    }
}

fn of_ramp(luminance: u32) -> char {
    let steps = RAMP.len() as u32;
    char::from(RAMP[(luminance * steps / 256) as usize])
}

/// Digits of a number of one byte.
fn digits(number: u8) -> u32 {
    1 + u32::from(number >= 10) + u32::from(number >= 100)
}

/// Appends a number in decimal digits.
pub(super) fn push_number(number: u16, bytes: &mut Vec<u8>) {
    if number >= 10 {
        push_number(number / 10, bytes);
    }
    bytes.push(b'0' + (number % 10) as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The palette's colour, by its definition.
    fn of_index(index: Code) -> Levels {
        if index >= FIRST_GREY {
            return [(8 + 10 * (index - FIRST_GREY)) as u8; 3];
        }
        let index = (index - FIRST_OF_CUBE) as usize;
        [CUBE[index / 36], CUBE[index / 6 % 6], CUBE[index % 6]]
    }

    #[test]
    fn the_palette_has_no_nearer_colour() {
        for number in 0..20_000_u32 {
            let [_, red, green, blue] = crate::maths::hash::mix(number).to_be_bytes();
            for colour in [
                [red, green, blue],
                [red, red, red.saturating_add(green % 9)],
            ] {
                let found = nearest_index(colour);
                let best = (FIRST_OF_CUBE..=255)
                    .map(|i| distance(colour, of_index(i)))
                    .min();
                assert_eq!(Some(distance(colour, of_index(found))), best, "{colour:?}");
            }
        }
    }

    #[test]
    fn colours_of_the_palette_are_themselves() {
        for index in FIRST_OF_CUBE..=255 {
            assert_eq!(of_index(nearest_index(of_index(index))), of_index(index));
        }
    }

    #[test]
    fn lengths_are_those_of_what_is_sent() {
        for (colours, code) in [
            (Colours::True, u32::from_be_bytes([0, 9, 10, 100])),
            (Colours::True, 0),
            (Colours::Indexed256, 16),
            (Colours::Indexed256, 255),
        ] {
            let mut bytes = Vec::new();
            colours.push_ink(code, &mut bytes);
            assert_eq!(bytes.len(), colours.length(code) as usize);
        }
    }

    #[test]
    fn the_ramp_goes_from_nothing_to_the_densest() {
        let halves = |ink, paper| {
            without_colours(Cell {
                glyph: '▀',
                ink,
                paper,
            })
            .glyph
        };
        assert_eq!(halves([0; 3], [0; 3]), ' ');
        assert_eq!(halves([255; 3], [255; 3]), '@');
        assert_eq!(halves([255; 3], [0; 3]), '=');
        let text = Cell {
            glyph: 'x',
            ink: [0; 3],
            paper: [200; 3],
        };
        assert_eq!(without_colours(text).paper, REVERSED);
    }
}
