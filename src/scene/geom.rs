//! Geoms and skins of a scene: read access, and changes of the appearance.

use std::fmt;

use mujoco_sys::{self as sys, adapted, mjvGeom};

use super::{Categories, Scene};
use crate::element::Object;
use crate::error::Result;
use crate::ffi;
use crate::id::{HeightFieldId, Id, Lineage, MeshId, SkinId, TextureId};
use crate::macros::engine_enum;
use crate::model::Model;

engine_enum! {
    /// Shape of a geom in a scene: the shapes of a model, and shapes for decoration only.
    SceneGeomType {
        /// Plane through its origin, normal along z. `size`: half lengths along x and y, 0 for
        /// infinite.
        Plane = mjGEOM_PLANE,
        /// Height field.
        HeightField = mjGEOM_HFIELD,
        /// Sphere. `size`: the radius, three times.
        Sphere = mjGEOM_SPHERE,
        /// Capsule along z. `size`: the radius, twice, and half the length of the cylindrical part.
        Capsule = mjGEOM_CAPSULE,
        /// Ellipsoid. `size`: the semi-axes.
        Ellipsoid = mjGEOM_ELLIPSOID,
        /// Cylinder along z. `size`: the radius, twice, and half the length.
        Cylinder = mjGEOM_CYLINDER,
        /// Box. `size`: half lengths.
        Box = mjGEOM_BOX,
        /// Triangle mesh.
        Mesh = mjGEOM_MESH,
        /// Signed distance field, shown as a triangle mesh. With engines from 3.0.
        Sdf = mjGEOM_SDF,
        /// Arrow from its origin along z. `size`: the radius of the shaft, twice, and a length. The
        /// engine's renderer and this crate's draw only half of that length: a third of it as the
        /// shaft, a sixth as the head.
        Arrow = mjGEOM_ARROW,
        /// Arrow whose head is no wider than its shaft, with the size of an [`Arrow`](Self::Arrow).
        Arrow1 = mjGEOM_ARROW1,
        /// Arrow with two heads, with the size of an [`Arrow`](Self::Arrow). Centred at its origin,
        /// half its length to either side.
        Arrow2 = mjGEOM_ARROW2,
        /// Line from its origin along z. `size`: the width, twice, and the length.
        Line = mjGEOM_LINE,
        /// Skin.
        Skin = mjGEOM_SKIN,
        /// Flex: a deformable object of engines from 3.0. `size`: the radius of its vertices and
        /// edges.
        Flex = mjGEOM_FLEX,
        /// Text label without a shape.
        Label = mjGEOM_LABEL,
        /// No shape.
        None = mjGEOM_NONE,
        /// Edges of a box, with the size of a [`Box`](Self::Box). With engines from 3.1.1.
        LineBox = mjGEOM_LINEBOX,
        /// Triangle of its origin and two points, at `size[0]` along x and `size[1]` along y. With
        /// engines from 3.0.
        Triangle = mjGEOM_TRIANGLE,
    }
}

/// Geom of a scene, in single precision.
#[derive(Clone, Copy)]
pub struct SceneGeom<'s> {
    raw: &'s mjvGeom,
    lineage: Lineage,
    /// Textures of the materials, for engines whose geoms refer to a material.
    materials: &'s [MaterialTexture],
}

/// Texture of a material.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MaterialTexture {
    texture: Option<usize>,
    repeat: [f32; 2],
    is_uniform: bool,
}

impl Scene {
    /// Updates the textures of the materials.
    pub(super) fn read_materials(&mut self, model: &Model) {
        for (index, material) in self.materials.iter_mut().enumerate() {
            *material = MaterialTexture {
                texture: model.drawn_texture(index),
                repeat: model.mat_texrepeat()[index],
                is_uniform: model.mat_texuniform()[index] != 0,
            };
        }
    }
}

impl<'s> SceneGeom<'s> {
    pub(super) fn new(raw: &'s mjvGeom, lineage: Lineage, materials: &'s [MaterialTexture]) -> Self {
        Self { raw, lineage, materials }
    }

    fn material_texture(self) -> MaterialTexture {
        // SAFETY: a valid geom, of which the function reads numbers.
        let found = unsafe { adapted::scene_geom_texture(self.raw) };
        match usize::try_from(found.material) {
            Ok(material) => self.materials.get(material).copied().unwrap_or_default(),
            Err(_) => MaterialTexture {
                texture: usize::try_from(found.texture).ok(),
                repeat: found.repeat,
                is_uniform: found.uniform != 0,
            },
        }
    }

    /// Returns the shape.
    #[doc(alias = "type")]
    pub fn geom_type(self) -> SceneGeomType {
        SceneGeomType::of_field(self.raw.type_)
    }

    /// Returns the dimensions, m. [`SceneGeomType`] defines them for each shape.
    pub fn size(self) -> [f32; 3] {
        self.raw.size
    }

    /// Returns the position, m, world frame.
    pub fn pos(self) -> [f32; 3] {
        self.raw.pos
    }

