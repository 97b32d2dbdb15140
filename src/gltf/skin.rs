//! Skins and flexes: meshes whose vertices follow the nodes of bodies.

use std::collections::HashSet;

use gltf_json::skin::Skin;
use gltf_json::{Index, Material, Node};

use super::document::{Document, object};
use super::node;
use crate::data::Data;
use crate::kind::Kind;
use crate::replay::{Look, Surface, TextureMap, decoration, label};
use crate::scene::{DeformableId, Scene, SceneOptions};
use crate::shape::Skinned;

impl Document<'_> {
    /// Adds the skins and flexes of a scene in the present state, which is that of the nodes.
    pub(super) fn add_deformables(&mut self, data: &Data, scene: &Scene, options: &SceneOptions, look: &mut Look) {
        for shape in scene.deformables(self.model) {
            let description = decoration(self.model, shape.geom);
            self.left_out.remove(&description);
            // A hidden skin has a geom in the scene, unlike a hidden flex.
            if let DeformableId::Skin(id) = shape.id
                && options.skingroup.get(self.model.skin(id).group() as usize) == Some(&false)
            {
                continue;
            }
            let skinned = match Skinned::new(data, scene, &shape) {
                Ok(skinned) => skinned,
                Err(error) => {
                    self.left_out.insert(format!("{description}: {error}"));
                    continue;
                }
            };
            if skinned.lost > 1e-6 {
                self.left_out.insert(format!("{description}: weights of a vertex with the sum {:.1e}", skinned.lost));
            }
            let (name, material) = match shape.id {
                DeformableId::Skin(id) => {
                    let material = self.model.skin(id).material().map(|id| id.index());
                    (label(self.model, Kind::Skin, id.index()), material)
                }
                DeformableId::Flex(_) => (description, shape.geom.material()),
            };
            let texture = shape.geom.texture().map(|id| look.texture(self.model, id));
            let texture = texture.and_then(|index| Some((index, look.textures[&index].as_ref()?)));
            let is_flat = texture.is_some_and(|(_, texture)| !texture.is_cube);
            let material = self.material(&Surface::new(shape.geom), material, texture, shape.is_sheet);
            self.add_skinned(name, &skinned, material, is_flat.then(|| TextureMap::new(shape.geom, false)));
        }
    }

    /// Adds a node at the root, since programs ignore the pose of a node with a skin.
    fn add_skinned(&mut self, name: String, skinned: &Skinned, material: Index<Material>, map: Option<TextureMap>) {
        let mesh = self.add_mesh(name.clone(), &skinned.triangles, material, map, skinned.sets());
        let (mut known, mut joints, mut matrices) = (HashSet::new(), Vec::new(), Vec::new());
        for bone in &skinned.bones {
            let body = self.nodes[bone.body];
            // The joints of a skin are different nodes.
            let is_new = known.insert(bone.body);
            joints.push(if is_new { body } else { node::add_child(&mut self.root, body, Node::default()) });
            matrices.push(bone.inverse_bind);
        }
        let inverse_bind_matrices = Some(self.floats(&matrices, None));
        let skin = object!(Skin { inverse_bind_matrices, joints, name: Some(name.clone()), skeleton: None });
        let skin = Some(self.root.push(skin));
        let node = self.root.push(Node { name: Some(name), mesh: Some(mesh), skin, ..Node::default() });
        self.root.scenes[0].nodes.push(node);
    }
}
