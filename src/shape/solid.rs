//! Shapes of a given size, made of unit shapes, and the repair of normals.

use super::{Triangles, cylinder};
use crate::math::cross;

impl Triangles {
    /// Scales a shape about its centre.
    pub(crate) fn scaled(&self, [x, y, z]: [f32; 3]) -> Self {
        let mut result = Self::default();
        result.extend_by(self, |at| [x * at[0], y * at[1], z * at[2]], |n| [n[0] / x, n[1] / y, n[2] / z]);
        result
    }

    /// Gives each normal the length 1. Normals without a direction become the z-axis.
    pub(crate) fn unit_normals(&mut self) {
        for vertex in &mut self.vertices {
            vertex.normal = unit(vertex.normal);
        }
    }

    /// Replaces normals that point to the inside of a triangle, as the engine computes some at
    /// sharp corners of meshes with texture coordinates.
    pub(crate) fn face_outwards(&mut self) {
        for face in self.indices.as_chunks_mut::<3>().0 {
            let flat = area_normal(face.map(|index| self.vertices[index as usize].position)).map(|part| part as f32);
            for index in face {
                let mut vertex = self.vertices[*index as usize];
                if vertex.normal.iter().zip(flat).map(|(a, b)| a * b).sum::<f32>() < 0.0 {
                    vertex.normal = unit(flat);
                    *index = self.vertices.len() as u32;
                    self.vertices.push(vertex);
                }
            }
        }
    }
}

/// Returns a cylinder with two ends, of which the upper one is given for a radius of 1.
pub(crate) fn tube(slices: u32, [radius, _, half]: [f32; 3], end: &Triangles) -> Triangles {
    let turned = |[x, y, z]: [f32; 3]| [x, -y, -z];
    let raised = |[x, y, z]: [f32; 3]| [radius * x, radius * y, radius * z + half];
    let mut tube = cylinder(slices, 1).scaled([radius, radius, half]);
    tube.extend_by(end, raised, |normal| normal);
    tube.extend_by(end, |at| turned(raised(at)), turned);
    tube
}

/// Returns the normal of a triangle, of which the length is twice the area.
pub(super) fn area_normal(corners: [[f32; 3]; 3]) -> [f64; 3] {
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let edge = |to: [f64; 3]| -> [f64; 3] { std::array::from_fn(|axis| to[axis] - a[axis]) };
    cross(&edge(b), &edge(c))
}

/// Returns a vector of length 1: the z-axis for a vector without a direction.
fn unit(vector: [f32; 3]) -> [f32; 3] {
    let vector = vector.map(f64::from);
    let length = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() { vector.map(|part| (part / length) as f32) } else { [0.0, 0.0, 1.0] }
}
