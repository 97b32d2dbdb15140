//! The textures of a model as a graphics card takes them: four bytes for each pixel, and smaller and smaller copies of each image
//! for surfaces that are far away.
//!
//! | file | what is in it |
//! |---|---|
//! | `shrink.rs` | an image of half the size |

mod shrink;

use self::shrink::shrunk;
use crate::enums::TextureType;
use crate::id::TextureId;
use crate::model::Model;

/// How many faces a cube has.
const CUBE: usize = 6;

/// A texture: its images, from the largest to that of one pixel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Images {
    pub(crate) faces: Faces,
    /// Each half as wide and half as high as the one before, rounded down.
    pub(crate) levels: Vec<Level>,
}

/// What the images are put onto.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Faces {
    /// One image.
    Flat,
    /// The six faces of a cube, in the order +x, -x, +y, -y, +z, -z of the graphics card.
    Cube,
}

impl Faces {
    /// How many images there are of each size.
    pub(crate) fn count(self) -> usize {
        match self {
            Self::Flat => 1,
            Self::Cube => CUBE,
        }
    }
}

/// The images of one size, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Level {
    /// Width of each image, pixels; at least 1.
    pub(crate) width: u32,
    /// Height of each image, pixels; at least 1.
    pub(crate) height: u32,
    /// Row by row: red, green, blue, and 255 for opaque.
    pub(crate) rgba: Vec<u8>,
}

/// The images of a texture, none wider or higher than `limit`: of one that is larger, the first that is not is the first here.
pub(crate) fn images(model: &Model, id: TextureId, limit: u32) -> Images {
    let texture = model.texture(id);
    let (width, height, rgb) = (texture.width(), texture.height(), texture.rgb());
    let faces = if texture.texture_type() == TextureType::Flat { Faces::Flat } else { Faces::Cube };
    let first = match faces {
        Faces::Flat => Level::new(width, height, &[rgb]),
        // One square for all faces.
        Faces::Cube if width == height => Level::new(width, width, &[rgb; CUBE]),
        Faces::Cube => Level::new(width, height / CUBE, &[rgb]),
    };
    let mut levels = vec![first];
    while let Some(last) = levels.last()
        && (last.width > 1 || last.height > 1)
    {
        let smaller = last.smaller(faces.count());
        // The larger one has served.
        if last.width.max(last.height) > limit {
            levels.clear();
        }
        levels.push(smaller);
    }
    Images { faces, levels }
}

impl Level {
    fn new(width: usize, height: usize, images: &[&[u8]]) -> Self {
        let mut rgba = Vec::with_capacity(4 * width * height * images.len());
        for [red, green, blue] in images.iter().flat_map(|image| image.as_chunks().0) {
            rgba.extend_from_slice(&[*red, *green, *blue, u8::MAX]);
        }
        Self { width: width as u32, height: height as u32, rgba }
    }

    /// The images of half the size.
    fn smaller(&self, count: usize) -> Self {
        let from = [self.width, self.height];
        let [width, height] = from.map(|length| (length / 2).max(1));
        let bytes = self.rgba.len() / count;
        let mut rgba = Vec::with_capacity(count * 4 * (width * height) as usize);
        if bytes > 0 {
            for image in self.rgba.chunks_exact(bytes) {
                shrunk(image, from, [width, height], &mut rgba);
            }
        }
        Self { width, height, rgba }
    }
}

#[cfg(test)]
mod tests {
    use super::{Faces, Images, Level, images};
    use crate::render::Picture;
    use crate::{LoadOptions, Model};

    fn model() -> Model {
        let mut picture = Picture::new(4, 4);
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

    fn of(model: &Model, name: &str, limit: u32) -> Images {
        images(model, model.texture(name).unwrap().id(), limit)
    }

    fn sizes(images: &Images) -> Vec<[u32; 2]> {
        images.levels.iter().map(|level| [level.width, level.height]).collect()
    }

    fn bytes(level: &Level, faces: Faces) -> usize {
        faces.count() * 4 * (level.width * level.height) as usize
    }

    fn mean(level: &Level, channel: usize) -> f64 {
        let pixels = level.rgba.as_chunks::<4>().0;
        pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / pixels.len() as f64
    }

    #[test]
    fn the_first_level_is_the_texture_and_the_last_is_one_pixel() {
        let model = model();
        let flat = of(&model, "flat", 8192);
        assert_eq!(flat.faces, Faces::Flat);
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
            let images = of(&model, name, 8192);
            for level in &images.levels {
                assert_eq!(level.rgba.len(), bytes(level, images.faces), "{name}");
                assert!(level.rgba.iter().skip(3).step_by(4).all(|&alpha| alpha == 255));
            }
        }
    }

    #[test]
    fn a_cube_has_six_faces_or_one_six_times() {
        let model = model();
        let sky = of(&model, "sky", 8192);
        assert_eq!((sky.faces, sizes(&sky)), (Faces::Cube, vec![[16, 16], [8, 8], [4, 4], [2, 2], [1, 1]]));
        let rgba = &sky.levels[0].rgba;
        // The fourth face is the ground, the third the zenith: the gradient ends there.
        let face = |index: usize| &rgba[index * 4 * 16 * 16..][..4 * 16 * 16];
        assert_ne!(face(2), face(3));
        let cube = of(&model, "cube", 8192);
        assert_eq!((cube.faces, sizes(&cube)), (Faces::Cube, vec![[4, 4], [2, 2], [1, 1]]));
        for level in &cube.levels {
            let (first, rest) = level.rgba.split_at(level.rgba.len() / 6);
            assert!(rest.chunks_exact(first.len()).all(|face| face == first));
        }
    }

    #[test]
    fn smaller_levels_have_the_same_mean() {
        let model = model();
        for (name, halved) in [("sky", 5), ("cube", 3)] {
            let images = of(&model, name, 8192);
            assert_eq!(images.levels.len(), halved);
            for pair in images.levels.windows(2) {
                for channel in 0..3 {
                    // Each byte is rounded by half a step at most.
                    assert!((mean(&pair[0], channel) - mean(&pair[1], channel)).abs() <= 0.5, "{name}");
                }
            }
        }
    }

    #[test]
    fn what_is_too_large_begins_with_a_smaller_level() {
        let model = model();
        let all = of(&model, "flat", 127);
        assert_eq!(all.levels.len(), 7);
        assert_eq!(of(&model, "flat", 126).levels, all.levels[1..]);
        assert_eq!(of(&model, "flat", 7).levels, all.levels[4..]);
        assert_eq!(of(&model, "flat", 0).levels, all.levels[6..], "one pixel is always left");
    }

    #[test]
    fn bytes_that_were_edited_are_seen() {
        let mut model = model();
        model.edit().texture_mut("cube").unwrap().rgb_mut().fill(7);
        for level in of(&model, "cube", 8192).levels {
            assert!(level.rgba.as_chunks().0.iter().all(|pixel| *pixel == [7, 7, 7, 255]));
        }
    }
}
