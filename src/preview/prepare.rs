//! Makes a scene ready to be drawn, beside whatever is on the screen: surface
//! first, then the bake, from the cache or anew.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::message::Message;
use crate::bake::{Progress, RunSettings, Scheme, thread_pool};
use crate::relight::{BakeAtHand, FrameSettings, Renderer};
use crate::scene::Scene;
use crate::simd::Level;

/// Time between two reports of progress.
const REPORT_EVERY: Duration = Duration::from_millis(200);

/// How scenes are made ready, the same for all of a session.
#[derive(Debug, Clone)]
pub struct Preparation {
    /// Folder for bakes; `None`: no cache.
    pub cache_folder: Option<PathBuf>,
    /// How bakes are made.
    pub scheme: Scheme,
    /// Threads of each job; 0: one a processor.
    pub threads: usize,
    /// Widest instructions to use.
    pub level: Level,
}

/// A preparation with the last bake of the session: another albedo costs a folding
/// of it, at most.
#[derive(Clone)]
pub(super) struct Preparer {
    preparation: Preparation,
    at_hand: Option<BakeAtHand>,
}

impl Preparer {
    pub(super) fn new(preparation: Preparation) -> Self {
        Self {
            preparation,
            at_hand: None,
        }
    }

    /// A renderer of a scene, with the bake at hand if it is the scene's.
    pub(super) fn renderer(&self, scene: Scene) -> Renderer {
        let folder = self.preparation.cache_folder.as_deref();
        let mut renderer = Renderer::with_scheme(scene, folder, self.preparation.scheme);
        if let Some(at_hand) = &self.at_hand {
            renderer.take_bake(at_hand);
        }
        renderer
    }

    /// Keeps the bake of a renderer at hand, if it has one.
    pub(super) fn keep_bake_of(&mut self, renderer: &Renderer) {
        self.at_hand = renderer.bake_at_hand().or(self.at_hand.take());
    }
}

/// What is wanted of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Wanted {
    /// What is sent bears it.
    pub(crate) number: u64,
    /// A bake, also where the scene file asks for nothing that needs one: the
    /// scene is shown already, and what it shows now needs it.
    pub(crate) bake: bool,
}

/// A scene on its way.
pub(crate) struct Preparing {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Preparing {
    /// Begins in a thread of its own.
    pub(crate) fn start(
        wanted: Wanted,
        scene: Scene,
        preparer: Preparer,
        queue: Sender<Message>,
    ) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let job = Job {
            progress: BakeProgress::new(wanted.number, queue.clone(), stop.clone()),
            wanted,
            preparer,
            queue: queue.clone(),
        };
        let thread = std::thread::Builder::new().name("prepare".to_owned());
        let thread = thread.spawn(move || job.run(scene)).map_err(|error| {
            let _ = queue.send(Message::NotPrepared {
                number: wanted.number,
                error: format!("cannot start a thread: {error}"),
            });
        });
        Self {
            stop,
            thread: thread.ok(),
        }
    }

    /// Ends it as soon as it can; waits if told to.
    pub(crate) fn stop(&mut self, wait: bool) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take().filter(|_| wait) {
            // A panic there has been told by the hook.
            let _ = thread.join();
        }
    }
}

impl Drop for Preparing {
    fn drop(&mut self) {
        self.stop(false);
    }
}

struct Job {
    wanted: Wanted,
    preparer: Preparer,
    queue: Sender<Message>,
    progress: BakeProgress,
}

