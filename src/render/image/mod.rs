//! Images on the CPU, and their PNG files.
//!
//! All images are row-major from the top: the pixel in column `x` of row `y` is at index
//! `y * width + x`, both counted from 0.

mod depth;
mod rgb;
mod segmentation;

use std::io::{self, Write};

use png::{BitDepth, ColorType, Compression, Encoder};

pub use self::depth::DepthImage;
pub use self::rgb::RgbImage;
pub use self::segmentation::{Segment, SegmentationImage};
use crate::error::{Error, Result};

/// Returns the number of pixels of an image, or `None` if the image is too large.
fn area(width: usize, height: usize) -> Option<usize> {
    // PNG files and textures have 32-bit sizes. Byte counts must fit as well, with up to eight
    // bytes per pixel.
    let is_size = |length| u32::try_from(length).is_ok();
    let area = width
        .checked_mul(height)
        .filter(|&area| area.checked_mul(8).is_some_and(|bytes| isize::try_from(bytes).is_ok()))?;
    (is_size(width) && is_size(height)).then_some(area)
}

/// Checks the length of a pixel array with `channels` elements per pixel.
fn check(what: &'static str, [width, height]: [usize; 2], channels: usize, found: usize) -> Result<()> {
    let Some(area) = area(width, height) else {
        return Err(Error::out_of_range(
            "the size of an image",
            format!("{width} x {height} pixels"),
            "small enough to fit into memory",
        ));
    };
    Error::check_length(what, found, channels * area)
}

/// Returns the index of a pixel.
#[track_caller]
fn index([width, height]: [usize; 2], x: usize, y: usize) -> usize {
    assert!(x < width && y < height, "pixel ({x}, {y}) is outside of an image of {width} x {height} pixels");
    y * width + x
}

/// Writes a PNG file with 8 bits of red, green and blue per pixel.
fn write_png_rgb8(out: &mut impl Write, size: [usize; 2], pixels: &[u8]) -> io::Result<()> {
    write_png(out, size, (ColorType::Rgb, BitDepth::Eight), pixels)
}

/// Writes a greyscale PNG file with 16 bits per pixel.
fn write_png_grey16(out: &mut impl Write, size: [usize; 2], pixels: &[u16]) -> io::Result<()> {
    let bytes: Vec<u8> = pixels.iter().flat_map(|pixel| pixel.to_be_bytes()).collect();
    write_png(out, size, (ColorType::Grayscale, BitDepth::Sixteen), &bytes)
}

/// Writes a PNG file with fast compression: the file is a third larger than with the best
/// compression, and takes a tenth of the time.
fn write_png(
    out: &mut impl Write,
    size: [usize; 2],
    (color, depth): (ColorType, BitDepth),
    bytes: &[u8],
) -> io::Result<()> {
    let [width, height] = size.map(|length| u32::try_from(length).unwrap_or(0));
    let mut encoder = Encoder::new(out, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header().map_err(io::Error::from)?;
    writer.write_image_data(bytes).map_err(io::Error::from)?;
    writer.finish().map_err(io::Error::from)
}
