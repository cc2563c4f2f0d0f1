//! The thread that draws, so that no input ever waits for a picture.
//!
//! Of wishes only the newest counts: one that was not begun is dropped, and a
//! full frame of an old one is stopped. Errands are done in their order.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::message::Message;
use super::painter::{Painter, Sharpness, Wish};
use super::prepare::Preparation;
use super::write_frame::write_frame;
use crate::bake::{Progress, RunSettings, thread_pool};
use crate::relight::{RenderError, Renderer};
use crate::simd::Level;

/// How long nothing must change before a full frame is begun: longer than the
/// time between two events of a drag, shorter than one notices.
const RESTS_AFTER: Duration = Duration::from_millis(70);
/// Number of the wish that ends the thread.
const END: u64 = u64::MAX;

/// Something to be done besides the picture.
pub(crate) enum Errand {
    /// Draws with another renderer from now on.
    Adopt(Box<Renderer>),
    /// Writes a frame of a wish at a size.
    Write {
        wish: Box<Wish>,
        size: [u32; 2],
        path: PathBuf,
    },
}

/// The drawing thread.
pub(crate) struct Worker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    orders: Mutex<Orders>,
    wake: Condvar,
    /// Number of the newest wish.
    newest: AtomicU64,
}

#[derive(Default)]
struct Orders {
    wish: Option<(u64, Wish)>,
    errands: VecDeque<Errand>,
}

impl Worker {
    /// Starts it; two drafts are at least `pace` apart.
    pub(crate) fn start(
        preparation: &Preparation,
        pace: Duration,
        queue: Sender<Message>,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            orders: Mutex::default(),
            wake: Condvar::new(),
            newest: AtomicU64::new(0),
        });
        let pool = thread_pool(preparation.threads).map_err(std::io::Error::other)?;
        let drawing = Drawing {
            shared: shared.clone(),
            queue,
            level: preparation.level,
            painter: None,
            pace,
            last_draft: None,
        };
        let thread = std::thread::Builder::new().name("draw".to_owned());
        Ok(Self {
            shared,
            thread: Some(thread.spawn(move || pool.install(|| drawing.run()))?),
        })
    }

    /// Asks for pictures of a wish, and for none of those before it.
    pub(crate) fn show(&self, number: u64, wish: Wish) {
        self.shared.newest.store(number, Ordering::Relaxed);
        self.shared.lock().wish = Some((number, wish));
        self.shared.wake.notify_one();
    }

    pub(crate) fn send(&self, errand: Errand) {
        self.shared.lock().errands.push_back(errand);
        self.shared.wake.notify_one();
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        {
            // Not between the thread's last look and its sleep.
            let _orders = self.shared.lock();
            self.shared.newest.store(END, Ordering::Relaxed);
        }
        self.shared.wake.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic there has been told by the hook.
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Orders> {
        self.orders.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn ended(&self) -> bool {
        self.newest.load(Ordering::Relaxed) == END
    }
}

struct Drawing {
    shared: Arc<Shared>,
    queue: Sender<Message>,
    level: Level,
    painter: Option<Painter>,
    pace: Duration,
    last_draft: Option<Instant>,
}

/// Stops a job whose wish is no longer the newest; a draft goes on, so that there
/// is a picture however quickly wishes follow one another.
struct Superseded<'a> {
    shared: &'a Shared,
    number: u64,
    is_draft: bool,
}

impl Progress for Superseded<'_> {
    fn stage(&self, _name: &'static str, _total: u64) {}

    fn advance(&self, _steps: u64) {}

    fn cancelled(&self) -> bool {
        let newest = self.shared.newest.load(Ordering::Relaxed);
        newest == END || (!self.is_draft && newest != self.number)
    }
}

impl Drawing {
    fn run(mut self) {
        let mut current = None;
        while !self.shared.ended() {
            if let Some(errand) = self.next(&mut current) {
                self.perform(errand);
            } else if let Some((number, wish)) = &current {
                self.draw(*number, wish);
            }
        }
    }

