//! A terminal for tests: a pseudo terminal whose other end is read by a parser.
//!
//! A program gets a session of its own with the terminal as the controlling one,
//! as from a terminal's window. That takes a step between: the test's own binary
//! is started, runs [`launch`] and becomes the program.

#![allow(
    dead_code,
    reason = "each of the test binaries that include this file uses a part"
)]

use std::fs::File;
use std::io::{Read, Write};
use std::num::NonZeroU16;
use std::os::fd::OwnedFd;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, open};
use rustix::process::{Pid, Signal, ioctl_tiocsctty, kill_process, setsid};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::stdio::{dup2_stderr, dup2_stdout, stdin};
use rustix::termios::{Termios, Winsize, tcgetattr, tcgetpgrp, tcsetwinsize};

/// Holds the program and its arguments for [`launch`].
const PROGRAM: &str = "RELUME_TEST_PROGRAM";
/// Between its words.
const SEPARATOR: &str = "\u{1f}";
/// How long anything is waited for.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);
/// Variables that say what terminal the tests themselves run in.
const FOREIGN: [&str; 11] = [
    "COLORTERM",
    "LC_TERMINAL",
    "NO_COLOR",
    "SSH_CONNECTION",
    "SSH_TTY",
    "STY",
    "TERM_PROGRAM",
    "TMUX",
    "WT_SESSION",
    "COLUMNS",
    "LINES",
];

/// In the step between: becomes the program that [`Terminal::start`] was given.
/// Does nothing where there is none.
pub(crate) fn launch() {
    let Ok(words) = std::env::var(PROGRAM) else {
        return;
    };
    setsid().expect("a new session");
    ioctl_tiocsctty(stdin()).expect("the terminal is nobody's yet");
    dup2_stdout(stdin()).expect("standard output can be the terminal");
    dup2_stderr(stdin()).expect("standard error can be the terminal");
    let mut words = words.split(SEPARATOR);
    let program = words.next().expect("a program");
    let error = Command::new(program).args(words).env_remove(PROGRAM).exec();
    panic!("{program}: {error}");
}

/// A terminal with a program in it.
pub(crate) struct Terminal {
    master: Arc<Mutex<Option<File>>>,
    /// Kept open, so that the terminal's state is there when the program is gone.
    line: OwnedFd,
    before: String,
    child: Child,
    bytes: Arc<Mutex<Vec<u8>>>,
    is_read: Arc<AtomicBool>,
    size: (u16, u16),
}

