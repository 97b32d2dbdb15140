//! The recorder.

use std::fmt;
use std::path::{Path, PathBuf};

use super::clock::Clock;
use super::encoder::Encoder;
use super::ffmpeg::Ffmpeg;
use super::format::{self, Format, NumberedName};
use super::gif::AnimatedGif;
use super::options::RecorderOptions;
use super::png::{AnimatedPng, Sequence};
use crate::error::{Error, Result};
use crate::file::Replacement;
use crate::render::RgbImage;

/// Result of a recording.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// Path of the file; for a sequence, of its first file.
    pub path: PathBuf,
    /// File format.
    pub format: Format,
    /// Number of frames, including repetitions of an image.
    pub frames: u64,
    /// Duration, s.
    pub seconds: f64,
}

/// Records images together with the simulation times that they show. See the [module](super).
///
/// The file appears at its path when the recording is [finished](Self::finish): complete or not at
/// all. The files of a sequence appear one by one. Dropping a recorder finishes the recording, so
/// the frames recorded so far are kept if the program ends early by an error or a panic.
pub struct Recorder {
    path: PathBuf,
    format: Format,
    options: RecorderOptions,
    clock: Clock,
    state: State,
    /// Width and height of all images; zero before the first.
    size: [u32; 2],
    /// Most recent image. It is encoded when the time of the next image determines its duration.
    latest: Vec<u8>,
    frames: u64,
}

enum State {
    /// No image yet. The file exists, except for a sequence.
    Empty(Option<Replacement>),
    Recording(Box<dyn Encoder>),
    /// Finished or failed. Nothing more is written.
    Ended,
}

impl Recorder {
    /// Starts a recording. The path determines the format:
    ///
    /// | path | [`Format`] | |
    /// |---|---|---|
    /// | `walk.png`, `walk.apng` | animated PNG | lossless, large |
    /// | `walk.gif` | animated GIF | 256 colours |
    /// | `walk.mp4`, `walk.mov`, `walk.mkv` | H.264 | small; needs the program `ffmpeg` |
    /// | `walk/frame_%05d.png` | PNG files | `%05d` is replaced by the number, with at least five digits, starting at 0 |
    /// | `walk`, `walk/` | PNG files | `frame_%05d.png` in this folder |
    ///
    /// For a sequence, the folder is created if necessary. New files replace files of the same
    /// name. Other files remain, including the surplus files of an earlier and longer recording.
    ///
    /// # Errors
    ///
    /// [`Error::Save`] for an unknown extension, or for a video without `ffmpeg`.
    /// [`Error::File`] if the file cannot be written, [`Error::Invalid`] for options out of range.
    pub fn create(path: impl AsRef<Path>, options: RecorderOptions) -> Result<Self> {
        let path = path.as_ref();
        let format = Format::of(path)?;
        options.check(format)?;
        let (path, file) = if format == Format::Sequence {
            let name = file_names(path);
            if !name.folder().as_os_str().is_empty() {
                std::fs::create_dir_all(name.folder()).map_err(Error::file(name.folder()))?;
            }
            (path.to_owned(), None)
        } else {
            if format == Format::Video {
                Ffmpeg::check(path, &options)?;
            }
            (path.to_owned(), Some(Replacement::create(path).map_err(Error::file(path))?))
        };
        let clock = Clock::new(options.speed / options.frames_per_second);
        let state = State::Empty(file);
        Ok(Self { path, format, options, clock, state, size: [0; 2], latest: Vec::new(), frames: 0 })
    }

    /// Returns the output path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the file format.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Returns the number of frames so far, including repetitions of an image.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Returns `true` if [`push`](Self::push) would accept an image at this time, s: always for the
    /// first image, then every `speed / frames_per_second` seconds of simulation time. After a
    /// reset of the simulation to an earlier time, the next image is due.
    pub fn is_due(&self, time: f64) -> bool {
        time.is_finite() && self.clock.is_due(time)
    }

    /// Adds an image of the simulation at this time, s, if [one is due](Self::is_due). Returns
    /// `true` if the image was accepted.
    ///
    /// If images are further apart than frames, the previous image is repeated.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for an empty image, for a change of size, and for a time that is not
    /// finite or more than 100,000 frames after the previous image. The recording can continue.
    ///
    /// [`Error::File`] or [`Error::Save`] if the image cannot be written. The recording then
    /// ends without a file, except for the files of a sequence.
    pub fn push(&mut self, picture: &RgbImage, time: f64) -> Result<bool> {
        self.push_rgb(picture.width(), picture.height(), picture.as_bytes(), time)
    }

