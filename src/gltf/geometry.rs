//! Triangles of geoms in their local frames.

use std::collections::BTreeMap;

use gltf_json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf_json::validation::Checked::{self, Valid};
use gltf_json::{Accessor, Extras, Index, Material};

use super::document::{Document, Kind};
use crate::error::Result;
use crate::kind;
use crate::math::cross;
use crate::model::Model;
use crate::replay::{Geom, Shape, TextureMap};
use crate::shape::{self, Tessellation, Triangles};

/// Finest tessellation of round shapes: slices and stacks. A circle of 24 edges deviates by less
/// than 1% of its radius.
const FINEST: [u32; 2] = [24, 12];

/// Accessors of the attributes of vertices.
type Attributes = BTreeMap<Checked<Semantic>, Index<Accessor>>;

impl Document<'_> {
    /// Adds the mesh of a geom. `None` for a shape without triangles. `far` is half the length of
    /// infinite planes, m.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`](crate::Error::Unsupported) for coordinates that are not finite and
    /// for shapes of more than 2³² - 1 vertices.
    pub(super) fn mesh(
        &mut self,
        geom: &Geom,
        far: f32,
        material: Index<Material>,
        map: Option<TextureMap>,
    ) -> Result<Option<Index<Mesh>>> {
        let size = if geom.asset.is_some() { [0.0; 3] } else { geom.size };
        let key = format!("{:?}", (geom.shape, size, geom.asset, material, map));
        if let Some(&known) = self.meshes.get(&key) {
            return Ok(Some(known));
        }
        let triangles = triangles(self.model, geom, far)?;
        if triangles.indices.is_empty() {
            return Ok(None);
        }
        let primitive = Primitive {
            attributes: self.attributes(&triangles, map),
            extensions: None,
            extras: Extras::default(),
            indices: Some(self.indices(&triangles.indices, triangles.vertices.len())),
            material: Some(material),
            mode: Valid(Mode::Triangles),
            targets: None,
        };
        let asset = geom.asset.and_then(|index| match geom.shape {
            Shape::HeightField => self.model.name_at(kind::Kind::HeightField, index),
            _ => self.model.name_at(kind::Kind::Mesh, index),
        });
        let name = asset.map_or_else(|| format!("{:?}", geom.shape).to_lowercase(), str::to_owned);
        let mesh = self.root.push(Mesh {
            extensions: None,
            extras: Extras::default(),
            name: Some(name),
            primitives: vec![primitive],
            weights: None,
        });
        self.meshes.insert(key, mesh);
        Ok(Some(mesh))
    }

    /// Stores positions, normals and texture coordinates.
    fn attributes(&mut self, triangles: &Triangles, map: Option<TextureMap>) -> Attributes {
        let positions: Vec<[f32; 3]> = triangles.vertices.iter().map(|vertex| vertex.position).collect();
        let normals: Vec<[f32; 3]> = triangles.vertices.iter().map(|vertex| vertex.normal).collect();
        let mut attributes = Attributes::from([
            (Valid(Semantic::Positions), self.floats(Kind::Position, &positions)),
            (Valid(Semantic::Normals), self.floats(Kind::Normal, &normals)),
        ]);
        if let Some(map) = map {
            let texcoords = self.floats(Kind::Texcoord, &texcoords(triangles, map));
            attributes.insert(Valid(Semantic::TexCoords(0)), texcoords);
        }
        attributes
    }
}

fn triangles(model: &Model, geom: &Geom, far: f32) -> Result<Triangles> {
    let [slices, stacks] = FINEST;
    let round = Tessellation::of_model(model).limited(slices, stacks);
    let asset = geom.asset.unwrap_or_default();
    let mut triangles = match geom.shape {
        Shape::Plane => {
            let half = |length: f32| if length > 0.0 { length } else { far };
            scaled(&shape::plane(1), [half(geom.size[0]), half(geom.size[1]), 1.0])
        }
        Shape::Ellipsoid => scaled(&shape::sphere(round), geom.size),
        Shape::Box => scaled(&shape::cuboid(1), geom.size),
        Shape::Capsule => tube(round.slices, geom.size, &shape::hemisphere(round)),
        Shape::Cylinder => tube(round.slices, geom.size, &shape::disk(round.slices, 1)),
        Shape::Mesh => {
            let mesh = model.meshes().nth(asset);
            mesh.map(|mesh| shape::mesh(model, mesh.id(), usize::MAX)).transpose()?.unwrap_or_default()
        }
        Shape::HeightField => {
            let field = model.height_fields().nth(asset);
            field.map(|field| shape::height_field(model, field.id(), usize::MAX)).transpose()?.unwrap_or_default()
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

/// Scales a shape about its centre.
fn scaled(shape: &Triangles, [x, y, z]: [f32; 3]) -> Triangles {
    let mut result = Triangles::default();
    result.extend_by(shape, |at| [x * at[0], y * at[1], z * at[2]], |n| [n[0] / x, n[1] / y, n[2] / z]);
    result
}

/// Returns a cylinder with two ends, of which the upper one is given for a radius of 1.
fn tube(slices: u32, [radius, _, half]: [f32; 3], end: &Triangles) -> Triangles {
    let turned = |[x, y, z]: [f32; 3]| [x, -y, -z];
    let raised = |[x, y, z]: [f32; 3]| [radius * x, radius * y, radius * z + half];
    let mut tube = scaled(&shape::cylinder(slices, 1), [radius, radius, half]);
    tube.extend_by(end, raised, |normal| normal);
    tube.extend_by(end, |at| turned(raised(at)), turned);
    tube
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