    /// Returns the orientation, world frame: a row-major rotation matrix.
    pub fn mat(self) -> [f32; 9] {
        self.raw.mat
    }

    /// Returns red, green, blue and opacity.
    pub fn rgba(self) -> [f32; 4] {
        self.raw.rgba
    }

    /// Returns the emission coefficient.
    pub fn emission(self) -> f32 {
        self.raw.emission
    }

    /// Returns the specular coefficient.
    pub fn specular(self) -> f32 {
        self.raw.specular
    }

    /// Returns the shininess coefficient.
    pub fn shininess(self) -> f32 {
        self.raw.shininess
    }

    /// Returns the reflectance coefficient.
    pub fn reflectance(self) -> f32 {
        self.raw.reflectance
    }

    /// Returns `true` if the engine's renderer draws the shadow of the geom: not of decoration,
    /// with engines from 3.0.1, and not of geoms with `castshadow="false"`, with engines from 4.0.
    #[cfg(feature = "renderer")]
    pub(crate) fn casts_shadow(self) -> bool {
        // SAFETY: a valid geom, of which the function reads numbers.
        unsafe { adapted::scene_geom_casts_shadow(self.raw) != 0 }
    }

    /// Returns the category.
    pub fn category(self) -> Categories {
        Categories::from_bits_truncate(self.raw.category as u32)
    }

    /// Returns the element that the geom represents; `None` for decoration and for geoms added by
    /// the user.
    #[doc(alias = "objtype")]
    #[doc(alias = "objid")]
    pub fn object(self) -> Option<Object> {
        Object::from_raw(self.raw.objtype, self.raw.objid, self.lineage)
    }

    /// Returns the segmentation id: the index of the geom in the scene.
    pub fn segid(self) -> usize {
        ffi::size(self.raw.segid)
    }

    /// Returns the index of the material; `None` if there is none, and with engines before 3.2,
    /// whose geoms have only the texture.
    #[cfg(any(feature = "renderer", feature = "gltf"))]
    pub(crate) fn material(self) -> Option<usize> {
        // SAFETY: a valid geom, of which the function reads numbers.
        usize::try_from(unsafe { adapted::scene_geom_texture(self.raw) }.material).ok()
    }

    /// Returns the texture that the engine's OpenGL renderer draws: with engines from 3.2.1 the
    /// texture of the material's base colour.
    #[doc(alias = "texid")]
    pub fn texture(self) -> Option<TextureId> {
        self.material_texture().texture.map(|texture| Id::new(texture, self.lineage))
    }

    /// Returns the number of repetitions of a two-dimensional texture along x and y; 0 without a
    /// material.
    pub fn texrepeat(self) -> [f32; 2] {
        self.material_texture().repeat
    }

    /// Returns `true` if `texrepeat` counts repetitions per unit of length instead of per geom.
    pub fn texuniform(self) -> bool {
        self.material_texture().is_uniform
    }

    /// Returns `true` if the mesh or skin has texture coordinates.
    pub fn texcoord(self) -> bool {
        self.raw.texcoord != 0
    }

    /// Returns the mesh.
    #[doc(alias = "dataid")]
    pub fn mesh(self) -> Option<MeshId> {
        self.mesh_data().map(|data| Id::new(data / 2, self.lineage))
    }

    /// Returns `true` if the geom shows the convex hull of its mesh instead of the mesh.
    pub fn shows_convex_hull(self) -> bool {
        self.mesh_data().is_some_and(|data| data % 2 == 1)
    }

    fn mesh_data(self) -> Option<usize> {
        self.data(SceneGeomType::Mesh).or_else(|| self.data(SceneGeomType::Sdf))
    }

    /// Returns the height field.
    #[doc(alias = "dataid")]
    pub fn height_field(self) -> Option<HeightFieldId> {
        self.data(SceneGeomType::HeightField).map(|field| Id::new(field, self.lineage))
    }

    /// Returns the index of the plane among the planes of the model; `None` for a plane added by
    /// the user.
    #[doc(alias = "dataid")]
    pub fn plane(self) -> Option<usize> {
        self.data(SceneGeomType::Plane)
    }

    /// Returns the index of the flex.
    pub fn flex(self) -> Option<usize> {
        if self.geom_type() == SceneGeomType::Flex { usize::try_from(self.raw.objid).ok() } else { None }
    }

    /// Returns the faces of the flex that the geom shows, if it shows only some: those with one of
    /// several materials.
    #[cfg(feature = "renderer")]
    pub(crate) fn flex_faces(self) -> Option<std::ops::Range<usize>> {
        let [_, start, count] = self.raw.size.map(|number| number.max(0.0) as usize);
        (self.raw.dataid >= 0).then(|| start..start.saturating_add(count))
    }

    /// Returns `true` if the geom refers to data of the model, such as a mesh.
    #[cfg(feature = "renderer")]
    pub(crate) fn has_data(self) -> bool {
        self.raw.dataid >= 0
    }

    fn data(self, of: SceneGeomType) -> Option<usize> {
        if self.geom_type() == of { usize::try_from(self.raw.dataid).ok() } else { None }
    }

