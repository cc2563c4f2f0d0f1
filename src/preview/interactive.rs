//! The program in a terminal.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Instant;

use super::input::Input;
use super::message::Message;
use super::prepare::{Preparer, Preparing};
use super::program::{Effect, Program, SceneFile, load};
use super::screen::{Screen, ScreenSettings};
use super::watch::Watch;
use super::worker::{Errand, Worker};
use super::{PreviewError, PreviewSettings};
use crate::scene::Override;

/// What a session has besides the program.
struct Session<'a> {
    settings: &'a PreviewSettings,
    queue: Sender<Message>,
    screen: Screen,
    worker: Worker,
    watch: Option<Watch>,
    preparing: Option<Preparing>,
    preparer: Preparer,
}

/// How a session ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ended {
    /// Exit code: 0 by `q`, 130 by Ctrl-C, 128 + the signal's number else.
    pub exit_code: u8,
    /// Where the changes are that were not saved, if the end was not asked for.
    pub rescued: Option<PathBuf>,
}

/// Shows a scene in the terminal until the person at it ends the program. Unsaved
/// changes that nobody discarded are put beside the scene file.
///
/// # Errors
/// A scene that cannot be read, no terminal, or a system that starts no threads.
/// The terminal is then as it was.
pub fn run_in_terminal(settings: &PreviewSettings) -> Result<Ended, PreviewError> {
    let loaded = load(&settings.scene, &settings.overrides);
    let mut scene = *loaded.scene?;
    let warnings = std::mem::take(&mut scene.warnings);
    let (queue, messages) = channel();
    let notices = queue.clone();
    let wanted = ScreenSettings {
        colours: settings.colours,
        protocol: settings.protocol,
    };
    let mut screen = Screen::enter(wanted, move |notice| {
        // Nobody listens once the session has ended.
        let _ = notices.send(Message::Terminal(notice));
    })?;
    let worker = Worker::start(&settings.preparation, screen.pace(), queue.clone())?;
    let typed = screen.take_typed();
    read_inputs(&screen, queue.clone())?;
    let file = SceneFile {
        path: settings.scene.clone(),
        overrides: settings.overrides.clone(),
        bytes: loaded.bytes,
    };
    let cell_px = screen.abilities().protocol.and(screen.cell_px());
    let (mut program, effects) = Program::start(file, scene, loaded.at, (screen.size(), cell_px));
    if let Some(warning) = warnings.first() {
        program.status.say(warning.clone());
    }
    for input in typed.iter().filter_map(Input::of_terminal) {
        let _ = queue.send(Message::Input(input));
    }
    let mut session = Session {
        settings,
        queue,
        screen,
        worker,
        watch: None,
        preparing: None,
        preparer: Preparer::new(settings.preparation.clone()),
    };
    let exit_code = session.run(&mut program, effects, &messages);
    // The terminal is given back before anything that may take a while.
    session.screen.leave();
    let rescued = (exit_code != 0).then(|| program.rescue()).flatten();
    Ok(Ended { exit_code, rescued })
}

/// Starts the thread that waits for the terminal's events.
fn read_inputs(screen: &Screen, queue: Sender<Message>) -> Result<(), PreviewError> {
    let mut late = screen.late_answers();
    let thread = std::thread::Builder::new().name("input".to_owned());
    thread.spawn(move || {
        while let Ok(event) = crossterm::event::read() {
            let input = Input::of_terminal(&event).filter(|_| late.is_input(&event));
            if let Some(input) = input
                && queue.send(Message::Input(input)).is_err()
            {
                return;
            }
        }
    })?;
    Ok(())
}

impl Session<'_> {
    fn run(
        &mut self,
        program: &mut Program,
        effects: Vec<Effect>,
        messages: &Receiver<Message>,
    ) -> u8 {
        let start = Instant::now();
        if let Some(code) = self.follow(program, effects) {
            return code;
        }
        self.screen.show(program.cells(), None);
        while let Ok(message) = messages.recv() {
            // All that has come meanwhile is one frame.
            for message in std::iter::once(message).chain(messages.try_iter()) {
                let effects = program.take(message, start.elapsed());
                if let Some(code) = self.follow(program, effects) {
                    return code;
                }
            }
            program.status.written = self.screen.written();
            self.screen.show(program.cells(), program.pixel_picture());
        }
        0
    }

    /// Does what the program asks; the exit code where that is its end.
    fn follow(&mut self, program: &mut Program, effects: Vec<Effect>) -> Option<u8> {
        for effect in effects {
            match effect {
                Effect::Show(number, wish) => self.worker.show(number, *wish),
                Effect::Send(errand) => {
                    if let Errand::Adopt(renderer) = &errand {
                        self.preparer.keep_bake_of(renderer);
                    }
                    self.worker.send(errand);
                }
                Effect::Prepare(wanted, scene) => {
                    let preparer = self.preparer.clone();
                    let queue = self.queue.clone();
                    // The one before is stopped when it is dropped.
                    self.preparing = Some(Preparing::start(wanted, *scene, preparer, queue));
                }
                Effect::Load(number) => self.load(number, program.overrides().to_vec()),
                Effect::Watch(watched) => match &self.watch {
                    Some(watch) => watch.look_at(watched),
                    None => self.watch = Some(Watch::start(watched, self.queue.clone())),
                },
                Effect::Redraw => self.screen.forget(),
                Effect::Suspend => self.suspend(program),
                Effect::Resume => self.resume(program),
                Effect::AskSize => self.ask_size(),
                Effect::Quit(code) => return Some(code),
            }
        }
        None
    }

    /// Reads the scene again, in a thread of its own.
    fn load(&self, number: u64, overrides: Vec<Override>) {
        let path = self.settings.scene.clone();
        let queue = self.queue.clone();
        let thread = std::thread::Builder::new().name("load".to_owned());
        let started = thread.spawn(move || {
            let loaded = load(&path, &overrides);
            let _ = queue.send(Message::Loaded { number, loaded });
        });
        if let Err(error) = started {
            let error = format!("cannot read the scene again: {error}");
            let _ = self.queue.send(Message::NotDrawn(error));
        }
    }

    fn suspend(&self, program: &mut Program) {
        if let Err(error) = self.screen.suspend() {
            program.status.fail(format!("cannot suspend: {error}"));
        }
        self.ask_size();
    }

    fn resume(&self, program: &mut Program) {
        if let Err(error) = self.screen.resume() {
            program
                .status
                .fail(format!("cannot take the terminal again: {error}"));
        }
        self.ask_size();
    }

    /// The terminal may have another size by now.
    fn ask_size(&self) {
        let (columns, rows) = self.screen.size();
        let _ = self
            .queue
            .send(Message::Input(Input::Resize { columns, rows }));
    }
}
