//! Triangles of geoms in their local frames.

use std::collections::HashMap;

use gltf_json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Accessor, Extras, Index, Material};

use super::document::{Document, Kind};
use crate::error::Result;
use crate::math::cross;
use crate::model::Model;
use crate::replay::{Geom, Look, Shape, TextureMap};
use crate::shape::{self, Tessellation, Triangles};

/// Finest tessellation of round shapes: slices and stacks. A circle of 24 edges deviates by less
/// than 1% of its radius.
const FINEST: [u32; 2] = [24, 12];

/// Shapes and meshes of a file. Geoms of the same shape share their vertices.
#[derive(Debug)]
pub(super) struct Geometry {
    /// Half the length of infinite planes, m.
    pub(super) far: f32,
    shapes: HashMap<ShapeKey, Stored>,
    meshes: HashMap<MeshKey, Index<Mesh>>,
}

/// Shape, bits of the size, index of the asset.
type ShapeKey = (Shape, [u32; 3], Option<usize>);

/// Accessors of positions, normals and indices.
type Stored = [Index<Accessor>; 3];

/// Vertices, texture coordinates and material.
type MeshKey = (Stored, Option<Index<Accessor>>, Index<Material>);

impl Geometry {
    pub(super) fn new(far: f32) -> Self {
        Self { far, shapes: HashMap::new(), meshes: HashMap::new() }
    }

    /// Adds the mesh of a geom. `None` for a shape without triangles.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`](crate::Error::Unsupported) for coordinates that are not finite and
    /// for shapes of more than 2³² - 1 vertices.
    pub(super) fn mesh(
        &mut self,
        document: &mut Document,
        model: &Model,
        look: &Look,
        geom: &Geom,
        material: Index<Material>,
        map: Option<TextureMap>,
    ) -> Result<Option<Index<Mesh>>> {
        let size = if geom.asset.is_some() { [0; 3] } else { geom.size.map(f32::to_bits) };
        let key = (geom.shape, size, geom.asset);
        let known = self.shapes.get(&key).copied();
        if known.is_none() || map.is_some() {
            let triangles = self.triangles(model, look, geom)?;
            if triangles.indices.is_empty() {
                return Ok(None);
            }
            let stored = known.unwrap_or_else(|| stored(document, &triangles));
            self.shapes.insert(key, stored);
            let texcoords = map.map(|map| document.floats(Kind::Texcoord, &texcoords(&triangles, map)));
            return Ok(Some(self.with_material(document, model, geom, stored, texcoords, material)));
        }
        Ok(known.map(|stored| self.with_material(document, model, geom, stored, None, material)))
    }

    fn with_material(
        &mut self,
        document: &mut Document,
        model: &Model,
        geom: &Geom,
        stored: Stored,
        texcoords: Option<Index<Accessor>>,
        material: Index<Material>,
    ) -> Index<Mesh> {
        *self.meshes.entry((stored, texcoords, material)).or_insert_with(|| {
            let [positions, normals, indices] = stored;
            let attributes = [
                Some((Valid(Semantic::Positions), positions)),
                Some((Valid(Semantic::Normals), normals)),
                texcoords.map(|texcoords| (Valid(Semantic::TexCoords(0)), texcoords)),
            ];
            let primitive = Primitive {
                attributes: attributes.into_iter().flatten().collect(),
                extensions: None,
                extras: Extras::default(),
                indices: Some(indices),
                material: Some(material),
                mode: Valid(Mode::Triangles),
                targets: None,
            };
            let name = match (geom.shape, geom.asset) {
                (Shape::Mesh, Some(index)) => model.meshes().nth(index).and_then(|mesh| mesh.name()),
                (Shape::HeightField, Some(index)) => model.height_fields().nth(index).and_then(|field| field.name()),
                _ => None,
            };
            let name = name.map_or_else(|| format!("{:?}", geom.shape).to_lowercase(), str::to_owned);
            let primitives = vec![primitive];
            document.root.push(Mesh {
                extensions: None,
                extras: Extras::default(),
                name: Some(name),
                primitives,
                weights: None,
            })
        })
    }

