//! What the threads share: the terminal, the frame that waits, who writes.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::painter::Painter;
use super::tty::Tty;
use super::{Notice, modes};
use crate::output::terminal::{Cells, Colours, PixelPicture, Protocol};

/// How long a frame that is being written is let go on before what waits of it is
/// thrown away: a second of a slow line is too long for one who wants to go.
const GRACE: Duration = Duration::from_millis(100);
/// How long the writer may take to hear that its frame is not wanted. One that
/// waits in the system, as where a terminal cannot be opened again, hears nothing:
/// what waits is thrown away, again and again, until it is done. A frame of 450 KB
/// in a terminal's buffer of 4 KB takes a hundred times.
const FLUSHING: Duration = Duration::from_millis(500);
/// How long the last bytes may take. They are written by whoever leaves and need no
/// other thread: on a machine with much else to do, 1 s was too short for one.
const LAST_WORDS: Duration = Duration::from_millis(500);
/// Between two looks at whether the writer is done.
const LOOK: Duration = Duration::from_millis(2);

/// A frame to be shown.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub(super) cells: Cells,
    pub(super) picture: Option<PixelPicture>,
}

/// What has been written.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Written {
    /// Frames that were written.
    pub(crate) frames: u64,
    /// Frames that were replaced before they were written.
    pub(crate) dropped: u64,
    /// Bytes of the last frame; 0 if nothing had changed.
    pub(crate) bytes: usize,
    /// How long the last frame took to be encoded.
    pub(crate) encode_ms: f64,
    /// How long the terminal took to take it.
    pub(crate) write_ms: f64,
}

/// Who has the terminal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Who had it before.
    Left,
    /// Us.
    Entered,
    /// Us, but it is being given back.
    Leaving,
    /// Nobody will write again.
    Ended,
}

struct Slot {
    state: State,
    next: Option<Frame>,
    /// The last frame that was written; kept for taking the terminal again.
    last: Option<Frame>,
    /// Whether the terminal may show anything.
    is_forgotten: bool,
    /// Whether the last frame is to be written again if there is no newer one.
    is_to_be_redrawn: bool,
    is_writing: bool,
    /// Whether the rest of the frame that is being written is not wanted any more, and
    /// none is begun before the terminal is taken again.
    is_cut: bool,
    written: Written,
}

/// Signals that the program has sent itself, and which nobody is to hear.
#[derive(Debug, Default)]
pub(super) struct Expected {
    pub(super) stops: AtomicU32,
    pub(super) continues: AtomicU32,
}

pub(super) struct Shared {
    pub(super) tty: Tty,
    pub(super) expected: Expected,
    pub(super) notify: Box<dyn Fn(Notice) + Send + Sync>,
    /// Whether nothing has to be given back, so that a signal may end the program
    /// at once.
    pub(super) is_left: Arc<AtomicBool>,
    /// Takes away a picture of pixels that may be shown over the cells; not every
    /// terminal forgets it with the screen.
    remove_picture: OnceLock<&'static [u8]>,
    slot: Mutex<Slot>,
    changed: Condvar,
}

/// What became of a frame that the writer has taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Written,
    /// Of which nothing was written, or the beginning.
    Cut,
    Failed,
}

/// Of one frame.
struct Figures {
    bytes: usize,
    encode_ms: f64,
    write_ms: f64,
}

/// A frame that the writer has taken.
struct Work {
    frame: Frame,
    is_forgotten: bool,
}

impl Shared {
    pub(super) fn new(tty: Tty, notify: Box<dyn Fn(Notice) + Send + Sync>) -> Self {
        let slot = Slot {
            state: State::Left,
            next: None,
            last: None,
            is_forgotten: false,
            is_to_be_redrawn: false,
            is_writing: false,
            is_cut: false,
            written: Written::default(),
        };
        Self {
            tty,
            expected: Expected::default(),
            notify,
            is_left: Arc::new(AtomicBool::new(true)),
            remove_picture: OnceLock::new(),
            slot: Mutex::new(slot),
            changed: Condvar::new(),
        }
    }

