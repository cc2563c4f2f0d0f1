//! Where the time of a frame goes.

use std::time::Instant;

/// Milliseconds by stage, in the order in which the stages ran.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stages {
    times: Vec<(&'static str, f64)>,
}

impl Stages {
    /// Runs a stage and adds its time.
    pub fn time<T>(&mut self, stage: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        let time_ms = start.elapsed().as_secs_f64() * 1e3;
        match self.times.iter_mut().find(|(name, _)| *name == stage) {
            Some((_, total)) => *total += time_ms,
            None => self.times.push((stage, time_ms)),
        }
        result
    }

    /// (stage, milliseconds) in order.
    pub fn times_ms(&self) -> &[(&'static str, f64)] {
        &self.times
    }

    /// Sum of all stages, milliseconds.
    pub fn total_ms(&self) -> f64 {
        self.times.iter().map(|(_, ms)| ms).sum()
    }
}
