//! Generation of triangle meshes on the CPU: unit shapes, and the model's meshes, convex hulls,
//! height fields and skins, each in its local frame; flexes in the world frame.
//!
//! All values of [`Triangles`] are finite, even if the model contains NaN or infinity: triangles
//! with a non-finite vertex are skipped.

mod coarse;
mod flat;
mod flex;
mod height_field;
mod mesh;
mod revolution;
#[cfg(feature = "html")]
mod simplify;
#[cfg(feature = "gltf")]
mod skinned;
#[cfg(feature = "gltf")]
mod solid;
#[cfg(test)]
mod test_support;

pub(crate) use self::coarse::{MESH_LEVELS, coarse_levels};
pub(crate) use self::flat::{blocks, cuboid, longest_block, plane, plane_with_lines, triangle, uniform_lines};
pub(crate) use self::flex::{flex_faces, flex_skeleton};
pub(crate) use self::height_field::height_field;
pub(crate) use self::mesh::{SkinTopology, hull, mesh, skin};
pub(crate) use self::revolution::{cone, cylinder, disk, hemisphere, sphere};
#[cfg(feature = "html")]
pub(crate) use self::simplify::simplified;
#[cfg(feature = "gltf")]
pub(crate) use self::skinned::Skinned;
#[cfg(feature = "gltf")]
pub(crate) use self::solid::tube;
use crate::error::{Error, Result};
use crate::model::Model;

/// Vertex in the vertex buffer.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "renderer", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub(crate) struct Vertex {
    pub(crate) position: [f32; 3],
    /// Unit normal.
    pub(crate) normal: [f32; 3],
    /// Texture coordinates of the asset, or of a unit shape as in the engine from 3.12.
    pub(crate) texcoord: [f32; 2],
    /// Position in a grid of quadrilaterals: see [`Triangles::set_parity`].
    pub(crate) parity: f32,
}

/// Indexed triangle list. Front faces are counterclockwise.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Triangles {
    pub(crate) vertices: Vec<Vertex>,
    pub(crate) indices: Vec<u32>,
    /// The list contains quadrilaterals. Wireframe mode omits their diagonals.
    pub(crate) has_quads: bool,
}

impl Triangles {
    /// Appends a vertex and returns its index.
    fn vertex(&mut self, position: [f32; 3], normal: [f32; 3], texcoord: [f32; 2]) -> u32 {
        self.vertices.push(Vertex { position, normal, texcoord, parity: 0.0 });
        self.vertices.len() as u32 - 1
    }

    /// Appends a quadrilateral with counterclockwise vertices. The diagonal connects the second and
    /// the fourth vertex, as in the engine's renderer: the diagonal is visible with per-vertex
    /// lighting.
    fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.has_quads = true;
        self.indices.extend([a, b, d, b, c, d]);
    }

    /// Marks a vertex of a grid of quadrilaterals, with -1 and 1 as the colours of a chessboard.
    /// Both ends of a diagonal have the same parity, and the ends of an edge different ones.
    fn set_parity(&mut self, vertex: u32, [row, column]: [u32; 2]) {
        self.vertices[vertex as usize].parity = if (row + column).is_multiple_of(2) { 1.0 } else { -1.0 };
    }

    /// Appends a flat-shaded triangle, which shares no vertex with others. Skips a non-finite
    /// triangle.
    fn flat(&mut self, positions: [[f32; 3]; 3], texcoords: [[f32; 2]; 3]) {
        let Some(normal) = face_normal(positions) else { return };
        for (position, texcoord) in positions.into_iter().zip(texcoords) {
            self.indices.push(self.vertices.len() as u32);
            self.vertices.push(Vertex { position, normal, texcoord: texcoord.map(finite_or_zero), parity: 0.0 });
        }
    }

    /// Returns an error if the number of vertices of `what` exceeds the limit of the vertex buffer.
    fn check_size(what: impl FnOnce() -> String, vertices: usize, max_vertices: usize) -> Result<()> {
        if vertices <= max_vertices.min(u32::MAX as usize) {
            return Ok(());
        }
        Err(Error::Unsupported(format!(
            "{} has {vertices} vertices to render, but the limit of the vertex buffer is {max_vertices}",
            what()
        )))
    }
}

/// Tessellation of the unit shapes. Finer tessellation is rounder and slower to render.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Tessellation {
    /// Subdivisions around the axis of a round shape: at least 3.
    pub(crate) slices: u32,
    /// Subdivisions along the axis: at least 2.
    pub(crate) stacks: u32,
    /// Subdivisions along each edge of a flat shape: at least 1.
    pub(crate) quads: u32,
}

