//! A geom of a scene, to look at and to repaint.

use std::fmt;

use mujoco_sys::{self as sys, mjOBJ_UNKNOWN, mjvGeom};

use super::{Categories, Scene};
use crate::enums::engine_enum;
use crate::error::Result;
use crate::ffi;
use crate::id::{
    ActuatorId, BodyId, CameraId, EqualityId, GeomId, HeightFieldId, Id, JointId, Kind, LightId, Lineage, MeshId,
    SiteId, SkinId, TendonId, TextureId,
};

engine_enum! {
    /// The shape of a geom in a scene: those of a model, and some for decoration.
    #[doc(alias = "mjtGeom")]
    SceneGeomType {
        /// A plane through its origin, normal along z; `size`: half lengths along x and y, 0 for infinite.
        Plane = mjGEOM_PLANE,
        /// A height field.
        HeightField = mjGEOM_HFIELD,
        /// A sphere; `size`: three times the radius.
        Sphere = mjGEOM_SPHERE,
        /// A capsule along z; `size`: twice the radius, half the length of its cylinder.
        Capsule = mjGEOM_CAPSULE,
        /// An ellipsoid; `size`: its radii.
        Ellipsoid = mjGEOM_ELLIPSOID,
        /// A cylinder along z; `size`: twice the radius, half the length.
        Cylinder = mjGEOM_CYLINDER,
        /// A box; `size`: half lengths.
        Box = mjGEOM_BOX,
        /// A mesh.
        Mesh = mjGEOM_MESH,
        /// An arrow from its origin along z; `size`: twice the radius of its shaft, and a length of which the engine's renderer, and so
        /// ours, draws only half: a third of it is shaft, a sixth is head.
        Arrow = mjGEOM_ARROW,
        /// An arrow of which the head is no wider than the shaft, measured likewise.
        Arrow1 = mjGEOM_ARROW1,
        /// An arrow in both directions, measured likewise. It is drawn around its origin, half its length to either side.
        Arrow2 = mjGEOM_ARROW2,
        /// A line from its origin along z; `size`: twice the width, the length.
        Line = mjGEOM_LINE,
        /// A skin.
        Skin = mjGEOM_SKIN,
        /// A text without a shape.
        Label = mjGEOM_LABEL,
        /// Nothing.
        None = mjGEOM_NONE,
    }
}

/// The element of the model that a geom of a scene stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the kinds of element, by their names")]
pub enum SceneObject {
    Body(BodyId),
    Joint(JointId),
    Geom(GeomId),
    Site(SiteId),
    Camera(CameraId),
    Light(LightId),
    Tendon(TendonId),
    Actuator(ActuatorId),
    Equality(EqualityId),
    Skin(SkinId),
}

impl SceneObject {
    fn new(kind: Kind, index: usize, lineage: Lineage) -> Option<Self> {
        Some(match kind {
            Kind::Body => Self::Body(Id::new(index, lineage)),
            Kind::Joint => Self::Joint(Id::new(index, lineage)),
            Kind::Geom => Self::Geom(Id::new(index, lineage)),
            Kind::Site => Self::Site(Id::new(index, lineage)),
            Kind::Camera => Self::Camera(Id::new(index, lineage)),
            Kind::Light => Self::Light(Id::new(index, lineage)),
            Kind::Tendon => Self::Tendon(Id::new(index, lineage)),
            Kind::Actuator => Self::Actuator(Id::new(index, lineage)),
            Kind::Equality => Self::Equality(Id::new(index, lineage)),
            Kind::Skin => Self::Skin(Id::new(index, lineage)),
            _ => return None,
        })
    }
}

/// One geom of a scene. Its numbers are single precision, as a graphics card wants them.
#[derive(Clone, Copy)]
#[doc(alias = "mjvGeom")]
pub struct SceneGeom<'s> {
    raw: &'s mjvGeom,
    lineage: Lineage,
}