    /// Waits until there is something to do: an errand, or a picture of the wish
    /// that is current then.
    fn next(&self, current: &mut Option<(u64, Wish)>) -> Option<Errand> {
        let mut orders = self.shared.lock();
        loop {
            if self.shared.ended() {
                return None;
            }
            if let Some(errand) = orders.errands.pop_front() {
                return Some(errand);
            }
            if orders.wish.is_some() {
                *current = orders.wish.take();
            }
            let step = current.as_ref().and_then(|(_, wish)| self.step(wish));
            match step {
                Some(Sharpness::Draft(_)) => {
                    let since = self.last_draft.map(|last| last.elapsed());
                    let left = since.and_then(|since| self.pace.checked_sub(since));
                    let left = left.filter(|left| !left.is_zero())?;
                    let waited = self.shared.wake.wait_timeout(orders, left);
                    orders = waited.unwrap_or_else(PoisonError::into_inner).0;
                }
                // Sharper pictures are begun once nothing changes.
                Some(_) => {
                    let waited = self.shared.wake.wait_timeout(orders, RESTS_AFTER);
                    let (again, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
                    orders = again;
                    let is_quiet = orders.wish.is_none() && orders.errands.is_empty();
                    if timeout.timed_out() && is_quiet {
                        return None;
                    }
                }
                None => {
                    let woken = self.shared.wake.wait(orders);
                    orders = woken.unwrap_or_else(PoisonError::into_inner);
                }
            }
        }
    }

    fn step(&self, wish: &Wish) -> Option<Sharpness> {
        self.painter.as_ref()?.next_step(wish)
    }

    fn draw(&mut self, number: u64, wish: &Wish) {
        let Some(painter) = &mut self.painter else {
            return;
        };
        let is_draft = matches!(painter.next_step(wish), Some(Sharpness::Draft(_)));
        if is_draft {
            self.last_draft = Some(Instant::now());
        }
        let progress = Superseded {
            shared: &self.shared,
            number,
            is_draft,
        };
        let run = RunSettings {
            level: self.level,
            progress: &progress,
        };
        let message = match painter.next(wish, &run) {
            Ok(Some(drawn)) => Message::Drawn {
                number,
                drawn: Box::new(drawn),
            },
            Err(RenderError::Cancelled) => return,
            // A wish for a scene that is still on its way.
            Ok(None) => return painter.give_up(wish),
            Err(error) => {
                painter.give_up(wish);
                Message::NotDrawn(error.to_string())
            }
        };
        // Nobody listens once the session has ended.
        let _ = self.queue.send(message);
    }

    fn perform(&mut self, errand: Errand) {
        match errand {
            Errand::Adopt(renderer) => self.painter = Some(Painter::new(*renderer)),
            Errand::Write { wish, size, path } => {
                let Some(painter) = &mut self.painter else {
                    return;
                };
                let progress = Superseded {
                    shared: &self.shared,
                    number: 0,
                    is_draft: true,
                };
                let run = RunSettings {
                    level: self.level,
                    progress: &progress,
                };
                let written = write_frame(painter, &wish, size, &path, &run);
                let _ = self.queue.send(Message::Wrote { path, written });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};

    use super::*;
    use crate::bake::Scheme;
    use crate::relight::FrameSettings;
    use crate::scene::sample_scenes::{point_light, room_with_blocks};
    use crate::scene::{Scene, Tone};
    use glam::DVec3;

    fn room() -> Scene {
        let mut scene = room_with_blocks(false, 0.5, 64);
        scene.lights = vec![point_light(DVec3::new(0.2, 0.7, 0.5), 2.0)];
        scene.render.bounces = crate::scene::Bounces::Count(0);
        scene
    }

    fn wish(scene: &Scene, width: u32) -> Wish {
        let mut frame = FrameSettings::of_scene(scene);
        frame.camera.size = [width, 20];
        Wish {
            lights: scene.lights.clone(),
            materials: scene.materials.clone(),
            frame,
            exposure: 0.0,
            tone: Tone::Srgb,
            fine_size: None,
        }
    }

    fn preparation() -> Preparation {
        Preparation {
            cache_folder: None,
            scheme: Scheme::Relume,
            threads: 1,
            level: Level::detect(),
        }
    }

    /// Numbers and sharpness of the pictures until the worker rests.
    fn pictures(messages: &Receiver<Message>) -> Vec<(u64, Sharpness)> {
        let patience = 20 * RESTS_AFTER;
        let mut seen = Vec::new();
        while let Ok(message) = messages.recv_timeout(patience) {
            if let Message::Drawn { number, drawn } = message {
                seen.push((number, drawn.sharpness));
            }
        }
        seen
    }

    #[test]
    fn the_newest_wish_is_drawn_to_the_end_and_then_nothing() {
        let scene = room();
        let (queue, messages) = channel();
        let worker = Worker::start(&preparation(), Duration::ZERO, queue).unwrap();
        // A wish may come before there is anything to draw it with.
        worker.show(1, wish(&scene, 30));
        worker.send(Errand::Adopt(Box::new(Renderer::new(scene.clone(), None))));
        for number in 2..=40 {
            worker.show(number, wish(&scene, 30 + (number % 7) as u32));
        }
        let seen = pictures(&messages);
        let last: Vec<_> = seen.iter().filter(|(number, _)| *number == 40).collect();
        assert_eq!(last.last(), Some(&&(40, Sharpness::Full)), "{seen:?}");
        let full = seen
            .iter()
            .filter(|(_, sharpness)| *sharpness == Sharpness::Full);
        assert_eq!(full.count(), 1, "nobody waits for the others: {seen:?}");
        assert!(pictures(&messages).is_empty(), "at rest");
    }

    #[test]
    fn a_wish_for_another_scene_draws_nothing_and_does_not_spin() {
        let scene = room();
        let (queue, messages) = channel();
        let worker = Worker::start(&preparation(), Duration::ZERO, queue).unwrap();
        worker.send(Errand::Adopt(Box::new(Renderer::new(scene.clone(), None))));
        let mut other = wish(&scene, 30);
        other.materials.push(other.materials[0].clone());
        worker.show(1, other);
        assert!(pictures(&messages).is_empty());
        worker.show(2, wish(&scene, 30));
        assert!(!pictures(&messages).is_empty());
        let end = Instant::now();
        drop(worker);
        assert!(end.elapsed() < Duration::from_secs(5), "it ends at once");
    }
}
