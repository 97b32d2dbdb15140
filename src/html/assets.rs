//! Meshes, height fields and textures that the geoms of a page use.

use serde::Serialize;

use super::stream::{Binary, Interval, Part, Prediction};
use crate::element;
use crate::replay;
use crate::shape::simplified;

/// Triangle mesh. The page computes its normals.
#[derive(Debug, Serialize)]
pub(super) struct Mesh {
    positions: Corners,
    /// Texture coordinates.
    texcoords: Option<Corners>,
}

/// Vectors, and which of them each corner of each triangle has.
#[derive(Debug, Serialize)]
struct Corners {
    /// Intervals of the components.
    intervals: Vec<Interval>,
    /// The vectors, a channel for each component.
    vectors: Part,
    /// Number of vectors.
    count: usize,
    /// Indices of the vectors of each triangle, one channel.
    faces: Part,
}

impl Mesh {
    /// A mesh with a texture keeps its triangles.
    pub(super) fn new(binary: &mut Binary, mesh: &element::Mesh<'_>, is_textured: bool, error: f64) -> Self {
        let has_texcoords = is_textured && !mesh.texcoord().is_empty();
        let texcoords = has_texcoords.then(|| Corners::new(binary, mesh.texcoord(), mesh.facetexcoord()));
        let simple = if has_texcoords { None } else { simplified(mesh.vert(), mesh.face(), error) };
        let (vertices, faces) =
            simple.as_ref().map_or((mesh.vert(), mesh.face()), |(vertices, faces)| (vertices, faces));
        Self { positions: Corners::new(binary, vertices, faces), texcoords }
    }
}

impl Corners {
    fn new<const N: usize>(binary: &mut Binary, vectors: &[[f32; N]], faces: &[[i32; 3]]) -> Self {
        let values = |axis: usize| vectors.iter().map(move |vector| f64::from(vector[axis]));
        let intervals: Vec<Interval> = (0..N).map(|axis| Interval::of(values(axis))).collect();
        let channel = |(axis, &interval): (usize, &Interval)| values(axis).map(move |value| interval.number(value));
        let part = binary.stream(Prediction::Previous, intervals.iter().enumerate().map(channel));
        Self { intervals, vectors: part, count: vectors.len(), faces: indices(binary, faces, vectors.len()) }
    }
}

/// Appends the indices of the corners of triangles. An index that is out of range, which only an
/// edited model can have, becomes 0.
pub(super) fn indices(binary: &mut Binary, faces: &[[i32; 3]], count: usize) -> Part {
    let valid = |&index: &i32| if usize::try_from(index).is_ok_and(|index| index < count) { index.into() } else { 0 };
    binary.stream(Prediction::Previous, [faces.as_flattened().iter().map(valid)])
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
    pub(super) fn new(binary: &mut Binary, field: &element::HeightField<'_>) -> Self {
        let values = || field.data().iter().map(|&value| f64::from(value));
        let interval = Interval::of(values());
        let elevations = binary.stream(Prediction::Previous, [values().map(|value| interval.number(value))]);
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
