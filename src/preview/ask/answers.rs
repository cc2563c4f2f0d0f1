//! What a terminal says about itself, told from what a user types.
//!
//! Total: any bytes give some answer, and what is no answer is handed back in
//! its order.

/// Longest answer that is waited for to its end, bytes. A name or a colour takes
/// some dozens.
const LONGEST: usize = 512;

/// What a terminal has said; what it has not is none.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Answers {
    /// Primary device attributes: the class of terminal, then what it can do.
    pub(crate) attributes: Option<Vec<u16>>,
    /// Whether kitty's graphics are understood.
    pub(crate) kitty: Option<bool>,
    /// Name and version.
    pub(crate) name: Option<String>,
    /// Width and height of a cell, pixels.
    pub(crate) cell_px: Option<(u16, u16)>,
    /// Whether frames can be synchronized.
    pub(crate) synchronized: Option<bool>,
    /// Whether a colour of 24 bits has been kept as it was given.
    pub(crate) true_colour: Option<bool>,
}

impl Answers {
    /// Whether the answer is there that everyone gives, to the last question.
    pub(crate) fn is_complete(&self) -> bool {
        self.attributes.is_some()
    }

    /// Whether nothing has been said.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Bytes from a terminal, sorted.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Heard {
    /// What is understood.
    pub(crate) answers: Answers,
    /// What is no answer: keys, as they came.
    pub(crate) rest: Vec<u8>,
}

impl Heard {
    /// Sorts bytes. An answer that is cut at the end is dropped, for its other half is no key
    /// either; a lone escape there is a key.
    pub(crate) fn read(bytes: &[u8]) -> Self {
        let mut heard = Self::default();
        let mut left = bytes;
        while let Some((&first, behind)) = left.split_first() {
            let sequence = Sequence::at_start(left);
            match sequence {
                Some(sequence) if heard.answers.take(&sequence) => {
                    left = &left[sequence.length..];
                }
                Some(sequence) if sequence.is_string() || sequence.is_cut => {
                    left = &left[sequence.length..];
                }
                // A key's sequence goes as a whole, so that its inside is not
                // taken for something.
                Some(sequence) => {
                    heard.rest.extend_from_slice(&left[..sequence.length]);
                    left = &left[sequence.length..];
                }
                None => {
                    heard.rest.push(first);
                    left = behind;
                }
            }
        }
        heard
    }
}

/// A control sequence or string at the start of some bytes.
struct Sequence<'a> {
    /// `[` for CSI; `P`, `_`, `]`, `^`, `X` for strings.
    kind: u8,
    /// What stands between the introducer and the end; of CSI with its final byte.
    inner: &'a [u8],
    /// Bytes with the introducer and the end.
    length: usize,
    /// Whether its end has not come.
    is_cut: bool,
}

impl<'a> Sequence<'a> {
    fn at_start(bytes: &'a [u8]) -> Option<Self> {
        let [0x1b, kind, inner @ ..] = bytes else {
            return None;
        };
        match kind {
            b'[' => Some(Self::control(inner)),
            b'P' | b'_' | b']' | b'^' | b'X' => Self::string(*kind, inner),
            _ => None,
        }
    }

    /// CSI: parameters and intermediates up to a final byte. One that is broken off
    /// by another byte ends before it.
    fn control(inner: &'a [u8]) -> Self {
        let place = inner.iter().position(|byte| !(0x20..0x40).contains(byte));
        let (end, is_cut) = match place {
            Some(place) if (0x40..0x7f).contains(&inner[place]) => (place + 1, false),
            Some(place) => (place, false),
            None => (inner.len(), !inner.is_empty()),
        };
        Self {
            kind: b'[',
            inner: &inner[..end],
            length: 2 + end,
            is_cut,
        }
    }

    /// A string up to `ESC \` or, as some end theirs, BEL. One without end within
    /// the longest answer is none: alt and a letter were typed.
    fn string(kind: u8, inner: &'a [u8]) -> Option<Self> {
        let window = &inner[..inner.len().min(LONGEST)];
        let place = window.iter().position(|&byte| byte == 0x1b || byte == 0x07);
        let (inner, end) = match place {
            Some(place) if window[place] == 0x07 => (&window[..place], 1),
            Some(place) if window.get(place + 1) == Some(&b'\\') => (&window[..place], 2),
            Some(_) => return None,
            None if looks_like_answer(kind, window) => (window, 0),
            None => return None,
        };
        Some(Self {
            kind,
            inner,
            length: 2 + inner.len() + end,
            is_cut: end == 0,
        })
    }

