//! The terminal as the system has it.

use std::fs::File;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::thread;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{Mode, OFlags, open};
use rustix::io::{read, retry_on_intr};
use rustix::termios::{
    Action, OptionalActions, QueueSelector, Termios, tcflow, tcflush, tcgetattr, tcgetwinsize,
    tcsetattr, ttyname,
};

use super::ScreenError;

/// Standard input and output, which are a terminal.
pub(super) struct Tty {
    input: OwnedFd,
    /// Not `Stdout`: that would cut a frame at its lines.
    output: File,
    /// The same terminal opened once more, for writes that do not wait: what is set
    /// of standard output is set for the shell too. None where it has no name or may not
    /// be opened, as after `su`.
    unwaiting: Option<File>,
    before: Termios,
}

/// Between two tries to write last words.
const LOOK: Duration = Duration::from_millis(2);
/// Between two looks at whether what waits for room is still wanted, if there is no
/// room before: far less than whoever cuts a frame waits for.
const LOOK_IF_WANTED: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 20_000_000,
};

/// How large the terminal is; 0 what it does not say.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub(super) columns: u16,
    pub(super) rows: u16,
    pub(super) width_px: u16,
    pub(super) height_px: u16,
}

impl Tty {
    /// Opens the terminal and remembers how it is.
    pub(super) fn open() -> Result<Self, ScreenError> {
        if !io::stdout().is_terminal() {
            return Err(ScreenError::NoTerminal("standard output"));
        }
        if !io::stdin().is_terminal() {
            return Err(ScreenError::NoTerminal("standard input"));
        }
        let input = io::stdin().as_fd().try_clone_to_owned()?;
        let output = File::from(io::stdout().as_fd().try_clone_to_owned()?);
        let unwaiting = open_unwaiting(&output).ok();
        let before = tcgetattr(&input).map_err(io::Error::from)?;
        Ok(Self {
            input,
            output,
            unwaiting,
            before,
        })
    }

    /// Keys come as they are hit, unechoed, Ctrl-C among them.
    pub(super) fn enter_raw(&self) -> io::Result<()> {
        let mut raw = self.before.clone();
        raw.make_raw();
        self.set(&raw)
    }

    /// As it was when it was opened.
    pub(super) fn restore(&self) -> io::Result<()> {
        self.set(&self.before)
    }

    /// At once: waiting until all is written could be for ever.
    fn set(&self, termios: &Termios) -> io::Result<()> {
        let set = || tcsetattr(&self.input, OptionalActions::Now, termios);
        Ok(retry_on_intr(set)?)
    }

    /// Writes all of it, as one piece where the system takes it so.
    pub(super) fn write(&self, bytes: &[u8]) -> io::Result<()> {
        (&self.output).write_all(bytes)
    }

    /// Writes as the terminal takes it, as long as it is wanted; whether that was all.
    /// A write that waits in the system could not be called back: no signal may end
    /// it, and whoever writes next, as with a program's last message, waits behind it.
    pub(super) fn write_while(
        &self,
        bytes: &[u8],
        is_wanted: impl Fn() -> bool,
    ) -> io::Result<bool> {
        let Some(mut line) = self.unwaiting.as_ref() else {
            return self.write(bytes).map(|()| true);
        };
        let mut rest = bytes;
        while !rest.is_empty() {
            if !is_wanted() {
                return Ok(false);
            }
            match line.write(rest) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => rest = &rest[count..],
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() != ErrorKind::WouldBlock => return Err(error),
                Err(_) => wait_for_room(line, &LOOK_IF_WANTED)?,
            }
        }
        Ok(true)
    }

    /// Writes all of it within a time, throwing away what was written before it
    /// where the terminal reads nothing.
    pub(super) fn write_within(&self, bytes: &[u8], limit: Duration) -> io::Result<()> {
        let Some(mut line) = self.unwaiting.as_ref() else {
            return self.write_if_ready(bytes);
        };
        let start = Instant::now();
        let mut rest = bytes;
        while !rest.is_empty() {
            match line.write(rest) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => rest = &rest[count..],
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() != ErrorKind::WouldBlock => return Err(error),
                Err(error) if start.elapsed() > limit => return Err(error),
                Err(_) => {
                    // With what is thrown away may be the beginning.
                    rest = bytes;
                    self.discard_output();
                    thread::sleep(LOOK);
                }
            }
        }
        Ok(())
    }

    /// Writes, unless there is no room at all.
    fn write_if_ready(&self, bytes: &[u8]) -> io::Result<()> {
        let mut waiting = [PollFd::new(&self.output, PollFlags::OUT)];
        match poll(&mut waiting, Some(&Timespec::default()))? {
            0 => Err(ErrorKind::TimedOut.into()),
            _ => self.write(bytes),
        }
    }

    /// Bytes that come within a time; none if none do.
    pub(super) fn read_within(&self, limit: Duration) -> io::Result<Vec<u8>> {
        let limit = Timespec {
            tv_sec: i64::try_from(limit.as_secs()).unwrap_or(i64::MAX),
            tv_nsec: limit.subsec_nanos().into(),
        };
        let mut waiting = [PollFd::new(&self.input, PollFlags::IN)];
        let ready = match poll(&mut waiting, Some(&limit)) {
            // A signal: the caller takes it for the end of the time.
            Err(rustix::io::Errno::INTR) => 0,
            other => other?,
        };
        if ready == 0 {
            return Ok(Vec::new());
        }
        let mut buffer = [0; 1024];
        let count = retry_on_intr(|| read(&self.input, &mut buffer[..]))?;
        Ok(buffer[..count].to_vec())
    }

    /// Throws away what the terminal has not read, and wakes who waits for room:
    /// Linux does that only when output goes on after a halt.
    pub(super) fn discard_output(&self) {
        // Where one of them cannot be done the writer is waited for in vain.
        let _ = tcflush(&self.output, QueueSelector::OFlush);
        let _ = tcflow(&self.output, Action::OOff);
        let _ = tcflow(&self.output, Action::OOn);
    }

    /// Throws away what nobody has read of the terminal.
    pub(super) fn discard_input(&self) {
        let _ = tcflush(&self.input, QueueSelector::IFlush);
    }

    /// How large it is, if it says.
    pub(super) fn size(&self) -> Option<Size> {
        let size = tcgetwinsize(&self.output).ok()?;
        Some(Size {
            columns: size.ws_col,
            rows: size.ws_row,
            width_px: size.ws_xpixel,
            height_px: size.ws_ypixel,
        })
    }
}

