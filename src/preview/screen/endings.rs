//! The terminal is as before after every way to end: a small program with a
//! screen, in a process of its own, on a terminal of its own.

use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

use crossterm::event::{Event, KeyCode, KeyModifiers};
use rustix::process::Signal;

use super::terminal::{Terminal, changed_modes, launch as become_program};
use super::{Notice, Screen, ScreenSettings};
use crate::maths::hash::mix;
use crate::output::terminal::{Cell, Cells};

/// Set for the small program.
const IS_PROGRAM: &str = "RELUME_TEST_IS_PROGRAM";
/// Where these tests are.
const HERE: &str = "preview::screen::endings";
/// Longest that leaving may take where nobody reads, on a machine that has other
/// work too: 1.1 s at the most by its own limits.
const LONGEST_LEAVING: Duration = Duration::from_secs(3);

#[test]
#[ignore = "the step between a test and its program"]
fn launch() {
    become_program();
}

#[test]
#[ignore = "the program of the other tests"]
fn program() {
    if std::env::var(IS_PROGRAM).is_ok() {
        let code = run();
        std::process::exit(i32::from(code));
    }
}

enum Message {
    Event(Event),
    Notice(Notice),
}

/// What the program's loop does; the exit code.
fn run() -> u8 {
    let (sender, queue) = mpsc::channel();
    let notices = sender.clone();
    let entered = Screen::enter(ScreenSettings::default(), move |notice| {
        let _ = notices.send(Message::Notice(notice));
    });
    let mut screen = match entered {
        Ok(screen) => screen,
        Err(error) => panic!("{error}"),
    };
    for event in screen.take_typed() {
        sender.send(Message::Event(event)).unwrap();
    }
    let mut late = screen.late_answers();
    thread::spawn(move || {
        while let Ok(event) = crossterm::event::read() {
            if late.is_input(&event) {
                let _ = sender.send(Message::Event(event));
            }
        }
    });
    draw(&screen, "ready");
    serve(&screen, &queue)
}

fn serve(screen: &Screen, queue: &Receiver<Message>) -> u8 {
    for message in queue {
        match message {
            Message::Event(Event::Key(key)) => match (key.code, key.modifiers) {
                (KeyCode::Char('c'), KeyModifiers::CONTROL) => return 130,
                (KeyCode::Char('z'), KeyModifiers::CONTROL) => screen.suspend().unwrap(),
                (KeyCode::Char('q'), _) => return 0,
                (KeyCode::Char('p'), _) => panic!("as asked"),
                (KeyCode::Char('t'), _) => {
                    let thread = thread::spawn(|| panic!("in a thread"));
                    assert!(thread.join().is_err());
                }
                (KeyCode::Char('h'), _) => thread::sleep(Duration::from_secs(60)),
                (KeyCode::Char('n'), _) => noise(screen),
                (KeyCode::Char('l'), _) => {
                    screen.leave();
                    screen.leave();
                    return 0;
                }
                (KeyCode::Char('a'), _) => draw(screen, &abilities(screen)),
                (KeyCode::Char(letter), _) => draw(screen, &format!("key {letter}")),
                _ => {}
            },
            Message::Event(_) => {}
            Message::Notice(notice) => match notice {
                Notice::Stop => screen.suspend().unwrap(),
                Notice::Continued => screen.resume().unwrap(),
                Notice::Resized => {
                    screen.forget();
                    draw(screen, "resized");
                }
                Notice::End(code) => return code,
                Notice::Panicked => return 101,
                Notice::Lost => return 3,
            },
        }
    }
    1
}

fn draw(screen: &Screen, text: &str) {
    let (columns, rows) = screen.size();
    let mut cells = Cells::new(columns, rows);
    let text = format!("{text} {columns}x{rows}");
    for (row, part) in (0..).zip(text.as_bytes().chunks(usize::from(columns.max(1)))) {
        let part = String::from_utf8_lossy(part);
        cells.text(0, row, &part, [255; 3], [0; 3]);
    }
    screen.show(cells, None);
}

/// All that is known of the terminal.
fn abilities(screen: &Screen) -> String {
    format!("{:?} {:?}", screen.abilities(), screen.cell_px())
}

/// Many large frames.
fn noise(screen: &Screen) {
    let (columns, rows) = screen.size();
    for number in 0..60_u32 {
        let mut cells = Cells::new(columns, rows);
        for row in 0..rows {
            for column in 0..columns {
                let index = number * 1_000_000 + u32::from(row) * 1_000 + u32::from(column);
                let [_, r, g, b] = mix(index).to_be_bytes();
                let cell = Cell {
                    glyph: '▀',
                    ink: [r, g, b],
                    paper: [g, b, r],
                };
                cells.set(column, row, cell);
            }
        }
        let start = Instant::now();
        screen.show(cells, None);
        assert!(start.elapsed() < Duration::from_secs(3), "show blocks");
        thread::sleep(Duration::from_millis(1));
    }
    assert!(screen.written().dropped > 0, "nothing was dropped");
}

