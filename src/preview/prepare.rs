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
use crate::relight::{FrameSettings, Renderer};
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
        preparation: Preparation,
        queue: Sender<Message>,
    ) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let job = Job {
            progress: BakeProgress::new(wanted.number, queue.clone(), stop.clone()),
            wanted,
            preparation,
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
    preparation: Preparation,
    queue: Sender<Message>,
    progress: BakeProgress,
}

impl Job {
    fn run(self, scene: Scene) {
        match thread_pool(self.preparation.threads) {
            Ok(pool) => pool.install(|| self.prepare(scene)),
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Sends a renderer with its bake, or one without while the bake is made.
    fn prepare(&self, scene: Scene) {
        let mut first = self.renderer(scene.clone());
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
                self.renderer(scene)
            }
        };
        let run = RunSettings {
            level: self.preparation.level,
            progress: &self.progress,
        };
        match baked.bake(&run) {
            _ if self.stopped() => {}
            Ok(()) => self.send(baked),
            Err(error) => self.fail(error.to_string()),
        }
    }

    fn renderer(&self, scene: Scene) -> Renderer {
        let folder = self.preparation.cache_folder.as_deref();
        Renderer::with_scheme(scene, folder, self.preparation.scheme)
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
