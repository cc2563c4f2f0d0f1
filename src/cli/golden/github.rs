//! What GitHub shows of a check that runs there: an annotation a failure, and
//! the job's summary.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use relume::golden::Checked;

use super::check::stray_text;
use super::{text_of, warn};
use crate::cli::run::say;

/// Says the verdicts as GitHub reads them, where it does. Annotations go to
/// standard error, of which GitHub reads them as well: standard output may have
/// to hold one JSON object alone.
pub(super) fn tell(checked: &[Checked], without_scene: &[PathBuf]) {
    if std::env::var_os("GITHUB_ACTIONS").is_some_and(|it| it == "true") {
        let workspace = std::env::var_os("GITHUB_WORKSPACE").map(PathBuf::from);
        let workspace = workspace.and_then(|it| it.canonicalize().ok());
        say(&annotations(checked, without_scene, workspace.as_deref()));
    }
    if let Some(path) = std::env::var_os("GITHUB_STEP_SUMMARY").filter(|it| !it.is_empty()) {
        let text = step_summary(checked, without_scene);
        let file = std::fs::OpenOptions::new()
            .append(true)
            .create(true)
            .open(&path);
        if let Err(error) = file.and_then(|mut file| file.write_all(text.as_bytes())) {
            let path = Path::new(&path).display();
            warn(vec![format!(
                "{path}: the job's summary could not be written: {error}"
            )]);
        }
    }
}

fn annotations(
    checked: &[Checked],
    without_scene: &[PathBuf],
    workspace: Option<&Path>,
) -> Vec<String> {
    let failed = checked.iter().filter(|it| !it.passes());
    let errors = failed.map(|one| {
        let problems = one.verdict.problems().join("; ");
        annotation("error", one.scene.scene(), workspace, &problems)
    });
    let strays = without_scene
        .iter()
        .map(|it| annotation("warning", it, workspace, &stray_text(it)));
    errors.chain(strays).collect()
}

/// A workflow command; its file is relative to the repository.
fn annotation(level: &str, file: &Path, workspace: Option<&Path>, message: &str) -> String {
    let whole = file.canonicalize().ok();
    let inside = whole
        .as_deref()
        .zip(workspace)
        .and_then(|(it, top)| it.strip_prefix(top).ok());
    let file = text_of(inside.unwrap_or(file)).replace('\\', "/");
    format!(
        "::{level} file={},title=golden image::{}",
        property(&file),
        data(message)
    )
}

/// Escapes a message of a workflow command.
fn data(text: &str) -> String {
    let text = text.replace('%', "%25");
    text.replace('\r', "%0D").replace('\n', "%0A")
}

/// Escapes a property of a workflow command.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

fn step_summary(checked: &[Checked], without_scene: &[PathBuf]) -> String {
    let failed = checked.iter().filter(|it| !it.passes()).count();
    let mut text = format!(
        "### Golden images: {} of {} pass\n\n",
        checked.len() - failed,
        checked.len()
    );
    if failed > 0 {
        text.push_str("| scene | verdict | what |\n|---|---|---|\n");
    }
    for one in checked.iter().filter(|it| !it.passes()) {
        let cells = [
            text_of(one.scene.scene()),
            one.verdict.name().to_owned(),
            one.verdict.problems().join("; "),
        ];
        let [scene, verdict, what] = cells.map(|cell| plain(&cell));
        text.push_str(&format!("| {scene} | {verdict} | {what} |\n"));
    }
    for golden in without_scene {
        text.push_str(&format!("\n{}\n", plain(&stray_text(golden))));
    }
    text.push('\n');
    text
}

/// A text that Markdown shows as it is: everything with a meaning there becomes
/// a character reference.
fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for letter in text.chars() {
        let is_safe = letter.is_alphanumeric() || " /.,-".contains(letter);
        let is_control = letter.is_control();
        match letter {
            _ if is_control => plain.push(' '),
            _ if is_safe => plain.push(letter),
            _ => {
                // Writing to a text cannot fail.
                let _ = write!(plain, "&#{};", u32::from(letter));
            }
        }
    }
    plain
}

/// A text as it may stand in a line of the log, where GitHub obeys what looks
/// like a command of a workflow: names and keys come from whoever wrote the
/// scenes. A command is what begins a line with `::`, blanks aside, or has `##[`
/// anywhere (`ActionCommand.cs` of actions/runner); and control characters would
/// begin a line. These become escapes as Rust and, nearly, TOML write them.
pub(in crate::cli) fn printable(text: &str) -> String {
    let mut printable = String::with_capacity(text.len());
    for (place, letter) in text.char_indices() {
        let (before, rest) = text.split_at(place);
        let begins_line = before.trim_start().is_empty() && rest.starts_with("::");
        if letter.is_control() {
            printable.extend(letter.escape_default());
        } else if begins_line || rest.starts_with("##[") {
            printable.extend(letter.escape_unicode());
        } else {
            printable.push(letter);
        }
    }
    printable
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_a_meaning_is_escaped() {
        assert_eq!(property("a:b,c%\nd"), "a%3Ab%2Cc%25%0Ad");
        assert_eq!(data("50%: a\r\nb"), "50%25: a%0D%0Ab");
        assert_eq!(plain("a|b <i>`x`\n"), "a&#124;b &#60;i&#62;&#96;x&#96; ");
    }

    #[test]
    fn no_text_is_a_command() {
        assert_eq!(printable("a::b #[c] ## é"), "a::b #[c] ## é");
        assert_eq!(printable("a\n::b\r\u{1b}"), r"a\n::b\r\u{1b}");
        assert_eq!(printable(" ::b::c"), r" \u{3a}:b::c");
        assert_eq!(printable("a ###[b]"), r"a #\u{23}#[b]");
    }
}