/// The words that start the program.
fn words() -> Vec<String> {
    let path = std::env::current_exe().unwrap();
    let name = format!("{HERE}::program");
    let path = path.to_str().unwrap().to_owned();
    [path, name]
        .into_iter()
        .chain(["--exact", "--ignored", "--nocapture"].map(str::to_owned))
        .collect()
}

fn start_with(variables: &[(&str, &str)], size: (u16, u16)) -> Terminal {
    let words = words();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let ours = [(IS_PROGRAM, "1"), ("RUST_BACKTRACE", "0")];
    let variables = [&ours, variables].concat();
    Terminal::start(&format!("{HERE}::launch"), &words, &variables, size)
}

fn start() -> Terminal {
    let terminal = start_with(&[], (60, 10));
    terminal.wait_for("ready 60x10");
    assert!(terminal.is_raw());
    let mut modes = changed_modes(&terminal.bytes());
    modes.sort();
    assert_eq!(modes, ["1002", "1006", "1049", "25", "7"]);
    terminal
}

/// Whether the last of the questions has been asked.
fn has_asked(terminal: &Terminal) -> bool {
    terminal.bytes().windows(3).any(|bytes| bytes == b"\x1b[c")
}

#[test]
fn quitting_restores_the_terminal() {
    for (key, code) in [(&b"q"[..], 0), (b"\x03", 130), (b"l", 0)] {
        let mut terminal = start();
        terminal.feed(key);
        assert_eq!(terminal.end().code(), Some(code), "{key:?}");
        terminal.assert_as_before();
    }
}

#[test]
fn signals_restore_the_terminal() {
    for (signal, code) in [(Signal::TERM, 143), (Signal::HUP, 129), (Signal::INT, 130)] {
        let mut terminal = start();
        terminal.signal(signal);
        assert_eq!(terminal.end().code(), Some(code), "{signal:?}");
        terminal.assert_as_before();
    }
}

#[test]
fn a_program_that_hangs_is_ended_by_a_signal() {
    use std::os::unix::process::ExitStatusExt;
    for times in [1, 2] {
        let mut terminal = start();
        terminal.feed(b"h");
        for _ in 0..times {
            thread::sleep(Duration::from_millis(200));
            terminal.signal(Signal::TERM);
        }
        assert_eq!(terminal.end().signal(), Some(15));
        terminal.assert_as_before();
    }
}

#[test]
fn a_panic_restores_the_terminal_and_is_read() {
    for (key, message) in [(b"p", "as asked"), (b"t", "in a thread")] {
        let mut terminal = start();
        terminal.feed(key);
        assert_eq!(terminal.end().code(), Some(101));
        terminal.assert_as_before();
        terminal.wait_until(message, |it| {
            let bytes = String::from_utf8_lossy(&it.bytes()).into_owned();
            let behind = bytes.split("\x1b[?1049l").nth(1);
            behind.is_some_and(|behind| behind.contains(message))
        });
    }
}

#[test]
fn a_closed_window_ends_the_program() {
    let mut terminal = start();
    terminal.close();
    let start = Instant::now();
    terminal.end();
    assert!(start.elapsed() < LONGEST_LEAVING);
}

#[test]
fn a_window_that_reads_nothing_is_left_in_time() {
    for signal in [false, true] {
        let mut terminal = start_with(&[], (200, 60));
        terminal.wait_for("ready");
        terminal.read(false);
        terminal.feed(b"n");
        thread::sleep(Duration::from_millis(900));
        let start = Instant::now();
        match signal {
            true => terminal.signal(Signal::TERM),
            false => terminal.feed(b"q"),
        }
        let code = terminal.end().code();
        assert_eq!(code, Some(if signal { 143 } else { 0 }));
        assert!(start.elapsed() < LONGEST_LEAVING, "{:?}", start.elapsed());
        terminal.read(true);
        terminal.assert_as_before();
    }
}

#[test]
fn every_size_is_drawn() {
    let mut terminal = start();
    for size in [(30, 5), (100, 40), (10, 5), (1, 1), (60, 10)] {
        let place = terminal.bytes().len();
        terminal.resize(size);
        let wanted = format!("resized {}x{}", size.0, size.1);
        let wanted = &wanted[..wanted.len().min(usize::from(size.0) * usize::from(size.1))];
        terminal.wait_until(wanted, |it| {
            let seen = it.seen_from(place).screen().contents().replace('\n', "");
            seen.starts_with(wanted)
        });
    }
    terminal.feed(b"q");
    assert_eq!(terminal.end().code(), Some(0));
    terminal.assert_as_before();
}

