//! Looks of a model: geoms, lights and cameras, as the scene of the engine has them.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::assets::{HeightField, Mesh, Texture};
use super::frame::Frame;
use super::options::HtmlOptions;
use super::stream::Binary;
use super::texture_map::TextureMap;
use super::view::{FixedCamera, FreeCamera, Light};
use crate::data::Data;
use crate::element::Object;
use crate::enums::TextureType;
use crate::error::Result;
use crate::id::{MeshId, TextureId};
use crate::model::Model;
use crate::scene::{Camera, Scene, SceneGeom, SceneGeomType, SceneOptions};

/// Contents of the picture, apart from its motion. Assets have the indices of the model.
#[derive(Debug, Serialize)]
pub(super) struct Look {
    geoms: Vec<Geom>,
    meshes: BTreeMap<usize, Mesh>,
    height_fields: BTreeMap<usize, HeightField>,
    /// `None` for a texture that is drawn white.
    textures: BTreeMap<usize, Option<Texture>>,
    /// Index of the texture of the sky.
    sky: Option<usize>,
    lights: Vec<Light>,
    cameras: Vec<FixedCamera>,
    free: FreeCamera,
    /// Descriptions of what the page does not draw.
    pub(super) left_out: BTreeSet<String>,
}

/// Geom or site.
#[derive(Debug, Serialize)]
struct Geom {
    /// `geom` or `site`.
    element: &'static str,
    name: Option<String>,
    /// Index of the body, which is its frame.
    frame: usize,
    /// Position, m, and orientation in its frame.
    pos: [f64; 3],
    quat: [f64; 4],
    shape: &'static str,
    /// As [`SceneGeomType`] defines it.
    size: [f32; 3],
    /// Index of the mesh or of the height field.
    asset: Option<usize>,
    rgba: [f32; 4],
    emission: f32,
    specular: f32,
    shininess: f32,
    texture: Option<usize>,
    map: TextureMap,
}

impl Look {
    /// Collects the looks of a model. `data` has the positions of the first record.
    pub(super) fn new(binary: &mut Binary, data: &mut Data, frames: &[Frame], options: &HtmlOptions) -> Result<Self> {
        let model = data.model().clone();
        let mut scene = Scene::new(&model, model.ngeom() + model.nsite() + 100)?;
        let scene_options = SceneOptions::default().with_geomgroup(options.geomgroup).with_sitegroup(options.sitegroup);
        let mut camera = Camera::free(&model);
        scene.update_and_grow(data, &scene_options, &mut camera)?;
        let mut left_out = BTreeSet::new();
        let free = FreeCamera::new(&scene.viewpoint(), camera.lookat);
        let mut look = Self {
            geoms: Vec::new(),
            meshes: BTreeMap::new(),
            height_fields: BTreeMap::new(),
            textures: BTreeMap::new(),
            sky: None,
            lights: Light::all(&model, frames, &scene, &mut left_out),
            cameras: FixedCamera::all(data, frames, &mut scene)?,
            free,
            left_out,
        };
        look.add_geoms(binary, &model, &scene);
        let sky = model.textures().find(|texture| texture.texture_type() == TextureType::Skybox);
        look.sky = sky.map(|texture| look.texture(binary, &model, texture.id()));
        Ok(look)
    }

    fn add_geoms(&mut self, binary: &mut Binary, model: &Model, scene: &Scene) {
        // The page has the texture coordinates of meshes that any geom draws with a texture.
        let textured: BTreeSet<MeshId> =
            scene.geoms().filter(|geom| geom.texture().is_some()).filter_map(SceneGeom::mesh).collect();
        for geom in scene.geoms() {
            let (element, name, frame, pos, quat) = match geom.object() {
                Some(Object::Geom(id)) => {
                    let at = id.index();
                    let place = (model.geom_bodyid()[at], model.geom_pos()[at], model.geom_quat()[at]);
                    ("geom", model.geom(id).name(), place.0, place.1, place.2)
                }
                Some(Object::Site(id)) => {
                    let at = id.index();
                    let place = (model.site_bodyid()[at], model.site_pos()[at], model.site_quat()[at]);
                    ("site", model.site(id).name(), place.0, place.1, place.2)
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
                let mesh = || Mesh::new(binary, model, id, textured.contains(&id));
                self.meshes.entry(id.index()).or_insert_with(mesh);
            }
            if let Some(id) = geom.height_field() {
                self.height_fields.entry(id.index()).or_insert_with(|| HeightField::new(binary, model, id));
            }
            let texture = geom.texture().map(|id| self.texture(binary, model, id));
            let is_cube = texture.and_then(|index| self.textures[&index].as_ref()).is_some_and(|found| found.cube);
            self.geoms.push(Geom {
                element,
                name: name.map(str::to_owned),
                frame: frame as usize,
                pos,
                quat,
                shape,
                size: geom.size(),
                asset: geom.mesh().map(|id| id.index()).or(geom.height_field().map(|id| id.index())),
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
    fn texture(&mut self, binary: &mut Binary, model: &Model, id: TextureId) -> usize {
        if !self.textures.contains_key(&id.index()) {
            let texture = Texture::new(binary, model, id).map_err(|error| {
                let name = model.texture(id).name().unwrap_or("without a name");
                self.left_out.insert(format!("texture {name}: {error}"));
            });
            self.textures.insert(id.index(), texture.ok());
        }
        id.index()
    }
}

/// Returns the name of a shape that the page draws.
fn shape(geom: SceneGeom<'_>) -> Option<&'static str> {
    Some(match geom.geom_type() {
        SceneGeomType::Plane => "plane",
        SceneGeomType::HeightField if geom.height_field().is_some() => "heightfield",
        SceneGeomType::Sphere | SceneGeomType::Ellipsoid => "ellipsoid",
        SceneGeomType::Capsule => "capsule",
        SceneGeomType::Cylinder => "cylinder",
        SceneGeomType::Box => "box",
        SceneGeomType::Mesh | SceneGeomType::Sdf if geom.mesh().is_some() => "mesh",
        _ => return None,
    })
}

/// Describes a geom of the scene that is neither a geom nor a site of the model.
fn description(model: &Model, geom: SceneGeom<'_>, object: Option<Object>) -> String {
    let name = |name: Option<&str>, index: usize| name.map_or_else(|| index.to_string(), str::to_owned);
    match (object, geom.geom_type()) {
        (Some(Object::Tendon(id)), _) => format!("tendon {}", name(model.tendon(id).name(), id.index())),
        (Some(Object::Skin(id)), _) => format!("skin {}", name(model.skin(id).name(), id.index())),
        (_, SceneGeomType::Flex) => format!("flex {}", geom.flex().unwrap_or_default()),
        (Some(other), shape) => format!("{shape:?} of {other:?}"),
        (None, shape) => format!("decoration: {shape:?}"),
    }
}
