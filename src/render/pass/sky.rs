//! Skybox and haze, and their visibility.

use crate::numerics::spatial::dot;
use crate::render::draw_list::{DrawList, Horizon};
use crate::render::gpu::buffer::GrowableBuffer;
use crate::render::settings::VisualSettings;
use crate::render::view::ViewFrustum;
use crate::render::{Gpu, RenderError};
use crate::shape::{self, Triangles};

/// Vertex of the skybox, relative to the camera, or of the haze, in world space. If there is haze,
/// both share one shader, because compiling a second shader takes longer than rendering with it.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct SkyVertex {
    position: [f32; 3],
    is_haze: f32,
    rgba: [f32; 4],
}

/// Geometry of the skybox and of the haze.
#[derive(Debug)]
pub(crate) struct Sky {
    pub(crate) buffer: GrowableBuffer,
    pub(crate) is_visible: bool,
    /// Vertices of the skybox, a cylinder of radius 1 from z = -1 to 1, followed by the vertices of
    /// the haze.
    vertices: Vec<SkyVertex>,
    skybox_vertices: usize,
    /// Number of slices of the cylinder and of the haze: the model's for round shapes.
    slices: u32,
    /// Inputs of the haze in `vertices`.
    haze: Option<HazeView>,
}

/// Inputs of the haze that change from frame to frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct HazeView {
    horizon: Horizon,
    position: [f64; 3],
    /// Distance of the skybox, m.
    distance: f64,
}

/// Distance of the haze, as a fraction of the distance of the skybox. Haze without a width would
/// otherwise be in the surface of the skybox.
const HAZE_FRACTION: f64 = 0.9999;

impl Sky {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let buffer = GrowableBuffer::new(gpu, "vertices of the sky", wgpu::BufferUsages::VERTEX);
        Self { buffer, is_visible: false, vertices: Vec::new(), skybox_vertices: 0, slices: 0, haze: None }
    }

    /// Returns `true` if the last preparation added haze.
    pub(crate) fn has_haze(&self) -> bool {
        self.vertices.len() > self.skybox_vertices
    }

    /// Returns `true` if both skies look the same from their cameras.
    pub(super) fn is_equal(&self, other: &Self) -> bool {
        let of = |sky: &Self| (sky.is_visible, sky.slices, sky.haze);
        of(self) == of(other)
    }

    pub(crate) fn vertex_count(&self) -> u32 {
        self.vertices.len() as u32
    }

    /// Computes the visibility of the sky and the vertices of the haze.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        list: &DrawList,
        frustum: &ViewFrustum,
        settings: &VisualSettings,
        has_haze: bool,
    ) -> Result<(), RenderError> {
        self.is_visible = !list.horizon.is_some_and(|horizon| is_hidden(&horizon, frustum, settings));
        if !self.is_visible {
            return Ok(());
        }
        let haze = list.horizon.filter(|_| has_haze).map(|horizon| HazeView {
            horizon,
            position: frustum.position,
            distance: frustum.sky_distance(),
        });
        if self.slices == settings.slices && self.haze == haze {
            return Ok(());
        }
        if self.slices != settings.slices {
            self.vertices = skybox(settings.slices);
            (self.slices, self.skybox_vertices) = (settings.slices, self.vertices.len());
        }
        self.vertices.truncate(self.skybox_vertices);
        if let Some(HazeView { horizon, .. }) = &haze {
            add_haze(horizon, frustum, settings, &mut self.vertices);
        }
        self.haze = haze;
        self.buffer.write(gpu, bytemuck::cast_slice(&self.vertices))?;
        Ok(())
    }

    /// Requests an upload of the vertices. Required if commands may not have been executed.
    pub(crate) fn invalidate(&mut self) {
        self.slices = 0;
        self.buffer.invalidate();
    }
}

fn skybox(slices: u32) -> Vec<SkyVertex> {
    let disk = shape::disk(slices, 1);
    let mut vertices = unindexed(&shape::cylinder(slices, 1), |position| position);
    for sign in [1.0, -1.0] {
        vertices.extend(unindexed(&disk, |[x, y, z]| [x, sign * y, sign + sign * z]));
    }
    vertices
}