impl<'s> SceneGeom<'s> {
    pub(super) fn new(raw: &'s mjvGeom, lineage: Lineage) -> Self {
        Self { raw, lineage }
    }

    /// Its shape.
    #[doc(alias = "type")]
    pub fn geom_type(self) -> SceneGeomType {
        SceneGeomType::of_field(self.raw.type_)
    }

    /// Its measures, as [`SceneGeomType`] says, m.
    pub fn size(self) -> [f32; 3] {
        self.raw.size
    }

    /// Its position, m, world frame.
    pub fn pos(self) -> [f32; 3] {
        self.raw.pos
    }

    /// Its orientation, world frame: a row-major rotation matrix.
    pub fn mat(self) -> [f32; 9] {
        self.raw.mat
    }

    /// Red, green, blue and opacity.
    pub fn rgba(self) -> [f32; 4] {
        self.raw.rgba
    }

    /// Emission.
    pub fn emission(self) -> f32 {
        self.raw.emission
    }

    /// Specularity.
    pub fn specular(self) -> f32 {
        self.raw.specular
    }

    /// Shininess.
    pub fn shininess(self) -> f32 {
        self.raw.shininess
    }

    /// Reflectance.
    pub fn reflectance(self) -> f32 {
        self.raw.reflectance
    }

    /// Its category.
    pub fn category(self) -> Categories {
        Categories::from_bits_truncate(self.raw.category as u32)
    }

    /// The element that it stands for; none for decoration and for what the user added.
    #[doc(alias = "objtype")]
    #[doc(alias = "objid")]
    pub fn object(self) -> Option<SceneObject> {
        if self.raw.objtype == mjOBJ_UNKNOWN as i32 {
            return None;
        }
        let kind = Kind::ALL.iter().find(|kind| kind.object_type() == self.raw.objtype)?;
        SceneObject::new(*kind, usize::try_from(self.raw.objid).ok()?, self.lineage)
    }

    /// Its number for segmentation: its index in the scene.
    pub fn segid(self) -> usize {
        ffi::size(self.raw.segid)
    }

    /// Its texture.
    #[doc(alias = "texid")]
    pub fn texture(self) -> Option<TextureId> {
        usize::try_from(self.raw.texid).ok().map(|texture| Id::new(texture, self.lineage))
    }

    /// How often a texture of two dimensions is repeated along x and y; 0 without a material.
    pub fn texrepeat(self) -> [f32; 2] {
        self.raw.texrepeat
    }

    /// Whether the texture is repeated once for each unit of length, whatever the size.
    pub fn texuniform(self) -> bool {
        self.raw.texuniform != 0
    }

    /// Whether its mesh or skin has texture coordinates.
    pub fn texcoord(self) -> bool {
        self.raw.texcoord != 0
    }

    /// Its mesh, and whether it is shown as its convex hull.
    #[doc(alias = "dataid")]
    pub fn mesh(self) -> Option<(MeshId, bool)> {
        let data = self.data(SceneGeomType::Mesh)?;
        Some((Id::new(data / 2, self.lineage), data % 2 == 1))
    }

    /// Its height field.
    #[doc(alias = "dataid")]
    pub fn height_field(self) -> Option<HeightFieldId> {
        self.data(SceneGeomType::HeightField).map(|field| Id::new(field, self.lineage))
    }

    /// The number of the plane among the planes of the model; none for one that the user added.
    #[doc(alias = "dataid")]
    pub fn plane(self) -> Option<usize> {
        self.data(SceneGeomType::Plane)
    }

    fn data(self, of: SceneGeomType) -> Option<usize> {
        if self.geom_type() == of { usize::try_from(self.raw.dataid).ok() } else { None }
    }

