//! The recorder, and what can be set about it.

use std::fmt;
use std::path::{Path, PathBuf};

use super::clock::Clock;
use super::encoder::Encoder;
use super::ffmpeg::Ffmpeg;
use super::format::{self, Format, NumberedName};
use super::gif::AnimatedGif;
use super::png::{AnimatedPng, Sequence};
use crate::error::{Error, Result};
use crate::file::Replacement;
use crate::render::Picture;

/// How a moving picture is made. The default is 30 frames per second, as fast as it was, played for ever.
#[derive(Clone, Debug, PartialEq)]
pub struct RecorderOptions {
    /// Frames per second of the moving picture: up to 1000, and up to 50 in a GIF, because viewers play a faster one slowly.
    pub frames_per_second: f64,
    /// Seconds of the simulation in a second of the moving picture: 0.1 is slow motion, 2 is twice as fast.
    pub speed: f64,
    /// How often an animated PNG or GIF is played; 0 is for ever.
    pub plays: u16,
    /// The program that makes videos, as it is called or where it is.
    pub ffmpeg: PathBuf,
    /// What the program is told about how to encode. Unless set otherwise: `-c:v libx264 -preset veryfast -crf 18`, which is
    /// H.264 that looks as it was drawn.
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

impl RecorderOptions {
    fn check(&self, format: Format) -> Result<()> {
        let most = if format == Format::Gif { AnimatedGif::MOST_FRAMES_PER_SECOND } else { 1000.0 };
        // The least keeps a frame short enough to be told.
        if !(1e-3..=most).contains(&self.frames_per_second) {
            let expected = format!("from 0.001 to {most}");
            return Err(Error::invalid("RecorderOptions::frames_per_second", self.frames_per_second, expected));
        }
        if !(1e-9..=1e9).contains(&self.speed) {
            return Err(Error::invalid("RecorderOptions::speed", self.speed, "from 1e-9 to 1e9"));
        }
        Ok(())
    }
}

/// What was recorded.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// The file; of a sequence the first.
    pub path: PathBuf,
    /// What it is.
    pub format: Format,
    /// How many frames it has, those included that repeat a picture.
    pub frames: u64,
    /// How long it plays, s.
    pub seconds: f64,
}

/// Makes a moving picture of pictures and the times of the simulation that they show. See the [module](super).
///
/// The file appears when the recording is [finished](Self::finish), whole or not at all; the files of a sequence one by one. A
/// recorder that is dropped finishes too, so that a program which ends early, by an error or a panic, leaves what it has
/// recorded.
pub struct Recorder {
    path: PathBuf,
    format: Format,
    options: RecorderOptions,
    clock: Clock,
    state: State,
    /// Width and height of all pictures.
    size: [u32; 2],
    /// The picture that was taken last. How long it is shown, the next one says.
    held: Vec<u8>,
    frames: u64,
}

enum State {
    /// No picture yet. There is a file, unless it is a sequence.
    Waiting(Option<Replacement>),
    Recording(Box<dyn Encoder>),
    /// Finished, or failed: nothing more is written.
    Over,
}