/// Expands indexed triangles to a triangle list of skybox vertices.
fn unindexed(triangles: &Triangles, transform: impl Fn([f32; 3]) -> [f32; 3]) -> Vec<SkyVertex> {
    let vertex = |&index: &u32| {
        let position = transform(triangles.vertices[index as usize].position);
        SkyVertex { position, is_haze: 0.0, rgba: [0.0, 0.0, 0.0, 1.0] }
    };
    triangles.indices.iter().map(vertex).collect()
}

fn normal(horizon: &Horizon) -> [f64; 3] {
    let mat = horizon.mat;
    [mat[2], mat[5], mat[8]].map(f64::from)
}

/// Returns the height of the camera above the plane, m.
fn camera_height(horizon: &Horizon, frustum: &ViewFrustum) -> f64 {
    let offset = [0, 1, 2].map(|axis| frustum.position[axis] - f64::from(horizon.pos[axis]));
    dot(&normal(horizon), &offset)
}

/// Returns `true` if the plane hides the sky and the haze: the rays through all corners of the
/// image hit the plane before the haze begins.
fn is_hidden(horizon: &Horizon, frustum: &ViewFrustum, settings: &VisualSettings) -> bool {
    let (height, up) = (camera_height(horizon, frustum), normal(horizon));
    horizon.is_opaque
        && height > 0.0
        && !frustum.orthographic
        && frustum.corners.iter().all(|&corner| {
            let descent = -dot(&up, &corner);
            let length = dot(&corner, &corner).sqrt() * (height / descent);
            // The sides of the polygonal cylinder are nearer than its edges.
            let nearest = 0.95 * (std::f64::consts::PI / f64::from(settings.slices)).cos();
            descent > 0.0 && length < nearest * (1.0 - f64::from(settings.haze)) * frustum.sky_distance()
        })
}

/// Appends the haze: a ring around the camera, from the plane inside of the skybox up to the height
/// of the camera at the skybox, transparent at both edges.
fn add_haze(horizon: &Horizon, frustum: &ViewFrustum, settings: &VisualSettings, vertices: &mut Vec<SkyVertex>) {
    let height = camera_height(horizon, frustum);
    if height < 0.0 {
        return;
    }
    let distance = HAZE_FRACTION * frustum.sky_distance();
    let width = f64::from(settings.haze);
    // The haze is densest on the line of sight from the camera to the intersection of the plane
    // with the skybox.
    let slope = 1.0_f64.atan2(width);
    let densest = 0.5_f64.sqrt() * width * slope.sin() / (0.75 * std::f64::consts::PI - slope).sin();
    let [red, green, blue, _] = settings.haze_color;
    let vertex = |slice: u32, up: f64, alpha: f32| {
        let angle = std::f64::consts::TAU * f64::from(slice) / f64::from(settings.slices);
        let radius = 1.0 - width * (1.0 - up);
        let local = [distance * radius * angle.cos(), distance * radius * angle.sin(), height * (up - 1.0)];
        let mat = horizon.mat.map(f64::from);
        let position = [0, 1, 2].map(|row| {
            let offset = (0..3).map(|column| mat[3 * row + column] * local[column]).sum::<f64>();
            (frustum.position[row] + offset) as f32
        });
        SkyVertex { position, is_haze: 1.0, rgba: [red, green, blue, alpha] }
    };
    for [(low, low_alpha), (high, high_alpha)] in [[(0.0, 0.0), (densest, 1.0)], [(densest, 1.0), (1.0, 0.0)]] {
        for slice in 0..settings.slices {
            let [a, b] = [slice, slice + 1].map(|slice| vertex(slice, low, low_alpha));
            let [d, c] = [slice, slice + 1].map(|slice| vertex(slice, high, high_alpha));
            // The order in which Mesa divides a quad: with haze above 1 the quad intersects itself.
            vertices.extend([a, b, d, b, c, d]);
        }
    }
}