impl Terminal {
    /// Starts a program in a new terminal. `launcher` is the name of the ignored
    /// test that calls [`launch`], with its modules.
    pub(crate) fn start(
        launcher: &str,
        program: &[&str],
        variables: &[(&str, &str)],
        size: (u16, u16),
    ) -> Self {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)
            .expect("a pseudo terminal");
        grantpt(&master).expect("it can be granted");
        unlockpt(&master).expect("it can be unlocked");
        let name = ptsname(&master, Vec::new()).expect("it has a name");
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let line = open(name.as_c_str(), flags, Mode::empty()).expect("its line can be opened");
        set_size(&line, size);
        let before = state(&line);
        let mut command = Command::new(std::env::current_exe().expect("the test's own path"));
        for name in FOREIGN {
            command.env_remove(name);
        }
        let child = command
            .args([launcher, "--exact", "--ignored", "--nocapture"])
            .env("TERM", "xterm-256color")
            .envs(variables.iter().copied())
            .env(PROGRAM, program.join(SEPARATOR))
            .stdin(line.try_clone().expect("one more handle"))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the test's own binary can be started");
        let terminal = Self {
            master: Arc::new(Mutex::new(Some(File::from(master)))),
            line,
            before,
            child,
            bytes: Arc::default(),
            is_read: Arc::new(AtomicBool::new(true)),
            size,
        };
        terminal.read_in_a_thread();
        terminal
    }

    fn read_in_a_thread(&self) {
        let (master, bytes) = (Arc::clone(&self.master), Arc::clone(&self.bytes));
        let is_read = Arc::clone(&self.is_read);
        std::thread::spawn(move || {
            let mut buffer = [0; 65_536];
            loop {
                let mut guard = master.lock().expect("no reader has panicked");
                let Some(file) = guard.as_mut() else {
                    return;
                };
                let is_ready = is_read.load(Ordering::SeqCst) && has_bytes(file);
                let count = if is_ready {
                    file.read(&mut buffer).unwrap_or(0)
                } else {
                    0
                };
                drop(guard);
                let mut all = bytes.lock().expect("no reader has panicked");
                all.extend_from_slice(&buffer[..count]);
                drop(all);
                if count == 0 {
                    std::thread::sleep(Duration::from_millis(2));
                }
            }
        });
    }

    /// Types.
    pub(crate) fn feed(&self, bytes: &[u8]) {
        let mut guard = self.master.lock().expect("no reader has panicked");
        let file = guard.as_mut().expect("the window is open");
        file.write_all(bytes).expect("the terminal takes keys");
    }

    /// Reads no more, as a window whose connection hangs, or reads again.
    pub(crate) fn read(&self, is_read: bool) {
        self.is_read.store(is_read, Ordering::SeqCst);
    }

    /// Closes the window.
    pub(crate) fn close(&self) {
        drop(self.master.lock().expect("no reader has panicked").take());
    }

    /// Gives the window another size.
    pub(crate) fn resize(&mut self, size: (u16, u16)) {
        self.size = size;
        set_size(&self.line, size);
    }

    /// Sends a signal to the program.
    pub(crate) fn signal(&self, signal: Signal) {
        let id = Pid::from_raw(self.child.id().cast_signed()).expect("a process has a number");
        kill_process(id, signal).expect("the program is there");
    }

    /// Sends a signal to the leader of the terminal's foreground job.
    pub(crate) fn signal_foreground(&self, signal: Signal) {
        let guard = self.master.lock().expect("no reader has panicked");
        let file = guard.as_ref().expect("the window is open");
        let id = tcgetpgrp(file).expect("there is a job");
        kill_process(id, signal).expect("the program is there");
    }

    /// All that was written so far.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        self.bytes.lock().expect("no reader has panicked").clone()
    }

    /// What is seen, from all bytes behind a place, by a window of the size now.
    pub(crate) fn seen_from(&self, start: usize) -> vt100::Parser {
        let side = |side| NonZeroU16::new(side).expect("a window has a size");
        let mut parser = vt100::Parser::new(side(self.size.1), side(self.size.0), 0);
        parser.process(&self.bytes()[start..]);
        parser
    }

    /// What is seen.
    pub(crate) fn contents(&self) -> String {
        self.seen_from(0).screen().contents()
    }

    /// Waits until something is seen.
    pub(crate) fn wait_for(&self, text: &str) {
        self.wait_until(text, |terminal| terminal.contents().contains(text));
    }

    /// Waits until something holds.
    pub(crate) fn wait_until(&self, words: &str, holds: impl Fn(&Self) -> bool) {
        let start = Instant::now();
        while !holds(self) {
            assert!(
                start.elapsed() < PATIENCE,
                "waited in vain for {words}; seen is:\n{}\nwritten at last was:\n{}",
                self.contents(),
                self.last_words()
            );
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// The end of what was written, with what has scrolled out of the window: a
    /// panic's message among it.
    fn last_words(&self) -> String {
        /// Bytes of it.
        const LAST: usize = 4_000;
        let bytes = self.bytes();
        let last = &bytes[bytes.len().saturating_sub(LAST)..];
        last.escape_ascii().to_string().replace("\\n", "\n")
    }

    /// Waits for the program's end.
    pub(crate) fn end(&mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().expect("a child can be waited for") {
                return status;
            }
            assert!(
                start.elapsed() < PATIENCE,
                "the program does not end; seen is:\n{}",
                self.contents()
            );
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Whether the line takes keys one by one, without echo.
    pub(crate) fn is_raw(&self) -> bool {
        state(&self.line) != self.before
    }

    /// Asserts that the terminal is as it was before the program: the line, the
    /// screen, and every mode that has been set.
    pub(crate) fn assert_as_before(&self) {
        assert_eq!(state(&self.line), self.before, "the line's state");
        self.wait_until("the last bytes", |it| changed_modes(&it.bytes()).is_empty());
        let seen = self.seen_from(0);
        let screen = seen.screen();
        assert!(!screen.alternate_screen() && !screen.hide_cursor());
        assert_eq!(screen.mouse_protocol_mode(), vt100::MouseProtocolMode::None);
        assert_eq!(screen.fgcolor(), vt100::Color::Default);
        assert_eq!(screen.bgcolor(), vt100::Color::Default);
        assert!(!screen.bold() && !screen.inverse());
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        // Ends already, but after a failed assertion.
        let _ = self.child.kill();
        let _ = self.child.wait();
        self.close();
    }
}

/// Private modes that are not as a terminal starts with.
pub(crate) fn changed_modes(bytes: &[u8]) -> Vec<String> {
    let mut changed: Vec<String> = Vec::new();
    let text = String::from_utf8_lossy(bytes);
    for part in text.split("\x1b[?").skip(1) {
        let Some(end) = part.find(['h', 'l']) else {
            continue;
        };
        let (mode, is_on) = (&part[..end], part[end..].starts_with('h'));
        if !mode.bytes().all(|byte| byte.is_ascii_digit()) {
            continue;
        }
        // Lines wrap and the cursor is seen.
        let starts_on = ["7", "25"].contains(&mode);
        changed.retain(|known| known != mode);
        if is_on != starts_on {
            changed.push(mode.to_owned());
        }
    }
    changed
}

fn has_bytes(file: &File) -> bool {
    let limit = Timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    let mut waiting = [PollFd::new(file, PollFlags::IN)];
    poll(&mut waiting, Some(&limit)).is_ok_and(|ready| ready > 0)
}

fn set_size(line: &OwnedFd, (columns, rows): (u16, u16)) {
    let size = Winsize {
        ws_col: columns,
        ws_row: rows,
        ws_xpixel: 0,
        ws_ypixel: 0,
    };
    tcsetwinsize(line, size).expect("a window has a size");
}

/// All that the system knows of a line, as text.
fn state(line: &OwnedFd) -> String {
    let termios: Termios = tcgetattr(line).expect("a line has a state");
    format!("{termios:?}")
}