    fn is_string(&self) -> bool {
        self.kind != b'['
    }
}

/// Whether a string without its end begins as an answer to a question does.
fn looks_like_answer(kind: u8, inner: &[u8]) -> bool {
    match kind {
        b'P' => inner.starts_with(b">|") || inner.get(1..3) == Some(b"$r"),
        b'_' => inner.starts_with(b"Gi="),
        _ => false,
    }
}

impl Answers {
    /// Takes an answer in; says whether it was one.
    fn take(&mut self, sequence: &Sequence<'_>) -> bool {
        let Ok(text) = std::str::from_utf8(sequence.inner) else {
            return false;
        };
        if sequence.is_cut {
            return false;
        }
        match sequence.kind {
            b'[' => self.take_control(text),
            b'P' => self.take_device_string(text),
            b'_' => self.take_graphics(text),
            _ => false,
        }
    }

    fn take_control(&mut self, text: &str) -> bool {
        if let Some(list) = between(text, "?", "c") {
            self.attributes = Some(numbers(list).into_iter().flatten().collect());
        } else if let Some(list) = between(text, "?", "$y") {
            if let [Some(2026), Some(state)] = numbers(list)[..] {
                // 1 and 2: set and reset; 0, 3 and 4: unknown, or it never changes.
                self.synchronized = Some(matches!(state, 1 | 2));
            }
        } else if let Some(list) = between(text, "6;", "t") {
            if let [Some(height @ 1..), Some(width @ 1..)] = numbers(list)[..] {
                self.cell_px = Some((width, height));
            }
        } else {
            return false;
        }
        true
    }

    /// XTVERSION and DECRQSS.
    fn take_device_string(&mut self, text: &str) -> bool {
        if let Some(name) = text.strip_prefix(">|") {
            self.name = Some(name.to_owned());
        } else if let Some(colours) = between(text, "1$r", "m") {
            self.true_colour = Some(has_asked_colour(colours));
        } else {
            return text.starts_with("0$r") || text.starts_with("1$r");
        }
        true
    }

    fn take_graphics(&mut self, text: &str) -> bool {
        let Some((keys, words)) = text.strip_prefix('G').and_then(|it| it.split_once(';')) else {
            return false;
        };
        let is_ours = keys.split(',').any(|key| key == "i=7497068");
        if is_ours {
            self.kitty = Some(words == "OK");
        }
        is_ours
    }
}

/// What stands between a prefix and a suffix.
fn between<'a>(text: &'a str, prefix: &str, suffix: &str) -> Option<&'a str> {
    text.strip_prefix(prefix)?.strip_suffix(suffix)
}

/// Numbers between semicolons, each none where there is no number of 16 bits.
fn numbers(list: &str) -> Vec<Option<u16>> {
    list.split(';').map(|number| number.parse().ok()).collect()
}

