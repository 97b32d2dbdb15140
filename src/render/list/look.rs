//! Colour, material and picture of a geom.

use super::instance::{Instance, Kind};
use super::primitive::Part;
use super::{Numbers, Scenery, ids};
use crate::render::settings::is_drawable;
use crate::render::shader::Coat;
use crate::scene::{SceneGeom, SceneGeomType};

/// Takes the place of the last number that a texture is spread by, where the corners have coordinates of their own; `surface.wgsl` has the
/// same. No geom is so large.
const GLUED: f32 = f32::MIN;

/// What a geom looks like, whatever its shape.
pub(super) struct Look {
    rgba: [f32; 4],
    material: [f32; 4],
    coat: Coat,
    texture: u32,
    /// By what the coordinates of the shape are multiplied for the texture; of a flat one the last is 0, or `GLUED`.
    texgen: [f32; 3],
    id: u32,
}

pub(super) fn look(index: usize, geom: SceneGeom<'_>, scenery: &Scenery<'_>, is_behind: bool) -> Look {
    let id = index as u32 + 1;
    let plain = |rgba| Look { rgba, material: [0.0; 4], coat: Coat::Plain, texture: 0, texgen: [1.0; 3], id };
    match scenery.numbers {
        Some(Numbers::Colors) => return plain(ids::color(geom.segid())),
        Some(Numbers::IdColors) => return plain(ids::id_color(geom.segid())),
        Some(Numbers::Ids | Numbers::Depths) => return plain([1.0; 4]),
        None => {}
    }
    let [red, green, blue, alpha] = geom.rgba().map(|number| limited(number, 1e3));
    let alpha = if is_behind && geom.geom_type() == SceneGeomType::Plane { 0.3 * alpha } else { alpha };
    let mut look = plain([red, green, blue, alpha.clamp(0.0, 1.0)]);
    // OpenGL allows no larger exponent.
    let shininess = limited(128.0 * geom.shininess(), 128.0).max(0.0);
    look.material = [limited(geom.emission(), 1e3), limited(geom.specular(), 1e3), shininess, 0.0];
    if let Some(texture) = geom.texture() {
        look.cover(texture.index(), geom, scenery);
    }
    look
}

impl Look {
    fn cover(&mut self, texture: usize, geom: SceneGeom<'_>, scenery: &Scenery<'_>) {
        let coat = scenery.textures.coat(texture);
        // What is glued on by coordinates is flat; another texture cannot be.
        if geom.texcoord() && coat != Coat::Flat {
            return;
        }
        (self.coat, self.texture) = (coat, texture as u32);
        if geom.texcoord() {
            self.texgen = [0.0, 0.0, GLUED];
            return;
        }
        let (size, repeat) = (geom.size(), geom.texrepeat());
        let is_measured = geom.mesh().is_some() || geom.height_field().is_some() || geom.plane().is_some();
        self.texgen = match coat {
            Coat::Plain => [0.0; 3],
            Coat::Flat => {
                let mut scale = repeat;
                for axis in 0..2 {
                    // Coordinates of the model's own shapes are metres already.
                    if is_measured && size[axis] > 0.0 {
                        scale[axis] /= size[axis].max(1e-15);
                    }
                    if geom.texuniform() && size[axis] > 0.0 {
                        scale[axis] *= size[axis];
                    }
                }
                [0.5 * scale[0], -0.5 * scale[1], 0.0]
            }
            Coat::Cube if geom.texuniform() => size,
            Coat::Cube => [1.0; 3],
        }
        .map(|scale| if is_drawable(scale) { scale } else { 0.0 });
    }

    /// An instance of a part.
    pub(super) fn of(&self, geom: SceneGeom<'_>, part: &Part, line: bool, back: bool) -> (Kind, Instance) {
        let (pos, mat) = (geom.pos(), geom.mat());
        // A skin is in the world's frame.
        let is_skin = geom.geom_type() == SceneGeomType::Skin;
        let rows = [0, 1, 2].map(|row| {
            if is_skin {
                let mut own = [0.0; 4];
                own[row] = 1.0;
                return own;
            }
            let [x, y, z] = [mat[3 * row], mat[3 * row + 1], mat[3 * row + 2]];
            [x * part.scale[0], y * part.scale[1], z * part.scale[2], pos[row] + z * part.shift]
        });
        let [u, v, w] = [0, 1, 2].map(|axis| self.texgen[axis] * part.wrap[axis]);
        let texgen = match self.coat {
            Coat::Plain => [0.0; 4],
            Coat::Flat => [u, v, 0.0, self.texgen[2]],
            Coat::Cube => [u, v, w, self.texgen[2] * part.lift],
        }
        .map(|number| if number.is_finite() { number } else { 0.0 });
        let kind = Kind { shape: part.shape, coat: self.coat, texture: self.texture, line, back };
        (kind, Instance { rows, rgba: self.rgba, material: self.material, texgen, id: self.id })
    }
}

/// A number within limits; 0 for one that is none.
fn limited(number: f32, limit: f32) -> f32 {
    if number.is_nan() { 0.0 } else { number.clamp(-limit, limit) }
}
