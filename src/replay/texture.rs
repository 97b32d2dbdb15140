//! Textures as PNG files.

use crate::enums::TextureType;
use crate::error::{Error, Result};
use crate::id::TextureId;
use crate::model::{Model, TexturePixels};

/// Texture.
#[derive(Debug)]
pub(crate) struct Texture {
    /// Cube texture: six square images one below the other, or one for all faces.
    pub(crate) is_cube: bool,
    /// The engine's renderer converts the pixels from the sRGB colour space to linear colours.
    pub(crate) is_srgb: bool,
    pub(crate) has_alpha: bool,
    /// Mean colour of the pixels.
    pub(crate) mean: [f64; 3],
    /// PNG file.
    pub(crate) png: Vec<u8>,
}

impl Texture {
    /// # Errors
    ///
    /// [`Error::Unsupported`] for textures that the engine's renderer draws white, and errors of
    /// their files.
    pub(crate) fn new(model: &Model, id: TextureId) -> Result<Self> {
        let is_cube = model.texture(id).texture_type() != TextureType::Flat;
        let TexturePixels { width, height, channels, bytes, is_srgb } = model.texture_pixels(id)?;
        // The engine reads the pixels of cubes as three channels, and without a colour space.
        let (used, color) = match channels {
            4 if !is_cube => (4, png::ColorType::Rgba),
            3 | 4 => (3, png::ColorType::Rgb),
            _ => return Err(Error::Unsupported(format!("a texture with {channels} channels instead of 3 or 4"))),
        };
        let is_divisible = !is_cube || width == height || height == 6 * width;
        if width == 0 || height == 0 || !is_divisible {
            return Err(Error::Unsupported(format!("a texture of {width} by {height} pixels")));
        }
        let pixels = &bytes[..used * width * height];
        let mut png = Vec::new();
        let mut encoder = png::Encoder::new(&mut png, width as u32, height as u32);
        encoder.set_color(color);
        encoder.set_compression(png::Compression::High);
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels));
        written.map_err(|error| Error::Unsupported(format!("a texture that cannot be encoded: {error}")))?;
        Ok(Self {
            is_cube,
            is_srgb: is_srgb && !is_cube,
            has_alpha: used == 4,
            mean: [0, 1, 2].map(|channel| {
                let sum: f64 = pixels.iter().skip(channel).step_by(used).map(|&value| f64::from(value)).sum();
                sum / (255 * width * height) as f64
            }),
            png,
        })
    }
}