/// Whether an SGR string holds the paper of [`QUESTIONS`](super::QUESTIONS):
/// 48, 2, maybe an empty or zero colour space, then 1, 2, 3. A terminal that has
/// replaced the colour by one of its palette says 48, 5.
fn has_asked_colour(text: &str) -> bool {
    let parts: Vec<&str> = text.split([';', ':']).collect();
    parts.windows(2).enumerate().any(|(place, pair)| {
        let rest = &parts[place + 2..];
        let rest = match rest.first() {
            Some(&("" | "0")) => &rest[1..],
            _ => rest,
        };
        pair == ["48", "2"] && rest.starts_with(&["1", "2", "3"])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hash::hash3;

    fn heard(bytes: &[u8]) -> (Answers, String) {
        let heard = Heard::read(bytes);
        (heard.answers, String::from_utf8(heard.rest).unwrap())
    }

    #[test]
    fn kitty_says_all() {
        let (answers, rest) = heard(
            b"\x1bP1$r48:2:1:2:3m\x1b\\\x1b_Gi=7497068;OK\x1b\\\x1bP>|kitty(0.35.2)\x1b\\\
              \x1b[6;40;18t\x1b[?2026;2$y\x1b[?62;c",
        );
        let wanted = Answers {
            attributes: Some(vec![62]),
            kitty: Some(true),
            name: Some("kitty(0.35.2)".to_owned()),
            cell_px: Some((18, 40)),
            synchronized: Some(true),
            true_colour: Some(true),
        };
        assert_eq!((answers, rest), (wanted, String::new()));
    }

    #[test]
    fn xterm_with_a_palette_says_that_the_colour_is_another() {
        let (answers, rest) = heard(
            b"\x1bP1$r0;48:5:16m\x1b\\\x1bP>|XTerm(379)\x1b\\\x1b[6;13;6t\x1b[?2026;0$y\
              \x1b[?64;1;2;4;6;9;15;18;21;22;28c",
        );
        assert_eq!(answers.true_colour, Some(false));
        assert_eq!(answers.synchronized, Some(false));
        assert_eq!(answers.cell_px, Some((6, 13)));
        assert!(answers.attributes.unwrap().contains(&4));
        assert_eq!((answers.kitty, rest.as_str()), (None, ""));
    }

    #[test]
    fn foot_iterm2_and_tmux_are_understood() {
        let (foot, _) = heard(
            b"\x1bP1$r0;48:2::1:2:3m\x1b\\\x1bP>|foot(1.16.2)\x1b\\\x1b[6;17;8t\
              \x1b[?2026;2$y\x1b[?62;4;22;28c",
        );
        assert_eq!((foot.true_colour, foot.kitty), (Some(true), None));
        let (iterm2, _) =
            heard(b"\x1bP1$r0;48;2;1;2;3m\x1b\\\x1bP>|iTerm2 3.5.0\x1b\\\x1b[?2026;2$y\x1b[?62;4c");
        assert_eq!(iterm2.name.as_deref(), Some("iTerm2 3.5.0"));
        assert_eq!(iterm2.true_colour, Some(true));
        let (tmux, rest) = heard(b"\x1bP0$r\x1b\\\x1bP>|tmux 3.4\x1b\\\x1b[?1;2c");
        assert_eq!(tmux.true_colour, None);
        assert_eq!(tmux.attributes, Some(vec![1, 2]));
        assert_eq!(rest, "");
    }

    #[test]
    fn what_is_typed_meanwhile_is_handed_back() {
        let (answers, rest) = heard(b"q\x1b[A\x1b[?62c\x1b[1;5Dx\x1bOPy\x1bPz\x1b");
        assert_eq!(answers.attributes, Some(vec![62]));
        assert_eq!(rest, "q\x1b[A\x1b[1;5Dx\x1bOPy\x1bPz\x1b");
        assert_eq!(heard(b""), (Answers::default(), String::new()));
    }

    #[test]
    fn a_cut_answer_is_no_key() {
        for cut in [
            &b"\x1b[?62;"[..],
            b"\x1bP>|kit",
            b"\x1bP1$r48:2",
            b"\x1b_Gi=7497068;O",
        ] {
            assert_eq!(heard(cut), (Answers::default(), String::new()));
        }
    }

    #[test]
    fn nonsense_is_taken_without_harm() {
        for lie in [
            &b"\x1b[6;0;0t"[..],
            b"\x1b[6;99999999;1t",
            b"\x1b[?2026;999999$y",
            b"\x1b_Gi=1;OK\x1b\\",
            b"\x1b[?$y",
            b"\x1b]11;rgb:00/00/00\x07",
        ] {
            let (answers, rest) = heard(lie);
            assert_eq!((answers.is_empty(), rest.as_str()), (true, ""), "{lie:?}");
        }
        let parts: [&[u8]; 12] = [
            b"\x1b", b"[", b"P", b"_", b"\\", b"?", b";", b"62", b"c", b"$y", b"\x07", b"\xff",
        ];
        for seed in 0..5_000 {
            let pick = |index| parts[(hash3(seed, index, 0) % 12) as usize];
            let bytes = (0..seed % 24).flat_map(pick).copied().collect::<Vec<u8>>();
            let heard = Heard::read(&bytes);
            assert!(heard.rest.len() <= bytes.len());
        }
    }
}
