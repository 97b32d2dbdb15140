//! Skins and flexes, whose vertices differ in every record, as a `foxglove.SceneUpdate`: one entity
//! for each, in the frame of the world.

use super::geometry::{put_entity, put_pose, put_triangles};
use super::protobuf::Message;
use crate::data::Data;
use crate::error::Result;
use crate::model::Model;
use crate::scene::{Camera, DeformableId, Scene, SceneOptions};

/// Field of a `SceneEntity`.
const LINES: u32 = 11;
/// Pose of vertices in the frame of the world.
const POSE: (&[f64; 3], &[f64; 4]) = (&[0.0; 3], &[1.0, 0.0, 0.0, 0.0]);

/// Reader of the deformable shapes of a simulation.
pub(super) struct Deformables {
    scene: Scene,
    /// Copy of the simulation, because the engine writes to it when it updates the scene.
    copy: Data,
    message: Message,
}

impl Deformables {
    /// Returns `None` for a model without skins and flexes.
    pub(super) fn of(model: &Model) -> Result<Option<Self>> {
        let scene = Scene::new(model, model.ngeom() + 100)?;
        if model.nskin() + scene.flexes().len() == 0 {
            return Ok(None);
        }
        Ok(Some(Self { scene, copy: Data::new(model.try_clone()?)?, message: Message::default() }))
    }

    /// Encodes the shapes of a simulation, whose poses have been computed.
    pub(super) fn encode(&mut self, data: &Data, world: &str) -> Result<&mut Message> {
        let Self { scene, copy, message } = self;
        copy.clone_from(data);
        scene.update_and_grow(copy, &SceneOptions::default(), &mut Camera::free(data.model()))?;
        message.clear();
        for shape in scene.deformables(data.model()) {
            let color = shape.geom.rgba().map(f64::from);
            let id = match shape.id {
                DeformableId::Skin(id) => format!("skin{}", id.index()),
                DeformableId::Flex(index) => format!("flex{index}"),
            };
            put_entity(message, world, &id, |entity| {
                if let Some(faces) = shape.faces {
                    let points = shape.vertices.iter().map(|vertex| vertex.map(f64::from));
                    let indices = faces.as_flattened().iter().map(|&index| index as u32);
                    put_triangles(entity, POSE, points, indices, &color);
                }
                for edge in shape.edges {
                    entity.put_message(LINES, |line| {
                        put_pose(line, POSE.0, POSE.1);
                        line.put_double(3, 2.0 * f64::from(shape.geom.size()[0])); // thickness
                        let ends = edge.iter().filter_map(|&index| shape.vertices.get(index as usize));
                        ends.for_each(|end| line.put_tuple(5, &end.map(f64::from)));
                        line.put_tuple(6, &color);
                    });
                }
            });
        }
        Ok(message)
    }
}
