//! Rays that hit a flex.

use std::ffi::c_int;

use mujoco_sys as sys;

use crate::data::{Data, PipelineFlags};
use crate::error::Result;
use crate::id::IntoId;
use crate::kind;
use crate::macros::with_methods;
use crate::math::check_ray;

/// Parts of a flex that a ray can hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FlexRayOptions {
    /// Layer of the elements of a solid flex, from the outside.
    #[doc(alias = "flex_layer")]
    pub layer: u16,
    /// Includes the spheres around the vertices. Without effect beside edges, whose capsules
    /// contain them.
    #[doc(alias = "flg_vert")]
    pub vertices: bool,
    /// Includes the capsules around the edges.
    #[doc(alias = "flg_edge")]
    pub edges: bool,
    /// Includes the faces of the elements.
    #[doc(alias = "flg_face")]
    pub faces: bool,
    /// Includes the skin. For a flex of two or three dimensions the engine then includes the edges
    /// too, and ignores `layer` and `vertices`.
    #[doc(alias = "flg_skin")]
    pub skin: bool,
}

impl Default for FlexRayOptions {
    /// Selects vertices, edges and faces of the outermost layer.
    fn default() -> Self {
        Self { layer: 0, vertices: true, edges: true, faces: true, skin: false }
    }
}

with_methods!(FlexRayOptions {
    with_layer(layer: u16),
    with_vertices(vertices: bool),
    with_edges(edges: bool),
    with_faces(faces: bool),
    with_skin(skin: bool),
});

/// Intersection of a ray with a flex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlexHit {
    /// Distance from the start of the ray, in units of the length of its direction.
    pub distance: f64,
    /// Vertex of the flex that is nearest to the intersection, counted from the flex's first
    /// vertex.
    pub vertex: usize,
}

/// # Rays
impl Data {
    /// Returns the nearest intersection of a ray with a flex, which [`ray`](Self::ray) does not
    /// find. Engines before 3.0 have no flexes.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`](crate::Error::NoSuchName) or
    /// [`Error::NoSuchIndex`](crate::Error::NoSuchIndex) for an unknown key,
    /// [`Error::NotComputed`](crate::Error::NotComputed) before [`com_pos`](Self::com_pos), which
    /// computes the vertices, and [`Error::Invalid`](crate::Error::Invalid) for a direction of
    /// length zero or a value that is not finite.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_rayFlex")]
    #[doc(alias = "mju_rayFlex")]
    pub fn ray_flex(
        &self,
        flex: impl IntoId<kind::Flex>,
        point: [f64; 3],
        direction: [f64; 3],
        options: &FlexRayOptions,
    ) -> Result<Option<FlexHit>> {
        let flex = flex.id_in(&**self.model())?.index() as c_int;
        self.check_parts("ray_flex", PipelineFlags::KINEMATICS | PipelineFlags::COM_POS)?;
        check_ray(&point, &direction)?;
        let FlexRayOptions { layer, vertices, edges, faces, skin } = *options;
        let mut vertex = -1;
        // SAFETY: a flex of this model, whose vertices were computed, two vectors of three
        // elements, and a place for the vertex.
        let distance = unsafe {
            sys::adapted::ray_flex(
                self.model().as_ptr(),
                self.as_ptr(),
                layer.into(),
                vertices.into(),
                edges.into(),
                faces.into(),
                skin.into(),
                flex,
                point.as_ptr(),
                direction.as_ptr(),
                &raw mut vertex,
            )
        };
        let hit = FlexHit { distance, vertex: usize::try_from(vertex).unwrap_or(0) };
        // The engine returns -1 for no intersection.
        Ok((distance >= 0.0).then_some(hit))
    }
}
