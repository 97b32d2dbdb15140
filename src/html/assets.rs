//! Meshes, height fields and textures that the geoms of a page use.

use serde::Serialize;

use super::simplify::simplified;
use super::stream::{Binary, Interval, Part, Prediction};
use crate::id::{HeightFieldId, MeshId};
use crate::model::Model;
use crate::replay;

/// Triangle mesh. The page computes its normals.
#[derive(Debug, Serialize)]
pub(super) struct Mesh {
    /// Intervals of the coordinates x, y and z.
    intervals: [Interval; 3],
    /// Coordinates, three channels.
    vertices: Part,
    /// Number of vertices.
    count: usize,
    /// Indices of the vertices of each triangle, one channel.
    faces: Part,
    /// Texture coordinates.
    texcoords: Option<Texcoords>,
}

/// Texture coordinates of a mesh.
#[derive(Debug, Serialize)]
struct Texcoords {
    intervals: [Interval; 2],
    /// Coordinates, two channels.
    values: Part,
    /// Number of pairs of coordinates.
    count: usize,
    /// Index of the coordinates of each corner, one channel.
    faces: Part,
}

impl Mesh {
    /// A mesh with a texture keeps its triangles.
    pub(super) fn new(binary: &mut Binary, model: &Model, id: MeshId, is_textured: bool, error: f64) -> Self {
        let mesh = model.mesh(id);
        let texcoord = mesh.texcoord();
        let texcoords = (is_textured && !texcoord.is_empty()).then(|| {
            let (intervals, values) = points(binary, texcoord);
            let faces = indices(binary, mesh.facetexcoord(), texcoord.len());
            Texcoords { intervals, values, count: texcoord.len(), faces }
        });
        let simple = if texcoords.is_none() { simplified(mesh.vert(), mesh.face(), error) } else { None };
        let (vert, face) = match &simple {
            Some((vert, face)) => (&vert[..], &face[..]),
            None => (mesh.vert(), mesh.face()),
        };
        let (intervals, vertices) = points(binary, vert);
        let faces = indices(binary, face, vert.len());
        Self { intervals, vertices, count: vert.len(), faces, texcoords }
    }
}

/// Appends the coordinates of points, a channel for each axis.
fn points<const N: usize>(binary: &mut Binary, points: &[[f32; N]]) -> ([Interval; N], Part) {
    let axis = |axis: usize| points.iter().map(move |point| f64::from(point[axis]));
    let intervals = std::array::from_fn(|index| Interval::of(axis(index)));
    let part = binary.part(|binary| {
        for (index, interval) in intervals.iter().enumerate() {
            binary.channel(Prediction::Previous, axis(index).map(|value| Interval::number(*interval, value)));
        }
    });
    (intervals, part)
}

/// Appends the indices of the corners of triangles. An index that is out of range, which only an
/// edited model can have, becomes 0.
pub(super) fn indices(binary: &mut Binary, faces: &[[i32; 3]], count: usize) -> Part {
    let valid = |&index: &i32| if usize::try_from(index).is_ok_and(|index| index < count) { index.into() } else { 0 };
    binary.part(|binary| binary.channel(Prediction::Previous, faces.as_flattened().iter().map(valid)))
}

/// Height field.
#[derive(Debug, Serialize)]
pub(super) struct HeightField {
    rows: usize,
    columns: usize,
    /// Half lengths along x and y, the height of elevation 1, the depth of the base, m.
    size: [f64; 4],
    interval: Interval,
    /// Elevations, one channel.
    elevations: Part,
}

impl HeightField {
    pub(super) fn new(binary: &mut Binary, model: &Model, id: HeightFieldId) -> Self {
        let field = model.height_field(id);
        let values = || field.data().iter().map(|&value| f64::from(value));
        let interval = Interval::of(values());
        let numbers = values().map(|value| interval.number(value));
        let elevations = binary.part(|binary| binary.channel(Prediction::Previous, numbers));
        Self { rows: field.nrow(), columns: field.ncol(), size: *field.size(), interval, elevations }
    }
}

/// Texture.
#[derive(Debug, Serialize)]
pub(super) struct Texture {
    /// Cube texture: six square images one below the other, or one for all faces.
    cube: bool,
    /// The pixels are in the sRGB colour space, and are drawn as linear colours.
    srgb: bool,
    /// PNG file.
    png: Part,
}

impl Texture {
    pub(super) fn new(binary: &mut Binary, texture: &replay::Texture) -> Self {
        Self { cube: texture.is_cube, srgb: texture.is_srgb, png: binary.raw(&texture.png) }
    }
}
