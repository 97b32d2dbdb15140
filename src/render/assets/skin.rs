//! Skins: shapes whose vertices change with every frame.

use std::num::NonZero;

use super::shape_buffers::ShapeBuffers;
use crate::id::SkinId;
use crate::model::Model;
use crate::render::bounding_volume::signed_distance;
use crate::render::settings::is_drawable;
use crate::render::{Gpu, GpuKind, RenderError};
use crate::shape::{self, SkinTopology, Vertex};

/// Skin of a model.
#[derive(Debug)]
pub(super) struct Skin {
    topology: SkinTopology,
    /// Vertices in the image, and triangles that face the camera; the memory is reused.
    projected: Vec<[f32; 2]>,
    front: Vec<[u32; 3]>,
    /// The indices of all triangles are followed by the indices of the triangles that face the
    /// camera.
    pub(super) buffers: ShapeBuffers,
}

impl Skin {
    pub(super) fn new(gpu: &Gpu, model: &Model, id: SkinId, max_vertices: usize) -> Result<Self, RenderError> {
        let topology = shape::skin(model, id, max_vertices)?;
        let buffers = ShapeBuffers::dynamic(gpu, topology.vertices, topology.triangles.as_flattened())?;
        Ok(Self { topology, projected: Vec::new(), front: Vec::new(), buffers })
    }

    /// Writes the vertices, and with a software rasteriser also the triangles that face the camera:
    /// they are half of a closed skin, and the rasteriser would shade the vertices of the others
    /// for nothing.
    pub(super) fn update(
        &mut self,
        gpu: &Gpu,
        vertices: &[[f32; 3]],
        normals: &[[f32; 3]],
        pixel_rows: &[[f32; 4]; 3],
    ) {
        self.buffers.front_faces = None;
        if vertices.len() != self.topology.vertices {
            return;
        }
        self.write_vertices(gpu, vertices, normals);
        if gpu.kind() == GpuKind::Software {
            front_faces(&self.topology.triangles, vertices, pixel_rows, &mut self.projected, &mut self.front);
            let all = self.buffers.index_count;
            gpu.queue().write_buffer(&self.buffers.indices, 4 * u64::from(all), bytemuck::cast_slice(&self.front));
            self.buffers.front_faces = Some(all..all + 3 * self.front.len() as u32);
        }
    }

    fn write_vertices(&self, gpu: &Gpu, vertices: &[[f32; 3]], normals: &[[f32; 3]]) {
        let buffer = &self.buffers.vertices;
        // Vertices in the queue's own memory need no other copy.
        let view = NonZero::new(buffer.size()).and_then(|size| gpu.queue().write_buffer_with(buffer, 0, size));
        let Some(mut bytes) = view else { return };
        let (chunks, _) = bytes.slice(..).into_chunks::<{ size_of::<Vertex>() }>();
        chunks.write_iter(vertices.iter().zip(normals).zip(&self.topology.texcoords).map(
            |((&position, &normal), &texcoord)| {
                bytemuck::cast(Vertex { position: drawable(position), normal: drawable(normal), texcoord, parity: 0.0 })
            },
        ));
    }
}

/// Replaces the elements of a vector that cannot be drawn.
fn drawable(vector: [f32; 3]) -> [f32; 3] {
    vector.map(|number| if is_drawable(number) { number } else { 0.0 })
}

/// Distance by which rounding may move the corners of a triangle against each other in the image,
/// pixels: it turns triangles that are seen almost edge-on. Rasterisers round to 1/256 pixel.
const ROUNDING: f32 = 0.01;

/// Collects the triangles that may face the camera in `front`. `projected` receives the positions
/// of the vertices in the image, pixels.
fn front_faces(
    triangles: &[[u32; 3]],
    vertices: &[[f32; 3]],
    [right, up, forward]: &[[f32; 4]; 3],
    projected: &mut Vec<[f32; 2]>,
    front: &mut Vec<[u32; 3]>,
) {
    projected.clear();
    projected.extend(vertices.iter().map(|&vertex| {
        let vertex = drawable(vertex);
        // Each row is a plane through the camera.
        let along = |row: &[f32; 4]| signed_distance(vertex, row);
        let depth = along(forward);
        // Triangles with a vertex behind the camera are kept: their areas are NaN.
        let scale = if depth > 0.0 { 1.0 / depth } else { f32::NAN };
        [along(right) * scale, along(up) * scale]
    }));
    front.resize(triangles.len(), [0; 3]);
    let mut count = 0;
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| projected[corner as usize]);
        let ([bx, by], [cx, cy]) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        let twice_area = bx * cy - by * cx;
        let faces_away = twice_area < -ROUNDING * (bx.abs() + by.abs() + cx.abs() + cy.abs());
        front[count] = *corners;
        count += usize::from(!faces_away);
    }
    front.truncate(count);
}

#[cfg(test)]
mod tests {
    use super::front_faces;
    use crate::shape::{Tessellation, sphere};

    /// The camera at the origin looks along x, y is left, and a unit at a depth of one is 500
    /// pixels.
    const PIXEL_ROWS: [[f32; 4]; 3] = [[0.0, -500.0, 0.0, 0.0], [0.0, 0.0, 500.0, 0.0], [1.0, 0.0, 0.0, 0.0]];

    fn front(triangles: &[[u32; 3]], vertices: &[[f32; 3]]) -> Vec<[u32; 3]> {
        let mut front = vec![[0; 3]; 7];
        front_faces(triangles, vertices, &PIXEL_ROWS, &mut Vec::new(), &mut front);
        front
    }

    #[test]
    fn triangles_that_face_the_camera_are_kept() {
        let sphere = sphere(Tessellation::new(40, 30, 1));
        let vertices: Vec<[f32; 3]> =
            sphere.vertices.iter().map(|v| [v.position[0] + 3.0, v.position[1], v.position[2] - 0.5]).collect();
        let triangles = sphere.indices.as_chunks::<3>().0;
        let front = front(triangles, &vertices);
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| nalgebra::Vector3::from(vertices[corner as usize].map(f64::from)));
            let normal = (b - a).cross(&(c - a));
            let sine = -normal.dot(&a) / (normal.norm() * a.norm());
            let is_kept = front.contains(corners);
            assert!(is_kept || sine < 0.0, "{corners:?}: {sine}");
            assert!(!is_kept || sine > -0.05, "{corners:?}: {sine}");
        }
        assert!(front.len() > triangles.len() / 4 && front.len() < triangles.len() / 2, "{}", front.len());
    }

    #[test]
    fn triangles_without_a_projection_are_kept() {
        let away = [[2.0, 0.0, 0.0], [2.0, 0.0, 1.0], [2.0, -1.0, 0.0]];
        assert!(front(&[[0, 1, 2]], &away).is_empty());
        for wrong in [f32::NAN, f32::INFINITY, -1.0, 0.0] {
            let mut vertices = away;
            vertices[1][0] = wrong;
            assert_eq!(front(&[[0, 1, 2]], &vertices), [[0, 1, 2]], "{wrong}");
        }
    }

    #[test]
    fn a_triangle_faces_the_camera_if_the_drawn_one_does() {
        let towards = [[2.0, 1.0, 1.0], [2.0, 1.0, 0.0], [2.0, 0.0, 1.0]];
        assert_eq!(front(&[[0, 1, 2]], &towards), [[0, 1, 2]]);
        // A coordinate that cannot be drawn is drawn as zero.
        let mut vertices = towards;
        vertices[1][2] = 1e16;
        assert_eq!(front(&[[0, 1, 2]], &vertices), [[0, 1, 2]]);
    }
}