impl Job {
    fn run(self, scene: Scene) {
        match thread_pool(self.preparer.preparation.threads) {
            Ok(pool) => pool.install(|| self.prepare(scene)),
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Sends a renderer with its bake, or one without while the bake is made.
    fn prepare(&self, scene: Scene) {
        let mut first = self.preparer.renderer(scene.clone());
        if self.stopped() {
            return;
        }
        let settings = FrameSettings::of_scene(&scene);
        let is_ready = first.load_bake() || !(self.wanted.bake || first.needs_bake(&settings));
        if is_ready {
            return self.send(first);
        }
        // The lights may change while the bake is made, so the scene is shown
        // meanwhile without it.
        let mut baked = match self.wanted.bake {
            true => first,
            false => {
                self.send(first);
                self.preparer.renderer(scene)
            }
        };
        let run = RunSettings {
            level: self.preparer.preparation.level,
            progress: &self.progress,
        };
        match baked.bake(&run) {
            _ if self.stopped() => {}
            Ok(()) => self.send(baked),
            Err(error) => self.fail(error.to_string()),
        }
    }

    fn stopped(&self) -> bool {
        self.progress.cancelled()
    }

    fn send(&self, renderer: Renderer) {
        // Nobody listens once the session has ended.
        let _ = self.queue.send(Message::Prepared {
            number: self.wanted.number,
            renderer: Box::new(renderer),
        });
    }

    fn fail(&self, error: String) {
        let _ = self.queue.send(Message::NotPrepared {
            number: self.wanted.number,
            error,
        });
    }
}

/// Progress as messages.
struct BakeProgress {
    number: u64,
    queue: Mutex<Sender<Message>>,
    stop: Arc<AtomicBool>,
    stage: Mutex<(&'static str, u64, Instant)>,
    done: AtomicU64,
}

impl BakeProgress {
    fn new(number: u64, queue: Sender<Message>, stop: Arc<AtomicBool>) -> Self {
        Self {
            number,
            queue: Mutex::new(queue),
            stop,
            stage: Mutex::new(("", 0, Instant::now())),
            done: AtomicU64::new(0),
        }
    }

    fn report(&self, stage: &'static str, share: f64) {
        let queue = self.queue.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = queue.send(Message::Baking {
            number: self.number,
            stage,
            share,
        });
    }
}

impl Progress for BakeProgress {
    fn stage(&self, name: &'static str, total: u64) {
        self.done.store(0, Ordering::Relaxed);
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = (name, total, Instant::now());
        self.report(name, 0.0);
    }

    fn advance(&self, steps: u64) {
        let done = self.done.fetch_add(steps, Ordering::Relaxed) + steps;
        let Ok(mut stage) = self.stage.try_lock() else {
            return;
        };
        let (name, total, last) = *stage;
        if last.elapsed() >= REPORT_EVERY {
            stage.2 = Instant::now();
            drop(stage);
            self.report(name, done as f64 / total.max(1) as f64);
        }
    }

    fn cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use glam::{DVec3, Vec3};

    use super::*;
    use crate::scene::Bounces;
    use crate::scene::sample_scenes::{point_light, room_with_blocks};

    /// Prepares a scene with its bake, and the stages of doing so.
    fn prepared(scene: &Scene, last: Option<&Renderer>) -> (Renderer, Vec<&'static str>) {
        let mut preparer = Preparer::new(Preparation {
            cache_folder: None,
            scheme: Scheme::Relume,
            threads: 1,
            level: Level::detect(),
        });
        if let Some(last) = last {
            preparer.keep_bake_of(last);
        }
        let wanted = Wanted {
            number: 1,
            bake: true,
        };
        let (queue, messages) = channel();
        let _preparing = Preparing::start(wanted, scene.clone(), preparer, queue);
        let mut stages = Vec::new();
        loop {
            match messages.recv().expect("it ends with a renderer") {
                Message::Baking { stage, .. } => stages.push(stage),
                Message::Prepared { renderer, .. } => return (*renderer, stages),
                _ => panic!("nothing else is sent"),
            }
        }
    }

    #[test]
    fn another_fixed_albedo_is_folded_and_nothing_is_baked() {
        let mut scene = room_with_blocks(false, 0.5, 64);
        scene.lights = vec![point_light(DVec3::new(0.2, 0.7, 0.5), 2.0)];
        scene.render.bounces = Bounces::All;
        scene.bake.fixed_albedo = true;
        scene.camera.size = [24, 16];
        let (first, stages) = prepared(&scene, None);
        assert!(stages.contains(&"transfer") && stages.contains(&"folding bounces"));
        scene.materials[0].albedo = Vec3::new(0.2, 0.3, 0.4);
        let (mut edited, mut stages) = prepared(&scene, Some(&first));
        stages.dedup();
        assert_eq!(
            stages,
            [
                "prior lights",
                "folding bounces",
                "test lights",
                "test skies",
                "error of folding"
            ]
        );
        let (settings, run) = (FrameSettings::of_scene(&scene), RunSettings::silent());
        assert!(!edited.needs_bake(&settings));
        let found = edited.frame(&settings, &run).unwrap().image;
        let fresh = Renderer::new(scene.clone(), None).frame(&settings, &run);
        assert!(found == fresh.unwrap().image, "it is another picture");
        // Of another surface it is no bake.
        scene.bake.max_edge = Some(0.4);
        let (_, stages) = prepared(&scene, Some(&edited));
        assert!(stages.contains(&"transfer"), "{stages:?}");
    }
}
