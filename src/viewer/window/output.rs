//! A session's pictures and recordings.

use std::path::{Path, PathBuf};

use super::canvas::Canvas;
use super::file_name;
use super::session::Session;
use crate::error::{Error, Result};
use crate::record::{Recorder, RecorderOptions};
use crate::render::Gpu;
use crate::viewer::error::ViewerError;
use crate::viewer::launch::ViewerOptions;
use crate::viewer::snapshot::Snapshot;

/// Where pictures and recordings go, and the recording that runs.
pub(super) struct Output {
    screenshots: PathBuf,
    recordings: Option<PathBuf>,
    options: RecorderOptions,
    recording: Option<Recording>,
    /// Whether the next frame is to be saved.
    wants_screenshot: bool,
}

struct Recording {
    recorder: Recorder,
    /// All its pictures have this size, whatever the window has.
    size: [u32; 2],
}

/// What came of a frame's outputs, for the user.
#[derive(Default)]
pub(super) struct Outcome {
    pub notice: Option<String>,
    pub problem: Option<String>,
}

impl Output {
    pub fn new(options: &ViewerOptions) -> Self {
        Self {
            screenshots: options.screenshots.clone(),
            recordings: options.recordings.clone(),
            options: options.recording.clone(),
            recording: None,
            wants_screenshot: false,
        }
    }

    pub fn is_recording(&self) -> bool {
        self.recording.is_some()
    }

    /// The frames of the recording that runs.
    pub fn frames(&self) -> Option<u64> {
        self.recording.as_ref().map(|recording| recording.recorder.frames())
    }

    /// Begins a recording, of pictures of this size. Returns where it goes.
    fn start(&mut self, size: [u32; 2]) -> Result<PathBuf> {
        let recorder = match &self.recordings {
            Some(path) => Recorder::create(file_name::free(path), self.options.clone())?,
            None => {
                Recorder::create(file_name::free(Path::new("recording.mp4")), self.options.clone()).or_else(|_| {
                    // There is no ffmpeg.
                    let options = RecorderOptions {
                        frames_per_second: self.options.frames_per_second.min(50.0),
                        ..self.options.clone()
                    };
                    Recorder::create(file_name::free(Path::new("recording.gif")), options)
                })?
            }
        };
        let path = recorder.path().to_owned();
        // Videos have an even number of rows and columns.
        let size = size.map(|pixels| (pixels & !1).max(2));
        self.recording = Some(Recording { recorder, size });
        Ok(path)
    }

    /// Completes the recording that runs. Says what became of it.
    pub fn finish(&mut self) -> Result<Option<String>> {
        let Some(Recording { recorder, .. }) = self.recording.take() else { return Ok(None) };
        if recorder.frames() == 0 {
            return Ok(Some("nothing was recorded".to_owned()));
        }
        let summary = recorder.finish()?;
        Ok(Some(format!("{}: {} frames, {:.1} s", summary.path.display(), summary.frames, summary.seconds)))
    }

    /// Saves what of a frame is to be saved.
    pub fn take(&mut self, canvas: &mut Canvas, gpu: &Gpu, snapshot: &Snapshot, size: [u32; 2]) -> Outcome {
        let mut outcome = Outcome::default();
        if std::mem::take(&mut self.wants_screenshot) {
            match self.save(canvas, gpu, snapshot, size) {
                Ok(path) => outcome.notice = Some(format!("saved {}", path.display())),
                Err(error) => outcome.problem = Some(error.to_string()),
            }
        }
        if let Some(recording) = &mut self.recording
            && let Err(error) = recording.take(canvas, gpu, snapshot)
        {
            outcome.problem = Some(format!("the recording has ended: {error}"));
            self.recording = None;
        }
        outcome
    }

    fn save(
        &self,
        canvas: &mut Canvas,
        gpu: &Gpu,
        snapshot: &Snapshot,
        size: [u32; 2],
    ) -> Result<PathBuf, ViewerError> {
        let path = file_name::free(&self.screenshots);
        canvas.picture(gpu, snapshot, size)?.save_png(&path)?;
        Ok(path)
    }
}

impl Recording {
    fn take(&mut self, canvas: &mut Canvas, gpu: &Gpu, snapshot: &Snapshot) -> Result<(), ViewerError> {
        // A state that is not finite is shown in the panels, and no time of a picture.
        if !snapshot.time.is_finite() || !self.recorder.is_due(snapshot.time) {
            return Ok(());
        }
        self.recorder.push(canvas.picture(gpu, snapshot, self.size)?, snapshot.time)?;
        Ok(())
    }
}

impl Session {
    pub(super) fn screenshot(&mut self) {
        self.output.wants_screenshot = true;
    }

    pub(super) fn toggle_recording(&mut self) {
        if self.output.is_recording() {
            let outcome = self.output.finish();
            self.window.set_resizable(true);
            self.tell(outcome.map(Option::unwrap_or_default));
        } else {
            let size = self.screen.size();
            let begun = self.output.start(size);
            self.window.set_resizable(begun.is_err());
            self.tell(begun.map(|path| format!("recording to {}", path.display())));
        }
    }

    fn tell(&mut self, outcome: Result<String, Error>) {
        match outcome {
            Ok(notice) => self.panels.notice(notice),
            Err(error) => self.panels.warn(error.to_string()),
        }
    }
}
