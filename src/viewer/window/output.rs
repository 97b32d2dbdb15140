//! Files of screenshots and recordings.

use std::path::{Path, PathBuf};

use super::scene_renderer::SceneRenderer;
use crate::error::Result;
use crate::file::free_path;
use crate::record::{Recorder, RecorderOptions, Summary};
use crate::render::{Gpu, RenderError, RgbImage};
use crate::viewer::error::ViewerError;
use crate::viewer::link::Snapshot;
use crate::viewer::options::ViewerOptions;

/// Screenshots and recordings of a session.
pub(super) struct Output {
    screenshots: PathBuf,
    recordings: Option<PathBuf>,
    options: RecorderOptions,
    recording: Option<Recording>,
    /// The next frame is saved as a screenshot.
    pub screenshot_requested: bool,
}

/// Messages for the user about the outputs of a frame.
#[derive(Default)]
pub(super) struct OutputReport {
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
            screenshot_requested: false,
        }
    }

    pub fn is_recording(&self) -> bool {
        self.recording.is_some()
    }

    /// Returns the number of frames of the running recording.
    pub fn frames(&self) -> Option<u64> {
        self.recording.as_ref().map(Recording::frames)
    }

    /// Starts a recording with frames of this size. Returns the path of the file.
    pub fn start(&mut self, size: [u32; 2]) -> Result<PathBuf> {
        let recorder = match &self.recordings {
            Some(path) => Recorder::create(free_path(path), self.options.clone())?,
            None => {
                Recorder::create(free_path(Path::new("recording.mp4")), self.options.clone()).or_else(|_| {
                    // `ffmpeg` is not available.
                    let options = RecorderOptions {
                        frames_per_second: self.options.frames_per_second.min(50.0),
                        ..self.options.clone()
                    };
                    Recorder::create(free_path(Path::new("recording.gif")), options)
                })?
            }
        };
        let path = recorder.path().to_owned();
        self.recording = Some(Recording::new(recorder, size));
        Ok(path)
    }

    /// Finishes the running recording, which lasts until this simulation time. Returns a message
    /// for the user.
    pub fn finish(&mut self, time: Option<f64>) -> Result<Option<String>> {
        let Some(recording) = self.recording.take() else { return Ok(None) };
        let Some(summary) = recording.finish(time)? else { return Ok(Some("nothing was recorded".to_owned())) };
        Ok(Some(format!("{}: {} frames, {:.1} s", summary.path.display(), summary.frames, summary.seconds)))
    }

    /// Saves a requested screenshot and records the snapshot.
    pub fn save_frame(
        &mut self,
        renderer: &mut SceneRenderer,
        gpu: &Gpu,
        snapshot: &Snapshot,
        size: [u32; 2],
    ) -> OutputReport {
        let mut report = OutputReport::default();
        if std::mem::take(&mut self.screenshot_requested) {
            match self.save_screenshot(renderer, gpu, snapshot, size) {
                Ok(path) => report.notice = Some(format!("saved {}", path.display())),
                Err(error) => report.problem = Some(error.to_string()),
            }
        }
        report.problem = self.record(renderer, gpu, snapshot).or(report.problem);
        report
    }

    /// Records a snapshot if a recording runs and a frame is due. An error ends the recording and
    /// is returned as a message.
    pub fn record(&mut self, renderer: &mut SceneRenderer, gpu: &Gpu, snapshot: &Snapshot) -> Option<String> {
        if let Some(recording) = &mut self.recording
            && let Err(error) = recording.add(snapshot.time, |size| renderer.picture(gpu, snapshot, size))
        {
            self.recording = None;
            return Some(format!("the recording has ended: {error}"));
        }
        None
    }

    fn save_screenshot(
        &self,
        renderer: &mut SceneRenderer,
        gpu: &Gpu,
        snapshot: &Snapshot,
        size: [u32; 2],
    ) -> Result<PathBuf, ViewerError> {
        let path = free_path(&self.screenshots);
        renderer.picture(gpu, snapshot, size)?.save_png(&path)?;
        Ok(path)
    }
}

/// Running recording. Its duration is the simulated time, independent of the frame rate of the
/// window: each image is repeated until the next image.
struct Recording {
    recorder: Recorder,
    /// Size of all frames, even if the window is resized.
    size: [u32; 2],
}

impl Recording {
    /// Creates a recording with frames of this size.
    fn new(recorder: Recorder, size: [u32; 2]) -> Self {
        // Video formats require even sizes.
        Self { recorder, size: size.map(|pixels| (pixels & !1).max(2)) }
    }

    /// Returns the number of frames so far.
    fn frames(&self) -> u64 {
        self.recorder.frames()
    }

    /// Adds an image of the state at a simulation time, in s, if a frame is due.
    fn add<'a>(
        &mut self,
        time: f64,
        draw: impl FnOnce([u32; 2]) -> Result<&'a RgbImage, RenderError>,
    ) -> Result<(), ViewerError> {
        // A state with a time that is not finite is never due.
        if self.recorder.is_due(time) {
            self.recorder.push(draw(self.size)?, time)?;
        }
        Ok(())
    }

    /// Finishes the recording, which lasts until this simulation time if it is known. Returns
    /// `None` if the recording has no frame.
    fn finish(self, time: Option<f64>) -> Result<Option<Summary>> {
        if self.recorder.frames() == 0 {
            return Ok(None);
        }
        match time.filter(|time| time.is_finite()) {
            Some(time) => self.recorder.finish_at(time).map(Some),
            None => self.recorder.finish().map(Some),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::path::Path;

    use super::Recording;
    use crate::record::{Recorder, RecorderOptions};
    use crate::render::RgbImage;

    fn start(path: &Path) -> Recording {
        let options = RecorderOptions { frames_per_second: 10.0, ..RecorderOptions::default() };
        Recording::new(Recorder::create(path, options).unwrap(), [7, 5])
    }

    /// Returns the display times of the frames of a file, in hundredths of a second.
    fn delays(path: &Path) -> Vec<u16> {
        let mut decoder = gif::Decoder::new(File::open(path).unwrap()).unwrap();
        let mut delays = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            delays.push(frame.delay);
        }
        delays
    }

    #[test]
    fn recording_lasts_as_long_as_the_simulation_at_any_frame_rate() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("clip.gif");
        // Times at which the window is drawn, from 1 s to 4 s of the simulation, and the display
        // times of the frames.
        for (times, expected) in [
            (vec![1.0], vec![300]),
            (vec![1.0, 1.05, 3.7], vec![270, 30]),
            (vec![1.0, 2.5, 4.0], vec![150, 150, 10]),
            ((10..40).map(|tenth| f64::from(tenth) / 10.0).collect(), vec![10; 30]),
        ] {
            let mut recording = start(&path);
            for (number, time) in times.into_iter().enumerate() {
                let mut picture = RgbImage::new(6, 4);
                picture.set_pixel(number % 6, number / 6 % 4, [255; 3]);
                recording
                    .add(time, |size| {
                        Ok({
                            assert_eq!(size, [6, 4]);
                            &picture
                        })
                    })
                    .unwrap();
            }
            let summary = recording.finish(Some(4.0)).unwrap().unwrap();
            assert_eq!(delays(&path), expected);
            assert_eq!(summary.seconds, f64::from(expected.iter().sum::<u16>()) / 100.0);
        }
    }

    #[test]
    fn recording_without_frames_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("clip.gif");
        let mut recording = start(&path);
        recording.add(f64::NAN, |_| unreachable!()).unwrap();
        assert!(recording.finish(Some(4.0)).unwrap().is_none());
        assert!(!path.exists());
    }
}
