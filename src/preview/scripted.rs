//! The program driven by a script, without a terminal and without clocks: the
//! same script gives the same pictures.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::message::Message;
use super::painter::{Drawn, Painter, Sharpness, Wish};
use super::prepare::{Preparer, Wanted};
use super::program::{Effect, Program, SceneFile, load};
use super::script::{ScriptEvent, Scripted, parse};
use super::shot::write_shot;
use super::worker::Errand;
use super::write_frame::write_frame;
use super::{PreviewError, PreviewSettings};
use crate::bake::RunSettings;
use crate::output::terminal::{CellEncoder, Colours};
use crate::relight::FrameSettings;
use crate::scene::Scene;

/// Time between two frames, for what a burst of keys is.
const FRAME: Duration = Duration::from_millis(33);
/// Size of the screen until the script gives another.
const SIZE: (u16, u16) = (80, 24);

/// What a script's run came to.
#[derive(Debug, Clone, Default)]
pub struct ScriptReport {
    /// Frames that the script went through.
    pub frames: u64,
    /// Digest of the last full frame's pixels, at the size of the picture in cells,
    /// without marks: that of `render` at this size.
    pub digest: Option<String>,
    /// That size.
    pub size: [u32; 2],
    /// Files that were written: pictures of the screen, and frames with the digest
    /// of their pixels.
    pub written: Vec<(PathBuf, Option<String>)>,
    /// Whether there were changes that were not saved.
    pub unsaved: bool,
    /// Milliseconds of the drafts by stage (medians), `encode` being what it takes
    /// to turn a screen into bytes, and `total`.
    pub ms: Vec<(&'static str, f64)>,
    /// Bytes of a draft's screen: median and most.
    pub bytes: [usize; 2],
    /// Drafts that were drawn.
    pub drafts: usize,
    /// What was wrong last, if anything was.
    pub error: Option<String>,
}

/// Runs a script on a scene: the bake is made first where it is missing.
///
/// # Errors
/// A scene or script that cannot be read or understood, a bake that failed, a
/// picture that cannot be written.
pub fn run_script(
    settings: &PreviewSettings,
    script: &Path,
    run: &RunSettings,
) -> Result<ScriptReport, PreviewError> {
    let text = std::fs::read_to_string(script).map_err(|source| PreviewError::Script {
        path: script.to_owned(),
        source,
    })?;
    let events = parse(&text, &script.display().to_string())?;
    let loaded = load(&settings.scene, &settings.overrides);
    let file = SceneFile {
        path: settings.scene.clone(),
        overrides: settings.overrides.clone(),
        bytes: loaded.bytes,
    };
    let (program, effects) = Program::start(file, *loaded.scene?, loaded.at, (SIZE, None));
    let mut runner = Runner {
        settings,
        run,
        program,
        painter: None,
        preparer: Preparer::new(settings.preparation.clone()),
        wish: None,
        encoder: CellEncoder::new(Colours::True),
        frame: 0,
        is_over: false,
        times: BTreeMap::new(),
        bytes: Vec::new(),
        report: ScriptReport::default(),
    };
    runner.follow(effects)?;
    runner.play(&events)?;
    Ok(runner.report())
}

struct Runner<'a> {
    settings: &'a PreviewSettings,
    run: &'a RunSettings<'a>,
    program: Program,
    painter: Option<Painter>,
    preparer: Preparer,
    wish: Option<(u64, Wish)>,
    encoder: CellEncoder,
    frame: u64,
    is_over: bool,
    /// Milliseconds of every draft, by stage in the order of their names.
    times: BTreeMap<&'static str, Vec<f64>>,
    bytes: Vec<usize>,
    report: ScriptReport,
}

