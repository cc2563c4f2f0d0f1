//! What a Rust source names: the paths of its imports and expressions, and its
//! words, without comments and texts. No more of the language is understood
//! than that takes.

/// A path as it is written, with the place where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Named {
    /// `crate::surface::{Ray, direct::hidden}` gives two of these.
    pub(crate) segments: Vec<String>,
    /// Line of the path's first word, from 1.
    pub(crate) line: usize,
    /// Modules with a body around it in the same file.
    pub(crate) depth: usize,
    /// Whether it stands in a module that exists in tests alone.
    pub(crate) in_tests: bool,
}

/// All paths of a source, also those of one word.
pub(crate) fn paths(source: &str) -> Vec<Named> {
    let mut walk = Walk {
        tokens: &tokens(source),
        next: 0,
        modules: Vec::new(),
        braces: 0,
        found: Vec::new(),
    };
    walk.run();
    walk.found
}

/// Names of the modules that are declared `#[cfg(test)] mod name;`: their files
/// exist in tests alone.
pub(crate) fn test_files(source: &str) -> Vec<String> {
    let tokens = tokens(source);
    let starts = (0..tokens.len()).filter(|&start| is_test_module(&tokens[..start]));
    starts
        .filter_map(|start| match &tokens[start..] {
            [keyword, name, end, ..] if keyword.text == "mod" && end.text == ";" => {
                Some(name.text.clone())
            }
            _ => None,
        })
        .collect()
}

/// Words that stand before `::name` without being part of that path.
const BEFORE_PATHS: [&str; 11] = [
    "use", "return", "in", "as", "dyn", "impl", "for", "mut", "match", "if", "else",
];

/// A word, `::`, or one character that is neither.
struct Token {
    text: String,
    line: usize,
}

impl Token {
    fn is_word(&self) -> bool {
        self.text.starts_with(is_word_part)
    }
}

fn is_word_part(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Whether what comes next stands behind `#[cfg(test)]`, with or without other
/// attributes between.
fn is_test_module(before: &[Token]) -> bool {
    let item = before
        .iter()
        .rposition(|token| matches!(token.text.as_str(), ";" | "{" | "}"));
    let attributes = &before[item.map_or(0, |end| end + 1)..];
    let wanted = ["cfg", "(", "test", ")"];
    attributes.windows(wanted.len()).any(|window| {
        window
            .iter()
            .zip(wanted)
            .all(|(token, text)| token.text == text)
    })
}

/// One pass over the tokens of a file.
struct Walk<'a> {
    tokens: &'a [Token],
    next: usize,
    /// Open modules: braces around each, and whether tests alone have it.
    modules: Vec<(usize, bool)>,
    braces: usize,
    found: Vec<Named>,
}

impl Walk<'_> {
    fn run(&mut self) {
        while self.next < self.tokens.len() {
            match self.text(0) {
                "mod" if self.text(2) == "{" => {
                    let tests = is_test_module(&self.tokens[..self.next]);
                    self.modules.push((self.braces, tests));
                    self.next += 2;
                }
                "{" => {
                    self.braces += 1;
                    self.next += 1;
                }
                "}" => {
                    self.braces = self.braces.saturating_sub(1);
                    self.modules.retain(|&(around, _)| around < self.braces);
                    self.next += 1;
                }
                _ if self.tokens[self.next].is_word() => self.path(&[]),
                _ => self.next += 1,
            }
        }
    }

    fn text(&self, ahead: usize) -> &str {
        let token = self.tokens.get(self.next + ahead);
        token.map_or("", |token| token.text.as_str())
    }

    /// A path from its first word on, behind the words that a group shares.
    fn path(&mut self, shared: &[String]) {
        let line = self.tokens[self.next].line;
        let mut segments = shared.to_vec();
        loop {
            let word = self.text(0).to_owned();
            let ends = BEFORE_PATHS.contains(&word.as_str());
            segments.push(word);
            self.next += 1;
            if ends || self.text(0) != "::" {
                break;
            }
            match self.text(1) {
                "{" => {
                    self.next += 2;
                    return self.group(&segments);
                }
                next if next.starts_with(is_word_part) => self.next += 1,
                _ => break,
            }
        }
        self.found.push(Named {
            segments,
            line,
            depth: self.modules.len(),
            in_tests: self.modules.iter().any(|&(_, tests)| tests),
        });
    }

    /// The paths of `{...}` in an import, whose brace is behind us.
    fn group(&mut self, shared: &[String]) {
        while self.next < self.tokens.len() && self.text(0) != "}" {
            if self.text(0) == "as" {
                self.next += 2;
            } else if self.tokens[self.next].is_word() {
                self.path(shared);
            } else {
                self.next += 1;
            }
        }
        self.next += 1;
    }
}

/// The tokens of a source, without comments, texts and characters.
fn tokens(source: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut rest = source;
    let mut line = 1;
    while let Some(first) = rest.chars().next() {
        let length = match first {
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            '/' if rest.starts_with("/*") => block_comment_length(rest),
            '"' => text_length(rest),
            '\'' => character_length(rest),
            'r' | 'b' | 'c' if raw_text_length(rest).is_some() => {
                raw_text_length(rest).unwrap_or(rest.len())
            }
            _ => {
                let length = if rest.starts_with("::") {
                    2
                } else if is_word_part(first) {
                    rest.find(|c| !is_word_part(c)).unwrap_or(rest.len())
                } else {
                    first.len_utf8()
                };
                if !first.is_whitespace() {
                    let text = rest[..length].to_owned();
                    tokens.push(Token { text, line });
                }
                length
            }
        };
        let (passed, ahead) = rest.split_at(length);
        line += passed.matches('\n').count();
        rest = ahead;
    }
    tokens
}

/// Block comments nest.
fn block_comment_length(text: &str) -> usize {
    let mut open = 0_usize;
    let mut at = 0;
    while at < text.len() {
        if text[at..].starts_with("/*") {
            open += 1;
            at += 2;
        } else if text[at..].starts_with("*/") {
            open -= 1;
            at += 2;
            if open == 0 {
                return at;
            }
        } else {
            at += text[at..].chars().next().map_or(1, char::len_utf8);
        }
    }
    text.len()
}

/// Length of a text that begins with its quotation mark.
fn text_length(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// Length of `'x'` or `'\n'`; of a lifetime, only its mark.
fn character_length(text: &str) -> usize {
    let mut characters = text.char_indices().skip(1);
    let (Some((_, first)), Some((second_at, second))) = (characters.next(), characters.next())
    else {
        return 1;
    };
    match (first, second) {
        ('\\', _) => text[second_at + second.len_utf8()..]
            .find('\'')
            .map_or(text.len(), |end| second_at + second.len_utf8() + end + 1),
        (_, '\'') => second_at + 1,
        _ => 1,
    }
}

/// Length of `r"..."`, `r#"..."#`, `br"..."` and the like.
fn raw_text_length(text: &str) -> Option<usize> {
    let mark = text.trim_start_matches(['b', 'c']);
    let prefix = text.len() - mark.len();
    let quoted = mark.strip_prefix('r').filter(|_| prefix <= 1)?;
    let hashes = quoted.len() - quoted.trim_start_matches('#').len();
    let inside = quoted[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let start = prefix + 1 + hashes + 1;
    Some(
        inside
            .find(&end)
            .map_or(text.len(), |at| start + at + end.len()),
    )
}
