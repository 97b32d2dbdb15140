//! Geoms that the user adds.

use std::ffi::{c_char, c_int};
use std::ptr;

use mujoco_sys::{self as sys, guard, mjOBJ_UNKNOWN, mjvGeom};

use super::{Categories, Scene, SceneGeomType};
use crate::enums::engine_enum;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{HeightFieldId, MeshId, TextureId};
use crate::model::Model;

engine_enum! {
    /// The shape of something that reaches from one point to another.
    Connector {
        /// A capsule; its width is its radius.
        Capsule = mjGEOM_CAPSULE,
        /// A cylinder; its width is its radius.
        Cylinder = mjGEOM_CYLINDER,
        /// An arrow; its width is the radius of its shaft. It is drawn [only half as long](SceneGeomType::Arrow): to reach a point, give
        /// one that is twice as far.
        Arrow = mjGEOM_ARROW,
        /// An arrow that is no wider at its head. It is drawn only half as long, as [`Arrow`](Self::Arrow).
        Arrow1 = mjGEOM_ARROW1,
        /// An arrow with a head at both ends. It is drawn around the *first* point, [half its length to either
        /// side](SceneGeomType::Arrow2).
        Arrow2 = mjGEOM_ARROW2,
        /// A line, whose width is that of the model's visual settings.
        Line = mjGEOM_LINE,
    }
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Simple(SceneGeomType, [f64; 3]),
    Connector { shape: Connector, width: f64, from: [f64; 3], to: [f64; 3] },
    Mesh { mesh: MeshId, hull: bool },
    HeightField(HeightFieldId),
}

/// A geom to add to a scene with [`Scene::push`]: a shape, and what it looks like. Grey and opaque unless said otherwise.
///
/// ```
/// use mujoco_safe::scene::{Connector, NewGeom, Scene};
/// use mujoco_safe::sample;
///
/// let mut scene = Scene::new(&sample::cartpole(), 100)?;
/// scene.push(&NewGeom::sphere(0.1).pos([0.0, 0.0, 1.0]).rgba([1.0, 0.0, 0.0, 1.0]).label("goal")?)?;
/// scene.push(&NewGeom::connector(Connector::Arrow, 0.02, [0.0; 3], [0.0, 0.0, 1.0]))?;
/// assert_eq!(scene.ngeom(), 2);
/// assert_eq!(scene.geom(0).label(), "goal");
/// assert_eq!(scene.geom(1).size(), [0.02, 0.02, 1.0]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
#[doc(alias = "mjv_initGeom")]
#[must_use = "it is shown once it is pushed to a scene"]
pub struct NewGeom {
    shape: Shape,
    pos: [f64; 3],
    mat: [f64; 9],
    rgba: [f32; 4],
    emission: f32,
    specular: f32,
    shininess: f32,
    reflectance: f32,
    category: Categories,
    texture: Option<TextureId>,
    texrepeat: [f32; 2],
    texuniform: bool,
    label: [c_char; 100],
}

impl NewGeom {
    fn new(shape: Shape) -> Self {
        Self {
            shape,
            pos: [0.0; 3],
            mat: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            rgba: [0.5, 0.5, 0.5, 1.0],
            emission: 0.0,
            specular: 0.5,
            shininess: 0.5,
            reflectance: 0.0,
            category: Categories::DECOR,
            texture: None,
            texrepeat: [1.0; 2],
            texuniform: false,
            label: [0; 100],
        }
    }

