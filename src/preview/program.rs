//! The program: what is on the screen, and what follows from what happens.
//!
//! Pure: a [`Message`] comes in, [`Effect`]s go out, and [`Program::cells`] is the
//! screen. A terminal and a script drive it in the same way.

mod files;
mod prompt;
#[cfg(test)]
mod tests;

pub(crate) use files::load;

use std::path::PathBuf;
use std::time::Duration;

use glam::DVec2;

use super::command::Request;
use super::hands::{Hands, Outcome, Seen};
use super::input::Input;
use super::message::Message;
use super::painter::{Drawn, Sharpness, Wish};
use super::panel;
use super::screen::Notice;
use super::status::Status;
use super::view::View;
use super::worker::Errand;
use crate::frame::EncodedImage;
use crate::output::terminal::{Area, Cells, PixelPicture};
use crate::relight::{Component, Effort, FrameSettings};
use crate::scene::{Override, Scene};
use prompt::Prompt;

/// Exit code after Ctrl-C.
const INTERRUPTED: u8 = 130;

/// What the program asks of whatever drives it.
pub(crate) enum Effect {
    /// Pictures of the wish of that number, and of none before it.
    Show(u64, Box<Wish>),
    /// Something of the drawing thread.
    Send(Errand),
    /// A scene made ready, under that number.
    Prepare(u64, Box<Scene>),
    /// The scene file and all it names read again.
    Load,
    /// These files watched from now on, as they are now.
    Watch(Vec<PathBuf>),
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
    pub(crate) overrides: Vec<Override>,
    /// What the file holds, as far as the program knows.
    pub(crate) bytes: Vec<u8>,
}

/// The state of the program.
pub(crate) struct Program {
    file: SceneFile,
    /// The scene as the file has it.
    scene: Scene,
    hands: Hands,
    /// Columns and rows of the screen.
    size: (u16, u16),
    /// Pixels of a cell, where the terminal shows pictures.
    cell_px: Option<(u16, u16)>,
    /// Number of the last wish, and of the last scene that was sent to be prepared.
    wishes: u64,
    preparations: u64,
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

impl Program {
    /// The program on a scene that was read from `file`, and what it begins with.
    pub(crate) fn start(
        file: SceneFile,
        scene: Scene,
        size: (u16, u16),
        cell_px: Option<(u16, u16)>,
    ) -> (Self, Vec<Effect>) {
        let mut program = Self {
            hands: Hands::new(&scene, Component::Global),
            file,
            scene,
            size,
            cell_px,
            wishes: 0,
            preparations: 0,
            oldest: 0,
            drawn: None,
            fine: None,
            prompt: None,
            help: None,
            status: Status::default(),
        };
        program.status.say("? shows the keys");
        let effects = vec![
            Effect::Watch(program.watched()),
            program.prepare(),
            program.show(),
        ];
        (program, effects)
    }

