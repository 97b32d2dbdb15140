//! The clip of a session.

use crate::error::Result;
use crate::record::{Recorder, Summary};
use crate::render::{Picture, RenderError};
use crate::viewer::error::ViewerError;

/// A recording that runs. The clip lasts as long as the simulation that it shows, however seldom the window is drawn: a picture is
/// repeated until the next one.
pub(super) struct Recording {
    recorder: Recorder,
    /// All pictures have this size, even if the window is resized.
    size: [u32; 2],
}

impl Recording {
    /// Begins a recording of pictures of this size.
    pub fn new(recorder: Recorder, size: [u32; 2]) -> Self {
        // Videos have an even number of rows and columns.
        Self { recorder, size: size.map(|pixels| (pixels & !1).max(2)) }
    }

    /// Returns the number of frames so far.
    pub fn frames(&self) -> u64 {
        self.recorder.frames()
    }

    /// Takes the picture of a simulation time, in s, if one is due.
    pub fn take<'a>(
        &mut self,
        time: f64,
        draw: impl FnOnce([u32; 2]) -> Result<&'a Picture, RenderError>,
    ) -> Result<(), ViewerError> {
        // The panels show a state that is not finite. A recording leaves it out.
        if self.recorder.is_due(time) {
            self.recorder.push(draw(self.size)?, time)?;
        }
        Ok(())
    }

    /// Completes the clip, which lasts until this simulation time if it is known. Returns `None` if there was no picture.
    pub fn finish(self, time: Option<f64>) -> Result<Option<Summary>> {
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
    use crate::render::Picture;

    fn begin(path: &Path) -> Recording {
        let options = RecorderOptions { frames_per_second: 10.0, ..RecorderOptions::default() };
        Recording::new(Recorder::create(path, options).unwrap(), [7, 5])
    }

    /// How long the pictures of a file are shown, hundredths of a second.
    fn delays(path: &Path) -> Vec<u16> {
        let mut decoder = gif::Decoder::new(File::open(path).unwrap()).unwrap();
        let mut delays = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            delays.push(frame.delay);
        }
        delays
    }

    #[test]
    fn a_clip_lasts_as_long_as_the_simulation_however_seldom_a_picture_is_drawn() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("clip.gif");
        // Each consumer draws at these times, from 1 s to 4 s of the simulation.
        for (times, expected) in [
            (vec![1.0], vec![300]),
            (vec![1.0, 1.05, 3.7], vec![270, 30]),
            (vec![1.0, 2.5, 4.0], vec![150, 150, 10]),
            ((10..40).map(|tenth| f64::from(tenth) / 10.0).collect(), vec![10; 30]),
        ] {
            let mut recording = begin(&path);
            for (number, time) in times.into_iter().enumerate() {
                let mut picture = Picture::new(6, 4);
                picture.set_pixel(number % 6, number / 6 % 4, [255; 3]);
                recording
                    .take(time, |size| {
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
    fn a_clip_without_pictures_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("clip.gif");
        let mut recording = begin(&path);
        recording.take(f64::NAN, |_| unreachable!()).unwrap();
        assert!(recording.finish(Some(4.0)).unwrap().is_none());
        assert!(!path.exists());
    }
}