    /// Its label, which may be empty. One of 99 bytes and more was cut by the engine, which can leave half of a character: that
    /// half is left out here.
    pub fn label(self) -> &'s str {
        let label = &self.raw.label;
        // SAFETY: the bytes of an array that outlives `'s`.
        let label: &'s [u8] = unsafe { ffi::array(label.as_ptr().cast(), label.len()) };
        let label = label.split(|&byte| byte == 0).next().unwrap_or_default();
        match std::str::from_utf8(label) {
            Ok(label) => label,
            Err(error) => std::str::from_utf8(&label[..error.valid_up_to()]).unwrap_or_default(),
        }
    }

    /// The radius of a sphere around the geom of the model that it stands for, m; 0 for others and for planes.
    #[doc(alias = "rbound")]
    pub fn modelrbound(self) -> f32 {
        self.raw.modelrbound
    }

    /// Its distance from the camera, if a renderer past this crate has set it.
    pub fn camdist(self) -> f32 {
        self.raw.camdist
    }

    /// Whether it is to be drawn as transparent, if a renderer past this crate has set it.
    pub fn transparent(self) -> bool {
        self.raw.transparent != 0
    }
}

impl fmt::Debug for SceneGeom<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SceneGeom")
            .field("type", &self.geom_type())
            .field("size", &self.size())
            .field("pos", &self.pos())
            .field("rgba", &self.rgba())
            .field("category", &self.category())
            .field("object", &self.object())
            .field("label", &self.label())
            .finish_non_exhaustive()
    }
}

/// One geom of a scene, to repaint.
pub struct SceneGeomMut<'s> {
    raw: &'s mut mjvGeom,
    lineage: Lineage,
}

impl SceneGeomMut<'_> {
    /// To look at it.
    pub fn view(&self) -> SceneGeom<'_> {
        SceneGeom::new(self.raw, self.lineage)
    }

    /// Sets red, green, blue and opacity.
    pub fn set_rgba(&mut self, rgba: [f32; 4]) {
        self.raw.rgba = rgba;
    }

    /// Sets the emission.
    pub fn set_emission(&mut self, emission: f32) {
        self.raw.emission = emission;
    }

    /// Sets the position, m, world frame.
    pub fn set_pos(&mut self, pos: [f32; 3]) {
        self.raw.pos = pos;
    }

    /// Sets the label.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) for more than 99 bytes, or a NUL byte among them.
    pub fn set_label(&mut self, label: &str) -> Result<()> {
        self.raw.label = super::new_geom::label(label)?;
        Ok(())
    }
}

impl fmt::Debug for SceneGeomMut<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.view().fmt(f)
    }
}

impl Scene {
    /// How many geoms there are.
    pub fn ngeom(&self) -> usize {
        ffi::size(self.raw().ngeom)
    }

    /// The geoms, in the order in which they were added.
    pub fn geoms(&self) -> impl ExactSizeIterator<Item = SceneGeom<'_>> + DoubleEndedIterator + Clone + '_ {
        self.raw_geoms().iter().map(|raw| SceneGeom::new(raw, self.lineage))
    }

    /// One geom.
    ///
    /// # Panics
    ///
    /// If there is none of this index.
    #[track_caller]
    pub fn geom(&self, index: usize) -> SceneGeom<'_> {
        SceneGeom::new(&self.raw_geoms()[index], self.lineage)
    }

    /// The geoms, to repaint: a trail of poses that fades, say.
    pub fn geoms_mut(&mut self) -> impl ExactSizeIterator<Item = SceneGeomMut<'_>> + '_ {
        let lineage = self.lineage;
        let (geoms, count) = (self.raw().geoms, self.ngeom());
        // SAFETY: as for `raw_geoms`, and `self` is borrowed exclusively.
        unsafe { ffi::array_mut(geoms, count) }.iter_mut().map(move |raw| SceneGeomMut { raw, lineage })
    }

    fn raw_geoms(&self) -> &[mjvGeom] {
        // SAFETY: all of the buffer was zeroed, and its first `ngeom` are in use; written to through `&mut self` only.
        unsafe { ffi::array(self.raw().geoms, self.ngeom()) }
    }
}
