//! Why a report cannot be written.

/// Why a report cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A name cannot stand in a file's name and in a link.
    #[error(
        "{0:?} cannot name a part of a report; \
         use 1 to 80 of a-z and 0-9 with single hyphens between them"
    )]
    NotASlug(String),
    /// Two parts would have the same link or the same file.
    #[error("two parts of the report are named {0:?}; rename one of them")]
    NameTwice(String),
    /// A row has too few or too many cells.
    #[error(
        "table {table}, row {row}: {cell_count} cells for {column_count} columns; \
         give every row one cell a column"
    )]
    RowLength {
        /// Name of the table.
        table: String,
        /// The row, from 1.
        row: usize,
        /// Cells that it has.
        cell_count: usize,
        /// Columns of the table.
        column_count: usize,
    },
    /// Bytes given as a picture are none.
    #[error("{byte_count} bytes given as a picture do not begin like a PNG file; encode it first")]
    NotPng {
        /// How many bytes were given.
        byte_count: usize,
    },
}
