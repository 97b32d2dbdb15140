//! Numbered PNG files, and animated PNG.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use super::RecorderOptions;
use super::encoder::{Delays, Encoder, Rectangle};
use super::format::NumberedName;
use crate::error::{Error, Result};
use crate::file::{self, Replacement};

/// Numbered files, each of which is there as soon as it is written.
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
    fn picture(&mut self, rgb: &[u8], shown: u64) -> Result<()> {
        let mut bytes = Vec::new();
        let encoded = header(&mut bytes, self.size, None).and_then(|mut png| {
            png.write_image_data(rgb)?;
            png.finish()
        });
        for _ in 0..shown {
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

/// One file, in which every picture but the first is the part that has changed.
pub(super) struct AnimatedPng {
    file: Replacement,
    png: png::Writer<BufWriter<File>>,
    size: [u32; 2],
    plays: u32,
    pictures: u32,
    delays: Delays,
    ticks_per_second: u16,
    before: Vec<u8>,
    part: Vec<u8>,
    path: PathBuf,
}

impl AnimatedPng {
    pub(super) fn new(path: &Path, file: Replacement, size: [u32; 2], options: &RecorderOptions) -> Result<Self> {
        // Delays are fractions of 16-bit numbers.
        let per_second = options.frames_per_second;
        let ticks_per_second = if per_second.fract() == 0.0 { per_second as u16 } else { 10_000 };
        let plays = u32::from(options.plays);
        let started = || {
            // How many pictures there will be is not known yet; `finish` corrects it.
            header(BufWriter::new(file.file().try_clone()?), size, Some([i32::MAX as u32, plays]))
                .map_err(io::Error::from)
        };
        Ok(Self {
            png: started().map_err(Error::file(path))?,
            file,
            size,
            plays,
            pictures: 0,
            delays: Delays::new(f64::from(ticks_per_second), per_second),
            ticks_per_second,
            before: Vec::new(),
            part: Vec::new(),
            path: path.to_owned(),
        })
    }

    fn try_picture(&mut self, rgb: &[u8], shown: u64) -> io::Result<()> {
        let [width, height] = self.size.map(|length| length as usize);
        for delay in self.delays.next(shown) {
            let (before, after) = (self.before.as_chunks::<3>().0, rgb.as_chunks::<3>().0);
            let part = if before.is_empty() {
                Rectangle { left: 0, top: 0, width, height }
            } else {
                Rectangle::of_changes(width, height, |pixel| before[pixel] != after[pixel])
            };
            self.part.clear();
            for row in part.rows(width) {
                self.part.extend_from_slice(after[row].as_flattened());
            }
            // Otherwise the part before might reach too far from the new corner.
            self.png.reset_frame_position()?;
            self.png.set_frame_dimension(part.width as u32, part.height as u32)?;
            self.png.set_frame_position(part.left as u32, part.top as u32)?;
            self.png.set_frame_delay(delay, self.ticks_per_second)?;
            self.png.write_image_data(&self.part)?;
            self.pictures += 1;
            self.before.clear();
            self.before.extend_from_slice(rgb);
        }
        Ok(())
    }

    fn try_finish(self) -> io::Result<()> {
        self.png.finish()?;
        // The beginning once more, now with the number of pictures. It is as long as it was.
        let mut bytes = Vec::new();
        header(&mut bytes, self.size, Some([self.pictures, self.plays]))?.finish()?;
        bytes.truncate(bytes.len() - END);
        let mut file = self.file.file();
        file.rewind()?;
        file.write_all(&bytes)?;
        self.file.finish()
    }
}

/// The length of the chunk that ends every file, which has nothing in it.
const END: usize = 12;

impl Encoder for AnimatedPng {
    fn picture(&mut self, rgb: &[u8], shown: u64) -> Result<()> {
        self.try_picture(rgb, shown).map_err(Error::file(&self.path))
    }

    fn finish(self: Box<Self>) -> Result<()> {
        let path = self.path.clone();
        self.try_finish().map_err(Error::file(path))
    }
}

/// The beginning of a file; with the number of pictures and of plays, of an animated one.
fn header<W: Write>(
    out: W,
    [width, height]: [u32; 2],
    animated: Option<[u32; 2]>,
) -> Result<png::Writer<W>, png::EncodingError> {
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    if let Some([pictures, plays]) = animated {
        encoder.set_animated(pictures, plays)?;
    }
    encoder.write_header()
}
