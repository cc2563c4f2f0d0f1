//! `relume golden check`: every scene against its golden, with a report.

use std::fs;
use std::path::{Path, PathBuf};

use relume::golden::{Checked, Suite, Verdict, junit, picture_names, report_files};
use relume::report::ReportFile;
use relume::{OutputError, write_folder};
use serde_json::Value;

use super::arguments::Check;
use super::github::printable;
use super::{check_all, counted, exit_code, github, suite, summary, text_of, warn};
use crate::cli::error::CliError;
use crate::cli::report::Report;

/// The report for programs.
const SUMMARY: &str = "summary.json";
/// The page, which stands last: when it is there, so is what it links to.
const PAGE: &str = "report.html";

pub(super) fn execute(arguments: &Check) -> Result<Report, CliError> {
    let suite = suite(&arguments.suite)?;
    check_output(&arguments.output, &suite)?;
    let Suite {
        scenes,
        without_scene,
    } = suite;
    let checked = check_all(scenes, &arguments.suite)?;
    warn(without_scene.iter().map(|it| stray_text(it)).collect());
    github::tell(&checked, &without_scene);
    let mut json = summary::of_check(&checked, &without_scene);
    json["report"] = text_of(&arguments.output.join(PAGE)).into();
    let written = write_report(&arguments.output, &checked, &without_scene, &mut json);
    let code = checked.iter().map(|it| exit_code(&it.verdict)).max();
    let report = Report {
        text: text(&checked, arguments, written.is_ok()),
        json,
        exit_code: code.unwrap_or(0),
    };
    if written.is_err() {
        // The verdicts took longer than the report, and are worth saying.
        report.print(arguments.suite.run.json)?;
    }
    written.map(|()| report)
}

pub(super) fn stray_text(golden: &Path) -> String {
    format!("{}: a golden without a scene", golden.display())
}

/// Refuses, before any work, a report among goldens.
fn check_output(output: &Path, suite: &Suite) -> Result<(), CliError> {
    let whole = std::path::absolute(output).unwrap_or_else(|_| output.to_owned());
    // Of a folder that is not there yet, the nearest that is.
    let there = whole.ancestors().find_map(|it| it.canonicalize().ok());
    let there = there.unwrap_or(whole);
    let is_among = |folder: &Path| folder.ends_with("golden") && there.starts_with(folder);
    let goldens = suite.scenes.iter().map(|it| it.golden());
    for golden in goldens.chain(suite.without_scene.iter().map(PathBuf::as_path)) {
        let golden = std::path::absolute(golden).unwrap_or_default();
        if golden.ancestors().any(is_among) {
            return Err(CliError::Usage(format!(
                "{}: lies among goldens; write the report elsewhere",
                printable(&text_of(output))
            )));
        }
    }
    Ok(())
}

/// Writes all files, and takes away the pictures of an older report that this
/// one does not have.
fn write_report(
    folder: &Path,
    checked: &[Checked],
    without_scene: &[PathBuf],
    json: &mut Value,
) -> Result<(), CliError> {
    let mut files = vec![junit(checked, without_scene)];
    files.extend(report_files(checked, without_scene)?);
    let page = files.pop();
    let paths = files.iter().chain(&page).map(|file| file.path.as_str());
    json["files"] = paths.chain([SUMMARY]).collect();
    for (index, name) in picture_names(checked).into_iter().enumerate() {
        let start = name.map(|name| format!("pictures/{name}-"));
        let paths = files.iter().map(|file| file.path.as_str());
        let pictures = paths.filter(|path| start.as_ref().is_some_and(|it| path.starts_with(it)));
        json["results"][index]["pictures"] = pictures.collect();
    }
    files.push(ReportFile {
        path: SUMMARY.to_owned(),
        bytes: format!("{json:#}\n").into_bytes(),
    });
    files.extend(page);
    remove_older(folder, &files)?;
    Ok(write_folder(folder, &files)?)
}

