//! Textures as PNG files, and their mapping to geoms.
//!
//! Engines before 3.12 project a 2D texture along z on every shape without texture coordinates of
//! its own. From 3.12 on, planes have their texture in a corner, and the number of repetitions
//! applies to all texture coordinates. The page projects textures on other shapes for all engines.

use serde::Serialize;

use crate::enums::TextureType;
use crate::error::{Error, Result};
use crate::id::TextureId;
use crate::model::{Model, TexturePixels};
use crate::scene::{SceneGeom, SceneGeomType};

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

/// The engine repeats texture coordinates, and places textures in the corners of planes.
const REPEATS_TEXCOORDS: bool = cfg!(engine_since = "3.12.0");

/// Mapping from local positions, m, or from the texture coordinates of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct TextureMap {
    /// The coordinates are those of the mesh instead of the local position.
    pub(crate) explicit: bool,
    /// Factors of the coordinates.
    pub(crate) scale: [f32; 3],
    /// Added to the product.
    pub(crate) offset: [f32; 2],
}

impl TextureMap {
    pub(crate) fn new(geom: SceneGeom<'_>, is_cube: bool) -> Self {
        let (size, repeat) = (geom.size(), geom.texrepeat());
        let is_in_metres = geom.mesh().is_some() || geom.height_field().is_some();
        let reciprocal = |length: f32| if length > 0.0 { length.recip() } else { 1.0 };
        let explicit = geom.texcoord() && !is_cube;
        let repetitions = [0, 1].map(|axis| {
            let count = if repeat[axis] > 0.0 { repeat[axis] } else { 1.0 };
            if geom.texuniform() && size[axis] > 0.0 { count * size[axis] } else { count }
        });
        let (scale, offset) = if is_cube {
            // The direction of the position, of which only the ratios matter.
            let scale = match (is_in_metres, geom.texuniform()) {
                (false, true) | (true, false) => [1.0; 3],
                (false, false) => size.map(reciprocal),
                (true, true) => size,
            };
            (scale, [0.0; 2])
        } else if explicit {
            let [x, y] = if REPEATS_TEXCOORDS { repetitions } else { [1.0; 2] };
            ([x, y, 0.0], [0.0; 2])
        } else if REPEATS_TEXCOORDS && geom.geom_type() == SceneGeomType::Plane {
            let shift = if size[..2].iter().any(|&length| length <= 0.0) { -0.5 } else { 0.0 };
            let [x, y] = [0, 1].map(|axis| 0.5 * repetitions[axis] * reciprocal(size[axis]));
            let offset = |axis: usize| if size[axis] > 0.0 { 0.5 * repetitions[axis] + shift } else { shift };
            ([x, -y, 0.0], [offset(0), offset(1)])
        } else {
            let [x, y] = [0, 1].map(|axis| {
                let per_metre = if geom.texuniform() { 1.0 } else { reciprocal(size[axis]) };
                0.5 * repeat[axis] * per_metre
            });
            ([x, -y, 0.0], [-0.5; 2])
        };
        let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
        Self { explicit, scale: scale.map(finite), offset: offset.map(finite) }
    }
}
