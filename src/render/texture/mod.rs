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
        Faces::Flat => Level::new(width, height, rgb.as_chunks().0.iter().copied()),
        // One square for all faces.
        Faces::Cube if width == height => Level::new(width, width, (0..CUBE).flat_map(|_| rgb.as_chunks().0).copied()),
        Faces::Cube => Level::new(width, height / CUBE, rgb.as_chunks().0.iter().copied()),
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
    fn new(width: usize, height: usize, pixels: impl Iterator<Item = [u8; 3]>) -> Self {
        let rgba = pixels.flat_map(|[red, green, blue]| [red, green, blue, u8::MAX]).collect();
        Self { width: width as u32, height: height as u32, rgba }
    }

    /// The images of half the size.
    fn smaller(&self, count: usize) -> Self {
        let from = [self.width, self.height];
        let [width, height] = from.map(|length| (length / 2).max(1));
        let bytes = self.rgba.len() / count;
        let mut rgba = Vec::new();
        if bytes > 0 {
            for image in self.rgba.chunks_exact(bytes) {
                shrunk(image, from, [width, height], &mut rgba);
            }
        }
        Self { width, height, rgba }
    }
}
