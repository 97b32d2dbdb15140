//! Detection of changes of the model's file.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, SystemTime};
use std::{fs, io, thread};

use super::wake::Waker;

/// Time between two looks at the file.
const PERIOD: Duration = Duration::from_millis(200);

/// Thread that looks at a file, and wakes the window after it was changed. It ends when this is
/// dropped.
pub(super) struct FileWatch {
    path: PathBuf,
    is_changed: Arc<AtomicBool>,
    _end: mpsc::Sender<()>,
}

impl FileWatch {
    /// Starts to watch a file, from its present content.
    pub fn start(path: &Path, waker: Waker) -> io::Result<Self> {
        let (end, ended) = mpsc::channel::<()>();
        let is_changed = Arc::new(AtomicBool::new(false));
        let watch = Self { path: path.to_owned(), is_changed: is_changed.clone(), _end: end };
        let file = path.to_owned();
        let mut known = stamp(&file);
        let mut last = known;
        thread::Builder::new().name("file watch".to_owned()).spawn(move || {
            while ended.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                let present = stamp(&file);
                // A file that is being written changes between two looks, and may not exist in one.
                if present.is_some() && present != known && present == last {
                    known = present;
                    is_changed.store(true, Ordering::SeqCst);
                    waker.wake();
                }
                last = present;
            }
        })?;
        Ok(watch)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns `true` once after each change.
    pub fn take_change(&self) -> bool {
        self.is_changed.swap(false, Ordering::SeqCst)
    }
}

/// Returns the time of the last modification and the size of a file, or `None` if it does not
/// exist.
fn stamp(path: &Path) -> Option<(SystemTime, u64)> {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}