impl Tessellation {
    /// Upper limit of all subdivisions. The edges of 256 slices are within 0.0001 radii of the
    /// circle, which is invisible.
    pub(crate) const MAX: u32 = 256;

    /// Creates a tessellation, clamped to the valid range.
    pub(crate) fn new(slices: usize, stacks: usize, quads: usize) -> Self {
        let clamp = |count: usize, least: u32| (count.min(Self::MAX as usize) as u32).max(least);
        Self { slices: clamp(slices, 3), stacks: clamp(stacks, 2), quads: clamp(quads, 1) }
    }

    /// Reads the model's `visual/quality` settings. The engine's compiler accepts any value for
    /// them.
    pub(crate) fn of_model(model: &Model) -> Self {
        let quality = model.visual().quality;
        Self::new(quality.numslices, quality.numstacks, quality.numquads)
    }

    /// Limits the slices and the stacks, for shapes that are small on the screen.
    pub(crate) fn limited(self, slices: u32, stacks: u32) -> Self {
        Self { slices: self.slices.min(slices), stacks: self.stacks.min(stacks), ..self }
    }

    /// Returns the largest distance between a circle and the edges of its regular polygon, in
    /// radii: `1 - cos(π / slices)`. A sphere is subdivided in two directions, whose errors add up.
    pub(crate) fn chord_error(slices_per_circle: u32) -> f64 {
        1.0 - (std::f64::consts::PI / f64::from(slices_per_circle)).cos()
    }
}

/// Returns the unit normal of a triangle: the z-axis for a degenerate triangle, `None` for a
/// non-finite one.
fn face_normal(positions: [[f32; 3]; 3]) -> Option<[f32; 3]> {
    if !positions.as_flattened().iter().all(|coordinate| coordinate.is_finite()) {
        return None;
    }
    // Double precision: products of large and of small edges neither overflow nor underflow.
    let edge = |to: usize| [0, 1, 2].map(|axis| f64::from(positions[to][axis]) - f64::from(positions[0][axis]));
    let (u, v) = (edge(1), edge(2));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = normal.iter().map(|component| component * component).sum::<f64>().sqrt();
    Some(if length > 0.0 && length.is_finite() {
        normal.map(|component| (component / length) as f32)
    } else {
        [0.0, 0.0, 1.0]
    })
}

pub(crate) fn finite_or_zero(number: f32) -> f32 {
    if number.is_finite() { number } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::Tessellation;

    #[test]
    fn subdivisions_are_clamped() {
        assert_eq!(Tessellation::new(0, 0, 0), Tessellation { slices: 3, stacks: 2, quads: 1 });
        let max = Tessellation::MAX;
        assert_eq!(Tessellation::new(usize::MAX, 1 << 32, 1000), Tessellation { slices: max, stacks: max, quads: max });
        assert_eq!(Tessellation::new(28, 16, 4), Tessellation { slices: 28, stacks: 16, quads: 4 });
    }

    #[test]
    fn parities_of_a_quadrilateral_differ_along_its_edges_only() {
        let tessellation = Tessellation::new(28, 16, 4);
        for triangles in [
            super::plane(5),
            super::cuboid(3),
            super::sphere(tessellation),
            super::hemisphere(tessellation),
            super::cylinder(28, 3),
            super::disk(28, 3),
            super::cone(28, 3),
        ] {
            assert!(triangles.has_quads);
            let parity = |index: u32| triangles.vertices[index as usize].parity;
            let mut diagonals = 0;
            for [a, b, c] in triangles.indices.as_chunks::<3>().0 {
                let edges = [[a, b], [b, c], [c, a]].map(|ends| ends.map(|&index| parity(index)));
                let equal = edges.iter().filter(|[one, other]| one == other).count();
                // A triangle at a pole, whose parity is zero, has no diagonal.
                let has_pole = edges.iter().any(|[one, _]| *one == 0.0);
                assert_eq!(equal, usize::from(!has_pole), "{edges:?}");
                diagonals += equal;
            }
            assert!(diagonals > 0);
        }
    }

    #[test]
    fn limits_reduce_only_finer_subdivisions() {
        let tessellation = Tessellation::new(28, 16, 4);
        assert_eq!(tessellation.limited(14, 6), Tessellation { slices: 14, stacks: 6, quads: 4 });
        assert_eq!(tessellation.limited(100, 20), tessellation);
    }

    #[test]
    fn the_finest_tessellation_has_the_documented_chord_error() {
        assert!(Tessellation::chord_error(Tessellation::MAX) < 1e-4);
    }
}
