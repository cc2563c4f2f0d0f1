//! Statements of an OBJ or MTL file, line by line.

use std::borrow::Cow;

/// A line that says something.
#[derive(Debug, Clone, Copy)]
pub(super) struct Statement<'a> {
    /// Counts from 1.
    pub(super) line: usize,
    pub(super) keyword: &'a str,
    /// What follows the keyword, trimmed; may end with a comment.
    pub(super) rest: &'a str,
}

impl<'a> Statement<'a> {
    /// The words up to a comment. A comment starts a word, since Microsoft's
    /// library wrote infinity as `1.#INF`.
    pub(super) fn words(&self) -> impl Iterator<Item = &'a str> + Clone + use<'a> {
        let words = self.rest.split_whitespace();
        words.take_while(|word| !word.starts_with('#'))
    }
}

/// Text with lines that end in `\n` and no statement that spans lines. A
/// statement continued by a back-slash is joined; empty lines make up for the
/// ones that it took, so that line numbers stay.
pub(super) fn normalized(text: &str) -> Cow<'_, str> {
    let text = if has_lone_carriage_return(text) {
        // Two of them are a line end that was translated twice.
        let once = text.replace("\r\r\n", "\n").replace("\r\n", "\n");
        Cow::Owned(once.replace('\r', "\n"))
    } else {
        Cow::Borrowed(text)
    };
    if text.contains("\\\n") || text.contains("\\\r\n") || text.ends_with('\\') {
        Cow::Owned(joined(&text))
    } else {
        text
    }
}

/// Whether a line ends as those of old Macintoshes do.
fn has_lone_carriage_return(text: &str) -> bool {
    let bytes = text.as_bytes();
    let mut returns = text.match_indices('\r');
    returns.any(|(offset, _)| bytes.get(offset + 1) != Some(&b'\n'))
}

fn joined(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    let mut owed = 0;
    for line in text.lines() {
        // A comment may end with the path of a folder.
        let is_comment = owed == 0 && line.trim_start().starts_with('#');
        let start = line.strip_suffix('\\').filter(|_| !is_comment);
        if let Some(start) = start {
            result.push_str(start);
            result.push(' ');
            owed += 1;
        } else {
            result.push_str(line);
            result.extend(std::iter::repeat_n('\n', owed + 1));
            owed = 0;
        }
    }
    result
}

/// The statements of a normalised text, comments and empty lines left out.
pub(super) fn statements(text: &str) -> impl Iterator<Item = Statement<'_>> {
    text.lines().enumerate().filter_map(|(index, line)| {
        let line = line.trim_matches(|c: char| c.is_whitespace() || c == '\u{1a}');
        if line.is_empty() || line.starts_with('#') {
            return None;
        }
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        Some(Statement {
            line: index + 1,
            keyword,
            rest: rest.trim(),
        })
    })
}

/// A number, or NaN for the notations of what is not finite; `None` for text
/// that is no number.
pub(super) fn number(word: &str) -> Option<f64> {
    let lower = word.to_ascii_lowercase();
    match word.parse() {
        Ok(number) => Some(number),
        Err(_) if lower.contains("#in") || lower.contains("#q") || lower.contains("#s") => {
            Some(f64::NAN)
        }
        Err(_) if lower.trim_start_matches(['-', '+']).starts_with("nan") => Some(f64::NAN),
        Err(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn continued_statements_keep_the_line_numbers() {
        let text = normalized("f 1 \\\r\n  2 \\\n 3 # end\n\tv 1 2 3\n");
        let found: Vec<_> = statements(&text).collect();
        assert_eq!(found[0].words().collect::<Vec<_>>(), ["1", "2", "3"]);
        assert_eq!((found[1].line, found[1].keyword), (4, "v"));
        let lines = |text| {
            let text = normalized(text);
            let found = statements(&text).map(|s| format!("{} {}{}", s.line, s.keyword, s.rest));
            found.collect::<Vec<_>>()
        };
        for text in ["a\rb\r", "a\r\nb\r\n", "a\r\r\nb", "a\rb\n", "a\nb\\"] {
            assert_eq!(lines(text), ["1 a", "2 b"], "{text:?}");
        }
        assert_eq!(lines("# C:\\models\\\nf 1\\\n2"), ["2 f1 2"]);
    }

    #[test]
    fn numbers_that_are_not_finite() {
        for word in ["1.#IND", "-1.#INF", "nan(ind)", "-nan", "inf", "1.#QNAN"] {
            assert!(number(word).is_some_and(|x| !x.is_finite()), "{word}");
        }
        assert_eq!(number(".8e-001"), Some(0.08));
        assert_eq!(number("1,5"), None);
    }
}
