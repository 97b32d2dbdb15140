//! Shadow maps: how far the nearest thing is from a light, in each direction. Only the part that something is drawn to is kept, and it is
//! on the grid of the whole map, so that shadows have the edges that they would have.
//!
//! On a processor, to clear a map takes as long as to draw to it. So each picture draws nearer than the one before it, and what is left
//! over from that counts as nothing; see [`Window::depths`].

use super::target::{texture, view};
use super::{Draw, Key, Memory, Step};
use crate::render::frame::matrix::product;
use crate::render::frame::{Lights, Uniform, View, Window};
use crate::render::list::{Batch, Kind, List};
use crate::render::{Gpu, GpuKind, RenderError};

/// A map of one light.
#[derive(Debug)]
struct Map {
    window: Window,
    view: wgpu::TextureView,
    uniform: Memory,
    group: Option<wgpu::BindGroup>,
    /// Whether anything is drawn to it.
    is_used: bool,
    /// Whether something is in it that is nearer than what is to be drawn.
    is_spent: bool,
}

/// The maps of all lights.
#[derive(Debug)]
pub(crate) struct Shadows {
    /// Width and height of a whole map, texels.
    size: u32,
    maps: Vec<Map>,
    windows: Vec<Window>,
    /// Counts how often the textures were made anew.
    version: u64,
}

/// Parts of maps have widths and heights that are multiples of this: then they need not be made anew whenever something moves.
const GRAIN: u32 = 128;

/// A map is cleared every so many pictures: long before their depths become too small for a floating-point number.
const TURNS: u32 = 64;

/// A texture is kept for a part that is smaller, unless it has more than so many times as many texels.
const SLACK: u64 = 3;

impl Shadows {
    pub(crate) fn new(size: u32) -> Self {
        // Below that nothing is within the border.
        let size = if size < 4 { 0 } else { size };
        Self { size, maps: Vec::new(), windows: Vec::new(), version: 0 }
    }

    /// Whether there are shadows at all.
    pub(crate) fn any(&self) -> bool {
        self.size > 0
    }

    pub(crate) fn size(&self) -> u32 {
        self.size
    }

    /// The parts that are kept, for the lights of the last [`prepare`](Self::prepare).
    pub(crate) fn windows(&self) -> &[Window] {
        &self.windows
    }

    pub(crate) fn version(&self) -> u64 {
        self.version
    }

    /// The maps, for programs to read.
    pub(crate) fn views(&self) -> impl Iterator<Item = &wgpu::TextureView> {
        self.maps[..self.windows.len()].iter().map(|map| &map.view)
    }

