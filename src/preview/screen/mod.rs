//! The terminal taken over and given back.
//!
//! Comes in: frames, whenever there is a new one. Goes out: bytes to the terminal,
//! at its own pace, and [`Notice`]s of what happens from outside. The terminal is
//! as it was before after every way to end that a program can see: leaving, a
//! panic, a signal, a stop; and leaving takes a bounded time even where nobody
//! reads what is written.
//!
//! Threads: one writes, one hears signals. Neither uses a processor at rest.

mod hook;
mod modes;
mod painter;
mod shared;
#[cfg(unix)]
mod signals;
#[cfg(unix)]
mod stop;
#[cfg_attr(unix, path = "tty.rs")]
#[cfg_attr(not(unix), path = "tty_elsewhere.rs")]
mod tty;

use std::io;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crossterm::event::Event;

use super::ask::{
    Abilities, Answers, ColourChoice, Environment, Heard, LONG_PATIENCE, LateAnswers, PATIENCE,
    ProtocolChoice, QUESTIONS, decide, typed_events,
};
use crate::output::terminal::{Cells, PixelPicture, Protocol};
use shared::{Frame, Shared};
use tty::Tty;

pub(crate) use shared::Written;

/// Time between two pictures: 40 a second.
const PACE: Duration = Duration::from_millis(25);
/// The same over a network: 15 a second, of 50 KB each on a usual screen.
const REMOTE_PACE: Duration = Duration::from_millis(66);

/// What a user asks of the screen.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ScreenSettings {
    /// Colours of cells.
    pub(crate) colours: ColourChoice,
    /// Protocol for pixels.
    pub(crate) protocol: ProtocolChoice,
}

/// What happens to the screen from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Notice {
    /// Somebody asks the program to stop (SIGTSTP): call [`Screen::suspend`].
    Stop,
    /// The program goes on after a stop that it did not see (SIGCONT): call
    /// [`Screen::resume`].
    Continued,
    /// The terminal may have another size (SIGWINCH): call [`Screen::size`].
    Resized,
    /// The program is to end (a signal), with this exit code. If the screen is
    /// not left within two seconds, or the signal comes again, it is left and
    /// the signal does what it does by default.
    End(u8),
    /// A thread has panicked; the screen is left already.
    Panicked,
    /// The terminal cannot be written to any more.
    Lost,
}

/// Why there is no screen.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ScreenError {
    /// A pipe, a file or nothing.
    #[error("{0} is no terminal; `relume render` writes a picture without one")]
    NoTerminal(&'static str),
    /// One whose cursor cannot be moved.
    #[error(
        "a terminal of TERM={0} shows no pictures; `relume render` writes one without a terminal"
    )]
    Dumb(String),
    /// The system said no.
    #[error("the terminal could not be set up")]
    Setup(#[from] io::Error),
}

/// A terminal that shows frames, until it is dropped.
pub(crate) struct Screen {
    shared: Arc<Shared>,
    abilities: Abilities,
    typed: Vec<Event>,
    asked: Instant,
    is_answered: bool,
    is_remote: bool,
    #[cfg(unix)]
    _signals: signals::Listening,
}

impl Screen {
    /// Takes the terminal over: asks it what it can do, and starts the threads.
    /// `notify` is called from them and must not block.
    ///
    /// No other thread may read the terminal before this returns. Signals that
    /// end a program belong to the screen: nothing else may exit on them, and
    /// nothing may `exit` while it is shown.
    ///
    /// # Errors
    /// If standard input or output is no terminal, or cannot be set up. The
    /// terminal is then as it was.
    pub(crate) fn enter(
        settings: ScreenSettings,
        notify: impl Fn(Notice) + Send + Sync + 'static,
    ) -> Result<Self, ScreenError> {
        let environment = Environment::of_process();
        let tty = Tty::open()?;
        if environment.is_dumb() {
            return Err(ScreenError::Dumb(environment.term));
        }
        let shared = Arc::new(Shared::new(tty, Box::new(notify)));
        hook::watch(&shared);
        #[cfg(unix)]
        let signals = signals::listen(&shared)?;
        let asked = Instant::now();
        let heard = shared
            .enter()
            .and_then(|()| ask(&shared.tty, &environment, asked))
            .inspect_err(|_| shared.leave())?;
        let abilities = abilities(&environment, &heard.answers, settings, &shared.tty);
        let (colours, protocol) = (abilities.colours, abilities.protocol);
        Shared::start_writer(&shared, colours, protocol).inspect_err(|_| shared.leave())?;
        Ok(Self {
            shared,
            abilities,
            typed: typed_events(&heard.rest),
            asked,
            is_remote: environment.is_remote,
            is_answered: heard.answers.is_complete() || !environment.may_be_asked(),
            #[cfg(unix)]
            _signals: signals,
        })
    }

    /// Shows a frame, with a picture of pixels over its cells where the terminal
    /// has a protocol. Returns at once: a frame that has not been written yet is
    /// dropped for this one.
    pub(crate) fn show(&self, cells: Cells, picture: Option<PixelPicture>) {
        self.shared.show(Frame { cells, picture });
    }

