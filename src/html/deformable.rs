//! Tendons, skins and flexes: shapes whose vertices differ in every record.

use std::collections::BTreeSet;

use serde::Serialize;

use super::assets::indices;
use super::stream::{Binary, Part};
use crate::data::Data;
use crate::element::Object;
use crate::error::Result;
use crate::id::{SkinId, TendonId};
use crate::model::Model;
use crate::replay::{self, Surface};
use crate::scene::{Camera, Scene, SceneGeom, SceneGeomType, SceneOptions};

/// Vertices of a shape in a record, m, in the world frame: of triangles, or pairs of the ends of
/// segments.
pub(crate) type Vertices = Vec<[f32; 3]>;

/// Look of a deformable shape.
#[derive(Debug, Serialize)]
pub(super) struct Deformable {
    #[serde(flatten)]
    surface: Surface,
    /// Radius of segments, m.
    radius: f32,
    /// Indices of the vertices of each triangle, one channel. `None` for segments.
    faces: Option<Part>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Element {
    Tendon(TendonId),
    Skin(SkinId),
    /// Triangles of a flex.
    Flex(usize),
    /// Edges of a flex of one dimension.
    Rope(usize),
}

/// Reads the vertices of the deformable shapes that the first state shows.
#[derive(Debug)]
pub(crate) struct Sampler {
    scene: Scene,
    options: SceneOptions,
    elements: Vec<Element>,
}

impl Sampler {
    /// Takes a scene that has been updated with the options to the first state. Returns `None`
    /// without deformable shapes, and their looks, and removes them from those that are left out.
    pub(super) fn new(
        binary: &mut Binary,
        model: &Model,
        scene: Scene,
        options: SceneOptions,
        left_out: &mut BTreeSet<String>,
    ) -> (Option<Self>, Vec<Deformable>) {
        let (mut elements, mut looks) = (Vec::new(), Vec::new());
        for geom in scene.geoms() {
            let (element, faces, count) = match (geom.object(), geom.flex()) {
                (_, Some(index)) => match model.flex_triangles(index) {
                    Some(faces) => {
                        let count = scene.flexes().nth(index).map_or(0, |flex| flex.vertices.len());
                        (Element::Flex(index), Some(faces), count)
                    }
                    None => (Element::Rope(index), None, 0),
                },
                (Some(Object::Skin(id)), _) => {
                    let skin = model.skin(id);
                    (Element::Skin(id), Some(skin.face()), skin.vert().len())
                }
                (Some(Object::Tendon(id)), _) if is_segment(geom.geom_type()) => (Element::Tendon(id), None, 0),
                _ => continue,
            };
            if elements.contains(&element) {
                continue;
            }
            left_out.remove(&replay::decoration(model, geom, geom.object()));
            elements.push(element);
            looks.push(Deformable {
                surface: Surface::new(geom),
                radius: geom.size()[0],
                faces: faces.map(|faces| indices(binary, faces, count)),
            });
        }
        let sampler = (!elements.is_empty()).then_some(Self { scene, options, elements });
        (sampler, looks)
    }

    /// Computes the results that an update reads.
    #[cfg(feature = "live")]
    pub(crate) fn compute(&self, data: &mut Data) -> Result<()> {
        self.options.compute(data, crate::scene::Categories::all())
    }

    /// Updates the scene to the present state.
    pub(crate) fn update(&mut self, data: &mut Data) -> Result<()> {
        let mut camera = Camera::free(data.model());
        self.scene.update_and_grow(data, &self.options, &mut camera)
    }

    /// Returns the vertices of each shape in the state of the last update.
    pub(crate) fn vertices(&self) -> Vec<Vertices> {
        let scene = &self.scene;
        let vertices = |element: &Element| {
            let vertices = match *element {
                Element::Tendon(id) => Some(segments(scene, id)),
                Element::Skin(id) => scene.skins().find(|skin| skin.skin == id).map(|skin| skin.vertices.to_vec()),
                Element::Flex(index) => scene.flexes().nth(index).map(|flex| flex.vertices.to_vec()),
                Element::Rope(index) => scene.flexes().nth(index).map(|flex| edges(flex.vertices, flex.edges)),
            };
            vertices.unwrap_or_default()
        };
        self.elements.iter().map(vertices).collect()
    }
}

fn is_segment(shape: SceneGeomType) -> bool {
    matches!(shape, SceneGeomType::Capsule | SceneGeomType::Cylinder)
}

/// Returns the ends of the segments of a tendon.
fn segments(scene: &Scene, id: TendonId) -> Vertices {
    let is_part = |geom: &SceneGeom<'_>| geom.object() == Some(Object::Tendon(id)) && is_segment(geom.geom_type());
    let ends = |geom: SceneGeom<'_>| {
        let (pos, mat, half) = (geom.pos(), geom.mat(), geom.size()[2]);
        [-half, half].map(|along| [0, 1, 2].map(|axis| pos[axis] + along * mat[3 * axis + 2]))
    };
    scene.geoms().filter(is_part).flat_map(ends).collect()
}

/// Returns the ends of each edge.
fn edges(vertices: &[[f32; 3]], edges: &[[i32; 2]]) -> Vertices {
    let vertex = |&index: &i32| usize::try_from(index).ok().and_then(|index| vertices.get(index)).copied();
    edges.as_flattened().iter().map(|index| vertex(index).unwrap_or_default()).collect()
}
