//! The program: what is on the screen, and what follows from what happens.
//!
//! Pure: a [`Message`] comes in, [`Effect`]s go out, and [`Program::cells`] is the
//! screen. A terminal and a script drive it in the same way.

mod files;
mod pictures;
mod prompt;
#[cfg(test)]
mod tests;

pub(crate) use files::load;

use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use glam::DVec2;

use super::command::Request;
use super::hands::{Hands, Outcome};
use super::input::Input;
use super::message::Message;
use super::painter::{Drawn, Wish};
use super::panel;
use super::prepare::Wanted;
use super::screen::Notice;
use super::status::Status;
use super::watch::Watched;
use super::worker::Errand;
use crate::relight::{Component, Renderer};
use crate::scene::{Override, Scene};
use pictures::seen_at;
use prompt::Prompt;

/// Exit code after Ctrl-C.
const INTERRUPTED: u8 = 130;

/// What the program asks of whatever drives it.
pub(crate) enum Effect {
    /// Pictures of the wish of that number, and of none before it.
    Show(u64, Box<Wish>),
    /// Something of the drawing thread.
    Send(Errand),
    /// A scene made ready.
    Prepare(Wanted, Box<Scene>),
    /// The scene file and all it names read again, for the how manieth time.
    Load(u64),
    /// These files watched from now on.
    Watch(Watched),
    /// The screen drawn whole.
    Redraw,
    /// The terminal given back until the program is continued.
    Suspend,
    /// The terminal taken again.
    Resume,
    /// The terminal's size, as an input.
    AskSize,
    /// The end, with an exit code.
    Quit(u8),
}

/// A scene file and what the command line changes of it.
pub(crate) struct SceneFile {
    pub(crate) path: PathBuf,
    /// Those that still hold: the file gives what was edited and saved.
    pub(crate) overrides: Vec<Override>,
    /// What the file holds, as far as the program knows.
    pub(crate) bytes: Vec<u8>,
}

/// The state of the program.
pub(crate) struct Program {
    file: SceneFile,
    /// The scene as the file has it, and its longest side, scene units.
    scene: Scene,
    extent: f64,
    hands: Hands,
    /// Columns and rows of the screen.
    size: (u16, u16),
    /// Pixels of a cell, where the terminal shows pictures.
    cell_px: Option<(u16, u16)>,
    /// What was wished for last, and its number.
    wished: Option<Wish>,
    wishes: u64,
    /// Number of the last scene that was sent to be prepared.
    preparations: u64,
    bake: BakeState,
    /// Number of the last time the files were read.
    loads: u64,
    is_loading: bool,
    /// Whether that may cost edits.
    load_is_answered: bool,
    /// Whether files have changed while a question was open.
    files_wait: bool,
    /// Pictures that are on their way into files.
    writing: Vec<PathBuf>,
    /// What the program ends after: it is asked to.
    quits_after: Option<QuitsAfter>,
    /// Number of the oldest wish whose pictures may be shown. While something
    /// moves there is a newer wish before a picture of the last one has come: it
    /// is shown all the same.
    oldest: u64,
    drawn: Option<Drawn>,
    fine: Option<Drawn>,
    prompt: Option<Prompt>,
    /// First line of the help, while it is shown.
    help: Option<usize>,
    pub(crate) status: Status,
}

/// Where the bake is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum BakeState {
    /// A scene is being prepared, with its bake if it needs one.
    OnItsWay,
    /// Nothing is being made.
    Settled,
    /// It could not be made, and is not tried again.
    Failed,
}

/// What comes before the end of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum QuitsAfter {
    Saving,
    Writing,
}

impl Program {
    /// The program on a scene that was read from `file`, and what it begins with.
    pub(crate) fn start(
        file: SceneFile,
        scene: Scene,
        loaded_at: SystemTime,
        (size, cell_px): ((u16, u16), Option<(u16, u16)>),
    ) -> (Self, Vec<Effect>) {
        let mut program = Self {
            hands: Hands::new(&scene, Component::Global),
            file,
            extent: scene.placement().extent,
            scene,
            size,
            cell_px,
            wished: None,
            wishes: 0,
            preparations: 0,
            bake: BakeState::Settled,
            loads: 0,
            is_loading: false,
            load_is_answered: false,
            files_wait: false,
            writing: Vec::new(),
            quits_after: None,
            oldest: 0,
            drawn: None,
            fine: None,
            prompt: None,
            help: None,
            status: Status::default(),
        };
        program.status.say(match program.scene.lights.is_empty() {
            true => "no lights to move; n p makes one, ? shows the keys",
            false => "? shows the keys",
        });
        let mut effects = vec![
            Effect::Watch(program.watched(loaded_at)),
            program.prepare(false),
        ];
        effects.extend(program.show());
        (program, effects)
    }

