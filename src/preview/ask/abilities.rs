//! The decision: which colours and which protocol are used.

use std::fmt;
use std::str::FromStr;

use super::answers::Answers;
use super::environment::Environment;
use crate::output::terminal::{Colours, Protocol};

/// What of a terminal is used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Abilities {
    /// Colours of cells.
    pub(crate) colours: Colours,
    /// How a scene at rest is shown in pixels, if it is.
    pub(crate) protocol: Option<Protocol>,
    /// Width and height of a cell, pixels.
    pub(crate) cell_px: Option<(u16, u16)>,
    /// What the terminal calls itself; empty where it does not say.
    pub(crate) name: String,
    /// Whether it says that it shows a frame only once it has all of it. It is
    /// asked to in any case: who does not know the marks leaves them out.
    pub(crate) is_synchronized: bool,
}

impl fmt::Display for Abilities {
    /// One line for people.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.name.as_str() {
            "" => "a terminal without a name",
            name => name,
        };
        let colours = match self.colours {
            Colours::True => "24-bit colours",
            Colours::Indexed256 => "256 colours",
            Colours::Luminance => "no colours",
        };
        write!(to, "{name}: {colours}")?;
        if let Some(protocol) = self.protocol {
            write!(to, ", pixels by {}", protocol.name())?;
        }
        if let Some((width, height)) = self.cell_px {
            write!(to, ", cells of {width} x {height} pixels")?;
        }
        match self.is_synchronized {
            true => write!(to, ", whole frames"),
            false => Ok(()),
        }
    }
}

/// Colours as a user asks for them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ColourChoice {
    /// What the terminal can do.
    #[default]
    Auto,
    /// These, whatever the terminal says.
    Use(Colours),
}

/// A protocol for pixels as a user asks for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ProtocolChoice {
    /// What the terminal can do.
    #[default]
    Auto,
    /// None: half blocks at rest too.
    Cells,
    /// This, whatever the terminal says.
    Use(Protocol),
}

/// A name that stands for no choice.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{given:?} is none of {names}")]
pub struct UnknownChoice {
    given: String,
    /// What can be given.
    names: String,
}

impl ColourChoice {
    /// The names that can be given.
    pub const NAMES: [&str; 4] = ["auto", "true", "256", "none"];
}

impl FromStr for ColourChoice {
    type Err = UnknownChoice;

    fn from_str(name: &str) -> Result<Self, UnknownChoice> {
        match name {
            "auto" => Ok(Self::Auto),
            "true" => Ok(Self::Use(Colours::True)),
            "256" => Ok(Self::Use(Colours::Indexed256)),
            "none" => Ok(Self::Use(Colours::Luminance)),
            _ => Err(UnknownChoice {
                given: name.to_owned(),
                names: Self::NAMES.join(", "),
            }),
        }
    }
}

impl ProtocolChoice {
    /// The names that can be given.
    pub fn names() -> Vec<&'static str> {
        let protocols = Protocol::ALL.map(Protocol::name);
        ["auto", "cells"].into_iter().chain(protocols).collect()
    }
}

impl FromStr for ProtocolChoice {
    type Err = UnknownChoice;

    fn from_str(name: &str) -> Result<Self, UnknownChoice> {
        match name {
            "auto" => Ok(Self::Auto),
            "cells" => Ok(Self::Cells),
            _ => name.parse().map(Self::Use).map_err(|_| UnknownChoice {
                given: name.to_owned(),
                names: Self::names().join(", "),
            }),
        }
    }
}

/// Attribute of terminals that draw sixels.
const SIXEL: u16 = 4;
/// Largest side of a cell that is believed, pixels.
const LARGEST_CELL: u16 = 256;
/// Beginnings of names (XTVERSION, `TERM_PROGRAM`) of terminals that show colours
/// of 24 bits in every version in use.
const TRUE_COLOUR_NAMES: [&str; 13] = [
    "kitty",
    "foot",
    "iTerm",
    "WezTerm",
    "ghostty",
    "Konsole",
    "VTE(",
    "contour",
    "mintty",
    "vscode",
    "rio",
    "alacritty",
    "tmux",
];
/// The same of `TERM`.
const TRUE_COLOUR_TERMS: [&str; 6] = [
    "xterm-kitty",
    "foot",
    "alacritty",
    "wezterm",
    "xterm-ghostty",
    "contour",
];
/// Beginnings of `TERM` of terminals that have 16 colours at most, or none.
const COLOURLESS_TERMS: [&str; 4] = ["dumb", "vt", "ansi", "cons25"];
/// Beginnings of names of terminals that draw iTerm2's images.
const ITERM2_NAMES: [&str; 3] = ["iTerm", "WezTerm", "mintty"];

