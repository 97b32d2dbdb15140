//! Looks of a model: geoms, lights and cameras, as the scene of the engine has them.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::motion;
use super::names::{decoration, description};
use super::texture::{Texture, TextureMap};
use super::view::{CameraLook, Light};
use crate::data::Data;
use crate::element::Object;
use crate::enums::TextureType;
use crate::error::Result;
use crate::id::TextureId;
use crate::kind::Kind;
use crate::model::Model;
use crate::scene::{Camera, Scene, SceneGeom, SceneGeomType, SceneOptions};

/// Contents of the picture, apart from its motion. Assets have the indices of the model.
#[derive(Debug, Serialize)]
pub(crate) struct Look {
    pub(crate) geoms: Vec<Geom>,
    /// `None` for a texture that is drawn white.
    #[serde(skip)]
    pub(crate) textures: BTreeMap<usize, Option<Texture>>,
    /// Index of the texture of the sky.
    pub(crate) sky: Option<usize>,
    pub(crate) lights: Vec<Light>,
    pub(crate) cameras: Vec<CameraLook>,
    pub(crate) free: CameraLook,
    /// Point at the centre of the view of the free camera, m.
    pub(crate) lookat: [f64; 3],
    /// Descriptions of what is not drawn.
    pub(crate) left_out: BTreeSet<String>,
}

/// Geom or site.
#[derive(Debug, Serialize)]
pub(crate) struct Geom {
    /// `geom` or `site`.
    pub(crate) element: String,
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
    #[serde(flatten)]
    pub(crate) surface: Surface,
    pub(crate) texture: Option<usize>,
    pub(crate) map: TextureMap,
}

/// Colour and highlight of a surface.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Surface {
    pub(crate) rgba: [f32; 4],
    pub(crate) emission: f32,
    pub(crate) specular: f32,
    pub(crate) shininess: f32,
}

impl Surface {
    pub(crate) fn new(geom: SceneGeom<'_>) -> Self {
        let (emission, specular, shininess) = (geom.emission(), geom.specular(), geom.shininess());
        Self { rgba: geom.rgba(), emission, specular, shininess }
    }
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
    /// Collects the looks of a model, and returns them with the scene. `data` has the positions of
    /// the first record.
    pub(crate) fn new(data: &mut Data, options: &SceneOptions) -> Result<(Self, Scene)> {
        let model = data.model().clone();
        let frames = motion::all(&model);
        let mut scene = Scene::new(&model, model.ngeom() + model.nsite() + 100)?;
        let mut camera = Camera::free(&model);
        scene.update_and_grow(data, options, &mut camera)?;
        let free = CameraLook::free(scene.viewpoint());
        let mut left_out = BTreeSet::new();
        let mut look = Self {
            geoms: Vec::new(),
            textures: BTreeMap::new(),
            sky: None,
            lights: Light::all(&model, &frames, &scene, &mut left_out),
            cameras: CameraLook::all(data, &frames, &mut scene)?,
            free,
            lookat: camera.lookat,
            left_out,
        };
        look.add_geoms(&model, &scene);
        let sky = model.textures().find(|texture| texture.texture_type() == TextureType::Skybox);
        look.sky = sky.map(|texture| look.texture(&model, texture.id()));
        Ok((look, scene))
    }

    fn add_geoms(&mut self, model: &Model, scene: &Scene) {
        for geom in scene.geoms() {
            let (element, at) = match geom.object() {
                Some(Object::Geom(id)) => (Kind::Geom, id.index()),
                Some(Object::Site(id)) => (Kind::Site, id.index()),
                _ => {
                    self.left_out.insert(decoration(model, geom));
                    continue;
                }
            };
            let (frame, pos, quat, material) = if element == Kind::Geom {
                (model.geom_bodyid()[at], model.geom_pos()[at], model.geom_quat()[at], model.geom_matid()[at])
            } else {
                (model.site_bodyid()[at], model.site_pos()[at], model.site_quat()[at], model.site_matid()[at])
            };
            let Some(shape) = shape(geom) else {
                self.left_out.insert(description(model, element, at));
                continue;
            };
            let texture = geom.texture().map(|id| self.texture(model, id));
            let is_cube = texture.and_then(|index| self.textures[&index].as_ref()).is_some_and(|found| found.is_cube);
            self.geoms.push(Geom {
                element: element.to_string(),
                name: model.name_at(element, at).map(str::to_owned),
                frame: frame as usize,
                pos,
                quat,
                shape,
                size: geom.size(),
                asset: geom.mesh().map(|id| id.index()).or(geom.height_field().map(|id| id.index())),
                material: usize::try_from(material).ok(),
                surface: Surface::new(geom),
                texture,
                map: TextureMap::new(geom, is_cube),
            });
        }
    }

    /// Adds a texture unless it is known, and returns its index.
    pub(crate) fn texture(&mut self, model: &Model, id: TextureId) -> usize {
        if !self.textures.contains_key(&id.index()) {
            let texture = Texture::new(model, id).map_err(|error| {
                self.left_out.insert(format!("{}: {error}", description(model, Kind::Texture, id.index())));
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
