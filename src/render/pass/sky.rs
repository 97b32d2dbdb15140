//! The sky and the haze, and whether they are seen.

use super::Memory;
use crate::render::frame::Eye;
use crate::render::frame::matrix::dot;
use crate::render::list::{Horizon, List};
use crate::render::settings::Settings;
use crate::render::shape::{self, Triangles};
use crate::render::{Gpu, RenderError};

/// A corner of the sky, from the head, or of the haze, in the world's frame. One program draws both: to make a program takes longer than
/// to draw with it.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Corner {
    position: [f32; 3],
    is_haze: f32,
    rgba: [f32; 4],
}

/// What is at the end of the world.
#[derive(Debug)]
pub(crate) struct Sky {
    pub(crate) memory: Memory,
    /// Whether anything of it is seen.
    pub(crate) is_seen: bool,
    /// First those of a cylinder of radius 1 from z = -1 to 1, and then those of the haze.
    corners: Vec<Corner>,
    cylinder: usize,
}

/// Into how many slices they are cut: the engine's number for round shapes, where the model does not say.
const SLICES: u32 = 28;

/// The share of the far distance at which the sky is: its corners are not beyond it.
const DISTANCE: f64 = 0.7;

impl Sky {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, RenderError> {
        let disk = shape::disk(SLICES, 1);
        let mut corners = list(&shape::cylinder(SLICES, 1), |position| position);
        for turn in [1.0, -1.0] {
            corners.extend(list(&disk, |[x, y, z]| [x, turn * y, turn + turn * z]));
        }
        let mut memory = Memory::new(gpu, wgpu::BufferUsages::VERTEX);
        memory.write(gpu, bytemuck::cast_slice(&corners))?;
        Ok(Self { memory, is_seen: false, cylinder: corners.len(), corners })
    }

    pub(crate) fn corners(&self) -> u32 {
        self.corners.len() as u32
    }

    /// Finds out what of the sky is seen, and where the haze is.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        list: &List,
        eye: &Eye,
        settings: &Settings,
        has_haze: bool,
    ) -> Result<(), RenderError> {
        let distance = DISTANCE * eye.range[1] / eye.scale;
        self.is_seen = !list.horizon.is_some_and(|horizon| hides(&horizon, eye, settings, distance));
        if !self.is_seen {
            return Ok(());
        }
        // The cylinder is in the memory since it was made.
        self.corners.truncate(self.cylinder);
        if let Some(horizon) = list.horizon.filter(|_| has_haze) {
            haze(&horizon, eye, settings, distance, &mut self.corners);
            self.memory.write(gpu, bytemuck::cast_slice(&self.corners))?;
        }
        Ok(())
    }
}

/// The corners of all triangles, one after the other.
fn list(triangles: &Triangles, place: impl Fn([f32; 3]) -> [f32; 3]) -> Vec<Corner> {
    let corner = |&index: &u32| {
        let position = place(triangles.vertices[index as usize].position);
        Corner { position, is_haze: 0.0, rgba: [0.0, 0.0, 0.0, 1.0] }
    };
    triangles.indices.iter().map(corner).collect()
}

fn normal(mat: [f32; 9]) -> [f64; 3] {
    [mat[2], mat[5], mat[8]].map(f64::from)
}

/// The height of the head over a plane, m.
fn height(horizon: &Horizon, eye: &Eye) -> f64 {
    let from = [0, 1, 2].map(|axis| eye.head[axis] - f64::from(horizon.pos[axis]));
    dot(normal(horizon.mat), from)
}

/// Whether a plane hides the sky and the haze: all corners of the picture show the plane, before the haze begins.
fn hides(horizon: &Horizon, eye: &Eye, settings: &Settings, distance: f64) -> bool {
    let (height, up) = (height(horizon, eye), normal(horizon.mat));
    horizon.is_opaque
        && height > 0.0
        && eye.corners.iter().all(|&corner| {
            let fall = -dot(up, corner);
            let reach = height / fall;
            let length = dot(corner, corner).sqrt() * reach;
            // The cylinder's sides are a little nearer than its edges.
            fall > 0.0 && length < 0.95 * (1.0 - f64::from(settings.haze)) * distance
        })
}

/// The ring around the head: from the plane, where it is nearer than the sky, up to the height of the head; clear at both ends.
fn haze(horizon: &Horizon, eye: &Eye, settings: &Settings, distance: f64, corners: &mut Vec<Corner>) {
    let height = height(horizon, eye);
    if height < 0.0 {
        return;
    }
    let width = f64::from(settings.haze);
    // Where the haze is thickest: on the line from the head to where the plane meets the sky.
    let slope = 1.0_f64.atan2(width);
    let thickest = 0.5_f64.sqrt() * width * slope.sin() / (0.75 * std::f64::consts::PI - slope).sin();
    let [red, green, blue, _] = settings.haze_color;
    let corner = |slice: u32, up: f64, alpha: f32| {
        let angle = std::f64::consts::TAU * f64::from(slice) / f64::from(SLICES);
        let radius = 1.0 - width * (1.0 - up);
        let own = [distance * radius * angle.cos(), distance * radius * angle.sin(), height * (up - 1.0)];
        let mat = horizon.mat.map(f64::from);
        let position = [0, 1, 2]
            .map(|row| (eye.head[row] + (0..3).map(|column| mat[3 * row + column] * own[column]).sum::<f64>()) as f32);
        Corner { position, is_haze: 1.0, rgba: [red, green, blue, alpha] }
    };
    for [(low, clear), (high, thick)] in [[(0.0, 0.0), (thickest, 1.0)], [(thickest, 1.0), (1.0, 0.0)]] {
        for slice in 0..SLICES {
            let [a, b] = [slice, slice + 1].map(|slice| corner(slice, low, clear));
            let [d, c] = [slice, slice + 1].map(|slice| corner(slice, high, thick));
            corners.extend([a, b, c, a, c, d]);
        }
    }
}
