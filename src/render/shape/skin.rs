//! What of a skin stays as it is while it bends.

use super::{Triangles, finite_or_zero};
use crate::error::Result;
use crate::id::SkinId;
use crate::model::Model;

/// What of a skin stays as it is while it bends. Positions and normals of its vertices are in the scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SkinSurface {
    /// How many vertices it has.
    pub(crate) vertices: usize,
    /// Triangles, three vertices each, counterclockwise from outside.
    pub(crate) indices: Vec<u32>,
    /// For each vertex where it is in the picture that is glued on; zero where none is.
    pub(crate) texcoords: Vec<[f32; 2]>,
}

/// The surface of a skin.
///
/// # Errors
///
/// [`Error::Unsupported`](crate::Error::Unsupported) for more than `most` vertices, or for more than `most` triangles.
pub(crate) fn skin(model: &Model, id: SkinId, most: usize) -> Result<SkinSurface> {
    let skin = model.skin(id);
    let (vertices, faces) = (skin.vert().len(), skin.face());
    Triangles::check_room(|| format!("{skin:?}"), vertices.max(faces.len()), most)?;
    let mut surface = SkinSurface { vertices, indices: Vec::with_capacity(3 * faces.len()), texcoords: Vec::new() };
    for face in faces {
        let corners = face.map(|corner| u32::try_from(corner).unwrap_or(u32::MAX));
        if corners.iter().all(|&corner| (corner as usize) < vertices) {
            surface.indices.extend(corners);
        }
    }
    surface.texcoords.extend(skin.texcoord().iter().map(|texcoord| texcoord.map(finite_or_zero)));
    surface.texcoords.resize(vertices, [0.0; 2]);
    Ok(surface)
}

#[cfg(test)]
mod tests {
    use super::skin;
    use crate::Model;

    fn cloth() -> Model {
        Model::from_xml_str(
            "<mujoco><worldbody><body name='B1_1' pos='0 0 1'><freejoint/>
               <composite type='cloth' count='4 3 1' spacing='0.1'><geom type='sphere' size='0.02'/>
                 <skin texcoord='true' inflate='0.01'/></composite></body></worldbody></mujoco>",
        )
        .unwrap()
    }

    #[test]
    fn a_skin_keeps_its_triangles_and_where_the_picture_is() {
        let model = cloth();
        let view = model.skins().next().unwrap();
        let surface = skin(&model, view.id(), usize::MAX).unwrap();
        assert_eq!(surface.vertices, view.vert().len());
        assert_eq!(surface.indices, view.face().as_flattened().iter().map(|&index| index as u32).collect::<Vec<_>>());
        assert_eq!(surface.texcoords, view.texcoord());
        assert!(surface.texcoords.as_flattened().iter().all(|coordinate| (0.0..=1.0).contains(coordinate)));
        assert!(skin(&model, view.id(), surface.vertices - 1).is_err());
    }

    #[test]
    fn numbers_that_are_none_do_not_get_through() {
        let mut model = cloth();
        let id = model.skins().next().unwrap().id();
        model.edit().skin_mut(id).texcoord_mut()[3] = [f32::NAN, f32::INFINITY];
        assert_eq!(skin(&model, id, usize::MAX).unwrap().texcoords[3], [0.0; 2]);
    }
}
