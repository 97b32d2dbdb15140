//! Triangles that follow bodies by linear blend skinning, as skins and flexes do: each vertex moves
//! with the weighted mean of the motions of a few bodies.

use std::collections::HashMap;

use super::mesh::checked;
use super::solid::area_normal;
use super::{Triangles, Vertex, skin};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::id::SkinId;
use crate::math::{neg_quat, quat2mat, rot_vec_mat};
use crate::model::Model;
use crate::scene::{Deformable, DeformableId, Scene};

/// Greatest number of bodies that a vertex follows: those of a composite skin of the engine.
const MOST: usize = 16;

/// Body that vertices follow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bone {
    pub(crate) body: usize,
    /// Converts positions of vertices at rest to the frame of the body: 4 by 4, column-major.
    pub(crate) inverse_bind: [f32; 16],
}

impl Bone {
    /// Takes the pose of the body while the vertices are at rest. Quaternions may have any length,
    /// which scales the vertices as in the engine.
    fn new(body: usize, pos: [f64; 3], quat: [f64; 4]) -> Self {
        let mat = quat2mat(&neg_quat(&quat));
        let [x, y, z] = rot_vec_mat(&pos.map(|part| -part), &mat);
        let column = |column: usize| [mat[column], mat[3 + column], mat[6 + column], 0.0];
        let columns = [column(0), column(1), column(2), [x, y, z, 1.0]];
        Self { body, inverse_bind: std::array::from_fn(|index| columns[index / 4][index % 4] as f32) }
    }
}

/// Triangles at rest, and the bones that their vertices follow.
#[derive(Debug)]
pub(crate) struct Skinned {
    pub(crate) triangles: Triangles,
    pub(crate) bones: Vec<Bone>,
    /// Bones of each vertex, with positive weights that sum to 1, of which the first is the
    /// largest.
    weights: Vec<Vec<(usize, f32)>>,
    /// Largest sum of the weights of a vertex that are not in `weights`.
    pub(crate) lost: f64,
}

impl Skinned {
    /// Returns the triangles of a skin or flex in the present state, or in the bind pose.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] with the reason for which skinning does not have the motion.
    pub(crate) fn new(data: &Data, scene: &Scene, shape: &Deformable<'_>) -> Result<Self> {
        match (shape.id, shape.faces) {
            (DeformableId::Skin(id), _) => Self::of_skin(data.model(), id),
            (DeformableId::Flex(index), Some(faces)) => Self::of_flex(data, scene, shape, index, faces),
            (DeformableId::Flex(_), None) => unsupported("a rope, which has no triangles".to_owned()),
        }
    }

    /// The engine moves vertices along their normals after blending, and this function before.
    fn of_skin(model: &Model, id: SkinId) -> Result<Self> {
        let (view, topology) = (model.skin(id), skin(model, id, usize::MAX)?);
        let mut triangles = Triangles::smooth(view.vert(), topology.triangles.into_flattened());
        for (vertex, texcoord) in triangles.vertices.iter_mut().zip(topology.texcoords) {
            let Vertex { position, normal, .. } = *vertex;
            vertex.position = std::array::from_fn(|axis| position[axis] + view.inflate() * normal[axis]);
            vertex.texcoord = texcoord;
        }
        let (mut bones, mut weights) = (Vec::new(), vec![Vec::<(usize, f32)>::new(); triangles.vertices.len()]);
        let poses = view.bonebindpos().iter().zip(view.bonebindquat());
        for (index, (bone, (pos, quat))) in view.bones().zip(poses).enumerate() {
            bones.push(Bone::new(bone.body.index(), pos.map(f64::from), quat.map(f64::from)));
            for (&vertex, &weight) in bone.vertid.iter().zip(bone.vertweight) {
                let Some(weights) = weights.get_mut(vertex as usize) else { continue };
                match weights.last_mut() {
                    Some((known, sum)) if *known == index => *sum += weight,
                    _ => weights.push((index, weight)),
                }
            }
        }
        Self::checked(triangles, bones, weights)
    }