    /// Adds an image as [`push`](Self::push) does, from an array of red, green and blue for each
    /// pixel, row-major from the top, `(height, width, 3)`.
    ///
    /// # Errors
    ///
    /// As for [`push`](Self::push), and [`Error::Shape`] if the length of `rgb` is not
    /// `3 * width * height`.
    pub fn push_rgb(&mut self, width: usize, height: usize, rgb: &[u8], time: f64) -> Result<bool> {
        let size = self.check_size(width, height)?;
        Error::check_length("rgb of Recorder::push_rgb", rgb.len(), 3 * width * height)?;
        if !time.is_finite() {
            return Err(Error::not_finite("the time of an image", time));
        }
        if matches!(self.state, State::Ended) {
            return Err(self.ended_error());
        }
        if !self.clock.is_due(time) {
            return Ok(false);
        }
        let shown = self.clock.accept(time)?;
        if let State::Empty(file) = &mut self.state {
            let file = file.take();
            self.size = size;
            self.state = State::Ended;
            self.state = State::Recording(self.encoder(file)?);
        } else {
            self.write(shown)?;
        }
        self.latest.clear();
        self.latest.extend_from_slice(rgb);
        self.frames += 1;
        Ok(true)
    }

    /// Completes the file and returns a summary.
    ///
    /// # Errors
    ///
    /// As for [`push_rgb`](Self::push_rgb), and [`Error::Save`] if the recording has no image.
    pub fn finish(self) -> Result<Summary> {
        self.finish_after(1)
    }

    /// Completes the file as [`finish`](Self::finish) does, and shows the last image until the
    /// given simulation time, s. The duration of the file then matches the simulation, even if
    /// images were added rarely.
    ///
    /// A time before the last image has no effect.
    ///
    /// # Errors
    ///
    /// As for [`finish`](Self::finish). [`Error::Invalid`] for a time that is not finite or more
    /// than 100,000 frames after the last image; the file then ends with this image.
    pub fn finish_at(self, time: f64) -> Result<Summary> {
        if !time.is_finite() {
            return Err(Error::not_finite("the end time of a recording", time));
        }
        let shown = self.clock.until(time)?;
        self.finish_after(shown)
    }

    /// Completes the file, with the last image shown for `shown` frames.
    fn finish_after(mut self, shown: u64) -> Result<Summary> {
        if let State::Empty(_) = self.state {
            return Err(Error::Save { path: self.path.clone(), reason: "no image was recorded".to_owned() });
        }
        if let State::Ended = self.state {
            return Err(self.ended_error());
        }
        self.complete(shown)?;
        let path = match self.format {
            Format::Sequence => file_names(&self.path).path(0),
            _ => self.path.clone(),
        };
        let seconds = self.frames as f64 / self.options.frames_per_second;
        Ok(Summary { path, format: self.format, frames: self.frames, seconds })
    }

    fn check_size(&self, width: usize, height: usize) -> Result<[u32; 2]> {
        let given = || format!("{width} × {height}");
        // No format supports lengths above `i32::MAX`.
        let size = [width, height].map(|length| i32::try_from(length).map_or(0, |length| length as u32));
        if size.contains(&0) {
            return Err(Error::out_of_range(
                "the size of an image",
                given(),
                format!("from 1 × 1 to {0} × {0}", i32::MAX),
            ));
        }
        match self.size {
            [0, 0] => Ok(size),
            before if before == size => Ok(size),
            [width, height] => {
                let expected = format!("{width} × {height}, the size of the previous images");
                Err(Error::out_of_range("the size of an image", given(), expected))
            }
        }
    }

    fn encoder(&self, file: Option<Replacement>) -> Result<Box<dyn Encoder>> {
        let (path, size, options) = (&self.path, self.size, &self.options);
        Ok(match (self.format, file) {
            (Format::AnimatedPng, Some(file)) => Box::new(AnimatedPng::new(path, file, size, options)?),
            (Format::Gif, Some(file)) => Box::new(AnimatedGif::new(path, file, size, options)?),
            (Format::Video, Some(file)) => Box::new(Ffmpeg::new(path, file, size, options)?),
            _ => Box::new(Sequence::new(file_names(path), size)),
        })
    }

    /// Encodes the most recent image.
    fn write(&mut self, shown: u64) -> Result<()> {
        let State::Recording(encoder) = &mut self.state else { return Ok(()) };
        let written = encoder.write(&self.latest, shown);
        self.frames += shown - 1;
        if written.is_err() {
            self.state = State::Ended;
        }
        written
    }

    /// Encodes the most recent image for `shown` frames, and completes the file if there is one.
    fn complete(&mut self, shown: u64) -> Result<()> {
        self.write(shown)?;
        match std::mem::replace(&mut self.state, State::Ended) {
            State::Recording(encoder) => encoder.finish(),
            State::Empty(_) | State::Ended => Ok(()),
        }
    }

    fn ended_error(&self) -> Error {
        Error::Save { path: self.path.clone(), reason: "an earlier write failed".to_owned() }
    }
}

/// Returns the file name pattern of a sequence.
fn file_names(path: &Path) -> NumberedName {
    NumberedName::of(path).filter(|_| !format::is_folder(path)).unwrap_or_else(|| NumberedName::in_folder(path))
}

impl Drop for Recorder {
    fn drop(&mut self) {
        if let Err(error) = self.complete(1) {
            log::error!("{error}");
        }
    }
}

impl fmt::Debug for Recorder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Recorder: {} frames to {}", self.frames, self.path.display())
    }
}