/// Decides from all that is known; what a user asks for is not doubted.
pub(crate) fn decide(
    environment: &Environment,
    answers: &Answers,
    colours: ColourChoice,
    protocol: ProtocolChoice,
) -> Abilities {
    let known = Known {
        environment,
        answers,
    };
    let colours = match colours {
        ColourChoice::Auto => known.colours(),
        ColourChoice::Use(colours) => colours,
    };
    let protocol = match protocol {
        ProtocolChoice::Auto => known.protocol(colours),
        ProtocolChoice::Cells => None,
        ProtocolChoice::Use(protocol) => Some(protocol),
    };
    let is_likely = |&(width, height): &(u16, u16)| width.max(height) <= LARGEST_CELL;
    Abilities {
        colours,
        protocol,
        cell_px: answers.cell_px.filter(is_likely),
        name: answers.name.clone().unwrap_or_default(),
        is_synchronized: answers.synchronized == Some(true),
    }
}

/// All that is known of a terminal.
struct Known<'a> {
    environment: &'a Environment,
    answers: &'a Answers,
}

impl Known<'_> {
    /// The terminal's own word first: it has been given a colour and asked what
    /// became of it. tmux takes 24 bits and gives its own terminal what that can
    /// do; screen, unless it is told to, takes a palette and garbles the rest.
    fn colours(&self) -> Colours {
        let environment = self.environment;
        if environment.wants_no_colour {
            return Colours::Luminance;
        }
        let has_true_colour = match self.answers.true_colour {
            Some(kept) => kept,
            None if environment.is_screen => false,
            None => self.is_said_to_have_true_colour(),
        };
        if has_true_colour {
            return Colours::True;
        }
        if starts_with_any(&environment.term, &COLOURLESS_TERMS) || environment.term.is_empty() {
            return Colours::Luminance;
        }
        Colours::Indexed256
    }

    fn is_said_to_have_true_colour(&self) -> bool {
        let environment = self.environment;
        // Apple's takes 24 bits for other attributes, whatever is set around it.
        if environment.program == "Apple_Terminal" && !environment.is_tmux {
            return false;
        }
        environment.says_true_colour
            || environment.is_tmux
            || environment.term.ends_with("-direct")
            || starts_with_any(&environment.term, &TRUE_COLOUR_TERMS)
            || self.is_named(&TRUE_COLOUR_NAMES)
    }

    /// Behind another program none: see the protocols. Where no colours are
    /// wanted none either.
    fn protocol(&self, colours: Colours) -> Option<Protocol> {
        let name = self.answers.name.as_deref().unwrap_or_default();
        let is_behind_another = self.environment.is_behind_another()
            || name.starts_with("tmux")
            || name.starts_with("screen");
        if is_behind_another || colours == Colours::Luminance {
            return None;
        }
        let has_sixel = self
            .answers
            .attributes
            .iter()
            .flatten()
            .any(|&it| it == SIXEL);
        if self.answers.kitty == Some(true) {
            Some(Protocol::Kitty)
        } else if self.is_named(&ITERM2_NAMES) {
            Some(Protocol::Iterm2)
        } else {
            has_sixel.then_some(Protocol::Sixel)
        }
    }

    /// Whether the terminal's name begins like one of these: what it says itself,
    /// else what the environment says.
    fn is_named(&self, names: &[&str]) -> bool {
        match self.answers.name.as_deref() {
            Some(name) => starts_with_any(name, names),
            None => starts_with_any(&self.environment.program, names),
        }
    }
}

