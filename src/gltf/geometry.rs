//! Triangles of geoms in their local frames.

use std::collections::BTreeMap;
use std::iter;

use gltf_json::accessor::ComponentType;
use gltf_json::buffer::Target;
use gltf_json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Material};

use super::document::{Document, VERTICES, object};
use crate::error::Result;
use crate::kind::Kind;
use crate::model::Model;
use crate::replay::{Geom, Shape, TextureMap};
use crate::shape::{self, Tessellation, Triangles};

/// Finest tessellation of round shapes: slices and stacks. A circle of 24 edges deviates by less
/// than 1% of its radius.
const FINEST: [u32; 2] = [24, 12];

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
        let kind = if geom.shape == Shape::HeightField { Kind::HeightField } else { Kind::Mesh };
        let asset = geom.asset.and_then(|index| self.model.name_at(kind, index));
        let name = asset.map_or_else(|| format!("{:?}", geom.shape).to_lowercase(), str::to_owned);
        let mesh = self.add_mesh(name, &triangles, material, map, iter::empty());
        self.meshes.insert(key, mesh);
        Ok(Some(mesh))
    }

    /// Adds triangles with the texture coordinates of a mapping, and with the sets of bones and
    /// weights that the vertices follow.
    pub(super) fn add_mesh(
        &mut self,
        name: String,
        triangles: &Triangles,
        material: Index<Material>,
        map: Option<TextureMap>,
        sets: impl Iterator<Item = (Vec<[u16; 4]>, Vec<[f32; 4]>)>,
    ) -> Index<Mesh> {
        let positions: Vec<[f32; 3]> = triangles.vertices.iter().map(|vertex| vertex.position).collect();
        let normals: Vec<[f32; 3]> = triangles.vertices.iter().map(|vertex| vertex.normal).collect();
        let mut attributes = BTreeMap::from([
            (Valid(Semantic::Positions), self.bounded(&positions, VERTICES)),
            (Valid(Semantic::Normals), self.floats(&normals, VERTICES)),
        ]);
        if let Some(map) = map {
            let texcoords = self.floats(&texcoords(triangles, map), VERTICES);
            attributes.insert(Valid(Semantic::TexCoords(0)), texcoords);
        }
        for (set, (bones, weights)) in (0..).zip(sets) {
            let bones = self.vectors(&bones, ComponentType::U16, u16::to_le_bytes, VERTICES);
            attributes.insert(Valid(Semantic::Joints(set)), bones);
            attributes.insert(Valid(Semantic::Weights(set)), self.floats(&weights, VERTICES));
        }
        let (indices, target) = (triangles.indices.as_chunks::<1>().0, Some(Target::ElementArrayBuffer));
        // The largest number of each type is no index.
        let indices = if u16::try_from(triangles.vertices.len()).is_ok() {
            self.vectors(indices, ComponentType::U16, |index| (index as u16).to_le_bytes(), target)
        } else {
            self.vectors(indices, ComponentType::U32, u32::to_le_bytes, target)
        };
        let primitive = object!(Primitive {
            attributes,
            indices: Some(indices),
            material: Some(material),
            mode: Valid(Mode::Triangles),
            targets: None,
        });
        self.root.push(object!(Mesh { name: Some(name), primitives: vec![primitive], weights: None }))
    }
}

fn triangles(model: &Model, geom: &Geom, far: f32) -> Result<Triangles> {
    let [slices, stacks] = FINEST;
    let round = Tessellation::of_model(model).limited(slices, stacks);
    let asset = geom.asset.unwrap_or_default();
    let mut triangles = match geom.shape {
        Shape::Plane => {
            let half = |length: f32| if length > 0.0 { length } else { far };
            shape::plane(1).scaled([half(geom.size[0]), half(geom.size[1]), 1.0])
        }
        Shape::Ellipsoid => shape::sphere(round).scaled(geom.size),
        Shape::Box => shape::cuboid(1).scaled(geom.size),
        Shape::Capsule => shape::tube(round.slices, geom.size, &shape::hemisphere(round)),
        Shape::Cylinder => shape::tube(round.slices, geom.size, &shape::disk(round.slices, 1)),
        Shape::Mesh => shape::mesh(model, model.mesh(asset)?.id(), usize::MAX)?,
        Shape::HeightField => shape::height_field(model, model.height_field(asset)?.id(), usize::MAX)?,
    };
    if !triangles.vertices.iter().all(|vertex| vertex.position.iter().all(|number| number.is_finite())) {
        return Err(crate::Error::Unsupported("a size that is not finite".to_owned()));
    }
    triangles.unit_normals();
    triangles.face_outwards();
    Ok(triangles)
}

/// Returns the texture coordinates of vertices.
fn texcoords(triangles: &Triangles, map: TextureMap) -> Vec<[f32; 2]> {
    let coordinate = |vertex: &shape::Vertex| {
        let source = if map.explicit { vertex.texcoord } else { [vertex.position[0], vertex.position[1]] };
        [0, 1].map(|axis| shape::finite_or_zero(source[axis] * map.scale[axis] + map.offset[axis]))
    };
    triangles.vertices.iter().map(coordinate).collect()
}
