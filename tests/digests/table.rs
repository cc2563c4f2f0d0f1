//! The table of digests, `golden/digests.txt`: a line a frame.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Environment variable that makes the test write the table.
pub(crate) const UPDATE: &str = "RELUME_UPDATE_DIGESTS";

const HEADER: &str = "\
# What every machine must give for the scenes in their reduced bakes, see
# tests/digests. Written anew by
# RELUME_UPDATE_DIGESTS=1 cargo test --test digests -- --include-ignored
# frame            linear values (EXR)              levels (PNG)                     file of the bake
";

/// Tests run side by side, and each writes lines of one file.
static WRITING: Mutex<()> = Mutex::new(());

/// Digests of a frame and of the bake that it was drawn from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Row {
    /// Of the linear values, as an EXR has them.
    pub(crate) linear: String,
    /// Of the 8-bit levels, as a PNG has them.
    pub(crate) levels: String,
    /// Of the bytes of the bake's file.
    pub(crate) bake: String,
}

/// All rows, by the frame's name.
pub(crate) fn rows() -> BTreeMap<String, Row> {
    let path = path();
    let text = fs::read_to_string(&path).unwrap_or_else(|error| {
        panic!("{} cannot be read: {error}", path.display());
    });
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines.map(row).collect()
}

fn row(line: &str) -> (String, Row) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [name, linear, levels, bake] = words[..] else {
        panic!("a line has a name and three digests: {line:?}");
    };
    let [linear, levels, bake] = [linear, levels, bake].map(str::to_owned);
    let row = Row {
        linear,
        levels,
        bake,
    };
    (name.to_owned(), row)
}

/// Writes some rows; others stay.
pub(crate) fn write(found: &[(String, Row)]) {
    // A test that panicked while it held the lock had nothing half written.
    let _writing = WRITING.lock().unwrap_or_else(|broken| broken.into_inner());
    let mut rows = if path().exists() {
        rows()
    } else {
        BTreeMap::new()
    };
    rows.extend(found.iter().cloned());
    let line = |(name, row): (&String, &Row)| {
        format!("{name:18} {} {} {}\n", row.linear, row.levels, row.bake)
    };
    let text: String = rows.iter().map(line).collect();
    fs::write(path(), format!("{HEADER}{text}")).expect("the table can be written");
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/digests.txt")
}