    /// The terminal may show anything by now, as after a change of its size: the
    /// next frame is written whole.
    pub(crate) fn forget(&self) {
        self.shared.forget();
    }

    /// Gives the terminal back and stops the program, with all of its process
    /// group, until it is continued; then takes the terminal again and writes the
    /// last frame whole. Does nothing where nobody could continue the program,
    /// as when the terminal was opened for it.
    ///
    /// # Errors
    /// If the terminal cannot be taken again.
    pub(crate) fn suspend(&self) -> io::Result<()> {
        #[cfg(unix)]
        if stop::can_be_continued() {
            self.shared.leave();
            stop::stop(&self.shared.expected)?;
            self.shared.enter()?;
        }
        Ok(())
    }

    /// Takes the terminal again after a stop that could not be seen, and writes
    /// the last frame whole.
    ///
    /// # Errors
    /// If the terminal cannot be taken again.
    pub(crate) fn resume(&self) -> io::Result<()> {
        self.shared.enter()
    }

    /// Gives the terminal back; a second time does nothing. Frames that are shown
    /// afterwards wait for [`resume`](Self::resume).
    pub(crate) fn leave(&self) {
        self.shared.leave();
    }

    /// Columns and rows of the terminal now. One that does not say has 80 x 24;
    /// more than anyone can see are not believed.
    pub(crate) fn size(&self) -> (u16, u16) {
        /// Most columns and rows.
        const MOST: (u16, u16) = (2_000, 1_000);
        match self.shared.tty.size() {
            Some(size) if size.columns > 0 && size.rows > 0 => {
                (size.columns.min(MOST.0), size.rows.min(MOST.1))
            }
            _ => (80, 24),
        }
    }

    /// Width and height of a cell in pixels, if the terminal says.
    pub(crate) fn cell_px(&self) -> Option<(u16, u16)> {
        cell_px(&self.abilities, &self.shared.tty)
    }

    /// Least time between two pictures that change: a network holds what is too
    /// much for it, and shows it late.
    pub(crate) fn pace(&self) -> Duration {
        if self.is_remote { REMOTE_PACE } else { PACE }
    }

    /// What of the terminal is used.
    pub(crate) fn abilities(&self) -> &Abilities {
        &self.abilities
    }

    /// Keys that were typed while the terminal was being asked, once.
    pub(crate) fn take_typed(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.typed)
    }

    /// What all events of the terminal have to pass, so that answers that come
    /// late are not taken for keys.
    pub(crate) fn late_answers(&self) -> LateAnswers {
        LateAnswers::new(self.asked, !self.is_answered)
    }

    /// What has been written so far.
    pub(crate) fn written(&self) -> Written {
        self.shared.written()
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        self.shared.leave();
        self.shared.end();
    }
}

/// Most bytes of answers and of keys between them; one who sends more babbles, and
/// nothing of it is taken for a key.
const MOST_ANSWERS: usize = 16_384;

/// Asks the terminal and waits for its answers, but not for long.
fn ask(tty: &Tty, environment: &Environment, asked: Instant) -> io::Result<Heard> {
    if !environment.may_be_asked() {
        return Ok(Heard::default());
    }
    tty.write(QUESTIONS)?;
    let mut bytes = Vec::new();
    let mut heard = Heard::default();
    while !heard.answers.is_complete() {
        let is_slow = environment.is_remote || !heard.answers.is_empty();
        let patience = if is_slow { LONG_PATIENCE } else { PATIENCE };
        let left = patience.saturating_sub(asked.elapsed());
        let more = tty.read_within(left)?;
        if more.is_empty() || left.is_zero() {
            break;
        }
        bytes.extend(more);
        if bytes.len() > MOST_ANSWERS {
            tty.discard_input();
            return Ok(Heard::default());
        }
        heard = Heard::read(&bytes);
    }
    Ok(heard)
}

/// What is used, but no sixels where their size is not known, unless they are
/// asked for.
fn abilities(
    environment: &Environment,
    answers: &Answers,
    settings: ScreenSettings,
    tty: &Tty,
) -> Abilities {
    let mut abilities = decide(environment, answers, settings.colours, settings.protocol);
    let is_chosen = settings.protocol == ProtocolChoice::Auto;
    let is_sixel = abilities.protocol == Some(Protocol::Sixel);
    if is_chosen && is_sixel && cell_px(&abilities, tty).is_none() {
        abilities.protocol = None;
    }
    abilities
}

/// A cell's pixels by the terminal's answer, else by the system.
fn cell_px(abilities: &Abilities, tty: &Tty) -> Option<(u16, u16)> {
    let by_system = || {
        let size = tty.size()?;
        let width = size.width_px.checked_div(size.columns)?;
        let height = size.height_px.checked_div(size.rows)?;
        (width > 0 && height > 0).then_some((width, height))
    };
    abilities.cell_px.or_else(by_system)
}

#[cfg(test)]
#[cfg(unix)]
mod endings;
#[cfg(test)]
#[cfg(unix)]
#[path = "../../../tests/preview/terminal.rs"]
mod terminal;
