//! Loading of model files on a background thread, so that the window stays responsive and shows the
//! previous model.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, TryRecvError};
use std::{io, thread};

use super::wake::Waker;
use crate::error::Result;
use crate::model::Model;
use crate::viewer::link::Kept;

/// Model file that is being loaded.
pub(super) struct ModelLoader {
    path: PathBuf,
    kept: Kept,
    result: mpsc::Receiver<Result<Model>>,
}

impl ModelLoader {
    /// Starts to load a file in the format of its extension. Wakes the window at the end.
    pub fn start(path: &Path, kept: Kept, waker: Waker) -> io::Result<Self> {
        let (sender, result) = mpsc::channel();
        let file = path.to_owned();
        thread::Builder::new().name("model loader".to_owned()).spawn(move || {
            #[cfg(feature = "_test-hooks")]
            crate::viewer::test_hooks::wait_while_loading_is_held();
            let is_binary = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mjb"));
            let model = if is_binary { Model::from_binary_path(&file) } else { Model::from_xml_path(&file) };
            // Fails if the window was closed or loads another file in the meantime.
            let _ = sender.send(model);
            waker.wake();
        })?;
        Ok(Self { path: path.to_owned(), kept, result })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns what remains when the model is replaced.
    pub fn kept(&self) -> Kept {
        self.kept
    }

    /// Returns the result once it is available.
    pub fn take_result(&self) -> Option<Result<Model>> {
        match self.result.try_recv() {
            Ok(model) => Some(model),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => unreachable!("Bug: the thread of the model loader has ended early"),
        }
    }
}