#[test]
fn a_stop_gives_the_terminal_to_the_shell_and_takes_it_again() {
    let program = words().join(" ");
    for key in [true, false] {
        // A shell with jobs, as one has in a window.
        let script = format!("{program}; echo stopped; read line; fg; echo code $?; read line");
        let words = ["sh", "-m", "-c", &script];
        let variables = [(IS_PROGRAM, "1")];
        let terminal = Terminal::start(&format!("{HERE}::launch"), &words, &variables, (70, 20));
        terminal.wait_for("ready");
        match key {
            true => terminal.feed(b"\x1a"),
            false => {
                // The job is the foreground's only process.
                terminal.signal_foreground(Signal::TSTP);
            }
        }
        terminal.wait_for("stopped");
        terminal.assert_as_before();
        let place = terminal.bytes().len();
        terminal.feed(b"\n");
        terminal.wait_until("the last frame again", |it| {
            it.bytes().len() > place && it.seen_from(place).screen().contents().contains("ready")
        });
        assert!(terminal.is_raw());
        terminal.feed(b"x");
        terminal.wait_for("key x");
        terminal.feed(b"q");
        terminal.wait_for("code 0");
        terminal.assert_as_before();
    }
}

#[test]
fn a_stop_that_was_not_seen_is_mended() {
    let terminal = start();
    terminal.signal(Signal::STOP);
    thread::sleep(Duration::from_millis(50));
    let place = terminal.bytes().len();
    terminal.signal(Signal::CONT);
    terminal.wait_until("a whole frame", |it| {
        it.seen_from(place).screen().contents().contains("ready")
    });
}

#[test]
fn where_nobody_could_continue_it_the_program_does_not_stop() {
    let mut terminal = start();
    terminal.feed(b"\x1ax");
    terminal.wait_for("key x");
    terminal.feed(b"q");
    assert_eq!(terminal.end().code(), Some(0));
    terminal.assert_as_before();
}

#[test]
fn the_terminals_answers_are_used_and_keys_are_not_lost() {
    // Over a network answers are waited for longer, which a busy machine needs.
    let mut terminal = start_with(&[("SSH_TTY", "1")], (60, 10));
    terminal.wait_until("the questions", has_asked);
    terminal.feed(
        b"a\x1bP1$r48:2:1:2:3m\x1b\\\x1b_Gi=7497068;OK\x1b\\\x1bP>|quick\x1b\\\
          \x1b[6;20;10t\x1b[?2026;2$y\x1b[?62;4c",
    );
    terminal.wait_for("Kitty");
    let seen = terminal.contents().replace('\n', "");
    assert!(
        seen.contains("colours: True") && seen.matches("(10, 20)").count() == 2,
        "{seen}"
    );
    terminal.feed(b"q");
    assert_eq!(terminal.end().code(), Some(0));
    terminal.assert_as_before();
    let bytes = String::from_utf8_lossy(&terminal.bytes()).into_owned();
    assert!(bytes.contains("\x1b_Ga=d,d=I,i=7497068,q=2\x1b\\\x1b[?1006l"));
}

#[test]
fn late_answers_and_nonsense_do_no_harm() {
    let mut terminal = start();
    terminal.feed(b"\x1bP>|quick\x1b\\\x1b[6;20;10t\x1b[?2026;2$y\x1b[?62;4cx");
    terminal.wait_for("key x");
    terminal.feed(b"q");
    assert_eq!(terminal.end().code(), Some(0));
    terminal.assert_as_before();
}

#[test]
fn a_terminal_that_babbles_is_not_believed() {
    let mut terminal = start_with(&[], (60, 10));
    terminal.wait_until("the questions", has_asked);
    for _ in 0..20 {
        terminal.feed(&b"\x1b[?12;\xfe9\x1b]x\x1b\\".repeat(70));
    }
    // What comes too late to be thrown away is keys, which draw other words.
    terminal.wait_for("60x10");
    terminal.signal(Signal::TERM);
    assert_eq!(terminal.end().code(), Some(143));
    terminal.assert_as_before();
}

#[test]
fn without_colours_none_is_sent() {
    let mut terminal = start_with(&[("NO_COLOR", "1")], (60, 10));
    terminal.wait_for("ready");
    terminal.feed(b"q");
    assert_eq!(terminal.end().code(), Some(0));
    let text = String::from_utf8(terminal.bytes()).unwrap();
    let behind = text.split("\x1b[c").nth(1).unwrap();
    assert!(!behind.contains("38;") && !behind.contains("48;"));
}
