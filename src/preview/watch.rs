//! Tells when one of a scene's files was changed by someone else.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, SystemTime};

use super::message::Message;

/// Time between two looks at the files. A look asks the system for dates alone:
/// it takes microseconds.
const LOOK_EVERY: Duration = Duration::from_millis(400);

/// How much older a file's date may be than the moment of writing: systems take it
/// from a clock that ticks a hundred times a second.
const GRAIN: Duration = Duration::from_millis(20);

/// When files are known that were written by the program a moment ago.
pub(crate) fn just_written() -> SystemTime {
    SystemTime::now() + GRAIN
}

/// What tells one state of a file from another; `None`: it is not there.
type State = Option<(SystemTime, u64)>;

/// A thread that looks at files until this is dropped.
pub(crate) struct Watch {
    files: Sender<Watched>,
}

/// Files, and when they were known to be as the program has them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Watched {
    pub(crate) files: Vec<PathBuf>,
    /// What was written later is a change already: reading may take seconds.
    pub(crate) known_at: SystemTime,
}

impl Watched {
    /// The files' states, and whether one was written since they were known. (A
    /// date in the future is another machine's clock.)
    fn states(&self) -> (Vec<State>, bool) {
        let (states, now) = (states(&self.files), SystemTime::now());
        let is_later =
            |(written, _): &(SystemTime, u64)| *written + GRAIN > self.known_at && *written <= now;
        let is_changed = states.iter().flatten().any(is_later);
        (states, is_changed)
    }
}

impl Watch {
    /// Begins to look at files, and sends [`Message::FilesChanged`] when some of
    /// them are in another state than before, and stay in it for one more look:
    /// programs write in steps.
    pub(crate) fn start(watched: Watched, queue: Sender<Message>) -> Self {
        let (sender, receiver) = channel();
        let thread = std::thread::Builder::new().name("watch".to_owned());
        // Without the thread nothing is reloaded, and all else works.
        let _ = thread.spawn(move || look(&watched, &receiver, &queue));
        Self { files: sender }
    }

    /// Looks at these files from now on.
    pub(crate) fn look_at(&self, watched: Watched) {
        // The thread ends only with this.
        let _ = self.files.send(watched);
    }
}

fn look(watched: &Watched, orders: &Receiver<Watched>, queue: &Sender<Message>) {
    let mut files = watched.files.clone();
    let (mut last, mut is_changed) = watched.states();
    let mut known = last.clone();
    loop {
        match orders.recv_timeout(LOOK_EVERY) {
            Ok(others) => {
                (last, is_changed) = others.states();
                known.clone_from(&last);
                files = others.files;
                continue;
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        let now = states(&files);
        if (now != known || is_changed) && now == last {
            known.clone_from(&now);
            is_changed = false;
            if queue.send(Message::FilesChanged).is_err() {
                return;
            }
        }
        last = now;
    }
}

fn states(files: &[PathBuf]) -> Vec<State> {
    files.iter().map(|file| state(file)).collect()
}

fn state(file: &Path) -> State {
    let metadata = std::fs::metadata(file).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_told_once_and_a_file_that_vanishes_is_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, "a").unwrap();
        std::thread::sleep(2 * GRAIN);
        let (sender, receiver) = channel();
        let now = || Watched {
            files: vec![path.clone()],
            known_at: SystemTime::now(),
        };
        let watch = Watch::start(now(), sender);
        let is_told = || receiver.recv_timeout(Duration::from_secs(5)).is_ok();
        let is_quiet = || receiver.recv_timeout(3 * LOOK_EVERY).is_err();
        assert!(is_quiet(), "nothing has changed");
        std::fs::write(&path, "ab").unwrap();
        assert!(is_told() && is_quiet(), "once");
        std::fs::remove_file(&path).unwrap();
        assert!(is_told(), "it is gone");
        watch.look_at(now());
        std::fs::write(&path, "abc").unwrap();
        assert!(is_told(), "it is back");
        let before = SystemTime::now();
        std::thread::sleep(Duration::from_millis(50));
        std::fs::write(&path, "abcd").unwrap();
        watch.look_at(Watched {
            known_at: before,
            ..now()
        });
        assert!(is_told() && is_quiet(), "it was written while it was read");
    }
}
