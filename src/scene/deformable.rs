//! Skins, flexes and tendons of a scene, each of them once: shapes whose vertices differ in every
//! state.

use std::collections::HashSet;

use super::{Scene, SceneGeom, SceneGeomType};
use crate::element::Object;
use crate::id::{SkinId, TendonId};
use crate::model::Model;

/// Identifier of a skin, or index of a flex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum DeformableId {
    Skin(SkinId),
    Flex(usize),
}

/// Skin or flex in the pose of the last update.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deformable<'s> {
    pub(crate) id: DeformableId,
    /// First geom of the shape in the scene, which has its look.
    pub(crate) geom: SceneGeom<'s>,
    /// Positions of the vertices, m, world frame.
    pub(crate) vertices: &'s [[f32; 3]],
    /// Indices of the vertices of each triangle. `None` for a rope.
    pub(crate) faces: Option<&'s [[i32; 3]]>,
    /// Both sides of the triangles are drawn.
    pub(crate) is_sheet: bool,
    /// Indices of the ends of each segment of a rope. Empty for a surface.
    pub(crate) edges: &'s [[i32; 2]],
}

impl Scene {
    /// Iterates over the skins and flexes that the scene shows, in the order of their geoms.
    pub(crate) fn deformables<'s>(&'s self, model: &'s Model) -> impl Iterator<Item = Deformable<'s>> + 's {
        let mut known = HashSet::new();
        self.geoms().filter_map(move |geom| {
            let (id, triangles) = match (geom.flex(), geom.object()) {
                (Some(flex), _) => (DeformableId::Flex(flex), model.flex_triangles(flex)),
                (_, Some(Object::Skin(id))) => (DeformableId::Skin(id), Some((model.skin(id).face(), false))),
                _ => return None,
            };
            let (faces, is_sheet) = triangles.unzip();
            let (vertices, edges) = self.deformable(id);
            let edges = if faces.is_none() { edges } else { &[] };
            known.insert(id).then_some(Deformable {
                id,
                geom,
                vertices,
                faces,
                is_sheet: is_sheet == Some(true),
                edges,
            })
        })
    }

    /// Returns the vertices and the edges of a skin, which has no edges, or of a flex.
    pub(crate) fn deformable(&self, id: DeformableId) -> (&[[f32; 3]], &[[i32; 2]]) {
        let found = match id {
            DeformableId::Skin(id) => self.skins().nth(id.index()).map(|skin| (skin.vertices, &[][..])),
            DeformableId::Flex(index) => self.flexes().nth(index).map(|flex| (flex.vertices, flex.edges)),
        };
        found.unwrap_or_default()
    }

    /// Iterates over the ends of the edges of a flex, m, world frame. An index that is out of
    /// range, which only an edited model can have, is the origin.
    pub(crate) fn rope_segments(&self, id: DeformableId) -> impl Iterator<Item = [[f32; 3]; 2]> + '_ {
        let (vertices, edges) = self.deformable(id);
        let vertex = |index: i32| usize::try_from(index).ok().and_then(|index| vertices.get(index)).copied();
        edges.iter().map(move |edge| edge.map(|index| vertex(index).unwrap_or_default()))
    }

    /// Iterates over the ends of the segments of a tendon, m, world frame.
    pub(crate) fn tendon_segments(&self, id: TendonId) -> impl Iterator<Item = [[f32; 3]; 2]> + '_ {
        self.geoms().filter(move |geom| geom.segment_of() == Some(id)).map(|geom| {
            let (pos, mat, half) = (geom.pos(), geom.mat(), geom.size()[2]);
            [-half, half].map(|along| [0, 1, 2].map(|axis| pos[axis] + along * mat[3 * axis + 2]))
        })
    }
}

impl SceneGeom<'_> {
    /// Returns the tendon of which the geom is a segment.
    pub(crate) fn segment_of(self) -> Option<TendonId> {
        match (self.geom_type(), self.object()) {
            (SceneGeomType::Capsule | SceneGeomType::Cylinder, Some(Object::Tendon(id))) => Some(id),
            _ => None,
        }
    }
}
