//! A session's pictures and recordings.

use std::path::{Path, PathBuf};

use super::canvas::Canvas;
use super::file_name;
use super::recording::Recording;
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
        self.recording.as_ref().map(Recording::frames)
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
        self.recording = Some(Recording::new(recorder, size));
        Ok(path)
    }

    /// Completes the running recording, which lasts until this simulation time. Returns a message for the user.
    pub fn finish(&mut self, time: Option<f64>) -> Result<Option<String>> {
        let Some(recording) = self.recording.take() else { return Ok(None) };
        let Some(summary) = recording.finish(time)? else { return Ok(Some("nothing was recorded".to_owned())) };
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
        outcome.problem = self.record(canvas, gpu, snapshot).or(outcome.problem);
        outcome
    }

    /// Records a snapshot if a recording runs and a picture is due. Returns the problem that ends the recording.
    fn record(&mut self, canvas: &mut Canvas, gpu: &Gpu, snapshot: &Snapshot) -> Option<String> {
        if let Some(recording) = &mut self.recording
            && let Err(error) = recording.take(snapshot.time, |size| canvas.picture(gpu, snapshot, size))
        {
            self.recording = None;
            return Some(format!("the recording has ended: {error}"));
        }
        None
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

impl Session {
    pub(super) fn screenshot(&mut self) {
        self.output.wants_screenshot = true;
    }

    pub(super) fn toggle_recording(&mut self) {
        if self.output.is_recording() {
            let outcome = self.finish_recording();
            self.window.set_resizable(true);
            self.tell(outcome.map(Option::unwrap_or_default));
        } else {
            let size = self.screen.size();
            let begun = self.output.start(size);
            self.window.set_resizable(begun.is_err());
            self.tell(begun.map(|path| format!("recording to {}", path.display())));
            // The recording begins now, even if the next frame is drawn much later.
            self.record_newest();
        }
    }

    /// Completes the running recording with the newest snapshot: the time since the last frame belongs to it too.
    pub(super) fn finish_recording(&mut self) -> Result<Option<String>> {
        self.record_newest();
        let time = self.front.drawn().map(|snapshot| snapshot.time);
        self.output.finish(time)
    }

    /// Records the newest snapshot, whether or not the window is drawn.
    fn record_newest(&mut self) {
        if !self.output.is_recording() {
            return;
        }
        self.meet();
        let (Some(snapshot), Some(view)) = (self.front.drawn_mut(), &mut self.view) else { return };
        let gpu = self.screen.gpu().clone();
        let problem = match view.prepare(snapshot) {
            Ok(()) => self.output.record(&mut self.canvas, &gpu, snapshot),
            Err(error) => Some(error.to_string()),
        };
        if let Some(problem) = problem {
            self.panels.warn(problem);
        }
    }

    fn tell(&mut self, outcome: Result<String, Error>) {
        match outcome {
            Ok(notice) => self.panels.notice(notice),
            Err(error) => self.panels.warn(error.to_string()),
        }
    }
}
