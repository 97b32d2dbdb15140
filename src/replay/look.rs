//! Looks of a model: geoms, lights and cameras, as the scene of the engine has them.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::frame::Frame;
use super::texture::Texture;
use super::texture_map::TextureMap;
use super::view::{FixedCamera, FreeCamera, Light};
use crate::data::Data;
use crate::element::Object;
use crate::enums::TextureType;
use crate::error::Result;
use crate::id::{HeightFieldId, MeshId, TextureId};
use crate::model::Model;
use crate::scene::{Camera, Scene, SceneGeom, SceneGeomType, SceneOptions};

/// Contents of the picture, apart from its motion. Assets have the indices of the model.
#[derive(Debug, Serialize)]
pub(crate) struct Look {
    pub(crate) geoms: Vec<Geom>,
    /// Meshes of the geoms: `true` for those that any geom draws with a texture.
    #[serde(skip)]
    pub(crate) meshes: BTreeMap<MeshId, bool>,
    #[serde(skip)]
    pub(crate) height_fields: BTreeSet<HeightFieldId>,
    /// `None` for a texture that is drawn white.
    #[serde(skip)]
    pub(crate) textures: BTreeMap<usize, Option<Texture>>,
    /// Index of the texture of the sky.
    pub(crate) sky: Option<usize>,
    pub(crate) lights: Vec<Light>,
    pub(crate) cameras: Vec<FixedCamera>,
    pub(crate) free: FreeCamera,
    /// Descriptions of what is not drawn.
    pub(crate) left_out: BTreeSet<String>,
}

/// Groups of geoms and of sites that are drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Groups {
    pub(crate) geom: [bool; 6],
    pub(crate) site: [bool; 6],
}

/// Geom or site.
#[derive(Debug, Serialize)]
pub(crate) struct Geom {
    /// `geom` or `site`.
    pub(crate) element: &'static str,
    pub(crate) name: Option<String>,
    /// Index of the body, which is its frame.
    pub(crate) frame: usize,
    /// Position, m, and orientation in its frame.
    pub(crate) pos: [f64; 3],
    pub(crate) quat: [f64; 4],
    pub(crate) shape: Shape,
    /// As [`SceneGeomType`] defines it.
    pub(crate) size: [f32; 3],
    /// Index of the mesh or of the height field.
    pub(crate) asset: Option<usize>,
    /// Index of the material.
    #[serde(skip)]
    pub(crate) material: Option<usize>,
    pub(crate) rgba: [f32; 4],
    pub(crate) emission: f32,
    pub(crate) specular: f32,
    pub(crate) shininess: f32,
    pub(crate) texture: Option<usize>,
    pub(crate) map: TextureMap,
}

/// Shape of a geom.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Shape {
    Plane,
    HeightField,
    Ellipsoid,
    Capsule,
    Cylinder,
    Box,
    Mesh,
}

impl Look {
    /// Collects the looks of a model. `data` has the positions of the first record.
    pub(crate) fn new(data: &mut Data, frames: &[Frame], groups: Groups) -> Result<Self> {
        let model = data.model().clone();
        let mut scene = Scene::new(&model, model.ngeom() + model.nsite() + 100)?;
        let scene_options = SceneOptions::default().with_geomgroup(groups.geom).with_sitegroup(groups.site);
        let mut camera = Camera::free(&model);
        scene.update_and_grow(data, &scene_options, &mut camera)?;
        let mut left_out = BTreeSet::new();
        let free = FreeCamera::new(&scene.viewpoint(), camera.lookat);
        let mut look = Self {
            geoms: Vec::new(),
            meshes: BTreeMap::new(),
            height_fields: BTreeSet::new(),
            textures: BTreeMap::new(),
            sky: None,
            lights: Light::all(&model, frames, &scene, &mut left_out),
            cameras: FixedCamera::all(data, frames, &mut scene)?,
            free,
            left_out,
        };
        look.add_geoms(&model, &scene);
        let sky = model.textures().find(|texture| texture.texture_type() == TextureType::Skybox);
        look.sky = sky.map(|texture| look.texture(&model, texture.id()));
        Ok(look)
    }

