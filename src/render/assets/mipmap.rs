//! Mip chains of the model's textures, as four bytes per pixel.

use crate::enums::TextureType;
use crate::id::TextureId;
use crate::model::{Model, TexturePixels};

/// Number of faces of a cube texture.
const CUBE_FACES: usize = 6;

const BYTES_PER_PIXEL: usize = 4;

/// Mip chain of a texture, down to one pixel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MipChain {
    pub(crate) faces: Faces,
    /// Mip levels. Each has half the width and height of the previous level, rounded down. Empty if
    /// the texture has no pixels that the engine's renderer draws: it is then white.
    pub(crate) levels: Vec<MipLevel>,
    /// The pixels are in the sRGB colour space, and are converted to linear colours when they are
    /// sampled.
    pub(crate) is_srgb: bool,
}

/// Array layers of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Faces {
    /// One layer of a 2D texture.
    D2,
    /// Six layers of a cube texture, in the order +x, -x, +y, -y, +z, -z of the graphics APIs.
    Cube,
}

impl Faces {
    /// Returns the number of layers.
    pub(crate) fn count(self) -> usize {
        match self {
            Self::D2 => 1,
            Self::Cube => CUBE_FACES,
        }
    }
}

/// Mip level with all its layers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MipLevel {
    /// Width of each layer, pixels; at least 1.
    pub(crate) width: u32,
    /// Height of each layer, pixels; at least 1.
    pub(crate) height: u32,
    /// Layers one after the other, each row-major: red, green, blue and opacity.
    pub(crate) rgba: Vec<u8>,
}

impl MipChain {
    /// Computes the mip chain of a texture. Levels with a width or height above `limit` are
    /// omitted. Textures that the engine's renderer does not draw, and files that cannot be read,
    /// are logged.
    pub(crate) fn new(model: &Model, id: TextureId, limit: u32) -> Self {
        let faces = if model.texture(id).texture_type() == TextureType::Flat { Faces::D2 } else { Faces::Cube };
        let white = Self { faces, levels: Vec::new(), is_srgb: false };
        let texture = match model.texture_pixels(id) {
            Ok(texture) => texture,
            Err(error) => {
                log::warn!("texture {} is drawn white: {error}", model.texture(id).name().unwrap_or("without a name"));
                return white;
            }
        };
        let TexturePixels { width, height, channels, bytes, is_srgb } = texture;
        if !matches!(channels, 3 | 4) {
            log::warn!(
                "texture {} is drawn white, as by the engine: it has {channels} channels instead of 3 or 4",
                model.texture(id).name().unwrap_or("without a name")
            );
            return white;
        }
        // The engine reads the pixels of cubes as three channels, and without a colour space.
        let channels = if faces == Faces::D2 { channels } else { 3 };
        let bytes = &bytes[..channels * width * height];
        let first = match faces {
            Faces::D2 => MipLevel::new(width, height, channels, &[bytes]),
            // A square image is repeated on all faces.
            Faces::Cube if width == height => MipLevel::new(width, width, channels, &[bytes; CUBE_FACES]),
            Faces::Cube => MipLevel::new(width, height / CUBE_FACES, channels, &[bytes]),
        };
        let mut levels = vec![first];
        while let Some(last) = levels.last()
            && (last.width > 1 || last.height > 1)
        {
            let half = last.half_size(faces.count());
            // All levels so far exceed the limit.
            if last.width.max(last.height) > limit {
                levels.clear();
            }
            levels.push(half);
        }
        Self { levels, is_srgb: is_srgb && faces == Faces::D2, ..white }
    }
}

impl MipLevel {
    /// Creates a level from images with three or four channels.
    fn new(width: usize, height: usize, channels: usize, images: &[&[u8]]) -> Self {
        let mut rgba = Vec::with_capacity(BYTES_PER_PIXEL * width * height * images.len());
        for image in images {
            if channels == BYTES_PER_PIXEL {
                rgba.extend_from_slice(image);
                continue;
            }
            for [red, green, blue] in image.as_chunks().0 {
                rgba.extend_from_slice(&[*red, *green, *blue, u8::MAX]);
            }
        }
        Self { width: width as u32, height: height as u32, rgba }
    }