impl Recorder {
    /// Begins a recording. The path says what it is:
    ///
    /// | path | [`Format`] | |
    /// |---|---|---|
    /// | `walk.png`, `walk.apng` | animated PNG | without loss, large |
    /// | `walk.gif` | animated GIF | 256 colours |
    /// | `walk.mp4`, `walk.mov`, `walk.mkv` | H.264 | small; needs the program `ffmpeg` |
    /// | `walk/frame_%05d.png` | PNG files | `%05d` stands for the number, with at least five digits, from 0 on |
    /// | `walk`, `walk/` | PNG files | `frame_%05d.png` in this folder |
    ///
    /// The folder of a sequence is made if there is none. Its files replace those of the same names; others, such as those of an
    /// earlier and longer recording, stay.
    ///
    /// # Errors
    ///
    /// [`Error::Recording`] for another extension, or without `ffmpeg` for a video. [`Error::File`] if the file cannot be
    /// written, [`Error::Invalid`] for options that are out of range.
    pub fn create(path: impl AsRef<Path>, options: RecorderOptions) -> Result<Self> {
        let path = path.as_ref();
        let format = Format::of(path)?;
        options.check(format)?;
        let (path, file) = if format == Format::Sequence {
            let name = numbered(path);
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
        let state = State::Waiting(file);
        Ok(Self { path, format, options, clock, state, size: [0; 2], held: Vec::new(), frames: 0 })
    }

    /// What is recorded to.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What is written.
    pub fn format(&self) -> Format {
        self.format
    }

    /// How many frames there are so far, those included that repeat a picture.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Whether a picture of this time, in s, would be taken: the first one always, then every
    /// `speed / frames_per_second` seconds of the simulation. After a reset, which turns time back, the next one is due.
    pub fn is_due(&self, time: f64) -> bool {
        time.is_finite() && self.clock.is_due(time)
    }

    /// Takes a picture that shows the simulation at this time, in s, if [one is due](Self::is_due), and tells whether it was.
    ///
    /// Where pictures are farther apart than frames, the one before is shown for longer.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for a picture without pixels or of another size than before, and for a time that is not finite or more
    /// than 100,000 frames after the one before. The recording may go on.
    ///
    /// [`Error::File`] or [`Error::Recording`] if it cannot be written. The recording is over then, and nothing is left of it but
    /// the files of a sequence.
    pub fn push(&mut self, picture: &Picture, time: f64) -> Result<bool> {
        self.push_rgb(picture.width(), picture.height(), picture.as_bytes(), time)
    }

    /// As [`push`](Self::push), with a picture that is an array: red, green and blue of each pixel, row-major from the top,
    /// `(height, width, 3)`.
    ///
    /// # Errors
    ///
    /// As for [`push`](Self::push), and [`Error::Shape`] if `rgb` has not `3 * width * height` elements.
    pub fn push_rgb(&mut self, width: usize, height: usize, rgb: &[u8], time: f64) -> Result<bool> {
        let size = self.check_size(width, height)?;
        Error::check_length("rgb of Recorder::push_rgb", rgb.len(), 3 * width * height)?;
        if !time.is_finite() {
            return Err(Error::invalid("the time of a picture", time, "finite"));
        }
        if matches!(self.state, State::Over) {
            return Err(self.is_over());
        }
        if !self.clock.is_due(time) {
            return Ok(false);
        }
        let shown = self.clock.take(time)?;
        if let State::Waiting(file) = &mut self.state {
            let file = file.take();
            self.size = size;
            self.state = State::Over;
            self.state = State::Recording(self.encoder(file)?);
        } else {
            self.write(shown)?;
        }
        self.held.clear();
        self.held.extend_from_slice(rgb);
        self.frames += 1;
        Ok(true)
    }

    /// Completes the file, and says what is in it.
    ///
    /// # Errors
    ///
    /// As for [`push_rgb`](Self::push_rgb), and [`Error::Recording`] if there is no picture in it.
    pub fn finish(self) -> Result<Summary> {
        self.finish_after(1)
    }

    /// Completes the file as [`finish`](Self::finish) does, and shows the last picture until the simulation has reached this time,
    /// in s: the file then lasts as long as the simulation, however seldom a picture was drawn.
    ///
    /// A time before that of the last picture adds nothing.
    ///
    /// # Errors
    ///
    /// As for [`finish`](Self::finish). [`Error::Invalid`] for a time that is not finite or more than 100,000 frames after the last
    /// picture; the file then ends with this picture.
    pub fn finish_at(self, time: f64) -> Result<Summary> {
        if !time.is_finite() {
            return Err(Error::invalid("the time at which a recording ends", time, "finite"));
        }
        let shown = self.clock.until(time)?;
        self.finish_after(shown)
    }

    /// Completes the file. The last picture is shown for this number of frames.
    fn finish_after(mut self, shown: u64) -> Result<Summary> {
        if let State::Waiting(_) = self.state {
            return Err(Error::Recording { path: self.path.clone(), reason: "there was no picture".to_owned() });
        }
        if let State::Over = self.state {
            return Err(self.is_over());
        }
        self.complete(shown)?;
        let path = match self.format {
            Format::Sequence => numbered(&self.path).path(0),
            _ => self.path.clone(),
        };
        let seconds = self.frames as f64 / self.options.frames_per_second;
        Ok(Summary { path, format: self.format, frames: self.frames, seconds })
    }

    fn check_size(&self, width: usize, height: usize) -> Result<[u32; 2]> {
        let given = || format!("{width} × {height}");
        // More than an `i32` counts is no picture, and no format has room for it.
        let size = [width, height].map(|length| i32::try_from(length).map_or(0, |length| length as u32));
        if size.contains(&0) {
            return Err(Error::invalid("the size of a picture", given(), format!("from 1 × 1 to {0} × {0}", i32::MAX)));
        }
        match self.size {
            [0, 0] => Ok(size),
            before if before == size => Ok(size),
            [width, height] => {
                let expected = format!("{width} × {height} as that of those before");
                Err(Error::invalid("the size of a picture", given(), expected))
            }
        }
    }

    fn encoder(&self, file: Option<Replacement>) -> Result<Box<dyn Encoder>> {
        let (path, size, options) = (&self.path, self.size, &self.options);
        Ok(match (self.format, file) {
            (Format::AnimatedPng, Some(file)) => Box::new(AnimatedPng::new(path, file, size, options)?),
            (Format::Gif, Some(file)) => Box::new(AnimatedGif::new(path, file, size, options)?),
            (Format::Video, Some(file)) => Box::new(Ffmpeg::new(path, file, size, options)?),
            _ => Box::new(Sequence::new(numbered(path), size)),
        })
    }

    /// Writes the picture that is held.
    fn write(&mut self, shown: u64) -> Result<()> {
        let State::Recording(encoder) = &mut self.state else { return Ok(()) };
        let written = encoder.picture(&self.held, shown);
        self.frames += shown - 1;
        if written.is_err() {
            self.state = State::Over;
        }
        written
    }

    /// Writes the last picture, which is shown for this number of frames, and the end of the file, if there is one.
    fn complete(&mut self, shown: u64) -> Result<()> {
        self.write(shown)?;
        match std::mem::replace(&mut self.state, State::Over) {
            State::Recording(encoder) => encoder.finish(),
            State::Waiting(_) | State::Over => Ok(()),
        }
    }

    fn is_over(&self) -> Error {
        Error::Recording { path: self.path.clone(), reason: "it has failed before".to_owned() }
    }
}

/// The names of a sequence.
fn numbered(path: &Path) -> NumberedName {
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