    fn add_geoms(&mut self, model: &Model, scene: &Scene) {
        for geom in scene.geoms() {
            let (element, name, (frame, pos, quat, material)) = match geom.object() {
                Some(Object::Geom(id)) => {
                    let at = id.index();
                    let (pos, quat) = (model.geom_pos()[at], model.geom_quat()[at]);
                    ("geom", model.geom(id).name(), (model.geom_bodyid()[at], pos, quat, model.geom_matid()[at]))
                }
                Some(Object::Site(id)) => {
                    let at = id.index();
                    let (pos, quat) = (model.site_pos()[at], model.site_quat()[at]);
                    ("site", model.site(id).name(), (model.site_bodyid()[at], pos, quat, model.site_matid()[at]))
                }
                other => {
                    self.left_out.insert(description(model, geom, other));
                    continue;
                }
            };
            let Some(shape) = shape(geom) else {
                self.left_out.insert(format!("{element} {}", name.unwrap_or("without a name")));
                continue;
            };
            if let Some(id) = geom.mesh() {
                *self.meshes.entry(id).or_insert(false) |= geom.texture().is_some();
            }
            self.height_fields.extend(geom.height_field());
            let texture = geom.texture().map(|id| self.texture(model, id));
            let is_cube = texture.and_then(|index| self.textures[&index].as_ref()).is_some_and(|found| found.is_cube);
            self.geoms.push(Geom {
                element,
                name: name.map(str::to_owned),
                frame: frame as usize,
                pos,
                quat,
                shape,
                size: geom.size(),
                asset: geom.mesh().map(|id| id.index()).or(geom.height_field().map(|id| id.index())),
                material: usize::try_from(material).ok(),
                rgba: geom.rgba(),
                emission: geom.emission(),
                specular: geom.specular(),
                shininess: geom.shininess(),
                texture,
                map: TextureMap::new(geom, is_cube),
            });
        }
    }

    /// Adds a texture unless it is known, and returns its index.
    fn texture(&mut self, model: &Model, id: TextureId) -> usize {
        if !self.textures.contains_key(&id.index()) {
            let texture = Texture::new(model, id).map_err(|error| {
                let name = model.texture(id).name().unwrap_or("without a name");
                self.left_out.insert(format!("texture {name}: {error}"));
            });
            self.textures.insert(id.index(), texture.ok());
        }
        id.index()
    }
}

/// Logs and returns the descriptions of elements that a file leaves out.
pub(crate) fn report(left_out: BTreeSet<String>, problem: &str) -> Vec<String> {
    left_out.into_iter().inspect(|element| log::warn!("{problem} {element}")).collect()
}

/// Returns the shape, or `None` for shapes that are not drawn.
fn shape(geom: SceneGeom<'_>) -> Option<Shape> {
    Some(match geom.geom_type() {
        SceneGeomType::Plane => Shape::Plane,
        SceneGeomType::HeightField if geom.height_field().is_some() => Shape::HeightField,
        SceneGeomType::Sphere | SceneGeomType::Ellipsoid => Shape::Ellipsoid,
        SceneGeomType::Capsule => Shape::Capsule,
        SceneGeomType::Cylinder => Shape::Cylinder,
        SceneGeomType::Box => Shape::Box,
        SceneGeomType::Mesh | SceneGeomType::Sdf if geom.mesh().is_some() => Shape::Mesh,
        _ => return None,
    })
}

/// Describes a geom of the scene that is neither a geom nor a site of the model.
pub(crate) fn description(model: &Model, geom: SceneGeom<'_>, object: Option<Object>) -> String {
    let name = |name: Option<&str>, index: usize| name.map_or_else(|| index.to_string(), str::to_owned);
    match (object, geom.geom_type()) {
        (Some(Object::Tendon(id)), _) => format!("tendon {}", name(model.tendon(id).name(), id.index())),
        (Some(Object::Skin(id)), _) => format!("skin {}", name(model.skin(id).name(), id.index())),
        (_, SceneGeomType::Flex) => format!("flex {}", geom.flex().unwrap_or_default()),
        (Some(other), shape) => format!("{shape:?} of {other:?}"),
        (None, shape) => format!("decoration: {shape:?}"),
    }
}