    /// Takes a message; `now` is the time since any fixed moment.
    pub(crate) fn take(&mut self, message: Message, now: Duration) -> Vec<Effect> {
        match message {
            Message::Input(input) => self.input(input, now),
            Message::Drawn { number, drawn } => {
                if number < self.oldest {
                    return Vec::new();
                }
                self.look(number, *drawn, now)
            }
            Message::NotDrawn(error) => self.fails(error),
            Message::Wrote { path, written } => self.wrote(&path, written),
            Message::Prepared { number, .. }
            | Message::NotPrepared { number, .. }
            | Message::Baking { number, .. }
                if number != self.preparations =>
            {
                Vec::new()
            }
            Message::Prepared { renderer, .. } => self.prepared(renderer),
            Message::NotPrepared { error, .. } => {
                self.bake = BakeState::Failed;
                self.status.baking = None;
                self.fails(error)
            }
            Message::Baking { stage, share, .. } => {
                self.status.baking = Some((stage, share));
                Vec::new()
            }
            Message::FilesChanged => self.files_changed(),
            Message::Loaded { number, loaded } if number == self.loads => self.loaded(loaded),
            Message::Loaded { .. } => Vec::new(),
            Message::Terminal(notice) => self.notice(notice),
        }
    }

    /// There is a renderer, whose bake may follow.
    fn prepared(&mut self, renderer: Box<Renderer>) -> Vec<Effect> {
        self.status.prepared(&renderer);
        let awaits_bake = self.status.baking.is_some();
        self.bake = match awaits_bake {
            true => BakeState::OnItsWay,
            false => BakeState::Settled,
        };
        // The drawing thread begins its wish anew with another renderer.
        self.oldest = self.wishes;
        vec![Effect::Send(Errand::Adopt(renderer))]
    }

    fn notice(&mut self, notice: Notice) -> Vec<Effect> {
        match notice {
            Notice::Stop => vec![Effect::Suspend],
            Notice::Continued => vec![Effect::Resume],
            Notice::End(code) => vec![Effect::Quit(code)],
            // The hook has told; a terminal that is gone shows nothing.
            Notice::Panicked | Notice::Lost => vec![Effect::Quit(1)],
            Notice::Resized => vec![Effect::AskSize],
        }
    }

    fn input(&mut self, input: Input, now: Duration) -> Vec<Effect> {
        if let Input::Resize { columns, rows } = input {
            return self.resize((columns, rows), now);
        }
        if let Input::Key(key) = input {
            if let Some(prompt) = self.prompt.take() {
                return self.answer(prompt, key);
            }
            if let Some(first) = self.help {
                self.help = panel::scrolled(first, key, self.size);
                return Vec::new();
            }
        } else if self.help.is_some() && !input.is_release() {
            return Vec::new();
        }
        let view = self.view();
        let drawn = self.drawn.as_ref();
        let hands = &mut self.hands;
        let camera = hands.document().camera;
        let sight = |px: DVec2| seen_at(drawn?, &view, &camera, px);
        let outcome = hands.take(input, &view, &sight, now);
        self.follow(outcome)
    }

    fn resize(&mut self, size: (u16, u16), now: Duration) -> Vec<Effect> {
        let (columns, rows) = size;
        let view = self.view();
        let input = Input::Resize { columns, rows };
        self.hands.take(input, &view, &|_| None, now);
        self.size = size;
        // Another number of lines may be the last page of the help.
        self.help = self.help.map(|first| panel::clamped(first, size));
        let mut effects = vec![Effect::Redraw];
        effects.extend(self.show_anew());
        effects
    }

    /// What follows from what the hands did.
    fn follow(&mut self, outcome: Outcome) -> Vec<Effect> {
        if let Some(message) = outcome.message {
            self.status.say(message);
        }
        let mut effects = Vec::new();
        let changed = outcome.changed;
        let redrawn = changed.lights || changed.reflections || changed.camera || changed.render;
        if redrawn || changed.component {
            effects.extend(self.show());
        }
        if let Some(request) = outcome.request {
            effects.extend(self.request(request));
        }
        effects
    }

    fn request(&mut self, request: Request) -> Vec<Effect> {
        match request {
            Request::Save => self.save(),
            Request::WritePng => self.write_png(),
            Request::Help => {
                self.help = Some(0);
                Vec::new()
            }
            Request::Redraw => vec![Effect::Redraw],
            Request::Suspend => vec![Effect::Suspend],
            Request::Interrupt => vec![Effect::Quit(INTERRUPTED)],
            Request::Quit if self.hands.is_unsaved() => {
                self.prompt = Some(Prompt::Quit);
                Vec::new()
            }
            Request::Quit => self.quit(),
        }
    }

    /// Ends the program, once what is being written is written.
    fn quit(&mut self) -> Vec<Effect> {
        if let Some(path) = self.writing.first() {
            let waits = format!(
                "quits once {} is written; Ctrl-C does at once",
                path.display()
            );
            self.status.say(waits);
            self.quits_after = Some(QuitsAfter::Writing);
            return Vec::new();
        }
        vec![Effect::Quit(0)]
    }

    /// What is changed of the scene file whenever it is read.
    pub(crate) fn overrides(&self) -> &[Override] {
        &self.file.overrides
    }

    fn fails(&mut self, error: String) -> Vec<Effect> {
        self.status.fail(error);
        Vec::new()
    }
}
