//! Geoms that the user adds to a scene.

use std::ffi::{c_char, c_int};
use std::ptr;

use mujoco_sys::adapted::{self, SceneTexture};
use mujoco_sys::{self as sys, guard, mjOBJ_UNKNOWN, mjvGeom};

use super::{Categories, Scene, SceneGeomType};
use crate::error::{Error, InvalidKind, Result};
use crate::ffi;
use crate::id::{HeightFieldId, MeshId, TextureId};
use crate::macros::engine_enum;

engine_enum! {
    /// Shape of a geom that connects two points.
    Connector {
        /// Capsule. The width is its radius.
        Capsule = mjGEOM_CAPSULE,
        /// Cylinder. The width is its radius.
        Cylinder = mjGEOM_CYLINDER,
        /// Arrow. The width is the radius of its shaft. It is drawn at [half its
        /// length](SceneGeomType::Arrow): to reach a point, pass a point at twice the distance.
        Arrow = mjGEOM_ARROW,
        /// Arrow whose head is no wider than its shaft, drawn at half its length as
        /// [`Arrow`](Self::Arrow).
        Arrow1 = mjGEOM_ARROW1,
        /// Arrow with two heads. It is centred at the *first* point and extends [half its length to
        /// either side](SceneGeomType::Arrow2).
        Arrow2 = mjGEOM_ARROW2,
        /// Line. The model's visual settings define its width.
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

/// Geom to add to a scene with [`Scene::add_geom`]: shape and appearance. Grey and opaque by
/// default.
///
/// ```
/// use mujoco_safe::scene::{Connector, NewGeom, Scene};
/// use mujoco_safe::sample;
///
/// let mut scene = Scene::new(&sample::cartpole(), 100)?;
/// scene.add_geom(&NewGeom::sphere(0.1).with_pos([0.0, 0.0, 1.0]).with_rgba([1.0, 0.0, 0.0, 1.0]).with_label("goal")?)?;
/// scene.add_geom(&NewGeom::connector(Connector::Arrow, 0.02, [0.0; 3], [0.0, 0.0, 1.0]))?;
/// assert_eq!(scene.ngeom(), 2);
/// assert_eq!(scene.geom(0).label(), "goal");
/// assert_eq!(scene.geom(1).size(), [0.02, 0.02, 1.0]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
#[must_use = "a new geom is shown only after `Scene::add_geom`"]
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
    repeat: TextureRepeat,
    label: [c_char; 100],
}

/// Number of repetitions of a texture along x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "texrepeat")]
#[doc(alias = "texuniform")]
pub enum TextureRepeat {
    /// Repetitions over the whole geom.
    PerGeom([f32; 2]),
    /// Repetitions per metre.
    PerLength([f32; 2]),
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
            repeat: TextureRepeat::PerGeom([1.0; 2]),
            label: [0; 100],
        }
    }

    /// Creates a plane through its position, with normal z and these half lengths along x and y, m;
    /// 0 for infinite.
    pub fn plane(half_lengths: [f64; 2]) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Plane, [half_lengths[0], half_lengths[1], 0.0]))
    }

    /// Creates a sphere of this radius, m.
    pub fn sphere(radius: f64) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Sphere, [radius; 3]))
    }

    /// Creates a capsule along z from its radius and half the length of its cylindrical part, m.
    pub fn capsule(radius: f64, half_length: f64) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Capsule, [radius, half_length, 0.0]))
    }

    /// Creates an ellipsoid with these semi-axes, m.
    pub fn ellipsoid(radii: [f64; 3]) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Ellipsoid, radii))
    }

    /// Creates a cylinder along z from its radius and half its length, m.
    pub fn cylinder(radius: f64, half_length: f64) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Cylinder, [radius, half_length, 0.0]))
    }

    /// Creates a box with these half lengths, m.
    #[doc(alias = "box")]
    #[doc(alias = "mjGEOM_BOX")]
    pub fn cuboid(half_lengths: [f64; 3]) -> Self {
        Self::new(Shape::Simple(SceneGeomType::Box, half_lengths))
    }

    /// Creates an instance of a mesh of the model.
    pub fn mesh(mesh: impl Into<MeshId>) -> Self {
        Self::new(Shape::Mesh { mesh: mesh.into(), hull: false })
    }

    /// Creates an instance of the convex hull of a mesh of the model, or of the mesh itself if the
    /// compiler built no hull.
    pub fn convex_hull(mesh: impl Into<MeshId>) -> Self {
        Self::new(Shape::Mesh { mesh: mesh.into(), hull: true })
    }

    /// Creates an instance of a height field of the model.
    pub fn height_field(field: impl Into<HeightFieldId>) -> Self {
        Self::new(Shape::HeightField(field.into()))
    }

    /// Creates a text label without a shape, for example to name a place.
    ///
    /// # Errors
    ///
    /// As for [`with_label`](Self::with_label).
    pub fn text(text: &str) -> Result<Self> {
        Self::new(Shape::Simple(SceneGeomType::Label, [0.1; 3])).with_label(text)
    }

    /// Creates a geom that connects two points, m, world frame. They determine its position and
    /// orientation.
    #[doc(alias = "mjv_makeConnector")]
    pub fn connector(shape: Connector, width: f64, from: [f64; 3], to: [f64; 3]) -> Self {
        Self::new(Shape::Connector { shape, width, from, to })
    }

    /// Sets the position, m, world frame. Default: the origin.
    pub fn with_pos(mut self, pos: [f64; 3]) -> Self {
        self.pos = pos;
        self
    }

    /// Sets the orientation, world frame, as a row-major rotation matrix. Default: the identity.
    pub fn with_mat(mut self, mat: [f64; 9]) -> Self {
        self.mat = mat;
        self
    }

    /// Sets red, green, blue and opacity.
    pub fn with_rgba(mut self, rgba: [f32; 4]) -> Self {
        self.rgba = rgba;
        self
    }

    /// Sets emission, specular, shininess and reflectance coefficients. Default: 0, 0.5, 0.5 and 0.
    pub fn with_surface(mut self, emission: f32, specular: f32, shininess: f32, reflectance: f32) -> Self {
        (self.emission, self.specular) = (emission, specular);
        (self.shininess, self.reflectance) = (shininess, reflectance);
        self
    }

    /// Sets a texture of the model and its repetitions.
    pub fn with_texture(mut self, texture: impl Into<TextureId>, repeat: TextureRepeat) -> Self {
        (self.texture, self.repeat) = (Some(texture.into()), repeat);
        self
    }

    /// Sets the category. Default: decoration.
    pub fn with_category(mut self, category: Categories) -> Self {
        self.category = category;
        self
    }

    /// Sets the label.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for more than 99 bytes or a NUL byte.
    pub fn with_label(mut self, text: &str) -> Result<Self> {
        self.label = label(text)?;
        Ok(self)
    }

    /// Returns an error if a renderer cannot draw the geom.
    fn check(&self) -> Result<()> {
        let invalid = |what: &str, value: &dyn std::fmt::Debug, expected: &str| {
            Error::out_of_range(format!("{what} of a new geom"), format!("{value:?}"), expected)
        };
        let single = |values: &[f64]| values.iter().all(|&value| (value as f32).is_finite());
        let sizes = match &self.shape {
            Shape::Simple(_, size) => *size,
            Shape::Connector { width, from, to, .. } => {
                if !(single(from) && single(to)) {
                    return Err(invalid("an end point", &[from, to], "finite in single precision"));
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
        let (TextureRepeat::PerGeom(repeat) | TextureRepeat::PerLength(repeat)) = &self.repeat;
        let numbers = self.rgba.iter().chain(&surface).chain(repeat);
        if numbers.clone().any(|number| !(number.is_finite() && *number >= 0.0)) {
            return Err(invalid("the appearance", &numbers.collect::<Vec<_>>(), "finite and not negative"));
        }
        Ok(())
    }

    /// Returns `true` if no mesh, height field or texture belongs to another model than the scene.
    pub(crate) fn fits(&self, scene: &Scene) -> bool {
        let of_scene = match self.shape {
            Shape::Mesh { mesh, .. } => mesh.lineage() == scene.lineage,
            Shape::HeightField(field) => field.lineage() == scene.lineage,
            Shape::Simple(..) | Shape::Connector { .. } => true,
        };
        let texture = self.texture.is_none_or(|texture| texture.lineage() == scene.lineage);
        of_scene && texture
    }

    /// Converts the geom to the engine's structure.
    fn raw(&self, segid: usize) -> Result<mjvGeom> {
        // SAFETY: all-zero bytes are a valid structure of numbers and arrays of numbers.
        let mut geom: mjvGeom = unsafe { std::mem::zeroed() };
        let (geom_type, size, dataid) = match self.shape {
            Shape::Simple(geom_type, size) => (geom_type, Some(size), -1),
            Shape::Connector { .. } => (SceneGeomType::None, None, -1),
            Shape::Mesh { mesh, hull } => (SceneGeomType::Mesh, None, 2 * mesh.index() as c_int + c_int::from(hull)),
            Shape::HeightField(field) => (SceneGeomType::HeightField, None, field.index() as c_int),
        };
        let size = size.as_ref().map_or(ptr::null(), |size| size.as_ptr());
        let (pos, mat, rgba) = (self.pos.as_ptr(), self.mat.as_ptr(), self.rgba.as_ptr());
        // SAFETY: three numbers or NULL, then three, nine and four numbers; the function cannot
        // fail.
        unsafe { sys::mjv_initGeom(&raw mut geom, geom_type.raw(), size, pos, mat, rgba) };
        if let Shape::Connector { shape, width, from: [a0, a1, a2], to: [b0, b1, b2] } = self.shape {
            let geom = &raw mut geom;
            // SAFETY: the geom was initialised above.
            let status = unsafe { guard::mjv_make_connector(geom, shape.raw(), width, a0, a1, a2, b0, b1, b2) };
            ffi::check_without_data("mjv_makeConnector", status)?;
        }
        geom.dataid = dataid;
        (geom.objtype, geom.objid) = (mjOBJ_UNKNOWN as c_int, -1);
        geom.category = self.category.bits() as c_int;
        geom.segid = segid as c_int;
        let texture = self.texture.map_or(-1, |texture| texture.index() as c_int);
        let (repeat, uniform) = match self.repeat {
            TextureRepeat::PerGeom(repeat) => (repeat, 0),
            TextureRepeat::PerLength(repeat) => (repeat, 1),
        };
        let texture = SceneTexture { material: -1, texture, repeat, uniform };
        // SAFETY: two valid structures.
        if unsafe { adapted::set_scene_geom_texture(&raw mut geom, &raw const texture) } == 0 {
            return Err(Error::Unsupported("a texture of a geom without a material, with engines from 3.2".to_owned()));
        }
        (geom.emission, geom.specular) = (self.emission, self.specular);
        (geom.shininess, geom.reflectance) = (self.shininess, self.reflectance);
        geom.label = self.label;
        Ok(geom)
    }
}

/// Converts a label to the engine's fixed-size array.
pub(super) fn label(text: &str) -> Result<[c_char; 100]> {
    let mut label = [0; 100];
    if text.len() >= label.len() || text.contains('\0') {
        return Err(Error::invalid(
            InvalidKind::Text,
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
    /// Adds a geom, which remains until the next [`update`](Self::update) or
    /// [`clear`](Self::clear). Returns its index, which is also its
    /// [`segid`](super::SceneGeom::segid).
    ///
    /// # Errors
    ///
    /// [`Error::SceneFull`] if the scene is full, [`Error::Invalid`] for values that cannot be
    /// drawn.
    ///
    /// # Panics
    ///
    /// If a mesh, height field or texture of the geom belongs to another model.
    pub fn add_geom(&mut self, geom: &NewGeom) -> Result<usize> {
        assert!(geom.fits(self), "a mesh, height field or texture of a new geom belongs to another model");
        geom.check()?;
        let index = self.ngeom();
        if index >= self.max_geoms() {
            return Err(self.geoms_full());
        }
        let mut raw = geom.raw(index)?;
        self.replace_missing_hull(&mut raw);
        // SAFETY: the index is below the capacity of the buffer.
        unsafe { *self.raw().geoms.add(index) = raw };
        self.raw_mut().ngeom += 1;
        Ok(index)
    }

    /// Replaces a convex hull that the compiler has not built by the mesh itself.
    fn replace_missing_hull(&self, geom: &mut mjvGeom) {
        if geom.type_ == SceneGeomType::Mesh.raw()
            && geom.dataid % 2 == 1
            && !self.has_convex_hull[ffi::size(geom.dataid / 2)]
        {
            geom.dataid -= 1;
        }
    }
}
