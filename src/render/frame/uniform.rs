//! Views and lights as the graphics card reads them.

use super::matrix::{Matrix4, ONE, product, row, single, unit};
use super::{Eye, Lights};
use crate::render::settings::Settings;

/// What is the same for all that is drawn in one view: the first part of each program's uniforms. `view.wgsl` has the same.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct View {
    pub(crate) clip: [[f32; 4]; 4],
    /// The head, and what colours are multiplied by.
    pub(crate) eye: [f32; 4],
    /// The depth of a point, m, is this times it.
    pub(crate) depth: [f32; 4],
    /// Light from everywhere.
    pub(crate) ambient: [f32; 4],
    pub(crate) fog_color: [f32; 4],
    /// How much of a thing shows through the fog is the first times its depth plus the second.
    pub(crate) fog: [f32; 4],
    /// Only what is on the positive side of this plane is drawn, where that is asked for.
    pub(crate) plane: [f32; 4],
    /// Width and height of the picture, pixels; the width of lines, pixels; the near side of the frustum, m.
    pub(crate) pixels: [f32; 4],
    /// Colour of haze, and the distance of the sky.
    pub(crate) sky: [f32; 4],
}

/// A light. `light.wgsl` has the same.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Light {
    /// Its place; for a directional one the direction towards it.
    place: [f32; 4],
    /// The axis of its cone, and how much it is focused.
    axis: [f32; 4],
    /// Constant, linear and quadratic attenuation; the cosine of its cone.
    attenuation: [f32; 4],
    ambient: [f32; 4],
    diffuse: [f32; 4],
    specular: [f32; 4],
}

/// From the world to the texels of a shadow map. `light.wgsl` has the same.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Shadow {
    texels: [[f32; 4]; 4],
    /// The last texel.
    last: [f32; 4],
}

/// The uniforms of one view, as bytes.
#[derive(Debug, Default)]
pub(crate) struct Uniform {
    bytes: Vec<u8>,
}

impl View {
    /// That of an eye.
    pub(crate) fn new(eye: &Eye, settings: &Settings, [width, height]: [u32; 2], has_fog: bool) -> Self {
        let [x, y, z] = eye.head.map(|coordinate| coordinate as f32);
        let [start, end] = settings.fog;
        // Fog without a depth is none, as in OpenGL, which refuses it.
        let fog = if has_fog && end > start { [-1.0 / (end - start), end / (end - start)] } else { [0.0, 1.0] };
        let [red, green, blue, _] = settings.haze_color;
        Self {
            clip: single(&eye.clip),
            eye: [x, y, z, 1.0],
            depth: eye.depth.map(|number| number as f32),
            ambient: [0.0; 4],
            fog_color: settings.fog_color,
            fog: [fog[0], fog[1], 0.0, 0.0],
            plane: [0.0, 0.0, 0.0, 1.0],
            pixels: [width as f32, height as f32, settings.line_width, eye.range[0] as f32],
            sky: [red, green, blue, (0.7 * eye.range[1] / eye.scale) as f32],
        }
    }

    /// That of a light that casts a shadow.
    pub(crate) fn of_shadow(clip: &Matrix4) -> Self {
        Self { clip: single(clip), ..bytemuck::Zeroable::zeroed() }
    }
}

/// The part of a shadow map that is kept: the first texel and how many there are, and how deep they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Window {
    pub(crate) first: [u32; 2],
    pub(crate) size: [u32; 2],
    /// Pictures since the map was cleared; see [`depths`](Self::depths).
    pub(crate) turn: u32,
}

impl Window {
    /// From the cube that the light sees to the cube that the kept part shows, of a map of `size` texels. The map has a border of one
    /// texel that nothing is drawn to.
    pub(crate) fn zoom(&self, size: u32) -> Matrix4 {
        let mut matrix = ONE;
        let inner = f64::from(size) - 2.0;
        #[allow(clippy::needless_range_loop, reason = "rows and columns by the same axis")]
        for axis in 0..2 {
            let (first, length) = (f64::from(self.first[axis]), f64::from(self.size[axis]));
            matrix[axis][axis] = inner / length;
            // The texel of a point is 1 + (x + 1) / 2 * inner.
            matrix[3][axis] = 2.0 * (1.0 + inner / 2.0 - first) / length - 1.0;
        }
        matrix[1][1] = -matrix[1][1];
        matrix[3][1] = -matrix[3][1];
        matrix
    }

    /// The nearest and the farthest depth. Each picture's are half of those of the one before, so that whatever that one has left in the
    /// map is behind all that this one draws: as good as cleared. Halves are exact: all pictures of a scene are the same.
    pub(crate) fn depths(&self) -> [f32; 2] {
        let far = 0.5_f32.powi(self.turn as i32);
        [far / 2.0, far]
    }

    /// From the cube that the light sees to texels of the kept part, and to its depths. The border is not thought of here, as the
    /// engine does not.
    fn texels(&self, size: u32) -> Matrix4 {
        let mut matrix = ONE;
        let [near, far] = self.depths().map(f64::from);
        (matrix[2][2], matrix[3][2]) = (far - near, near);
        #[allow(clippy::needless_range_loop, reason = "rows and columns by the same axis")]
        for axis in 0..2 {
            matrix[axis][axis] = f64::from(size) / 2.0;
            matrix[3][axis] = f64::from(size) / 2.0 - f64::from(self.first[axis]);
        }
        matrix
    }
}

impl Uniform {
    /// A view without lights.
    pub(crate) fn plain(view: &View) -> Self {
        Self { bytes: bytemuck::bytes_of(view).to_vec() }
    }

    /// A view with lights; with their shadows if there are windows.
    pub(crate) fn lit(view: &View, lights: &Lights, windows: &[Window], size: u32) -> Self {
        let mut view = *view;
        if lights.is_dark {
            view.ambient = [0.3, 0.3, 0.3, 1.0];
        }
        let mut uniform = Self::plain(&view);
        for lamp in &lights.lamps {
            let light = &lamp.light;
            let dir = unit(light.dir.map(f64::from)).map(|part| part as f32);
            let wide = |[x, y, z]: [f32; 3], w: f32| [x, y, z, w];
            let place = if lamp.kind.directional { dir.map(|part| -part) } else { light.pos };
            let light = Light {
                place: wide(place, 0.0),
                axis: wide(dir, light.exponent),
                attenuation: wide(light.attenuation, light.cutoff.to_radians().cos()),
                ambient: wide(light.ambient, 0.0),
                diffuse: wide(light.diffuse, 0.0),
                specular: wide(light.specular, 0.0),
            };
            uniform.bytes.extend_from_slice(bytemuck::bytes_of(&light));
        }
        for (matrix, window) in lights.shadows().zip(windows) {
            let texels = clip_to(&window.texels(size), matrix);
            let last = window.size.map(|length| length as f32 - 1.0);
            let shadow = Shadow { texels: single(&texels), last: [last[0], last[1], window.depths()[1], 0.0] };
            uniform.bytes.extend_from_slice(bytemuck::bytes_of(&shadow));
        }
        uniform
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// A shift and a scale of what is divided by its fourth number later.
fn clip_to(shift: &Matrix4, matrix: &Matrix4) -> Matrix4 {
    debug_assert_eq!(row(shift, 3), [0.0, 0.0, 0.0, 1.0], "it keeps the fourth number");
    product(shift, matrix)
}