    /// A plane through its position, with its normal along z, and these half lengths along x and y, m; 0 for infinite.
    pub fn plane(half_lengths: [f64; 2]) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Plane, [half_lengths[0], half_lengths[1], 0.0]))
    }

    /// A sphere of this radius, m.
    pub fn sphere(radius: f64) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Sphere, [radius; 3]))
    }

    /// A capsule along z: its radius and half the length of its cylinder, m.
    pub fn capsule(radius: f64, half_length: f64) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Capsule, [radius, half_length, 0.0]))
    }

    /// An ellipsoid of these radii, m.
    pub fn ellipsoid(radii: [f64; 3]) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Ellipsoid, radii))
    }

    /// A cylinder along z: its radius and half its length, m.
    pub fn cylinder(radius: f64, half_length: f64) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Cylinder, [radius, half_length, 0.0]))
    }

    /// A box of these half lengths, m.
    #[doc(alias = "box")]
    #[doc(alias = "mjGEOM_BOX")]
    pub fn cuboid(half_lengths: [f64; 3]) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Box, half_lengths))
    }

    /// A mesh of the model.
    pub fn mesh(mesh: MeshId) -> Self {
        Self::new(Shape::Mesh { mesh, hull: false })
    }

    /// The convex hull of a mesh of the model; the mesh itself if the compiler has made no hull.
    pub fn convex_hull(mesh: MeshId) -> Self {
        Self::new(Shape::Mesh { mesh, hull: true })
    }

    /// A height field of the model.
    pub fn height_field(field: HeightFieldId) -> Self {
        Self::new(Shape::HeightField(field))
    }

    /// A text without a shape: the name of a place.
    ///
    /// # Errors
    ///
    /// As for [`label`](Self::label).
    pub fn text(text: &str) -> Result<Self> {
        Self::new(Shape::Simple(SceneGeomType::Label, [0.1; 3])).label(text)
    }

    /// Something that reaches from one point to another, world frame, m. Its position and orientation follow from them.
    #[doc(alias = "mjv_makeConnector")]
    pub fn connector(shape: Connector, width: f64, from: [f64; 3], to: [f64; 3]) -> Self {
        Self::new(Shape::Connector { shape, width, from, to })
    }

    /// Its position, m, world frame. The zero point if it is not said.
    pub fn pos(mut self, pos: [f64; 3]) -> Self {
        self.pos = pos;
        self
    }

    /// Its orientation, world frame: a row-major rotation matrix. That of the world if it is not said.
    pub fn mat(mut self, mat: [f64; 9]) -> Self {
        self.mat = mat;
        self
    }

    /// Red, green, blue and opacity.
    pub fn rgba(mut self, rgba: [f32; 4]) -> Self {
        self.rgba = rgba;
        self
    }

    /// Emission, specularity, shininess and reflectance. 0, 0.5, 0.5 and 0 if it is not said.
    pub fn surface(mut self, emission: f32, specular: f32, shininess: f32, reflectance: f32) -> Self {
        (self.emission, self.specular) = (emission, specular);
        (self.shininess, self.reflectance) = (shininess, reflectance);
        self
    }

    /// A texture of the model, how often it is repeated along x and y, and whether that is meant for each unit of length.
    pub fn texture(mut self, texture: TextureId, texrepeat: [f32; 2], texuniform: bool) -> Self {
        (self.texture, self.texrepeat, self.texuniform) = (Some(texture), texrepeat, texuniform);
        self
    }

    /// Its category. Decoration if it is not said.
    pub fn category(mut self, category: Categories) -> Self {
        self.category = category;
        self
    }

    /// Its label.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for more than 99 bytes, or a NUL byte among them.
    pub fn label(mut self, text: &str) -> Result<Self> {
        self.label = label(text)?;
        Ok(self)
    }

    /// Refuses what no renderer can show.
    fn check(&self) -> Result<()> {
        let invalid = |what: &str, value: &dyn std::fmt::Debug, expected: &str| {
            Error::invalid(format!("{what} of a new geom"), format!("{value:?}"), expected)
        };
        let single = |values: &[f64]| values.iter().all(|&value| (value as f32).is_finite());
        let sizes = match &self.shape {
            Shape::Simple(_, size) => *size,
            Shape::Connector { width, from, to, .. } => {
                if !(single(from) && single(to)) {
                    return Err(invalid("an end", &[from, to], "finite in single precision"));
                }
                [*width; 3]
            }
            Shape::Mesh { .. } | Shape::HeightField(_) => [0.0; 3],
        };
        if !single(&sizes) || sizes.iter().any(|&size| size < 0.0) {
            return Err(invalid("the size", &sizes, "finite and not negative"));
        }
        if !(single(&self.pos) && single(&self.mat)) {
            return Err(invalid("the pose", &(self.pos, self.mat), "finite in single precision"));
        }
        let surface = [self.emission, self.specular, self.shininess, self.reflectance];
        let numbers = self.rgba.iter().chain(&surface).chain(&self.texrepeat);
        if numbers.clone().any(|number| !(number.is_finite() && *number >= 0.0)) {
            return Err(invalid("the look", &numbers.collect::<Vec<_>>(), "finite and not negative"));
        }
        Ok(())
    }

    /// Panics for an id of another model.
    #[track_caller]
    fn check_ids(&self, scene: &Scene) {
        let of_scene = match self.shape {
            Shape::Mesh { mesh, .. } => mesh.lineage() == scene.lineage,
            Shape::HeightField(field) => field.lineage() == scene.lineage,
            Shape::Simple(..) | Shape::Connector { .. } => true,
        };
        let texture = self.texture.is_none_or(|texture| texture.lineage() == scene.lineage);
        assert!(of_scene && texture, "a mesh, height field or texture of a new geom belongs to another model");
    }

    /// As the engine keeps it.
    fn raw(&self, segid: usize) -> Result<mjvGeom> {
        // SAFETY: numbers, arrays of numbers.
        let mut geom: mjvGeom = unsafe { std::mem::zeroed() };
        let (geom_type, size, dataid) = match self.shape {
            Shape::Simple(geom_type, size) => (geom_type, Some(size), -1),
            Shape::Connector { .. } => (SceneGeomType::None, None, -1),
            Shape::Mesh { mesh, hull } => (SceneGeomType::Mesh, None, 2 * mesh.index() as c_int + c_int::from(hull)),
            Shape::HeightField(field) => (SceneGeomType::HeightField, None, field.index() as c_int),
        };
        let size = size.as_ref().map_or(ptr::null(), |size| size.as_ptr());
        let (pos, mat, rgba) = (self.pos.as_ptr(), self.mat.as_ptr(), self.rgba.as_ptr());
        // SAFETY: three numbers or NULL, three, nine and four; the function cannot fail.
        unsafe { sys::mjv_initGeom(&raw mut geom, geom_type.raw(), size, pos, mat, rgba) };
        if let Shape::Connector { shape, width, from: [a0, a1, a2], to: [b0, b1, b2] } = self.shape {
            let geom = &raw mut geom;
            // SAFETY: a geom that was initialised.
            let status = unsafe { guard::mjv_make_connector(geom, shape.raw(), width, a0, a1, a2, b0, b1, b2) };
            ffi::check_without_data("mjv_makeConnector", status)?;
        }
        geom.dataid = dataid;
        (geom.objtype, geom.objid) = (mjOBJ_UNKNOWN as c_int, -1);
        geom.category = self.category.bits() as c_int;
        geom.segid = segid as c_int;
        geom.texid = self.texture.map_or(-1, |texture| texture.index() as c_int);
        (geom.texrepeat, geom.texuniform) = (self.texrepeat, self.texuniform.into());
        (geom.emission, geom.specular) = (self.emission, self.specular);
        (geom.shininess, geom.reflectance) = (self.shininess, self.reflectance);
        geom.label = self.label;
        Ok(geom)
    }
}

