//! Ctrl-C and SIGTERM: a prompt end, the signal's exit code, and no half file.

use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::program::{Finished, files_in, relume, scene, temporary_folder};

/// Rays a vertex with which the box bakes for minutes.
const ENDLESS_RAYS: &str = "bake.rays=65536";
/// The scene's own mesh, which its `[golden]` would make coarser.
const FINE_MESH: &str = "bake.max_edge=0.05";
/// Paths a pixel with which a reference of the box takes hours.
const ENDLESS_PATHS: &str = "65536";
/// Within this the program must have stopped, on a busy machine too.
const PATIENCE: Duration = Duration::from_secs(20);
/// How long the program gets to begin its bake, at first.
const FIRST_WAIT: Duration = Duration::from_millis(400);
/// Longer waits than this do not help a program that does not listen.
const LONGEST_WAIT: Duration = Duration::from_secs(7);

/// Sends a signal by its name.
fn send(signal: &str, child: &Child) {
    let status = Command::new("kill")
        .args([&format!("-{signal}"), &child.id().to_string()])
        .status()
        .expect("kill can be run");
    assert!(status.success(), "SIG{signal} was not sent");
}

/// Waits for the end; a program that does not end is killed and the test fails.
fn end_of(mut child: Child) -> Finished {
    let start = Instant::now();
    while child.try_wait().expect("the child can be asked").is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().expect("the child can be killed");
            panic!("the program was still running {PATIENCE:?} after the signal");
        }
        sleep(Duration::from_millis(10));
    }
    let output = child
        .wait_with_output()
        .expect("the child's words can be read");
    Finished::of(output)
}

/// Stops a program with a signal once it listens: one that the signal killed
/// before that is started again and given more time.
fn stopped(command: &mut Command, signal: &str) -> Finished {
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut wait = FIRST_WAIT;
    loop {
        let child = command.spawn().expect("the program starts");
        sleep(wait);
        send(signal, &child);
        let finished = end_of(child);
        if finished.exit_code.is_some() || wait > LONGEST_WAIT {
            return finished;
        }
        wait *= 2;
    }
}

/// A job that lasts is stopped: this exit code, one line that says so, and
/// nothing left in the folder or its cache.
fn leaves_nothing(command: &str, signal: &str, exit_code: i32) {
    let folder = temporary_folder();
    let cache = folder.path().join("cache");
    let mut job = relume(&command.split(' ').collect::<Vec<_>>());
    job.arg("--cache-dir").arg(&cache).arg(scene("cornell"));
    match command {
        "reference" => job.args(["--spp", ENDLESS_PATHS]),
        _ => job.args(["--set", ENDLESS_RAYS, "--set", FINE_MESH]),
    };
    if command != "bake" {
        job.arg("-o").arg(folder.path().join("frame.png"));
    }
    let finished = stopped(&mut job, signal);
    assert_eq!(
        finished.exit_code,
        Some(exit_code),
        "{command}, SIG{signal}: {finished:#?}"
    );
    assert_eq!(finished.stdout, "", "{command}: nothing is reported");
    let lines: Vec<&str> = finished.stderr.lines().collect();
    let says = lines.len() == 1 && lines[0].contains("stopped; nothing was written");
    assert!(says, "{command}: one line says so: {finished:#?}");
    let left = files_in(&cache);
    assert!(left.is_empty(), "{command}: the cache holds {left:?}");
    let outside: Vec<_> = files_in(folder.path())
        .into_iter()
        .filter(|path| *path != cache)
        .collect();
    assert!(
        outside.is_empty(),
        "{command}: the folder holds {outside:?}"
    );
}

#[test]
fn control_c_stops_a_render_and_leaves_nothing() {
    leaves_nothing("render", "INT", 130);
}

#[test]
fn sigterm_stops_a_bake_and_leaves_nothing() {
    leaves_nothing("bake", "TERM", 143);
}

#[test]
fn control_c_stops_a_reference_and_leaves_nothing() {
    leaves_nothing("reference", "INT", 130);
}

#[test]
fn control_c_stops_a_golden_check_and_leaves_no_report() {
    leaves_nothing("golden check", "INT", 130);
}
