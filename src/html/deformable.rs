//! Tendons, skins and flexes: shapes whose vertices differ in every record.

use std::collections::BTreeMap;

use serde::Serialize;

use super::assets::indices;
use super::options::HtmlOptions;
use super::stream::{Binary, Part};
use crate::data::Data;
use crate::element::Object;
use crate::error::Result;
use crate::id::{SkinId, TendonId};
use crate::model::Model;
use crate::replay;
use crate::scene::{Camera, Scene, SceneGeomType, SceneOptions};

/// Vertices of a shape in a record, m, in the world frame: of triangles, or pairs of the ends of
/// segments.
pub(crate) type Vertices = Vec<[f32; 3]>;

/// Look of a deformable shape.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Deformable {
    #[serde(skip)]
    element: Element,
    /// Description of the shape among those that are not drawn.
    #[serde(skip)]
    pub(super) description: String,
    rgba: [f32; 4],
    emission: f32,
    specular: f32,
    shininess: f32,
    /// Radius of segments, m.
    radius: f32,
    /// Indices of the vertices of each triangle, one channel. `None` for segments.
    faces: Option<Part>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Element {
    Tendon(TendonId),
    Skin(SkinId),
    Flex(usize),
}

/// Reads the vertices of the deformable shapes that the first state shows.
#[derive(Debug)]
pub(crate) struct Sampler {
    scene: Scene,
    options: SceneOptions,
    shapes: Option<Vec<Deformable>>,
}

impl Sampler {
    /// Returns `None` for a model without deformable shapes.
    pub(super) fn new(model: &Model, options: &HtmlOptions) -> Result<Option<Self>> {
        let scene = Scene::new(model, model.ngeom() + model.nsite() + 100)?;
        let has_shapes = model.ntendon() + model.nskin() + scene.flexes().len() > 0;
        let options = SceneOptions::default().with_geomgroup(options.geomgroup).with_sitegroup(options.sitegroup);
        Ok(has_shapes.then_some(Self { scene, options, shapes: None }))
    }

    /// Returns the shapes that were found.
    pub(super) fn shapes(&self) -> &[Deformable] {
        self.shapes.as_deref().unwrap_or_default()
    }

    /// Updates the scene to the present state, and finds the shapes the first time.
    pub(super) fn find(&mut self, binary: &mut Binary, data: &mut Data) -> Result<()> {
        self.update(data)?;
        let scene = &self.scene;
        self.shapes.get_or_insert_with(|| shapes(binary, data.model(), scene));
        Ok(())
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
        let mut segments: BTreeMap<TendonId, Vertices> = BTreeMap::new();
        for geom in scene.geoms().filter(|geom| is_segment(geom.geom_type())) {
            if let Some(Object::Tendon(id)) = geom.object() {
                let (pos, mat, half) = (geom.pos(), geom.mat(), geom.size()[2]);
                let end = |sign: f32| [0, 1, 2].map(|axis| pos[axis] + sign * half * mat[3 * axis + 2]);
                segments.entry(id).or_default().extend([end(-1.0), end(1.0)]);
            }
        }
        let vertices =
            |shape: &Deformable| match shape.element {
                Element::Tendon(id) => segments.remove(&id).unwrap_or_default(),
                Element::Skin(id) => {
                    scene.skins().find(|skin| skin.skin == id).map(|skin| skin.vertices.to_vec()).unwrap_or_default()
                }
                Element::Flex(index) => {
                    let flex = scene.flexes().nth(index);
                    flex.map(|flex| {
                        if shape.faces.is_some() { flex.vertices.to_vec() } else { edges(flex.vertices, flex.edges) }
                    })
                    .unwrap_or_default()
                }
            };
        self.shapes().iter().map(vertices).collect()
    }
}

fn is_segment(shape: SceneGeomType) -> bool {
    matches!(shape, SceneGeomType::Capsule | SceneGeomType::Cylinder)
}

/// Returns the shapes of a scene.
fn shapes(binary: &mut Binary, model: &Model, scene: &Scene) -> Vec<Deformable> {
    let mut shapes: Vec<Deformable> = Vec::new();
    for geom in scene.geoms() {
        let (element, faces) = match (geom.object(), geom.flex()) {
            (_, Some(index)) => (Element::Flex(index), flex_faces(model, index)),
            (Some(Object::Skin(id)), _) => (Element::Skin(id), Some(model.skin(id).face().to_vec())),
            (Some(Object::Tendon(id)), _) if is_segment(geom.geom_type()) => (Element::Tendon(id), None),
            _ => continue,
        };
        if shapes.iter().any(|shape| shape.element == element) {
            continue;
        }
        let count = match element {
            Element::Skin(id) => model.skin(id).vert().len(),
            Element::Flex(index) => scene.flexes().nth(index).map_or(0, |flex| flex.vertices.len()),
            Element::Tendon(_) => 0,
        };
        shapes.push(Deformable {
            element,
            description: replay::description(model, geom, geom.object()),
            rgba: geom.rgba(),
            emission: geom.emission(),
            specular: geom.specular(),
            shininess: geom.shininess(),
            radius: geom.size()[0],
            faces: faces.map(|faces| indices(binary, &faces, count)),
        });
    }
    shapes
}

/// Returns the ends of each edge.
fn edges(vertices: &[[f32; 3]], edges: &[[i32; 2]]) -> Vertices {
    let vertex = |&index: &i32| usize::try_from(index).ok().and_then(|index| vertices.get(index)).copied();
    edges.as_flattened().iter().map(|index| vertex(index).unwrap_or_default()).collect()
}

/// Returns the triangles of a flex: its elements in two dimensions, its surface in three. `None`
/// for a rope.
#[cfg(engine_since = "3.0.0")]
fn flex_faces(model: &Model, index: usize) -> Option<Vec<[i32; 3]>> {
    let (numbers, start, count) = match model.flex_dim()[index] {
        2 => (model.flex_elem(), model.flex_elemdataadr()[index], model.flex_elemnum()[index]),
        3 => (model.flex_shell(), model.flex_shelldataadr()[index], model.flex_shellnum()[index]),
        _ => return None,
    };
    let numbers = numbers.get(start.max(0) as usize..)?;
    Some(numbers.as_chunks().0.iter().take(count.max(0) as usize).copied().collect())
}

/// Older engines have no flexes.
#[cfg(not(engine_since = "3.0.0"))]
fn flex_faces(_: &Model, _: usize) -> Option<Vec<[i32; 3]>> {
    None
}