/// Waits until a terminal takes something, at most so long.
fn wait_for_room(line: &File, limit: &Timespec) -> io::Result<()> {
    let mut waiting = [PollFd::new(line, PollFlags::OUT)];
    match poll(&mut waiting, Some(limit)) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

/// Opens a terminal by its name, so that writing to it never waits.
fn open_unwaiting(terminal: &File) -> io::Result<File> {
    let name = ttyname(terminal, Vec::new())?;
    let flags = OFlags::WRONLY | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
    Ok(open(name.as_c_str(), flags, Mode::empty())?.into())
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::sync::mpsc::channel;

    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

    use super::*;

    /// Far longer than anything here takes.
    const PATIENCE: Duration = Duration::from_secs(20);

    /// A terminal and its other end, which nobody reads.
    fn unread() -> (Tty, OwnedFd) {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let master = openpt(flags).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let name = ptsname(&master, Vec::new()).unwrap();
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let input = open(name.as_c_str(), flags, Mode::empty()).unwrap();
        let output = File::from(input.try_clone().unwrap());
        let tty = Tty {
            unwaiting: Some(open_unwaiting(&output).unwrap()),
            before: tcgetattr(&input).unwrap(),
            input,
            output,
        };
        tty.enter_raw().unwrap();
        (tty, master)
    }

    /// What comes out at the other end until enough has come, in time.
    fn read_until(master: &OwnedFd, is_enough: impl Fn(&[u8]) -> bool) -> Vec<u8> {
        let limit = Timespec {
            tv_sec: PATIENCE.as_secs() as i64,
            tv_nsec: 0,
        };
        let mut all = Vec::new();
        while !is_enough(&all) {
            let mut waiting = [PollFd::new(master, PollFlags::IN)];
            assert!(poll(&mut waiting, Some(&limit)).unwrap() > 0, "{all:?}");
            let mut buffer = [0; 10_000];
            let count = read(master, &mut buffer[..]).unwrap();
            all.extend_from_slice(&buffer[..count]);
        }
        all
    }

    #[test]
    fn a_write_that_waits_is_given_up_when_it_is_not_wanted() {
        let (tty, master) = unread();
        let frame = vec![b'x'; 1_000_000];
        let (sender, done) = channel();
        thread::spawn(move || {
            let looks = Cell::new(0);
            let is_wanted = || looks.replace(looks.get() + 1) < 50;
            let is_whole = tty.write_while(&frame, is_wanted).unwrap();
            // Nobody stands before the last words.
            tty.write_within(b"last words", PATIENCE).unwrap();
            sender.send((is_whole, tty)).unwrap();
        });
        let (is_whole, _tty) = done.recv_timeout(PATIENCE).expect("nothing waits");
        assert!(!is_whole);
        let all = read_until(&master, |all| all.ends_with(b"last words"));
        assert!(all.starts_with(b"x"), "the frame was begun");
    }

    #[test]
    fn a_write_goes_on_when_there_is_room_again() {
        let (tty, master) = unread();
        let frame: Vec<u8> = (0..200_000_u32).map(|index| (index % 251) as u8).collect();
        let writer = thread::spawn({
            let frame = frame.clone();
            move || tty.write_while(&frame, || true).unwrap()
        });
        // So that it has to wait.
        thread::sleep(Duration::from_millis(50));
        assert!(read_until(&master, |all| all.len() >= frame.len()) == frame);
        assert!(writer.join().unwrap());
    }
}
