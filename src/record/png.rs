//! Numbered PNG files and animated PNG.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use super::RecorderOptions;
use super::encoder::{Delays, Encoder, Rectangle};
use super::format::NumberedName;
use crate::error::{Error, Result};
use crate::file::{self, Replacement};

/// Encoder of a sequence. Each file is complete as soon as it exists.
pub(super) struct Sequence {
    name: NumberedName,
    size: [u32; 2],
    next: u64,
}

impl Sequence {
    pub(super) fn new(name: NumberedName, size: [u32; 2]) -> Self {
        Self { name, size, next: 0 }
    }
}

impl Encoder for Sequence {
    fn write(&mut self, rgb: &[u8], frames: u64) -> Result<()> {
        let mut bytes = Vec::new();
        let encoded = header(&mut bytes, self.size, None).and_then(|mut png| {
            png.write_image_data(rgb)?;
            png.finish()
        });
        for _ in 0..frames {
            let path = self.name.path(self.next);
            if let Err(error) = &encoded {
                return Err(Error::file(path)(io::Error::other(error.to_string())));
            }
            file::replace(&path, |out| out.write_all(&bytes))?;
            self.next += 1;
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<()> {
        Ok(())
    }
}

/// Encoder of one animated PNG. Every frame but the first contains only the bounding rectangle of
/// the changed pixels.
pub(super) struct AnimatedPng {
    file: Replacement,
    png: png::Writer<BufWriter<File>>,
    size: [u32; 2],
    plays: u32,
    frames: u32,
    delays: Delays,
    ticks_per_second: u16,
    previous: Vec<u8>,
    region: Vec<u8>,
    path: PathBuf,
}

impl AnimatedPng {
    pub(super) fn new(path: &Path, file: Replacement, size: [u32; 2], options: &RecorderOptions) -> Result<Self> {
        // A delay is a fraction of two 16-bit numbers.
        let per_second = options.frames_per_second;
        let ticks_per_second = if per_second.fract() == 0.0 { per_second as u16 } else { 10_000 };
        let plays = u32::from(options.plays);
        let started = || {
            // The number of frames is not known yet; `try_finish` corrects it.
            header(BufWriter::new(file.file().try_clone()?), size, Some([i32::MAX as u32, plays]))
                .map_err(io::Error::from)
        };
        Ok(Self {
            png: started().map_err(Error::file(path))?,
            file,
            size,
            plays,
            frames: 0,
            delays: Delays::new(f64::from(ticks_per_second), per_second),
            ticks_per_second,
            previous: Vec::new(),
            region: Vec::new(),
            path: path.to_owned(),
        })
    }

    fn try_write(&mut self, rgb: &[u8], frames: u64) -> io::Result<()> {
        let [width, height] = self.size.map(|length| length as usize);
        for delay in self.delays.next(frames) {
            let (previous, current) = (self.previous.as_chunks::<3>().0, rgb.as_chunks::<3>().0);
            let region = if previous.is_empty() {
                Rectangle { left: 0, top: 0, width, height }
            } else {
                Rectangle::bounding(width, height, |pixel| previous[pixel] != current[pixel])
            };
            self.region.clear();
            for row in region.rows(width) {
                self.region.extend_from_slice(current[row].as_flattened());
            }
            // Resets the position first: the previous size could exceed the image at the new
            // position.
            self.png.reset_frame_position()?;
            self.png.set_frame_dimension(region.width as u32, region.height as u32)?;
            self.png.set_frame_position(region.left as u32, region.top as u32)?;
            self.png.set_frame_delay(delay, self.ticks_per_second)?;
            self.png.write_image_data(&self.region)?;
            self.frames += 1;
            self.previous.clear();
            self.previous.extend_from_slice(rgb);
        }
        Ok(())
    }

    fn try_finish(self) -> io::Result<()> {
        self.png.finish()?;
        // Writes the header again, now with the number of frames. Its length is unchanged.
        let mut bytes = Vec::new();
        header(&mut bytes, self.size, Some([self.frames, self.plays]))?.finish()?;
        bytes.truncate(bytes.len() - END_CHUNK_LENGTH);
        let mut file = self.file.file();
        file.rewind()?;
        file.write_all(&bytes)?;
        self.file.finish()
    }
}

/// Length of the empty chunk that ends every file.
const END_CHUNK_LENGTH: usize = 12;

impl Encoder for AnimatedPng {
    fn write(&mut self, rgb: &[u8], frames: u64) -> Result<()> {
        self.try_write(rgb, frames).map_err(Error::file(&self.path))
    }

    fn finish(self: Box<Self>) -> Result<()> {
        let path = self.path.clone();
        self.try_finish().map_err(Error::file(path))
    }
}

/// Writes the header of a file: of an animated one if the numbers of frames and of plays are given.
fn header<W: Write>(
    out: W,
    [width, height]: [u32; 2],
    animated: Option<[u32; 2]>,
) -> Result<png::Writer<W>, png::EncodingError> {
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    if let Some([frames, plays]) = animated {
        encoder.set_animated(frames, plays)?;
    }
    encoder.write_header()
}