    /// The present state is at rest. A vertex of a flex is fixed to one body.
    fn of_flex(data: &Data, scene: &Scene, shape: &Deformable<'_>, index: usize, faces: &[[i32; 3]]) -> Result<Self> {
        let Some(bodies) = data.model().flex_bodies(index) else {
            return unsupported("vertices that are interpolated between bodies".to_owned());
        };
        let count = bodies.len().min(shape.vertices.len());
        if !bodies.iter().all(|&body| usize::try_from(body).is_ok_and(|body| body < data.model().nbody())) {
            return unsupported("vertices without a body".to_owned());
        }
        let corners = |(index, face): (usize, &[i32; 3])| Some((index, checked(*face, &shape.vertices[..count])?));
        let faces: Vec<_> = faces.iter().enumerate().filter_map(corners).collect();
        let indices = faces.iter().flat_map(|(_, face)| face.map(|corner| corner as u32)).collect();
        let smooth = Triangles::smooth(shape.vertices, indices);
        let (mut triangles, mut weights) = (Triangles::default(), Vec::new());
        let flex = scene.flexes().nth(index);
        // A triangle with two sides is two faces of the engine.
        let texcoords = |face: usize| {
            let face = if shape.is_sheet { 2 * face } else { face };
            flex.and_then(|flex| flex.texcoords.get(face).copied()).unwrap_or_default()
        };
        let (mut bones, mut bone_of_body, mut known) = (Vec::new(), HashMap::new(), HashMap::new());
        for (face, corners) in faces {
            for (corner, texcoord) in corners.into_iter().zip(texcoords(face)) {
                let texcoord = texcoord.map(super::finite_or_zero);
                let at = *known.entry((corner, texcoord.map(f32::to_bits))).or_insert_with(|| {
                    let body = bodies[corner] as usize;
                    let bone = *bone_of_body.entry(body).or_insert_with(|| {
                        bones.push(Bone::new(body, data.xpos()[body], data.xquat()[body]));
                        bones.len() - 1
                    });
                    weights.push(vec![(bone, 1.0)]);
                    triangles.vertices.push(Vertex { texcoord, ..smooth.vertices[corner] });
                    triangles.vertices.len() as u32 - 1
                });
                triangles.indices.push(at);
            }
        }
        Self::checked(triangles, bones, weights)
    }

    /// Checks the numbers, and selects the largest positive weights.
    fn checked(mut triangles: Triangles, bones: Vec<Bone>, mut weights: Vec<Vec<(usize, f32)>>) -> Result<Self> {
        if triangles.indices.is_empty() {
            return unsupported("no triangles".to_owned());
        }
        let positions = triangles.vertices.iter().flat_map(|vertex| vertex.position);
        if !positions.chain(bones.iter().flat_map(|bone| bone.inverse_bind)).all(f32::is_finite) {
            return unsupported("a position or a bind pose that is not finite".to_owned());
        }
        triangles.unit_normals();
        if bones.len() > 1 << 16 {
            return unsupported(format!("{} bones, of more than 65,536", bones.len()));
        }
        let mut lost = 0.0_f64;
        for (vertex, weights) in weights.iter_mut().enumerate() {
            let sum = weights.iter().map(|&(_, weight)| f64::from(weight)).sum::<f64>();
            let is_one = (sum - 1.0).abs() <= 1e-3;
            if !is_one {
                return unsupported(format!("weights of vertex {vertex} with the sum {sum} instead of 1"));
            }
            let total = |weights: &[(usize, f32)]| -> f64 { weights.iter().map(|&(_, w)| f64::from(w.abs())).sum() };
            let all = total(weights);
            weights.sort_by(|(_, a), (_, b)| b.total_cmp(a));
            weights.truncate(MOST);
            weights.retain(|&(_, weight)| weight > 0.0);
            let kept = total(weights);
            lost = lost.max(all - kept);
            for (_, weight) in weights.iter_mut() {
                *weight = (f64::from(*weight) / kept) as f32;
            }
            weights.retain(|&(_, weight)| weight > 0.0);
        }
        Ok(Self { triangles, bones, weights, lost })
    }

    /// Returns the bones of each vertex in sets of four, of which the first set has the largest
    /// weights. A weight of zero has the bone 0.
    pub(crate) fn sets(&self) -> impl Iterator<Item = (Vec<[u16; 4]>, Vec<[f32; 4]>)> + '_ {
        let count = self.weights.iter().map(Vec::len).max().unwrap_or_default();
        (0..count).step_by(4).map(|first| {
            let entry = |weights: &Vec<(usize, f32)>| {
                let four: [_; 4] = std::array::from_fn(|index| weights.get(first + index).copied().unwrap_or_default());
                (four.map(|(bone, _)| bone as u16), four.map(|(_, weight)| weight))
            };
            self.weights.iter().map(entry).unzip()
        })
    }
}

fn unsupported<T>(reason: String) -> Result<T> {
    Err(Error::Unsupported(reason))
}

impl Triangles {
    /// Returns triangles whose normals are the means of those of the adjacent faces, weighted by
    /// their areas, as the engine computes those of skins. A normal without a direction is zero.
    fn smooth(positions: &[[f32; 3]], indices: Vec<u32>) -> Self {
        let mut sums = vec![[0.0; 3]; positions.len()];
        for face in indices.as_chunks::<3>().0 {
            let normal = area_normal(face.map(|corner| positions[corner as usize]));
            for &corner in face {
                sums[corner as usize].iter_mut().zip(normal).for_each(|(sum, part)| *sum += part);
            }
        }
        let vertex = |(&position, sum): (&[f32; 3], [f64; 3])| {
            let length = sum.iter().map(|part| part * part).sum::<f64>().sqrt();
            let scale = if length > 0.0 && length.is_finite() { length.recip() } else { 0.0 };
            let normal = sum.map(|part| if scale > 0.0 { (part * scale) as f32 } else { 0.0 });
            Vertex { position, normal, texcoord: [0.0; 2], parity: 0.0 }
        };
        Self { vertices: positions.iter().zip(sums).map(vertex).collect(), indices, has_quads: false }
    }
}