    /// Computes the next mip level.
    fn half_size(&self, layers: usize) -> Self {
        let from = [self.width, self.height];
        let [width, height] = from.map(|length| (length / 2).max(1));
        let bytes = self.rgba.len() / layers;
        let mut rgba = Vec::with_capacity(layers * BYTES_PER_PIXEL * (width * height) as usize);
        if bytes > 0 {
            for image in self.rgba.chunks_exact(bytes) {
                resample(image, from, [width, height], &mut rgba);
            }
        }
        Self { width, height, rgba }
    }
}

/// Resamples an image with bilinear interpolation at the pixel centres and appends it to `out`.
///
/// For even lengths each pixel is the mean of 2 × 2 pixels. For odd lengths a 2 × 2 box filter
/// would drop the last row or column, and with it a line of one pixel.
fn resample(image: &[u8], from: [u32; 2], to: [u32; 2], out: &mut Vec<u8>) {
    let columns: Vec<Taps> = (0..to[0]).map(|column| Taps::new(column, from[0], to[0])).collect();
    let width = from[0] as usize * BYTES_PER_PIXEL;
    for row in 0..to[1] {
        let Taps { low, high, weight } = Taps::new(row, from[1], to[1]);
        let (above, below) = (&image[low * width..][..width], &image[high * width..][..width]);
        for column in &columns {
            for channel in 0..BYTES_PER_PIXEL {
                let [left, right] = [column.low, column.high].map(|column| {
                    let at = column * BYTES_PER_PIXEL + channel;
                    mix(f32::from(above[at]), f32::from(below[at]), weight)
                });
                // A mean of bytes does not exceed a byte.
                out.push((mix(left, right, column.weight) + 0.5) as u8);
            }
        }
    }
}

/// Taps of the interpolation: two adjacent source pixels, and the weight of the second.
struct Taps {
    low: usize,
    high: usize,
    weight: f32,
}

impl Taps {
    /// Returns the source pixels around the centre of a destination pixel.
    fn new(pixel: u32, from: u32, to: u32) -> Self {
        let last = f64::from(from - 1);
        let position = ((f64::from(pixel) + 0.5) * f64::from(from) / f64::from(to) - 0.5).clamp(0.0, last);
        let low = position.floor();
        Self { low: low as usize, high: (low + 1.0).min(last) as usize, weight: (position - low) as f32 }
    }
}

fn mix(a: f32, b: f32, weight: f32) -> f32 {
    a + (b - a) * weight
}

#[cfg(test)]
mod tests {
    use super::{Faces, MipChain, MipLevel, resample};
    use crate::render::RgbImage;
    use crate::{LoadOptions, Model};

