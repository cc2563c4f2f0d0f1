//! What a bake tells of its progress, and that it can be stopped.

use std::sync::Mutex;

use super::{BakeError, BakeSettings, Progress, RunSettings, Scheme, bake, thread_pool};
use crate::scene::sample_scenes::room_with_blocks;
use crate::surface::{Detail, Surface};

/// Stages of one short step, in the middle of which nobody asks.
const SHORT: [&str; 2] = ["back sides", "energy"];

/// What was heard of a stage.
#[derive(Debug, Clone, Copy)]
struct Stage {
    name: &'static str,
    total: u64,
    done: u64,
}

/// Where somebody stops a bake.
#[derive(Debug, Clone, Copy)]
struct Stop {
    stage: usize,
    /// Steps of that stage that are done.
    done: u64,
}

struct Listener {
    stages: Mutex<Vec<Stage>>,
    stop: Option<Stop>,
}

impl Progress for Listener {
    fn stage(&self, name: &'static str, total: u64) {
        let stage = Stage {
            name,
            total,
            done: 0,
        };
        self.stages.lock().unwrap().push(stage);
    }

    fn advance(&self, steps: u64) {
        if let Some(stage) = self.stages.lock().unwrap().last_mut() {
            stage.done += steps;
        }
    }

    fn cancelled(&self) -> bool {
        let stages = self.stages.lock().unwrap();
        self.stop.is_some_and(|stop| {
            let there = stages.get(stop.stage);
            there.is_some_and(|stage| stage.done >= stop.done)
        })
    }
}

/// The stages of a bake with a search for an error, which has one trial, and why it
/// ended early.
fn listened_to(stop: Option<Stop>) -> (Vec<Stage>, Option<BakeError>) {
    // Open, so that there are skies.
    let mut scene = room_with_blocks(false, 0.4, 16);
    scene.bake.error = Some(0.5);
    (scene.bake.functions, scene.bake.coefficients) = (Some(64), Some(32));
    let settings = BakeSettings::of_scheme(Scheme::Relume, &scene.bake);
    let mut surface = Surface::fronts(&scene, &Detail::of_keys(&scene.bake));
    let listener = Listener {
        stages: Mutex::default(),
        stop,
    };
    let run = RunSettings {
        progress: &listener,
        ..RunSettings::silent()
    };
    // Of few threads, so that in the middle of a stage there is work that nobody has begun.
    let threads = thread_pool(2).expect("two threads can be started");
    let error = threads.install(|| bake(&mut surface, &settings, &run).err());
    (listener.stages.into_inner().unwrap(), error)
}

/// The same of a bake that nobody stops.
fn all_stages() -> Vec<Stage> {
    let (stages, error) = listened_to(None);
    assert!(error.is_none(), "{error:?}");
    let names: Vec<&str> = stages.iter().map(|stage| stage.name).collect();
    let basis = ["spectral basis", "prior lights"];
    let lights = ["test lights", "test skies"];
    let trial = ["error budget", "trial 1", "trial 1"];
    let [first, second] = SHORT;
    let all = [
        &[first],
        &basis[..],
        &lights,
        &trial,
        &basis,
        &["transfer", second],
        &lights,
        &["error"],
    ]
    .concat();
    assert_eq!(names, all);
    stages
}

#[test]
fn the_steps_of_every_stage_add_up() {
    for stage in all_stages() {
        assert!(stage.total > 0, "{stage:?}");
        if !SHORT.contains(&stage.name) {
            assert_eq!(stage.done, stage.total, "{stage:?}");
        }
    }
}

#[test]
fn a_bake_can_be_stopped_in_the_middle_of_every_stage() {
    for (number, stage) in all_stages().iter().enumerate() {
        if SHORT.contains(&stage.name) {
            continue;
        }
        for done in [0, 3 * stage.total / 4] {
            let stop = Stop {
                stage: number,
                done,
            };
            let (heard, error) = listened_to(Some(stop));
            let what = format!("{stop:?} in {stage:?}");
            assert!(matches!(error, Some(BakeError::Cancelled)), "{what}");
            assert_eq!(heard.len(), number + 1, "{what}");
        }
    }
}