    /// Makes room for the shadows of a list.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, lights: &Lights, list: &List) -> Result<(), RenderError> {
        self.windows.clear();
        let clears = gpu.kind() != GpuKind::Software;
        for (index, (matrix, casters)) in lights.shadows().zip(&list.casters).enumerate() {
            let needed = self.needed(*casters);
            if index == self.maps.len() {
                self.maps.push(Map::new(gpu, needed));
                self.version += 1;
            }
            let map = &mut self.maps[index];
            let texels = |size: [u32; 2]| u64::from(size[0]) * u64::from(size[1]);
            let kept = map.window.size;
            let fits = kept[0] >= needed.size[0] && kept[1] >= needed.size[1];
            if fits && texels(kept) <= SLACK * texels(needed.size) {
                map.window.first = needed.first;
                // A card clears what it draws to at no cost, and draws faster to what is clear.
                map.window.turn = if clears { 0 } else { (map.window.turn + 1) % TURNS };
            } else {
                (map.window, map.view) = (needed, map_view(gpu, needed.size));
                self.version += 1;
            }
            map.is_spent |= map.window.turn == 0;
            map.is_used = casters.is_some();
            let clip = product(&map.window.zoom(self.size), matrix);
            if map.uniform.write(gpu, Uniform::plain(&View::of_shadow(&clip)).bytes())? {
                map.group = None;
            }
            self.windows.push(map.window);
        }
        Ok(())
    }

    /// The part of a map that a rectangle of the light's cube needs, with a texel around it that nothing is drawn to.
    fn needed(&self, casters: Option<[[f64; 2]; 2]>) -> Window {
        let Some([low, high]) = casters else {
            return Window { first: [0; 2], size: [GRAIN.min(self.size); 2], turn: 0 };
        };
        let inner = f64::from(self.size) - 2.0;
        let texel = |coordinate: f64| 1.0 + (0.5 + 0.5 * coordinate) * inner;
        let first = low.map(|low| (texel(low).floor() as u32).saturating_sub(2));
        let last = high.map(|high| (texel(high).ceil() as u32 + 2).min(self.size));
        let size = [0, 1].map(|axis| (last[axis] - first[axis]).next_multiple_of(GRAIN).min(self.size));
        Window { first, size, turn: 0 }
    }

    /// Clears all maps before they are drawn to again: for when it is not known whether what was to be drawn has been.
    pub(crate) fn forget(&mut self) {
        for map in &mut self.maps {
            map.is_spent = true;
        }
    }

    /// Draws everything that casts shadows to the maps.
    pub(crate) fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, draw: &mut Draw<'_>, list: &List, culls: bool) {
        // Upside down, so that its texels are in OpenGL's order.
        let key = Key::plain(Step::Shadow, super::COLOR, [culls, true]);
        for (light, map) in self.maps[..self.windows.len()].iter_mut().enumerate() {
            if !map.is_used && !map.is_spent {
                continue;
            }
            let load = if map.is_spent { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load };
            map.is_spent = false;
            let group = map.group.get_or_insert_with(|| draw.pipelines.group(draw.gpu, &map.uniform, &[]));
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadow map"),
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &map.view,
                    depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            if !map.is_used {
                continue;
            }
            let Some([[left, right], [top, bottom]]) = border(&map.window, self.size) else { continue };
            let [width, height] = map.window.size.map(|length| length as f32);
            let [near, far] = map.window.depths();
            pass.set_viewport(0.0, 0.0, width, height, near, far);
            pass.set_scissor_rect(left, top, right - left, bottom - top);
            pass.set_bind_group(0, &*group, &[]);
            let solid = list.reflector.iter().chain(&list.solid);
            let casts = |batch: &&Batch| batch.place.casts & 1 << light != 0;
            for batch in solid.chain(&list.clear[..list.clear_once]).filter(casts) {
                // A plane is not turned for a light: which side it shows the eye does not matter.
                let batch = Batch { kind: Kind { back: false, ..batch.kind }, ..batch.clone() };
                draw.batch(&mut pass, &batch, &key);
            }
        }
    }
}

impl Map {
    fn new(gpu: &Gpu, window: Window) -> Self {
        let uniform = Memory::new(gpu, wgpu::BufferUsages::UNIFORM);
        Self { window, view: map_view(gpu, window.size), uniform, group: None, is_used: false, is_spent: true }
    }
}

fn map_view(gpu: &Gpu, size: [u32; 2]) -> wgpu::TextureView {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    view(&texture(gpu, size, wgpu::TextureFormat::Depth32Float, 1, usage))
}

/// What of a part is within the border of the whole map: from and to, along x and along y. Nothing if there is none.
fn border(window: &Window, size: u32) -> Option<[[u32; 2]; 2]> {
    let range = [0, 1].map(|axis| {
        let first = window.first[axis];
        let low = 1_u32.saturating_sub(first);
        let high = (size - 1).saturating_sub(first).min(window.size[axis]);
        [low, high]
    });
    range.iter().all(|[low, high]| low < high).then_some(range)
}

#[cfg(test)]
mod tests {
    use super::{Shadows, Window, border};

    #[test]
    fn a_part_has_an_empty_texel_around_what_casts_shadows() {
        let shadows = Shadows::new(1024);
        let Window { first, size, .. } = shadows.needed(Some([[-0.5, 0.0], [0.0, 0.25]]));
        // Texels 1 + 0.25 * 1022 = 256.5 and 1 + 0.5 * 1022 = 512 in x; 512 and 639.75 in y.
        assert!(first[0] < 256 && first[0] + size[0] > 513, "{first:?} {size:?}");
        assert!(first[1] < 511 && first[1] + size[1] > 641, "{first:?} {size:?}");
        assert!(size[0] < 512 && size[1] < 384, "{size:?} is more than a rounding up");
    }

    #[test]
    fn the_border_of_the_whole_map_stays_empty() {
        let whole = Window { first: [0, 0], size: [1024, 1024], turn: 0 };
        assert_eq!(border(&whole, 1024), Some([[1, 1023], [1, 1023]]));
        let part = Window { first: [900, 100], size: [128, 128], turn: 0 };
        assert_eq!(border(&part, 1024), Some([[0, 123], [0, 128]]));
        assert_eq!(border(&Window { first: [1023, 0], size: [128, 128], turn: 0 }, 1024), None);
    }
}
