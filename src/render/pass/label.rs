//! Texts at geoms, over everything else.

use super::Memory;
use crate::render::frame::Eye;
use crate::render::frame::matrix::apply;
use crate::render::settings::is_drawable;
use crate::render::text::{CELL, Quad, Style, quads};
use crate::render::{Gpu, RenderError};
use crate::scene::Scene;

/// A letter as the graphics card reads it: [`Quad`].
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Letter {
    rect: [f32; 4],
    texcoords: [f32; 4],
    rgba: [f32; 4],
    channel: [f32; 2],
}

/// The texts of a scene.
#[derive(Debug)]
pub(crate) struct Labels {
    pub(crate) memory: Memory,
    pub(crate) count: u32,
    /// The letters, once there was a text.
    pub(crate) atlas: Option<wgpu::BindGroup>,
    letters: Vec<Letter>,
}

impl Labels {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let memory = Memory::new(gpu, wgpu::BufferUsages::VERTEX);
        Self { memory, count: 0, atlas: None, letters: Vec::new() }
    }

    /// Puts the labels of a scene in their places: the lower left corner of each at its geom.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, scene: &Scene, eye: &Eye, size: [u32; 2]) -> Result<(), RenderError> {
        self.letters.clear();
        for geom in scene.geoms() {
            let label = geom.label();
            if label.is_empty() {
                continue;
            }
            if let Some([x, y]) = pixel(geom.pos(), eye, size) {
                let at = [x.round(), (y - CELL[1] as f32 * Style::LABEL.scale).round()];
                self.letters.extend(quads(label, at, Style::LABEL).map(Letter::from));
            }
        }
        if eye.turned {
            let height = size[1] as f32;
            for Letter { rect: [_, top, _, bottom], .. } in &mut self.letters {
                (*top, *bottom) = (height - *top, height - *bottom);
            }
        }
        self.count = self.letters.len() as u32;
        self.memory.write(gpu, bytemuck::cast_slice(&self.letters))?;
        Ok(())
    }
}

impl From<Quad> for Letter {
    fn from(Quad { rect, texcoords, rgba, channel }: Quad) -> Self {
        Self { rect, texcoords, rgba, channel }
    }
}

/// Where a point is on the picture, pixels from the upper left; nothing if it is not on it.
fn pixel(point: [f32; 3], eye: &Eye, size: [u32; 2]) -> Option<[f32; 2]> {
    if !point.iter().all(|&coordinate| is_drawable(coordinate)) {
        return None;
    }
    let [x, y, z] = point.map(f64::from);
    let [x, y, z, w] = apply(&eye.clip, [x, y, z, 1.0]);
    let is_seen = w > 0.0 && x.abs() <= w && y.abs() <= w && z >= 0.0 && z <= w;
    let [width, height] = size.map(f64::from);
    let y = if eye.turned { -y } else { y };
    is_seen.then(|| [((0.5 + 0.5 * x / w) * width) as f32, ((0.5 - 0.5 * y / w) * height) as f32])
}
