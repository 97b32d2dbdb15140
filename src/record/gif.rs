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

/// One file, in which every picture but the first is the part that has changed. What stays in it is transparent, which packs well.
pub(super) struct AnimatedGif {
    file: Replacement,
    size: [u16; 2],
    plays: u16,
    /// Begun with the first picture, whose palette is that of the file.
    gif: Option<gif::Encoder<BufWriter<File>>>,
    palette: Palette,
    /// Pictures since have a palette of their own.
    repainted: bool,
    delays: Delays,
    /// What a viewer shows at the moment.
    screen: Vec<[u8; 3]>,
    indices: Vec<u8>,
    part: Vec<u8>,
    path: PathBuf,
}

impl AnimatedGif {
    /// Delays are in hundredths of a second, and viewers take one of less than two for ten.
    pub(super) const MOST_FRAMES_PER_SECOND: f64 = 50.0;

    pub(super) fn new(
        path: &Path,
        file: Replacement,
        [width, height]: [u32; 2],
        options: &RecorderOptions,
    ) -> Result<Self> {
        let (Ok(width), Ok(height)) = (u16::try_from(width), u16::try_from(height)) else {
            return Err(Error::invalid(
                "the size of a picture for a GIF",
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
            repainted: false,
            delays: Delays::new(100.0, options.frames_per_second),
            screen: Vec::new(),
            indices: Vec::new(),
            part: Vec::new(),
            path: path.to_owned(),
        })
    }

    fn try_picture(&mut self, rgb: &[u8], shown: u64) -> io::Result<()> {
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
        let error = self.palette.paint(pixels, width, &mut self.indices);
        if !self.palette.suits(error) {
            self.palette = Palette::of(pixels, width);
            self.palette.paint(pixels, width, &mut self.indices);
            self.repainted = true;
        }
        for delay in self.delays.next(shown) {
            let (palette, indices) = (&self.palette, &self.indices);
            let (part, transparent) = if self.screen.is_empty() {
                (Rectangle { left: 0, top: 0, width, height: self.size[1].into() }, None)
            } else {
                let differs = |pixel: usize| self.screen[pixel] != palette.color(indices[pixel]);
                (Rectangle::of_changes(width, self.size[1].into(), differs), Some(palette.transparent()))
            };
            self.screen.resize(pixels.len(), [0; 3]);
            self.part.clear();
            for pixel in part.rows(width).flatten() {
                let color = palette.color(indices[pixel]);
                self.part.push(transparent.filter(|_| self.screen[pixel] == color).unwrap_or(indices[pixel]));
                self.screen[pixel] = color;
            }
            let frame = Frame {
                delay,
                dispose: DisposalMethod::Keep,
                transparent,
                left: part.left as u16,
                top: part.top as u16,
                width: part.width as u16,
                height: part.height as u16,
                palette: self.repainted.then(|| palette.table()),
                buffer: self.part.as_slice().into(),
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
    fn picture(&mut self, rgb: &[u8], shown: u64) -> Result<()> {
        self.try_picture(rgb, shown).map_err(Error::file(&self.path))
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
