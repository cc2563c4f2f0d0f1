//! Where something was written: what errors and warnings start with.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// A place in a file, or an argument of `--set`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Place {
    /// Line and column count from 1; column 0 stands for the whole line.
    File {
        file: Arc<str>,
        line: usize,
        column: usize,
    },
    /// The path of an override, such as `light.lamp.position`.
    Set { path: Arc<str> },
}

impl Place {
    /// A whole line of a file.
    pub(crate) fn of_line(path: &Path, line: usize) -> Self {
        Self::File {
            file: path.display().to_string().into(),
            line,
            column: 0,
        }
    }

    /// Whether it is an argument of `--set`.
    pub(crate) fn is_override(&self) -> bool {
        matches!(self, Self::Set { .. })
    }

    /// The same place without its column, for warnings.
    pub(crate) fn line_only(&self) -> Self {
        match self {
            Self::File { file, line, .. } => Self::File {
                file: file.clone(),
                line: *line,
                column: 0,
            },
            Self::Set { path } => Self::Set { path: path.clone() },
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File {
                file,
                line,
                column: 0,
            } => write!(f, "{file}:{line}"),
            Self::File { file, line, column } => write!(f, "{file}:{line}:{column}"),
            Self::Set { path } => write!(f, "--set {path}"),
        }
    }
}

/// Translates byte offsets of a text into lines and columns.
pub(crate) struct LineIndex<'a> {
    text: &'a str,
    file: Arc<str>,
    line_starts: Vec<usize>,
}

impl<'a> LineIndex<'a> {
    /// Index of `text`, which was read from `path`.
    pub(crate) fn new(text: &'a str, path: &Path) -> Self {
        let newlines = text.match_indices('\n').map(|(offset, _)| offset + 1);
        Self {
            text,
            file: path.display().to_string().into(),
            line_starts: std::iter::once(0).chain(newlines).collect(),
        }
    }

    /// Place of a byte offset; columns count characters, not bytes.
    pub(crate) fn place(&self, offset: usize) -> Place {
        let offset = offset.min(self.text.len());
        let line = self.line_starts.partition_point(|&start| start <= offset);
        let start = self.line_starts[line - 1];
        let before = self.text.get(start..offset).unwrap_or("");
        Place::File {
            file: self.file.clone(),
            line,
            column: before.chars().count() + 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let index = LineIndex::new("a = 1\né = 2\n", Path::new("s.toml"));
        assert_eq!(index.place(0).to_string(), "s.toml:1:1");
        assert_eq!(index.place(11).to_string(), "s.toml:2:5");
        assert_eq!(index.place(99).to_string(), "s.toml:3:1");
        assert_eq!(index.place(11).line_only().to_string(), "s.toml:2");
    }
}
