//! Detection of changes of the model's file, and of the files that it includes or names.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, SystemTime};
use std::{fs, io, thread};

use super::wake::Waker;
use crate::model::Model;

/// Time between two looks at the file.
const PERIOD: Duration = Duration::from_millis(200);
/// Maximum number of files.
const MOST_FILES: usize = 1000;

/// Thread that looks at a model's files, and wakes the window after one was changed. It ends when
/// this is dropped.
pub(super) struct FileWatch {
    path: PathBuf,
    is_changed: Arc<AtomicBool>,
    _end: mpsc::Sender<()>,
}

impl FileWatch {
    /// Starts to watch the files of a model, from their present contents.
    pub fn start(path: &Path, waker: Waker) -> io::Result<Self> {
        let (end, ended) = mpsc::channel::<()>();
        let is_changed = Arc::new(AtomicBool::new(false));
        let watch = Self { path: path.to_owned(), is_changed: is_changed.clone(), _end: end };
        let (file, first) = (path.to_owned(), stamp(path));
        thread::Builder::new().name("file watch".to_owned()).spawn(move || {
            let mut others = Model::files_of_xml(&file);
            let mut known = stamps(&file, &others);
            known[0] = first;
            let mut last = known.clone();
            while ended.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                let present = stamps(&file, &others);
                // A file that is being written changes between two looks, and may not exist in one.
                if present[0].is_some() && present != known && present == last {
                    // After an error, the text names only a part of its files.
                    others.extend(Model::files_of_xml(&file));
                    known = stamps(&file, &others);
                    last.clone_from(&known);
                    is_changed.store(true, Ordering::SeqCst);
                    waker.wake();
                } else {
                    last = present;
                }
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

/// Returns the stamps of a model's file and of others.
fn stamps(file: &Path, others: &BTreeSet<PathBuf>) -> Vec<Option<(SystemTime, u64)>> {
    std::iter::once(stamp(file)).chain(others.iter().take(MOST_FILES).map(|other| stamp(other))).collect()
}

/// Returns the time of the last modification and the size of a file, or `None` if it does not
/// exist.
fn stamp(path: &Path) -> Option<(SystemTime, u64)> {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}