    fn model() -> Model {
        let mut picture = RgbImage::new(4, 4);
        for (index, byte) in picture.as_bytes_mut().iter_mut().enumerate() {
            *byte = index as u8;
        }
        let file = picture.to_png().unwrap();
        Model::from_xml_str_with(
            "<mujoco><asset>
               <texture name='flat' type='2d' builtin='checker' mark='cross' width='127' height='30' rgb1='1 0 0' rgb2='0 0 1'/>
               <texture name='sky' type='skybox' builtin='gradient' width='16' height='96' rgb1='1 1 1' rgb2='0 0 0'/>
               <texture name='cube' type='cube' file='square.png'/>
             </asset></mujoco>", &LoadOptions::default().with_files(&[("square.png", file.as_slice())]))
        .unwrap()
    }

    fn chain(model: &Model, name: &str, limit: u32) -> MipChain {
        MipChain::new(model, model.texture(name).unwrap().id(), limit)
    }

    fn sizes(chain: &MipChain) -> Vec<[u32; 2]> {
        chain.levels.iter().map(|level| [level.width, level.height]).collect()
    }

    fn bytes(level: &MipLevel, faces: Faces) -> usize {
        faces.count() * 4 * (level.width * level.height) as usize
    }

    fn mean(level: &MipLevel, channel: usize) -> f64 {
        let pixels = level.rgba.as_chunks::<4>().0;
        pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / pixels.len() as f64
    }

    #[test]
    fn first_level_is_the_texture_and_last_level_is_one_pixel() {
        let model = model();
        let flat = chain(&model, "flat", 8192);
        assert_eq!(flat.faces, Faces::D2);
        assert_eq!(sizes(&flat), [[127, 30], [63, 15], [31, 7], [15, 3], [7, 1], [3, 1], [1, 1]]);
        let rgb: Vec<u8> = flat.levels[0]
            .rgba
            .as_chunks::<4>()
            .0
            .iter()
            .flat_map(|[red, green, blue, _]| [*red, *green, *blue])
            .collect();
        assert_eq!(rgb, model.texture("flat").unwrap().rgb());
        for name in ["flat", "sky", "cube"] {
            let chain = chain(&model, name, 8192);
            for level in &chain.levels {
                assert_eq!(level.rgba.len(), bytes(level, chain.faces), "{name}");
                assert!(level.rgba.iter().skip(3).step_by(4).all(|&alpha| alpha == 255));
            }
        }
    }

    #[test]
    fn cube_texture_has_six_images_or_repeats_one() {
        let model = model();
        let sky = chain(&model, "sky", 8192);
        assert_eq!((sky.faces, sizes(&sky)), (Faces::Cube, vec![[16, 16], [8, 8], [4, 4], [2, 2], [1, 1]]));
        let rgba = &sky.levels[0].rgba;
        // The gradient runs from the zenith, the third face, to the ground, the fourth face.
        let face = |index: usize| &rgba[index * 4 * 16 * 16..][..4 * 16 * 16];
        assert_ne!(face(2), face(3));
        let cube = chain(&model, "cube", 8192);
        assert_eq!((cube.faces, sizes(&cube)), (Faces::Cube, vec![[4, 4], [2, 2], [1, 1]]));
        for level in &cube.levels {
            let (first, rest) = level.rgba.split_at(level.rgba.len() / 6);
            assert!(rest.chunks_exact(first.len()).all(|face| face == first));
        }
    }

    #[test]
    fn mip_levels_have_the_same_mean() {
        let model = model();
        for (name, halved) in [("sky", 5), ("cube", 3)] {
            let chain = chain(&model, name, 8192);
            assert_eq!(chain.levels.len(), halved);
            for pair in chain.levels.windows(2) {
                for channel in 0..3 {
                    // The rounding error of each byte is at most 0.5.
                    assert!((mean(&pair[0], channel) - mean(&pair[1], channel)).abs() <= 0.5, "{name}");
                }
            }
        }
    }

    #[test]
    fn levels_above_the_limit_are_omitted() {
        let model = model();
        let all = chain(&model, "flat", 127);
        assert_eq!(all.levels.len(), 7);
        assert_eq!(chain(&model, "flat", 126).levels, all.levels[1..]);
        assert_eq!(chain(&model, "flat", 7).levels, all.levels[4..]);
        assert_eq!(chain(&model, "flat", 0).levels, all.levels[6..], "the level of one pixel always remains");
    }

    #[test]
    fn mip_chain_contains_edited_bytes() {
        let mut model = model();
        model.edit().texture_mut("cube").unwrap().rgb_mut().fill(7);
        for level in chain(&model, "cube", 8192).levels {
            assert!(level.rgba.as_chunks().0.iter().all(|pixel| *pixel == [7, 7, 7, 255]));
        }
    }

    fn grey(pixels: &[u8]) -> Vec<u8> {
        pixels.iter().flat_map(|&pixel| [pixel; 4]).collect()
    }

    #[test]
    fn even_lengths_are_halved_by_means_of_four_pixels() {
        let mut out = Vec::new();
        resample(&grey(&[0, 100, 8, 8, 50, 50, 0, 0]), [4, 2], [2, 1], &mut out);
        assert_eq!(out, grey(&[50, 4]));
    }

    #[test]
    fn odd_lengths_keep_the_last_line() {
        // Length 3 to 1: the centre pixel. Length 5 to 2: samples at 0.75 and 3.25.
        let mut out = Vec::new();
        resample(&grey(&[10, 20, 90]), [3, 1], [1, 1], &mut out);
        assert_eq!(out, grey(&[20]));
        out.clear();
        resample(&grey(&[0, 0, 0, 0, 200]), [5, 1], [2, 1], &mut out);
        assert_eq!(out, grey(&[0, 50]));
    }

    #[test]
    fn constant_colours_are_preserved() {
        for length in 1..40_u32 {
            for level in [0, 1, 127, 255] {
                let mut out = Vec::new();
                let half = (length / 2).max(1);
                resample(&grey(&vec![level; length as usize]), [length, 1], [half, 1], &mut out);
                assert_eq!(out, grey(&vec![level; half as usize]));
            }
        }
    }
}
