//! Animated GIF.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use gif::{DisposalMethod, EncodingError, Frame, Repeat};

use super::RecorderOptions;
use super::encoder::{Delays, Encoder, Rectangle};
use super::palette::Palette;
use crate::error::{Error, Result};
use crate::file::Replacement;

/// Encoder of one GIF file. Every frame but the first contains only the bounding rectangle of the
/// changed pixels. Unchanged pixels inside the rectangle are transparent, which compresses well.
pub(super) struct AnimatedGif {
    file: Replacement,
    size: [u16; 2],
    plays: u16,
    /// Created with the first image, whose palette becomes the global colour table.
    gif: Option<gif::Encoder<BufWriter<File>>>,
    palette: Palette,
    /// `true` once an image has required another palette, which is then stored with every frame.
    has_local_palettes: bool,
    delays: Delays,
    /// Pixels that a viewer shows at present.
    canvas: Vec<[u8; 3]>,
    indices: Vec<u8>,
    region: Vec<u8>,
    path: PathBuf,
}

impl AnimatedGif {
    pub(super) fn new(
        path: &Path,
        file: Replacement,
        [width, height]: [u32; 2],
        options: &RecorderOptions,
    ) -> Result<Self> {
        let (Ok(width), Ok(height)) = (u16::try_from(width), u16::try_from(height)) else {
            return Err(Error::out_of_range(
                "the size of an image for a GIF",
                format!("{width} × {height}"),
                format!("at most {0} × {0}", u16::MAX),
            ));
        };
        Ok(Self {
            file,
            size: [width, height],
            plays: options.plays,
            gif: None,
            palette: Palette::default(),
            has_local_palettes: false,
            delays: Delays::new(100.0, options.frames_per_second),
            canvas: Vec::new(),
            indices: Vec::new(),
            region: Vec::new(),
            path: path.to_owned(),
        })
    }

    fn try_write(&mut self, rgb: &[u8], frames: u64) -> io::Result<()> {
        let (pixels, width) = (rgb.as_chunks::<3>().0, usize::from(self.size[0]));
        if self.gif.is_none() {
            self.palette = Palette::of(pixels, width);
            let out = BufWriter::new(self.file.file().try_clone()?);
            let mut gif = gif::Encoder::new(out, self.size[0], self.size[1], &self.palette.table()).map_err(into_io)?;
            match self.plays {
                0 => gif.set_repeat(Repeat::Infinite).map_err(into_io)?,
                1 => {}
                plays => gif.set_repeat(Repeat::Finite(plays - 1)).map_err(into_io)?,
            }
            self.gif = Some(gif);
        }
        let error = self.palette.quantise(pixels, width, &mut self.indices);
        if !self.palette.fits(error) {
            self.palette = Palette::of(pixels, width);
            self.palette.quantise(pixels, width, &mut self.indices);
            self.has_local_palettes = true;
        }
        for delay in self.delays.next(frames) {
            let (palette, indices) = (&self.palette, &self.indices);
            let (region, transparent) = if self.canvas.is_empty() {
                (Rectangle { left: 0, top: 0, width, height: self.size[1].into() }, None)
            } else {
                let differs = |pixel: usize| self.canvas[pixel] != palette.color(indices[pixel]);
                (Rectangle::bounding(width, self.size[1].into(), differs), Some(palette.transparent()))
            };
            self.canvas.resize(pixels.len(), [0; 3]);
            self.region.clear();
            for pixel in region.rows(width).flatten() {
                let color = palette.color(indices[pixel]);
                self.region.push(transparent.filter(|_| self.canvas[pixel] == color).unwrap_or(indices[pixel]));
                self.canvas[pixel] = color;
            }
            let frame = Frame {
                delay,
                dispose: DisposalMethod::Keep,
                transparent,
                left: region.left as u16,
                top: region.top as u16,
                width: region.width as u16,
                height: region.height as u16,
                palette: self.has_local_palettes.then(|| palette.table()),
                buffer: self.region.as_slice().into(),
                ..Frame::default()
            };
            self.gif.as_mut().map_or(Ok(()), |gif| gif.write_frame(&frame)).map_err(into_io)?;
        }
        Ok(())
    }

    fn try_finish(self) -> io::Result<()> {
        if let Some(gif) = self.gif {
            gif.into_inner().map_err(into_io)?.flush()?;
        }
        self.file.finish()
    }
}

impl Encoder for AnimatedGif {
    fn write(&mut self, rgb: &[u8], frames: u64) -> Result<()> {
        self.try_write(rgb, frames).map_err(Error::file(&self.path))
    }

    fn finish(self: Box<Self>) -> Result<()> {
        let path = self.path.clone();
        self.try_finish().map_err(Error::file(path))
    }
}

fn into_io(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    }
}
