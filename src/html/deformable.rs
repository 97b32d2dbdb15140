//! Tendons, skins and flexes: shapes whose vertices differ in every record.

use std::collections::BTreeSet;

use serde::Serialize;

use super::assets::indices;
use super::stream::{Binary, Part};
use crate::data::Data;
use crate::error::Result;
use crate::id::TendonId;
use crate::model::Model;
use crate::replay::{self, Surface};
use crate::scene::{Camera, DeformableId, Scene, SceneOptions};

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
    /// Skin, or flex with triangles.
    Surface(DeformableId),
    /// Flex of one dimension, which has only edges.
    Rope(DeformableId),
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
        let tendons = scene.geoms().filter_map(|geom| Some((Element::Tendon(geom.segment_of()?), geom, None)));
        let others = scene.deformables(model).map(|shape| {
            let element = if shape.faces.is_some() { Element::Surface } else { Element::Rope };
            (element(shape.id), shape.geom, shape.faces.map(|faces| (faces, shape.vertices.len())))
        });
        for (element, geom, faces) in tendons.chain(others) {
            if elements.contains(&element) {
                continue;
            }
            left_out.remove(&replay::decoration(model, geom));
            elements.push(element);
            looks.push(Deformable {
                surface: Surface::new(geom),
                radius: geom.size()[0],
                faces: faces.map(|(faces, count)| indices(binary, faces, count)),
            });
        }
        ((!looks.is_empty()).then_some(Self { scene, options, elements }), looks)
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
        let vertices = |element: &Element| match *element {
            Element::Tendon(id) => self.scene.tendon_segments(id).flatten().collect(),
            Element::Surface(id) => self.scene.deformable(id).0.to_vec(),
            Element::Rope(id) => self.scene.rope_segments(id).flatten().collect(),
        };
        self.elements.iter().map(vertices).collect()
    }
}
