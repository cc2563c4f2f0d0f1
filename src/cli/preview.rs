//! `relume preview`: a scene lit by hand, in a terminal or by a script.

use std::path::Path;
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use relume::preview::{Preparation, PreviewSettings, ScriptReport, run_in_terminal, run_script};
use serde_json::{Map, Value, json};

use super::args::Preview;
use super::error::CliError;
use super::report::{Report, rounded, stage_key};
use super::run::{cache_folder, overrides, say, with_run};

/// Exit code after the terminal has gone.
const HUNG_UP: u8 = 129;
/// How long a terminal may take to take a line. One that reads nothing, as when its
/// connection hangs, would hold the program for ever.
const LONGEST_SAYING: Duration = Duration::from_secs(1);

pub(super) fn execute(arguments: &Preview) -> Result<Report, CliError> {
    let run = &arguments.scene.run;
    let settings = PreviewSettings {
        scene: arguments.scene.path.clone(),
        overrides: overrides(&arguments.scene)?,
        preparation: Preparation {
            cache_folder: cache_folder(run),
            scheme: arguments.scene.scheme,
            threads: run.threads.map_or(0, usize::from),
            level: run.simd,
        },
        colours: arguments.colours,
        protocol: arguments.protocol,
    };
    match &arguments.script {
        Some(script) => scripted(arguments, &settings, script),
        None if run.json => Err(CliError::Usage(
            "a terminal shows no JSON; give --script FILE, or leave --json out".to_owned(),
        )),
        None => interactive(&settings),
    }
}

fn interactive(settings: &PreviewSettings) -> Result<Report, CliError> {
    let ended = run_in_terminal(settings)?;
    // After a hang-up nobody reads.
    if let Some(path) = ended.rescued.filter(|_| ended.exit_code != HUNG_UP) {
        say_in_time(format!(
            "changes were not saved; the scene with them is {}",
            path.display()
        ));
    }
    Ok(Report {
        json: Value::Null,
        text: String::new(),
        exit_code: ended.exit_code,
    })
}

/// Says a line, unless nobody takes it.
fn say_in_time(line: String) {
    let (said, is_said) = channel();
    // Without a thread it is left unsaid; the file is there all the same.
    let started = thread::Builder::new().spawn(move || {
        say(&[line]);
        // Nobody listens once the time is over.
        let _ = said.send(());
    });
    if started.is_ok() {
        let _ = is_said.recv_timeout(LONGEST_SAYING);
    }
}

fn scripted(
    arguments: &Preview,
    settings: &PreviewSettings,
    script: &Path,
) -> Result<Report, CliError> {
    let done = with_run(&arguments.scene.run, |run| {
        Ok(run_script(settings, script, run)?)
    })?;
    Ok(Report {
        json: object(&done),
        text: text(&done),
        // What failed is named; a script's runner sees it too.
        exit_code: if done.error.is_some() { 3 } else { 0 },
    })
}

fn object(done: &ScriptReport) -> Value {
    let written = done
        .written
        .iter()
        .map(|(path, digest)| json!({ "path": path.display().to_string(), "digest": digest }));
    let times = done.ms.iter();
    let ms: Map<String, Value> = times
        .map(|&(stage, ms)| (stage_key(stage), rounded(ms)))
        .collect();
    json!({
        "frames": done.frames,
        "drafts": done.drafts,
        "digest": done.digest,
        "size": done.size,
        "written": written.collect::<Vec<_>>(),
        "unsaved": done.unsaved,
        "error": done.error,
        "bytes": { "median": done.bytes[0], "most": done.bytes[1] },
        "ms": ms,
    })
}

fn text(done: &ScriptReport) -> String {
    let mut text = String::new();
    for (path, digest) in &done.written {
        let digest = digest
            .as_ref()
            .map_or(String::new(), |d| format!(": digest {d}"));
        text.push_str(&format!("{}{digest}\n", path.display()));
    }
    let digest = done.digest.as_deref().unwrap_or("none");
    let [width, height] = done.size;
    text.push_str(&format!(
        "{} frames, {} drafts; last full frame {width} x {height}, digest {digest}",
        done.frames, done.drafts
    ));
    if done.unsaved {
        text.push_str("\nthere are changes that were not saved");
    }
    if let Some(error) = &done.error {
        text.push_str(&format!("\n{error}"));
    }
    text
}
