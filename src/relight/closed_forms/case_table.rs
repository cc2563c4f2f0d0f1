//! The tests that the table of cases names exist, by the sources themselves.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Rows of the table of cases: none goes unseen.
const ROWS: usize = 59;

/// Names of the functions behind `#[test]`, and whether they are ignored.
fn tests_below(folder: &Path, found: &mut BTreeSet<(String, bool)>) {
    for entry in fs::read_dir(folder).expect("a folder of the sources can be listed") {
        let path = entry.expect("its entries can be read").path();
        if path.is_dir() {
            tests_below(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let text = fs::read_to_string(&path).expect("a source file is text");
            for after in text.split("#[test]").skip(1) {
                let (attributes, function) = after.split_once("fn ").unwrap_or_default();
                let name = function.split('(').next().unwrap_or_default();
                found.insert((name.to_owned(), attributes.contains("#[ignore")));
            }
        }
    }
}

#[test]
fn every_test_of_the_table_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut tests = BTreeSet::new();
    for folder in ["src", "tests"] {
        tests_below(&root.join(folder), &mut tests);
    }
    let rows = include_str!("../closed_forms.rs")
        .lines()
        .skip_while(|line| !line.starts_with("//! | case |"))
        .skip(2)
        .take_while(|line| line.starts_with("//! |"));
    let mut count = 0;
    for row in rows {
        let name = row.split('`').nth(1).expect("a row names a test");
        // The comparison with another renderer needs that renderer.
        let is_ignored = name == "relume_agrees_with_mitsuba";
        assert!(
            tests.contains(&(name.to_owned(), is_ignored)),
            "no test of this name, or it is ignored: {row}"
        );
        count += 1;
    }
    assert_eq!(count, ROWS, "rows of the table");
}