    /// Returns the label, which may be empty. The engine truncates labels to 99 bytes, possibly
    /// inside a character; this function omits the incomplete character.
    pub fn label(self) -> &'s str {
        let label = &self.raw.label;
        // SAFETY: the array outlives `'s`, and bytes have no invalid values.
        let label: &'s [u8] = unsafe { ffi::array(label.as_ptr().cast(), label.len()) };
        let label = label.split(|&byte| byte == 0).next().unwrap_or_default();
        match std::str::from_utf8(label) {
            Ok(label) => label,
            Err(error) => std::str::from_utf8(&label[..error.valid_up_to()]).unwrap_or_default(),
        }
    }

    /// Returns the radius of the bounding sphere of the model's geom, m; 0 for other geoms and for
    /// planes.
    #[doc(alias = "rbound")]
    pub fn modelrbound(self) -> f32 {
        self.raw.modelrbound
    }

    /// Returns the distance from the camera, if another renderer has set it.
    pub fn camdist(self) -> f32 {
        self.raw.camdist
    }

    /// Returns the flag for transparent rendering, if another renderer has set it.
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

/// Mutable view of a geom of a scene, to change its appearance.
pub struct SceneGeomMut<'s> {
    raw: &'s mut mjvGeom,
    lineage: Lineage,
    materials: &'s [MaterialTexture],
}

impl SceneGeomMut<'_> {
    /// Returns a read-only view.
    pub fn view(&self) -> SceneGeom<'_> {
        SceneGeom::new(self.raw, self.lineage, self.materials)
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
    /// [`Error::Invalid`](crate::Error::Invalid) for more than 99 bytes or a NUL byte.
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

/// Skin in the pose of the last update. Its faces are the model's
/// [`skin_face`](crate::Model::skin_face).
#[derive(Clone, Copy, Debug)]
pub struct SceneSkin<'s> {
    /// Identifier.
    pub skin: SkinId,
    /// Vertex positions, m, world frame. Zero before the first update, and while the group of the
    /// skin is hidden.
    pub vertices: &'s [[f32; 3]],
    /// Unit vertex normals. Zero whenever the vertices are.
    pub normals: &'s [[f32; 3]],
}

impl Scene {
    /// Returns the number of geoms.
    pub fn ngeom(&self) -> usize {
        ffi::size(self.raw().ngeom)
    }

    /// Iterates over the geoms in the order in which they were added.
    pub fn geoms(&self) -> impl ExactSizeIterator<Item = SceneGeom<'_>> + DoubleEndedIterator + Clone + '_ {
        self.raw_geoms().iter().map(|raw| SceneGeom::new(raw, self.lineage, &self.materials))
    }

    /// Returns a geom by its index.
    ///
    /// # Panics
    ///
    /// If the index is out of range.
    #[track_caller]
    pub fn geom(&self, index: usize) -> SceneGeom<'_> {
        SceneGeom::new(&self.raw_geoms()[index], self.lineage, &self.materials)
    }

    /// Iterates over the geoms with mutable access to their appearance, for example to fade a trail
    /// of poses.
    pub fn geoms_mut(&mut self) -> impl ExactSizeIterator<Item = SceneGeomMut<'_>> + '_ {
        let (lineage, materials) = (self.lineage, &*self.materials);
        let (geoms, count) = (self.raw().geoms, self.ngeom());
        // SAFETY: as in `raw_geoms`, and `self` is borrowed exclusively.
        unsafe { ffi::array_mut(geoms, count) }.iter_mut().map(move |raw| SceneGeomMut { raw, lineage, materials })
    }

    fn raw_geoms(&self) -> &[mjvGeom] {
        // SAFETY: the complete buffer is initialised, its first `ngeom` entries are in use, and
        // only `&mut self` writes to it.
        unsafe { ffi::array(self.raw().geoms, self.ngeom()) }
    }

    /// Iterates over all skins of the model. [`update`](Self::update) with
    /// [`VisualFlags::SKIN`](super::VisualFlags::SKIN) sets their poses.
    pub fn skins(&self) -> impl ExactSizeIterator<Item = SceneSkin<'_>> + '_ {
        let raw = self.raw();
        let count = ffi::size(raw.nskin);
        // SAFETY: the engine allocated one entry per skin in each array, and filled them when the
        // scene was created.
        let (starts, lengths) = unsafe { (ffi::array(raw.skinvertadr, count), ffi::array(raw.skinvertnum, count)) };
        // SAFETY: allocated for all vertices of the model and zeroed when the scene was created;
        // only `&mut self` writes to them.
        let (vertices, normals) =
            unsafe { (ffi::rows(raw.skinvert, self.skin_vertices), ffi::rows(raw.skinnormal, self.skin_vertices)) };
        starts.iter().zip(lengths).enumerate().map(move |(skin, (&start, &length))| {
            let range = ffi::size(start)..ffi::size(start) + ffi::size(length);
            SceneSkin {
                skin: Id::new(skin, self.lineage),
                vertices: &vertices[range.clone()],
                normals: &normals[range],
            }
        })
    }
}