/// Removes the pictures that the folder's `summary.json` names and `files` does
/// not; nothing else in the folder is touched.
fn remove_older(folder: &Path, files: &[ReportFile]) -> Result<(), OutputError> {
    let older = fs::read(folder.join(SUMMARY)).ok();
    let older: Option<Value> = older.and_then(|bytes| serde_json::from_slice(&bytes).ok());
    let older = older.as_ref().and_then(|it| it["files"].as_array());
    let older = older.into_iter().flatten().filter_map(Value::as_str);
    for path in older {
        let picture = path.strip_prefix("pictures/");
        let is_ours = picture.is_some_and(|name| !name.contains(['/', '\\']) && name != "..");
        if !is_ours || files.iter().any(|file| file.path == path) {
            continue;
        }
        let path = folder.join(path);
        match fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                return Err(OutputError::Write { path, source });
            }
            _ => {}
        }
    }
    Ok(())
}

/// A line a scene, and what to do.
fn text(checked: &[Checked], arguments: &Check, has_report: bool) -> String {
    let mut text: String = checked.iter().map(lines).collect();
    let failed: Vec<&Checked> = checked.iter().filter(|it| !it.passes()).collect();
    let verdict = match failed.len() {
        0 => "all pass".to_owned(),
        count => format!("{count} fail{}", if count == 1 { "s" } else { "" }),
    };
    let report = match has_report {
        true => printable(&text_of(&arguments.output.join(PAGE))),
        false => "not written".to_owned(),
    };
    let count = counted(checked.len(), "scene");
    text.push_str(&format!("{count}, {verdict}; report: {report}"));
    let blessable = failed.iter().filter(|it| it.candidate.is_some());
    let scenes: Vec<String> = blessable.map(|it| quoted(it.scene.scene())).collect();
    if !scenes.is_empty() {
        text.push_str(&format!(
            "\nif the new frames are right: relume golden bless {}{}",
            scenes.join(" "),
            options(arguments)
        ));
    }
    text
}

fn lines(checked: &Checked) -> String {
    let verdict = &checked.verdict;
    let scene = printable(&text_of(checked.scene.scene()));
    let mut line = format!("{:8} {scene}", word(verdict));
    for problem in verdict.problems() {
        line.push_str(&format!("\n         {}", printable(&problem)));
    }
    if let Verdict::Differs { judgement, .. } = verdict
        && let Some(measured) = judgement.measured()
    {
        let keys = measured.passing.keys_text();
        line.push_str(&format!("\n         would pass with {keys} in [golden]"));
    }
    line + "\n"
}

/// The verdict in a column of eight letters.
fn word(verdict: &Verdict) -> &'static str {
    match verdict {
        Verdict::Passes(judgement) if judgement.is_equal() => "same",
        Verdict::Passes(_) => "near",
        Verdict::Differs { .. } => "differs",
        Verdict::Missing => "missing",
        Verdict::Faulty(_) => "faulty",
        Verdict::Golden(_) | Verdict::Scene(_) => "error",
    }
}

/// What `bless` has to be given too, so that it draws the same frames.
fn options(arguments: &Check) -> String {
    let suite = &arguments.suite;
    let sets = suite.overrides.iter();
    let mut text: String = sets
        .map(|it| format!(" --set {}", quoted(Path::new(it))))
        .collect();
    if let Some(size) = suite.size {
        text.push_str(&format!(" --size {}x{}", size.0[0], size.0[1]));
    }
    text
}

/// A word as a POSIX shell takes it; what must not be printed is written in
/// octal, which shells know since POSIX.1-2024 and bash always did.
fn quoted(path: &Path) -> String {
    let text = text_of(path);
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./=,:+@".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        return text;
    }
    if printable(&text) != text {
        let octal = |byte: u8| match char::from(byte) {
            letter if is_plain(letter) => letter.to_string(),
            _ => format!("\\{byte:03o}"),
        };
        return format!("$'{}'", text.bytes().map(octal).collect::<String>());
    }
    format!("'{}'", text.replace('\'', r"'\''"))
}
