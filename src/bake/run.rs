//! How a job is run: settings that must not change a bit of its result.

use super::BakeError;
use crate::simd::Level;

/// Hears of a job's progress and may stop it.
pub trait Progress: Sync {
    /// A stage of `total` steps begins.
    fn stage(&self, name: &'static str, total: u64);
    /// So many more steps of the stage are done. Called from any thread.
    fn advance(&self, steps: u64);
    /// Whether the job should stop; asked often, from any thread.
    fn cancelled(&self) -> bool;
}

/// Progress that nobody watches and nobody stops.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn stage(&self, _name: &'static str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn cancelled(&self) -> bool {
        false
    }
}

/// Progress of a job within a job: all of its stages bear one name, one after the other.
pub(super) struct OneName<'a> {
    pub(super) name: &'static str,
    pub(super) progress: &'a dyn Progress,
}

impl Progress for OneName<'_> {
    fn stage(&self, _name: &'static str, total: u64) {
        self.progress.stage(self.name, total);
    }

    fn advance(&self, steps: u64) {
        self.progress.advance(steps);
    }

    fn cancelled(&self) -> bool {
        self.progress.cancelled()
    }
}

/// How to run a job: none of this changes a bit of what it computes.
/// The number of threads is that of the rayon pool it is called in.
#[derive(Clone, Copy)]
pub struct RunSettings<'a> {
    /// Widest instructions to use.
    pub level: Level,
    /// Who watches.
    pub progress: &'a dyn Progress,
}

impl RunSettings<'_> {
    /// Goes on, unless somebody stops the job.
    pub(super) fn proceed(&self) -> Result<(), BakeError> {
        match self.progress.cancelled() {
            true => Err(BakeError::Cancelled),
            false => Ok(()),
        }
    }
}

impl RunSettings<'static> {
    /// The widest instructions, and nobody watches.
    pub fn silent() -> Self {
        Self {
            level: Level::detect(),
            progress: &Silent,
        }
    }
}

/// A pool of so many threads (0: one a processor) in which jobs can be run;
/// the number changes no bit of any result.
///
/// # Errors
/// If the system cannot start so many threads.
pub fn thread_pool(threads: usize) -> Result<ThreadPool, ThreadPoolError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map(ThreadPool)
        .map_err(|error| ThreadPoolError(error.to_string()))
}

/// Threads that jobs can be run on.
pub struct ThreadPool(rayon::ThreadPool);

impl ThreadPool {
    /// Runs a job on the pool's threads.
    pub fn install<T: Send>(&self, job: impl FnOnce() -> T + Send) -> T {
        self.0.install(job)
    }
}

/// The system cannot start the threads.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ThreadPoolError(String);
