//! PNG files. Fast compression: files are a third larger than the smallest, and made in a tenth of the time.

use std::io::{self, Write};

use png::{BitDepth, ColorType, Compression, Encoder};

use crate::error::{Error, Result};

/// Writes 8 bits of red, green and blue for each pixel.
pub(super) fn rgb(out: &mut impl Write, size: [usize; 2], pixels: &[u8]) -> io::Result<()> {
    write(out, size, (ColorType::Rgb, BitDepth::Eight), pixels)
}

/// Writes 16 bits of grey for each pixel.
pub(super) fn depth16(out: &mut impl Write, size: [usize; 2], pixels: &[u16]) -> io::Result<()> {
    let bytes: Vec<u8> = pixels.iter().flat_map(|pixel| pixel.to_be_bytes()).collect();
    write(out, size, (ColorType::Grayscale, BitDepth::Sixteen), &bytes)
}

fn write(
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

/// What would be in a file.
pub(super) fn to_bytes(write: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // Memory takes what it is given: it is the picture that has no file.
    write(&mut bytes).map_err(|error| Error::invalid("a picture for a PNG file", error, "one with pixels"))?;
    Ok(bytes)
}
