//! Texture statements of MTL: options, then the name of a file.

use glam::Vec2;

use super::lines::number;
use crate::scene::defects::Defect;
use crate::scene::file::fields::LARGEST;

/// The file and the options that are obeyed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TextureStatement<'a> {
    pub(super) name: &'a str,
    pub(super) scale: Vec2,
    pub(super) offset: Vec2,
    pub(super) clamp: bool,
}

/// What follows an option.
#[derive(Debug, Clone, Copy)]
enum Argument {
    /// Up to three numbers: a factor on texture coordinates.
    Scale,
    /// Up to three numbers, added to texture coordinates.
    Offset,
    /// `on` or `off`.
    Clamp,
    /// So many numbers; other ones than these change the picture.
    Numbers(&'static [f64]),
    /// A word; another one than this changes the picture.
    Word(&'static str),
    /// A word that does not change the picture.
    AnyWord,
}

const OPTIONS: [(&str, Argument); 14] = [
    ("-s", Argument::Scale),
    ("-o", Argument::Offset),
    ("-clamp", Argument::Clamp),
    ("-mm", Argument::Numbers(&[0.0, 1.0])),
    ("-t", Argument::Numbers(&[0.0, 0.0, 0.0])),
    ("-cc", Argument::Word("off")),
    ("-colorspace", Argument::Word("srgb")),
    ("-imfchan", Argument::Word("")),
    ("-type", Argument::Word("")),
    ("-blendu", Argument::AnyWord),
    ("-blendv", Argument::AnyWord),
    ("-bm", Argument::AnyWord),
    ("-boost", Argument::AnyWord),
    ("-texres", Argument::AnyWord),
];

/// Parses what follows the keyword; `None` where there is no file name.
pub(super) fn parse<'a>(
    text: &'a str,
    add: &mut dyn FnMut(Defect),
) -> Option<TextureStatement<'a>> {
    let mut statement = TextureStatement {
        name: text,
        scale: Vec2::ONE,
        offset: Vec2::ZERO,
        clamp: false,
    };
    while let Some((argument, after)) = option(statement.name) {
        statement.name = statement.obey(argument, after, add);
    }
    if statement.name.is_empty() {
        add(Defect::MapPath);
        return None;
    }
    Some(statement)
}

/// The option that a text starts with, and what follows.
fn option(text: &str) -> Option<(Argument, &str)> {
    let (word, after) = split_word(text);
    let same = |(name, _): &&(&str, Argument)| name.eq_ignore_ascii_case(word);
    OPTIONS
        .iter()
        .find(same)
        .map(|(_, argument)| (*argument, after))
}

impl TextureStatement<'_> {
    /// Takes the argument off `text` and returns what follows.
    fn obey<'a>(
        &mut self,
        argument: Argument,
        text: &'a str,
        add: &mut dyn FnMut(Defect),
    ) -> &'a str {
        match argument {
            Argument::Scale | Argument::Offset => {
                let (numbers, after) = numbers(text, 3);
                // The third is for solid textures.
                let given = numbers.len().min(2);
                let is_usable = given > 0 && numbers[..given].iter().all(|x| x.abs() <= LARGEST);
                let slot = match argument {
                    Argument::Scale => &mut self.scale,
                    _ => &mut self.offset,
                };
                if is_usable {
                    slot.x = numbers[0] as f32;
                    slot.y = numbers.get(1).map_or(slot.y, |&v| v as f32);
                } else {
                    add(Defect::ColourNumber);
                }
                after
            }
            Argument::Clamp => {
                let (word, after) = split_word(text);
                self.clamp = word.eq_ignore_ascii_case("on");
                after
            }
            Argument::Numbers(neutral) => {
                let (numbers, after) = numbers(text, neutral.len());
                if numbers.iter().zip(neutral).any(|(x, neutral)| x != neutral) {
                    add(Defect::MapOption);
                }
                after
            }
            Argument::Word(neutral) => {
                let (word, after) = split_word(text);
                if !word.eq_ignore_ascii_case(neutral) {
                    add(Defect::MapOption);
                }
                after
            }
            Argument::AnyWord => split_word(text).1,
        }
    }
}

/// Up to `most` numbers, of which the last ones may be left out, and what
/// follows. The last word is the file, even where it looks like a number.
fn numbers(mut text: &str, most: usize) -> (Vec<f64>, &str) {
    let mut numbers = Vec::new();
    while numbers.len() < most {
        let (word, after) = split_word(text);
        match number(word) {
            Some(number) if !after.is_empty() => numbers.push(number),
            _ => break,
        }
        text = after;
    }
    (numbers, text)
}

fn split_word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> (Option<TextureStatement<'_>>, Vec<Defect>) {
        let mut defects = Vec::new();
        let statement = parse(text, &mut |defect| defects.push(defect));
        (statement, defects)
    }

    #[test]
    fn options_are_no_part_of_a_file_name() {
        let name = |text| parsed(text).0.map(|statement| statement.name);
        assert_eq!(name("texture 01.png"), Some("texture 01.png"));
        assert_eq!(name("-s 1 1 1 -o 0.1 a b.png"), Some("a b.png"));
        assert_eq!(name("-clamp on a\\b.png"), Some("a\\b.png"));
        assert_eq!(name("-s 1 1 7"), Some("7"));
        assert_eq!(name("-type sphere"), None);
        assert_eq!(name("-mm 0 1 -x.png"), Some("-x.png"));
    }

    #[test]
    fn scale_offset_and_clamp_are_obeyed() {
        let (statement, defects) =
            parsed("-s 2 -3 4 -o 0.5 -clamp ON -blendu off -mm 0 1 -BOOST 2 -colorspace sRGB a");
        let expected = TextureStatement {
            name: "a",
            scale: Vec2::new(2.0, -3.0),
            offset: Vec2::new(0.5, 0.0),
            clamp: true,
        };
        assert_eq!((statement, defects), (Some(expected), Vec::new()));
        let (statement, _) = parsed("-s 2 -clamp off a");
        let statement = statement.expect("it has a name");
        assert_eq!(
            (statement.scale, statement.clamp),
            (Vec2::new(2.0, 1.0), false)
        );
    }

    #[test]
    fn what_is_not_obeyed_is_a_defect() {
        for option in [
            "-mm 0 0.5",
            "-t 0 1",
            "-imfchan r",
            "-type sphere",
            "-cc on",
        ] {
            let text = format!("{option} a.png");
            let (statement, defects) = parsed(&text);
            assert!(statement.is_some_and(|s| s.name == "a.png"), "{option}");
            assert_eq!(defects, [Defect::MapOption], "{option}");
        }
        for option in ["-s nan 1", "-s 1e31", "-o"] {
            let text = format!("{option} a.png");
            let (statement, defects) = parsed(&text);
            let statement = statement.expect("it has a name");
            assert_eq!(defects, [Defect::ColourNumber], "{option}");
            assert_eq!(
                (statement.name, statement.scale, statement.offset),
                ("a.png", Vec2::ONE, Vec2::ZERO)
            );
        }
    }
}
