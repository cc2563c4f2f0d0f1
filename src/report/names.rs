//! Checks what the types of the model leave open: names and row lengths.

use std::collections::BTreeSet;

use super::page::RESERVED_ANCHORS;
use super::{Block, Report, ReportError, Table, picture_path};

/// Longest name; with folder and extension it fits any file system and archive.
const LONGEST_NAME: usize = 80;

/// Checks that every name is a slug, that no two parts share a link or a file,
/// and that every table is a rectangle.
pub(super) fn check(report: &Report) -> Result<(), ReportError> {
    let mut taken = Taken(RESERVED_ANCHORS.iter().map(|&it| it.to_owned()).collect());
    for section in &report.sections {
        taken.claim(&section.anchor)?;
    }
    for block in report.blocks() {
        taken.claim(block.name())?;
        match block {
            Block::Table(table) => check_rows(table)?,
            Block::Picture(picture) => taken.claim_file(picture_path(&picture.name))?,
            // "a" with its left picture and a picture "a-left" share a file.
            Block::Comparison(comparison) => {
                for (name, _) in comparison.named_images() {
                    if !is_slug(&name) {
                        return Err(ReportError::NotASlug(name));
                    }
                    taken.claim_file(picture_path(&name))?;
                }
            }
            Block::Plot(_) => {}
        }
    }
    Ok(())
}

/// Links and files that are in use. A file has a dot and a link has none.
struct Taken(BTreeSet<String>);

impl Taken {
    fn claim(&mut self, name: &str) -> Result<(), ReportError> {
        if !is_slug(name) {
            return Err(ReportError::NotASlug(name.to_owned()));
        }
        self.claim_file(name.to_owned())
    }

    fn claim_file(&mut self, path: String) -> Result<(), ReportError> {
        if self.0.contains(&path) {
            return Err(ReportError::NameTwice(path));
        }
        self.0.insert(path);
        Ok(())
    }
}

fn is_slug(name: &str) -> bool {
    let is_word = |word: &str| {
        let mut bytes = word.bytes();
        !word.is_empty() && bytes.all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit())
    };
    name.len() <= LONGEST_NAME && name.split('-').all(is_word)
}

fn check_rows(table: &Table) -> Result<(), ReportError> {
    let column_count = table.columns.len();
    let wrong = |&(_, count): &(usize, usize)| count != column_count;
    let counts = table.rows.iter().map(|row| row.cells.len());
    match counts.enumerate().find(wrong) {
        None => Ok(()),
        Some((index, cell_count)) => Err(ReportError::RowLength {
            table: table.name.clone(),
            row: index + 1,
            cell_count,
            column_count,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_words_with_single_hyphens() {
        for good in ["a", "speed-error", "4-bounces", &"x".repeat(LONGEST_NAME)] {
            assert!(is_slug(good), "{good}");
        }
        let long = "x".repeat(LONGEST_NAME + 1);
        for bad in [
            "", "-", "a-", "-a", "a--b", "A", "a b", "../a", "a.b", "ä", &long,
        ] {
            assert!(!is_slug(bad), "{bad}");
        }
    }
}