    /// Takes a message; `now` is the time since any fixed moment.
    pub(crate) fn take(&mut self, message: Message, now: Duration) -> Vec<Effect> {
        match message {
            Message::Input(input) => self.input(input, now),
            Message::Drawn { number, drawn } => {
                if number >= self.oldest {
                    self.look(number, *drawn, now);
                }
                Vec::new()
            }
            Message::NotDrawn(error) => self.fails(error),
            Message::Wrote { path, written } => {
                self.status.wrote(&path, written);
                Vec::new()
            }
            Message::Prepared { number, renderer } => {
                if number != self.preparations {
                    return Vec::new();
                }
                self.status.prepared(&renderer);
                vec![Effect::Send(Errand::Adopt(renderer)), self.show_anew()]
            }
            Message::NotPrepared { number, error } => {
                if number != self.preparations {
                    return Vec::new();
                }
                self.status.baking = None;
                self.fails(error)
            }
            Message::Baking { stage, share } => {
                self.status.baking = Some((stage, share));
                Vec::new()
            }
            Message::FilesChanged => self.files_changed(),
            Message::Loaded { bytes, scene } => self.loaded(bytes, scene),
            Message::Terminal(notice) => self.notice(notice),
        }
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
        if let Some(prompt) = self.prompt.take() {
            return self.answer(prompt, input);
        }
        if let Some(first) = self.help {
            let key = match input {
                Input::Key(key) => key,
                Input::Mouse(_) | Input::Resize { .. } => return Vec::new(),
            };
            self.help = panel::scrolled(first, key, self.size);
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
        vec![Effect::Redraw, self.show_anew()]
    }

    /// What follows from what the hands did.
    fn follow(&mut self, outcome: Outcome) -> Vec<Effect> {
        if let Some(message) = outcome.message {
            self.status.say(message);
        }
        let mut effects = Vec::new();
        let changed = outcome.changed;
        let redrawn = changed.lights || changed.albedos || changed.camera || changed.render;
        if redrawn || changed.component {
            effects.push(self.show());
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
            Request::Quit => vec![Effect::Quit(0)],
        }
    }

    fn fails(&mut self, error: String) -> Vec<Effect> {
        self.status.fail(error);
        Vec::new()
    }

    /// A picture has come.
    fn look(&mut self, number: u64, drawn: Drawn, now: Duration) {
        self.oldest = number;
        self.status.drew(&drawn, now);
        if drawn.sharpness == Sharpness::Fine {
            if number == self.wishes {
                self.fine = Some(drawn);
            }
        } else {
            self.fine = None;
            self.drawn = Some(drawn);
        }
    }

    /// The same, and none of what was wished for before: of another size or scene.
    fn show_anew(&mut self) -> Effect {
        let effect = self.show();
        self.oldest = self.wishes;
        effect
    }

    /// Pictures of the scene as it is now.
    fn show(&mut self) -> Effect {
        self.wishes += 1;
        self.fine = None;
        Effect::Show(self.wishes, Box::new(self.wish()))
    }

    fn prepare(&mut self) -> Effect {
        self.preparations += 1;
        self.status.baking = Some(("reading the mesh", 0.0));
        Effect::Prepare(self.preparations, Box::new(self.scene.clone()))
    }

    /// What is to be seen.
    pub(crate) fn wish(&self) -> Wish {
        let document = self.hands.document();
        let mut materials = self.scene.materials.clone();
        for (material, albedo) in materials.iter_mut().zip(&document.albedos) {
            material.albedo = *albedo;
        }
        let view = self.view();
        let mut camera = document.camera;
        camera.size = view.size_px;
        let fine_size = self.cell_px.map(|(width, height)| {
            [(view.columns, width), (view.rows, height)]
                .map(|(cells, px)| u32::from(cells) * u32::from(px))
        });
        Wish {
            lights: document.shown_lights(),
            materials,
            frame: FrameSettings {
                camera,
                bounces: document.render.bounces,
                light_samples: document.render.light_samples,
                component: document.component,
                effort: Effort::Full,
            },
            exposure: document.render.exposure,
            tone: document.render.tone,
            fine_size,
        }
    }

    /// Where the picture is: above the status line, which goes first where there
    /// is hardly any room.
    pub(crate) fn view(&self) -> View {
        let (columns, rows) = self.size;
        let picture_rows = if rows > 1 { rows - 1 } else { rows };
        let side = |cells: u16, px: u32| u32::from(cells.max(1)) * px;
        View {
            column: 0,
            row: 0,
            columns,
            rows: picture_rows,
            size_px: [side(columns, 1), side(picture_rows, 2)],
            extent: self.scene.placement().extent,
        }
    }

    /// The screen.
    pub(crate) fn cells(&self) -> Cells {
        let (columns, rows) = self.size;
        let mut cells = Cells::new(columns, rows);
        let view = self.view();
        match self.marked() {
            Some(marked) => cells.picture(view.row, &marked),
            None => panel::waiting(&mut cells, &self.status),
        }
        if let Some(first) = self.help {
            panel::help(&mut cells, first);
        }
        let bottom = match &self.prompt {
            Some(prompt) => panel::Bottom::Question(prompt.text()),
            None if self.help.is_some() => panel::Bottom::Question(panel::HELP_KEYS),
            None => panel::Bottom::Status {
                status: &self.status,
                selected: self.hands.selected_name(),
                is_unsaved: self.hands.is_unsaved(),
            },
        };
        panel::bottom(&mut cells, &bottom);
        cells
    }

    /// The picture in pixels, once the scene rests and nothing lies over it.
    pub(crate) fn pixel_picture(&self) -> Option<PixelPicture> {
        let fine = self.fine.as_ref().filter(|_| self.help.is_none())?;
        let view = self.view();
        let mut fine_view = view;
        fine_view.size_px = [fine.levels.width(), fine.levels.height()];
        Some(PixelPicture {
            levels: self.hands.with_marks(&fine.levels, &fine_view),
            area: Area {
                column: view.column,
                row: view.row,
                columns: view.columns,
                rows: view.rows,
            },
        })
    }

    /// The last picture in cells, with the marks of lights.
    pub(crate) fn marked(&self) -> Option<EncodedImage> {
        let drawn = self.drawn.as_ref()?;
        Some(self.hands.with_marks(&drawn.levels, &self.view()))
    }

    /// Whether there is something to save.
    pub(crate) fn is_unsaved(&self) -> bool {
        self.hands.is_unsaved()
    }
}

/// What is seen at pixel coordinates of the view.
fn seen_at(drawn: &Drawn, view: &View, camera: &crate::scene::Camera, px: DVec2) -> Option<Seen> {
    let [width, height] = drawn.seen.size;
    let at = |place: f64, of: u32, count: u32| {
        let scaled = place / f64::from(of) * f64::from(count);
        (scaled >= 0.0 && scaled < f64::from(count)).then_some(scaled as usize)
    };
    let x = at(px.x, view.size_px[0], width)?;
    let y = at(px.y, view.size_px[1], height)?;
    let pixel = y * width as usize + x;
    let depth = f64::from(*drawn.seen.depths.get(pixel)?);
    let material = drawn.seen.materials.get(pixel).copied().flatten()?;
    Some(Seen {
        material: material as usize,
        point: view.eye(camera).point_at(px, depth),
    })
}