/// A label as the engine keeps it.
pub(super) fn label(text: &str) -> Result<[c_char; 100]> {
    let mut label = [0; 100];
    if text.len() >= label.len() || text.contains('\0') {
        return Err(Error::invalid(
            "a label",
            format!("{text:?}, {} bytes", text.len()),
            "at most 99 bytes, none of them NUL",
        ));
    }
    for (to, from) in label.iter_mut().zip(text.bytes()) {
        *to = from as c_char;
    }
    Ok(label)
}

impl Scene {
    /// Adds a geom, which stays until the next [`update`](Self::update) or [`clear`](Self::clear). Its index, which is its
    /// [`segid`](super::SceneGeom::segid) too, is returned.
    ///
    /// # Errors
    ///
    /// [`Error::SceneFull`] if there is no room for it, [`Error::Invalid`] for numbers that cannot be shown.
    ///
    /// # Panics
    ///
    /// If a mesh, a height field or a texture of the geom belongs to another model.
    pub fn push(&mut self, geom: &NewGeom) -> Result<usize> {
        geom.check_ids(self);
        geom.check()?;
        let index = self.ngeom();
        if index >= self.max_geoms() {
            return Err(self.geoms_full());
        }
        let mut raw = geom.raw(index)?;
        self.without_missing_hull(&mut raw);
        // SAFETY: there is room for one more in the buffer.
        unsafe { *self.raw().geoms.add(index) = raw };
        self.raw_mut().ngeom += 1;
        Ok(index)
    }

    /// A mesh for which the compiler has made no convex hull is shown as it is.
    fn without_missing_hull(&self, geom: &mut mjvGeom) {
        if geom.type_ == SceneGeomType::Mesh.raw() && geom.dataid % 2 == 1 && !self.hulls[ffi::size(geom.dataid / 2)] {
            geom.dataid -= 1;
        }
    }

    /// For each mesh whether it has a convex hull.
    pub(super) fn hulls_of(model: &Model) -> Box<[bool]> {
        model.mesh_graphadr().iter().map(|&address| address >= 0).collect()
    }
}
