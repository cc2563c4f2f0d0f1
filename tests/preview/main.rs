//! `relume preview` in a terminal: what is left of it after every way to end.

#![cfg(unix)]

mod terminal;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::Signal;
use terminal::{Terminal, changed_modes, launch as become_program};

const RELUME: &str = env!("CARGO_BIN_EXE_relume");
/// Longest that leaving may take where nobody reads.
const LONGEST_LEAVING: Duration = Duration::from_secs(3);

#[test]
#[ignore = "the step between a test and its program"]
fn launch() {
    become_program();
}

/// A copy of a scene that is baked in a moment: what is not saved is put beside it.
fn scene() -> &'static str {
    static SCENE: LazyLock<String> = LazyLock::new(|| {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/plank");
        let to = Path::new(env!("CARGO_TARGET_TMPDIR")).join("preview");
        fs::create_dir_all(&to).expect("the folder can be made");
        for name in ["plank.toml", "plank.obj", "plank.mtl"] {
            let bytes = fs::read(from.join(name)).expect("the scene is there");
            fs::write(to.join(name), bytes).expect("the scene is copied");
        }
        let scene = to.join("plank.toml");
        scene
            .to_str()
            .expect("the folder has a plain name")
            .to_owned()
    });
    &SCENE
}

/// The command in a terminal, once it has taken it.
fn start(size: (u16, u16)) -> Terminal {
    let terminal = Terminal::start("launch", &[RELUME, "preview", scene()], &[], size);
    terminal.wait_until("the first frame", |it| {
        it.is_raw() && it.bytes().ends_with(b"\x1b[?2026l")
    });
    terminal
}

#[test]
fn keys_and_signals_end_it() {
    for (key, code) in [(b"q", 0), (b"\x03", 130)] {
        let mut terminal = start((80, 24));
        terminal.feed(key);
        assert_eq!(terminal.end().code(), Some(code), "{key:?}");
        terminal.assert_as_before();
    }
    for (signal, code) in [(Signal::TERM, 143), (Signal::HUP, 129), (Signal::INT, 130)] {
        let mut terminal = start((10, 5));
        terminal.signal(signal);
        assert_eq!(terminal.end().code(), Some(code), "{signal:?}");
        terminal.assert_as_before();
    }
}

#[test]
fn a_stop_gives_the_terminal_to_the_shell_and_takes_it_again() {
    let scene = scene();
    let script =
        format!("{RELUME} preview {scene}; echo stopped; read line; fg; echo code $?; read line");
    for key in [true, false] {
        let terminal = Terminal::start("launch", &["sh", "-m", "-c", &script], &[], (70, 20));
        let is_shown = |it: &Terminal| it.bytes().ends_with(b"\x1b[?2026l");
        terminal.wait_until("the first frame", is_shown);
        match key {
            true => terminal.feed(b"\x1a"),
            false => terminal.signal_foreground(Signal::TSTP),
        }
        terminal.wait_for("stopped");
        terminal.assert_as_before();
        terminal.feed(b"\n");
        terminal.wait_until("the frame again", is_shown);
        assert!(changed_modes(&terminal.bytes()).contains(&"1049".to_owned()));
        terminal.feed(b"q");
        terminal.wait_for("code 0");
        terminal.assert_as_before();
    }
}

#[test]
fn a_window_that_reads_nothing_or_is_closed_does_not_hold_it() {
    let mut terminal = start((200, 60));
    terminal.read(false);
    // The camera moves and moves.
    for _ in 0..50 {
        terminal.feed(b"\x1b[D");
        thread::sleep(Duration::from_millis(10));
    }
    let start_of_end = Instant::now();
    terminal.signal(Signal::TERM);
    assert_eq!(terminal.end().code(), Some(143));
    assert!(start_of_end.elapsed() < LONGEST_LEAVING);
    terminal.read(true);
    terminal.assert_as_before();
    terminal.wait_for("changes were not saved");
    let mut terminal = start((80, 24));
    terminal.close();
    terminal.end();
}

#[test]
fn every_size_is_drawn() {
    let mut terminal = start((80, 24));
    for size in [(10, 5), (200, 60), (1, 1), (33, 12)] {
        let place = terminal.bytes().len();
        terminal.resize(size);
        terminal.wait_until("a frame of the new size", |it| {
            it.bytes().len() > place && it.bytes().ends_with(b"\x1b[?2026l")
        });
    }
    terminal.feed(b"q");
    assert_eq!(terminal.end().code(), Some(0));
    terminal.assert_as_before();
}

#[test]
fn without_a_terminal_it_says_what_to_do() {
    let output = Command::new(RELUME).args(["preview", scene()]).output();
    let output = output.expect("the program can be started");
    assert_eq!(output.status.code(), Some(2));
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(
        words.contains("no terminal") && words.contains("relume render"),
        "{words}"
    );
}