fn starts_with_any(text: &str, beginnings: &[&str]) -> bool {
    beginnings.iter().any(|it| text.starts_with(it))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::ask::answers::Heard;

    fn decided(variables: &[(&str, &str)], said: &[u8]) -> (Colours, Option<Protocol>) {
        let environment = Environment::read(|name| {
            let found = variables.iter().find(|(known, _)| *known == name);
            found.map(|(_, value)| (*value).to_owned())
        });
        let answers = Heard::read(said).answers;
        let abilities = decide(
            &environment,
            &answers,
            ColourChoice::Auto,
            ProtocolChoice::Auto,
        );
        (abilities.colours, abilities.protocol)
    }

    const KITTY: &[u8] = b"\x1bP1$r48:2:1:2:3m\x1b\\\x1b_Gi=7497068;OK\x1b\\\x1b[?62;c";
    const TMUX: &[u8] = b"\x1bP>|tmux 3.4\x1b\\\x1b[?1;2;4c";

    #[test]
    fn terminals_get_what_they_can() {
        let xterm = ("TERM", "xterm-256color");
        for (variables, said, wanted) in [
            (&[xterm][..], KITTY, (Colours::True, Some(Protocol::Kitty))),
            (&[xterm], b"", (Colours::Indexed256, None)),
            (
                &[xterm],
                b"\x1b[?62;4c",
                (Colours::Indexed256, Some(Protocol::Sixel)),
            ),
            (
                &[xterm],
                b"\x1bP>|iTerm2 3.5\x1b\\\x1b[?62;4c",
                (Colours::True, Some(Protocol::Iterm2)),
            ),
            (
                &[("TERM", "vt220")],
                b"\x1b[?62c",
                (Colours::Luminance, None),
            ),
            (&[("TERM", "linux")], b"", (Colours::Indexed256, None)),
            (&[], b"", (Colours::Luminance, None)),
            (
                &[xterm, ("NO_COLOR", "1")],
                KITTY,
                (Colours::Luminance, None),
            ),
            (&[xterm, ("TMUX", "x")], TMUX, (Colours::True, None)),
            // Over ssh nothing but the answer names tmux.
            (&[xterm], TMUX, (Colours::True, None)),
            (
                &[("TERM", "screen"), ("COLORTERM", "truecolor")],
                b"",
                (Colours::Indexed256, None),
            ),
        ] {
            assert_eq!(decided(variables, said), wanted, "{variables:?} {said:?}");
        }
    }

    #[test]
    fn a_lie_about_colours_is_found_out() {
        let lies = [("TERM", "xterm"), ("COLORTERM", "truecolor")];
        assert_eq!(decided(&lies, b"").0, Colours::True);
        let said = b"\x1bP1$r0;48:5:16m\x1b\\\x1b[?64;1c";
        assert_eq!(decided(&lies, said).0, Colours::Indexed256);
    }

    #[test]
    fn a_users_word_is_taken() {
        let environment = Environment::read(|name| (name == "TMUX").then(|| "x".to_owned()));
        let answers = Answers {
            cell_px: Some((60_000, 2)),
            ..Answers::default()
        };
        let colours = "256".parse().unwrap();
        let abilities = decide(&environment, &answers, colours, "sixel".parse().unwrap());
        assert_eq!(abilities.colours, Colours::Indexed256);
        assert_eq!(abilities.protocol, Some(Protocol::Sixel));
        assert_eq!(abilities.cell_px, None, "no cell is that large");
    }

    #[test]
    fn abilities_are_told_in_a_line() {
        let said = b"\x1b_Gi=7497068;OK\x1b\\\x1bP>|kitty(0.35.2)\x1b\\\x1b[6;40;18t\x1b[?2026;2$y";
        let (auto, answers) = (ColourChoice::Auto, Heard::read(said).answers);
        let environment = Environment::read(|name| (name == "TERM").then(|| "xterm".to_owned()));
        let known = decide(&environment, &answers, auto, ProtocolChoice::Auto);
        assert_eq!(
            known.to_string(),
            "kitty(0.35.2): 24-bit colours, pixels by kitty, cells of 18 x 40 pixels, whole frames"
        );
        let nothing = Answers::default();
        let unknown = decide(&environment, &nothing, auto, ProtocolChoice::Auto);
        assert_eq!(
            unknown.to_string(),
            "a terminal without a name: 256 colours"
        );
    }

    #[test]
    fn choices_have_names() {
        for name in ColourChoice::NAMES {
            assert!(name.parse::<ColourChoice>().is_ok(), "{name}");
        }
        for name in ProtocolChoice::names() {
            assert!(name.parse::<ProtocolChoice>().is_ok(), "{name}");
        }
        let error = "ascii".parse::<ProtocolChoice>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "\"ascii\" is none of auto, cells, kitty, iterm2, sixel"
        );
    }
}