    /// The slot is in order after every statement, so a panic spoils nothing.
    fn slot(&self) -> MutexGuard<'_, Slot> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a change, at most so long.
    fn wait<'a>(&self, slot: MutexGuard<'a, Slot>, limit: Duration) -> MutexGuard<'a, Slot> {
        let waited = self.changed.wait_timeout(slot, limit);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }

    /// Takes the terminal, whoever has it, and lets frames through.
    pub(super) fn enter(&self) -> io::Result<()> {
        let Some(before) = self.hold_writer() else {
            return Ok(());
        };
        let taken = self.take_terminal(before);
        let mut slot = self.slot();
        slot.is_cut = false;
        slot.is_forgotten = true;
        slot.is_to_be_redrawn |= taken.is_ok();
        drop(slot);
        self.changed.notify_all();
        taken
    }

    /// Lets no frame begin and waits until none is being written; who has the terminal
    /// then, or nothing if all is over.
    fn hold_writer(&self) -> Option<State> {
        let mut slot = self.slot();
        slot.is_cut = true;
        let start = Instant::now();
        while slot.is_writing && start.elapsed() < FLUSHING {
            slot = self.wait(slot, LOOK);
        }
        (slot.state != State::Ended).then_some(slot.state)
    }

    /// Takes the terminal from who has it, which may be us.
    fn take_terminal(&self, before: State) -> io::Result<()> {
        self.tty.enter_raw()?;
        self.is_left.store(false, Ordering::Relaxed);
        // Before the bytes, so that leaving takes back what may have arrived.
        self.slot().state = State::Entered;
        if before == State::Entered {
            // A frame may have been cut.
            self.tty.write(modes::CUT)?;
        }
        self.tty.write(modes::ENTER)
    }

    /// Gives the terminal back, if we have it. Who comes second waits until it is
    /// done.
    pub(super) fn leave(&self) {
        let mut slot = self.slot();
        let start = Instant::now();
        while slot.state == State::Leaving && start.elapsed() < GRACE + FLUSHING + LAST_WORDS {
            slot = self.wait(slot, LOOK);
        }
        if slot.state != State::Entered {
            return;
        }
        slot.state = State::Leaving;
        slot.next = None;
        self.wait_for_writer(slot);
        // A terminal that is gone has no modes left to be changed.
        let remove_picture = self.remove_picture.get().copied().unwrap_or_default();
        let last = [modes::CUT, remove_picture, modes::LEAVE].concat();
        let _ = self.tty.write_within(&last, LAST_WORDS);
        // Reports of the mouse that nobody reads would be typed into a shell.
        self.tty.discard_input();
        // The terminal may be gone, and then there is nothing to restore.
        let _ = self.tty.restore();
        self.is_left.store(true, Ordering::Relaxed);
        self.slot().state = State::Left;
        self.changed.notify_all();
    }

    /// Waits until no frame is being written: for a while in peace, then cutting it
    /// and throwing away what the terminal has not read.
    fn wait_for_writer(&self, mut slot: MutexGuard<'_, Slot>) {
        let start = Instant::now();
        while slot.is_writing && start.elapsed() < GRACE + FLUSHING {
            if start.elapsed() > GRACE {
                slot.is_cut = true;
                self.tty.discard_output();
            }
            slot = self.wait(slot, LOOK);
        }
    }

    /// Lets the writer's thread end.
    pub(super) fn end(&self) {
        let mut slot = self.slot();
        slot.state = State::Ended;
        slot.next = None;
        slot.last = None;
        drop(slot);
        self.changed.notify_all();
    }

    /// Whether the terminal is ours.
    pub(super) fn is_entered(&self) -> bool {
        matches!(self.slot().state, State::Entered | State::Leaving)
    }

    pub(super) fn show(&self, frame: Frame) {
        let mut slot = self.slot();
        if slot.next.replace(frame).is_some() {
            slot.written.dropped += 1;
        }
        drop(slot);
        self.changed.notify_all();
    }

    pub(super) fn forget(&self) {
        self.slot().is_forgotten = true;
    }

    pub(super) fn written(&self) -> Written {
        self.slot().written
    }

    /// Starts the thread that writes frames.
    pub(super) fn start_writer(
        shared: &Arc<Self>,
        colours: Colours,
        protocol: Option<Protocol>,
    ) -> io::Result<()> {
        let shared = Arc::clone(shared);
        let remove_picture = protocol.map_or(&b""[..], Protocol::remove);
        shared.remove_picture.get_or_init(|| remove_picture);
        let name = "terminal".to_owned();
        let thread = thread::Builder::new().name(name);
        thread.spawn(move || shared.write_frames(Painter::new(colours, protocol)))?;
        Ok(())
    }

    fn write_frames(&self, mut painter: Painter) {
        while let Some(work) = self.take() {
            if work.is_forgotten {
                painter.forget();
            }
            let start = Instant::now();
            let bytes = painter.bytes(&work.frame, || self.slot().next.is_some());
            let encode_ms = start.elapsed().as_secs_f64() * 1e3;
            let start = Instant::now();
            let outcome = self.write_if_entered(&bytes);
            let figures = Figures {
                bytes: bytes.len(),
                encode_ms,
                write_ms: start.elapsed().as_secs_f64() * 1e3,
            };
            if self.finish(work.frame, outcome, figures) {
                (self.notify)(Notice::Lost);
            }
        }
    }

    /// Writes a frame, unless the terminal has been given back meanwhile.
    fn write_if_entered(&self, bytes: &[u8]) -> Outcome {
        if self.slot().state != State::Entered {
            return Outcome::Cut;
        }
        match self.tty.write_while(bytes, || !self.slot().is_cut) {
            Ok(true) => Outcome::Written,
            Ok(false) => Outcome::Cut,
            Err(_) => Outcome::Failed,
        }
    }

    /// Notes what became of a frame; says whether the terminal is lost.
    fn finish(&self, frame: Frame, outcome: Outcome, figures: Figures) -> bool {
        let mut slot = self.slot();
        slot.is_writing = false;
        slot.last = Some(frame);
        // What was left out or cut is not what the painter has in mind.
        slot.is_forgotten |= outcome != Outcome::Written;
        slot.written = Written {
            frames: slot.written.frames + u64::from(outcome == Outcome::Written),
            bytes: figures.bytes,
            encode_ms: figures.encode_ms,
            write_ms: figures.write_ms,
            ..slot.written
        };
        let is_lost = outcome == Outcome::Failed && slot.state == State::Entered;
        drop(slot);
        self.changed.notify_all();
        is_lost
    }

    /// Waits for a frame; none once all is over.
    fn take(&self) -> Option<Work> {
        let mut slot = self.slot();
        loop {
            if slot.state == State::Ended {
                return None;
            }
            let is_redrawn = slot.is_to_be_redrawn && slot.last.is_some();
            if slot.state == State::Entered && !slot.is_cut && (slot.next.is_some() || is_redrawn) {
                let next = slot.next.take();
                if let Some(frame) = next.or_else(|| slot.last.take()) {
                    slot.is_writing = true;
                    slot.is_to_be_redrawn = false;
                    let is_forgotten = std::mem::take(&mut slot.is_forgotten);
                    return Some(Work {
                        frame,
                        is_forgotten,
                    });
                }
            }
            let waited = self.changed.wait(slot);
            slot = waited.unwrap_or_else(PoisonError::into_inner);
        }
    }
}