    fn triangles(&self, model: &Model, look: &Look, geom: &Geom) -> Result<Triangles> {
        let [slices, stacks] = FINEST;
        let round = Tessellation::of_model(model).limited(slices, stacks);
        let [x, y, z] = geom.size;
        let scaled = |shape: Triangles, [x, y, z]: [f32; 3]| {
            let mut result = Triangles::default();
            result.extend_by(&shape, |at| [x * at[0], y * at[1], z * at[2]], |n| [n[0] / x, n[1] / y, n[2] / z]);
            result
        };
        let turned = |[x, y, z]: [f32; 3]| [x, -y, -z];
        let mut triangles = match geom.shape {
            Shape::Plane => {
                let half = |length: f32| if length > 0.0 { length } else { self.far };
                scaled(shape::plane(1), [half(x), half(y), 1.0])
            }
            Shape::Ellipsoid => scaled(shape::sphere(round), geom.size),
            Shape::Box => scaled(shape::cuboid(1), geom.size),
            Shape::Capsule => {
                let mut capsule = scaled(shape::cylinder(round.slices, 1), [x, x, z]);
                let cap = shape::hemisphere(round);
                let raised = |at: [f32; 3]| [x * at[0], x * at[1], x * at[2] + z];
                capsule.extend_by(&cap, raised, |normal| normal);
                capsule.extend_by(&cap, |at| turned(raised(at)), turned);
                capsule
            }
            Shape::Cylinder => {
                let mut cylinder = scaled(shape::cylinder(round.slices, 1), [x, x, z]);
                let end = shape::disk(round.slices, 1);
                let raised = |at: [f32; 3]| [x * at[0], x * at[1], z];
                cylinder.extend_by(&end, raised, |normal| normal);
                cylinder.extend_by(&end, |at| turned(raised(at)), turned);
                cylinder
            }
            Shape::Mesh => {
                let id = look.meshes.keys().find(|id| Some(id.index()) == geom.asset);
                id.map(|&id| shape::mesh(model, id, usize::MAX)).transpose()?.unwrap_or_default()
            }
            Shape::HeightField => {
                let id = look.height_fields.iter().find(|id| Some(id.index()) == geom.asset);
                id.map(|&id| shape::height_field(model, id, usize::MAX)).transpose()?.unwrap_or_default()
            }
        };
        if !triangles.vertices.iter().all(|vertex| vertex.position.iter().all(|number| number.is_finite())) {
            return Err(crate::Error::Unsupported("a size that is not finite".to_owned()));
        }
        for vertex in &mut triangles.vertices {
            vertex.normal = unit(vertex.normal);
        }
        face_outwards(&mut triangles);
        Ok(triangles)
    }
}

/// Replaces normals that point to the inside of a triangle, as the engine computes some at sharp
/// corners of meshes with texture coordinates.
fn face_outwards(triangles: &mut Triangles) {
    for face in triangles.indices.as_chunks_mut::<3>().0 {
        let [a, b, c] = face.map(|index| triangles.vertices[index as usize].position.map(f64::from));
        let edge = |to: [f64; 3]| -> [f64; 3] { std::array::from_fn(|axis| to[axis] - a[axis]) };
        let flat = cross(&edge(b), &edge(c)).map(|part| part as f32);
        for index in face {
            let mut vertex = triangles.vertices[*index as usize];
            if vertex.normal.iter().zip(flat).map(|(a, b)| a * b).sum::<f32>() < 0.0 {
                vertex.normal = unit(flat);
                *index = triangles.vertices.len() as u32;
                triangles.vertices.push(vertex);
            }
        }
    }
}

/// Stores positions, normals and indices.
fn stored(document: &mut Document, triangles: &Triangles) -> Stored {
    let positions: Vec<[f32; 3]> = triangles.vertices.iter().map(|vertex| vertex.position).collect();
    let normals: Vec<[f32; 3]> = triangles.vertices.iter().map(|vertex| vertex.normal).collect();
    [
        document.floats(Kind::Position, &positions),
        document.floats(Kind::Normal, &normals),
        document.indices(&triangles.indices, positions.len()),
    ]
}

/// Returns a vector of length 1: the z-axis for a vector without a direction.
fn unit(vector: [f32; 3]) -> [f32; 3] {
    let vector = vector.map(f64::from);
    let length = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() { vector.map(|part| (part / length) as f32) } else { [0.0, 0.0, 1.0] }
}

/// Returns the texture coordinates of vertices.
fn texcoords(triangles: &Triangles, map: TextureMap) -> Vec<[f32; 2]> {
    let coordinate = |vertex: &shape::Vertex| {
        let source = if map.explicit { vertex.texcoord } else { [vertex.position[0], vertex.position[1]] };
        [0, 1].map(|axis| {
            let value = source[axis] * map.scale[axis] + map.offset[axis];
            if value.is_finite() { value } else { 0.0 }
        })
    };
    triangles.vertices.iter().map(coordinate).collect()
}