impl Runner<'_> {
    fn play(&mut self, events: &[Scripted]) -> Result<(), PreviewError> {
        let mut events = events.iter().peekable();
        while !self.is_over {
            while let Some(next) = events.next_if(|next| next.frame <= self.frame) {
                self.perform(&next.event)?;
                if self.is_over {
                    return Ok(());
                }
            }
            if events.peek().is_none() {
                break;
            }
            self.draw()?;
            self.frame += 1;
        }
        self.rest()
    }

    fn perform(&mut self, event: &ScriptEvent) -> Result<(), PreviewError> {
        match event {
            ScriptEvent::Input(input) => self.tell(Message::Input(*input)),
            ScriptEvent::Rest => self.rest(),
            ScriptEvent::Shot(path) => {
                write_shot(path, &self.program)?;
                self.report.written.push((path.clone(), None));
                Ok(())
            }
        }
    }

    fn tell(&mut self, message: Message) -> Result<(), PreviewError> {
        let now = FRAME * u32::try_from(self.frame).unwrap_or(u32::MAX);
        let effects = self.program.take(message, now);
        self.follow(effects)
    }

    /// Draws until the picture is as sharp as it gets.
    fn rest(&mut self) -> Result<(), PreviewError> {
        while self.draw()? {}
        Ok(())
    }

    /// Draws the next picture; says whether there was one.
    fn draw(&mut self) -> Result<bool, PreviewError> {
        let (Some(painter), Some((number, wish))) = (&mut self.painter, &self.wish) else {
            return Ok(false);
        };
        let start = Instant::now();
        let (number, drawn) = (*number, painter.next(wish, self.run));
        let draw_ms = start.elapsed().as_secs_f64() * 1e3;
        match drawn {
            Ok(None) => Ok(false),
            Ok(Some(drawn)) => {
                self.show(number, drawn, draw_ms)?;
                Ok(true)
            }
            Err(crate::relight::RenderError::Cancelled) => Err(PreviewError::Stopped),
            Err(error) => {
                painter.give_up(wish);
                self.tell(Message::NotDrawn(error.to_string()))?;
                Ok(false)
            }
        }
    }

    fn show(&mut self, number: u64, drawn: Drawn, draw_ms: f64) -> Result<(), PreviewError> {
        let sharpness = drawn.sharpness;
        if sharpness == Sharpness::Full {
            self.report.digest = Some(drawn.levels.digest());
            self.report.size = [drawn.levels.width(), drawn.levels.height()];
        }
        let stages = drawn.stages.clone();
        self.tell(Message::Drawn {
            number,
            drawn: Box::new(drawn),
        })?;
        let start = Instant::now();
        let cells = self.program.cells();
        let compose_ms = start.elapsed().as_secs_f64() * 1e3;
        let start = Instant::now();
        let bytes = self.encoder.encode(&cells).len();
        let encode_ms = start.elapsed().as_secs_f64() * 1e3;
        if matches!(sharpness, Sharpness::Draft(_)) {
            self.report.drafts += 1;
            self.bytes.push(bytes);
            let total = draw_ms + compose_ms + encode_ms;
            let more = [
                ("marks", compose_ms),
                ("encode", encode_ms),
                ("total", total),
            ];
            for &(stage, ms) in stages.times_ms().iter().chain(&more) {
                self.times.entry(stage).or_default().push(ms);
            }
        }
        Ok(())
    }

    fn follow(&mut self, effects: Vec<Effect>) -> Result<(), PreviewError> {
        for effect in effects {
            match effect {
                Effect::Show(number, wish) => self.wish = Some((number, *wish)),
                Effect::Send(errand) => self.send(errand)?,
                Effect::Prepare(wanted, scene) => self.prepare(wanted, *scene)?,
                Effect::Load(number) => {
                    let loaded = load(&self.settings.scene, self.program.overrides());
                    self.tell(Message::Loaded { number, loaded })?;
                }
                Effect::Redraw => self.encoder.forget(),
                Effect::Quit(_) => self.is_over = true,
                // No one else changes files, and there is no terminal.
                Effect::Watch(_) | Effect::Suspend | Effect::Resume | Effect::AskSize => {}
            }
        }
        Ok(())
    }

    fn prepare(&mut self, wanted: Wanted, scene: Scene) -> Result<(), PreviewError> {
        let settings = FrameSettings::of_scene(&scene);
        let mut renderer = self.preparer.renderer(scene);
        if wanted.bake || renderer.needs_bake(&settings) {
            renderer.bake(self.run)?;
        }
        self.tell(Message::Prepared {
            number: wanted.number,
            renderer: Box::new(renderer),
        })
    }

    fn send(&mut self, errand: Errand) -> Result<(), PreviewError> {
        match errand {
            Errand::Adopt(renderer) => {
                self.preparer.keep_bake_of(&renderer);
                self.painter = Some(Painter::new(*renderer));
            }
            Errand::Write { wish, size, path } => {
                let Some(painter) = &mut self.painter else {
                    return Ok(());
                };
                let written = write_frame(painter, &wish, size, &path, self.run);
                if let Ok(digest) = &written {
                    self.report
                        .written
                        .push((path.clone(), Some(digest.clone())));
                }
                self.tell(Message::Wrote { path, written })?;
            }
        }
        Ok(())
    }

    fn report(mut self) -> ScriptReport {
        let median = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        let times = std::mem::take(&mut self.times).into_iter();
        self.report.ms = times.map(|(stage, ms)| (stage, median(ms))).collect();
        self.bytes.sort_unstable();
        let most = self.bytes.last().copied().unwrap_or(0);
        let middle = self.bytes.get(self.bytes.len() / 2).copied().unwrap_or(0);
        ScriptReport {
            frames: self.frame,
            unsaved: self.program.is_unsaved(),
            bytes: [middle, most],
            error: self.program.status.error(),
            ..self.report
        }
    }
}
