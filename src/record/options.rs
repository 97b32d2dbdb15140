//! Options of a recording.

use std::path::PathBuf;

use super::format::Format;
use crate::error::{Error, Result};
use crate::macros::with_methods;

/// Largest number of frames per second of a GIF: its delays are in hundredths of a second, and
/// viewers replace delays of less than two by ten.
const MAX_GIF_RATE: f64 = 50.0;

/// Options of a recording. The default is 30 frames per second, in real time, played in an endless
/// loop.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RecorderOptions {
    /// Frames per second of the recording: up to 1000, or up to 50 in a GIF, because viewers slow
    /// down faster animations.
    pub frames_per_second: f64,
    /// Simulation time per second of the recording: 0.1 is slow motion, 2 is double speed.
    pub speed: f64,
    /// Number of times that an animated PNG or GIF is played; 0 for an endless loop.
    pub plays: u16,
    /// Name or path of the program that encodes video.
    pub ffmpeg: PathBuf,
    /// Encoding arguments of the program. Default: `-c:v libx264 -preset veryfast -crf 18`,
    /// visually lossless H.264.
    pub ffmpeg_arguments: Vec<String>,
}

impl Default for RecorderOptions {
    fn default() -> Self {
        Self {
            frames_per_second: 30.0,
            speed: 1.0,
            plays: 0,
            ffmpeg: "ffmpeg".into(),
            ffmpeg_arguments: ["-c:v", "libx264", "-preset", "veryfast", "-crf", "18"].map(String::from).to_vec(),
        }
    }
}

with_methods!(RecorderOptions {
    with_frames_per_second(frames_per_second: f64),
    with_speed(speed: f64),
    with_plays(plays: u16),
    with_ffmpeg(ffmpeg: impl Into<PathBuf>) = ffmpeg.into(),
    with_ffmpeg_arguments(ffmpeg_arguments: impl Into<Vec<String>>) = ffmpeg_arguments.into(),
});

impl RecorderOptions {
    pub(super) fn check(&self, format: Format) -> Result<()> {
        let maximum = if format == Format::Gif { MAX_GIF_RATE } else { 1000.0 };
        // The lower limit keeps the duration of a frame within the range of the formats.
        if !(1e-3..=maximum).contains(&self.frames_per_second) {
            let expected = format!("from 0.001 to {maximum}");
            return Err(Error::out_of_range("RecorderOptions::frames_per_second", self.frames_per_second, expected));
        }
        if !(1e-9..=1e9).contains(&self.speed) {
            return Err(Error::out_of_range("RecorderOptions::speed", self.speed, "from 1e-9 to 1e9"));
        }
        Ok(())
    }
}
