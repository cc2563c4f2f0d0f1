//! Tells when one of a scene's files was changed by someone else.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, SystemTime};

use super::message::Message;

/// Time between two looks at the files. A look asks the system for dates alone:
/// it takes microseconds.
const LOOK_EVERY: Duration = Duration::from_millis(400);

/// What tells one state of a file from another; `None`: it is not there.
type State = Option<(SystemTime, u64)>;

/// A thread that looks at files until this is dropped.
pub(crate) struct Watch {
    files: Sender<Vec<PathBuf>>,
}

impl Watch {
    /// Begins to look at files, and sends [`Message::FilesChanged`] when some of
    /// them are in another state than before, and stay in it for one more look:
    /// programs write in steps.
    pub(crate) fn start(files: Vec<PathBuf>, queue: Sender<Message>) -> Self {
        let (sender, receiver) = channel();
        let thread = std::thread::Builder::new().name("watch".to_owned());
        // Without the thread nothing is reloaded, and all else works.
        let _ = thread.spawn(move || look(files, &receiver, &queue));
        Self { files: sender }
    }

    /// Looks at these files from now on, as they are now.
    pub(crate) fn look_at(&self, files: Vec<PathBuf>) {
        // The thread ends only with this.
        let _ = self.files.send(files);
    }
}

fn look(mut files: Vec<PathBuf>, orders: &Receiver<Vec<PathBuf>>, queue: &Sender<Message>) {
    let mut known = states(&files);
    let mut last = known.clone();
    loop {
        match orders.recv_timeout(LOOK_EVERY) {
            Ok(others) => {
                files = others;
                known = states(&files);
                last.clone_from(&known);
                continue;
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        let now = states(&files);
        if now != known && now == last {
            known.clone_from(&now);
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
        let (sender, receiver) = channel();
        let watch = Watch::start(vec![path.clone()], sender);
        let is_told = || receiver.recv_timeout(Duration::from_secs(5)).is_ok();
        let is_quiet = || receiver.recv_timeout(3 * LOOK_EVERY).is_err();
        assert!(is_quiet(), "nothing has changed");
        std::fs::write(&path, "ab").unwrap();
        assert!(is_told() && is_quiet(), "once");
        std::fs::remove_file(&path).unwrap();
        assert!(is_told(), "it is gone");
        watch.look_at(vec![path.clone()]);
        std::fs::write(&path, "abc").unwrap();
        assert!(is_told(), "it is back");
    }
}
