//! Uniform data of a view, in the memory layout of the shaders.

use super::matrix::{Matrix4, product, row, to_f32, unit};
use super::{Lights, ShadowRegion, ViewFrustum};
use crate::render::settings::{MAX_MAGNITUDE, VisualSettings};

/// Per-view uniforms, at the start of the uniform buffer of each view. `common.wgsl` declares the
/// same structure.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct ViewUniforms {
    pub(crate) clip: [[f32; 4]; 4],
    /// Position of the camera; factor on all colours.
    pub(crate) camera: [f32; 4],
    /// Product with a point (x, y, z, 1) is its depth, m.
    pub(crate) depth: [f32; 4],
    /// Ambient light of the scene.
    pub(crate) ambient: [f32; 4],
    pub(crate) fog_color: [f32; 4],
    /// Visibility in fog: slope and offset of a linear function of the depth.
    pub(crate) fog: [f32; 4],
    /// Clipping plane. Shaders with clipping discard fragments on its negative side.
    pub(crate) plane: [f32; 4],
    /// Width and height of the image, pixels; line width, pixels; distance of the near plane, m.
    pub(crate) pixels: [f32; 4],
    /// Colour of the haze; distance of the skybox.
    pub(crate) sky: [f32; 4],
    pub(crate) place: Place,
}

/// Place of an image in a texture of several images. The image has clip coordinates of its own.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Place {
    /// Scale and offset along x and y from the clip coordinates of the image to those of the
    /// texture.
    tile: [f32; 4],
    /// Smallest x and y, and largest x and y, that are drawn, in clip coordinates of the image.
    edges: [f32; 4],
}

impl Place {
    /// The whole texture.
    pub(crate) const WHOLE: Self = Self { tile: [1.0, 1.0, 0.0, 0.0], edges: [-1.0, -1.0, 1.0, 1.0] };

    /// Returns the place of an image of `size` whose upper left pixel is `origin` in a texture of
    /// the size `of`.
    pub(crate) fn new(origin: [u32; 2], size: [u32; 2], of: [u32; 2]) -> Self {
        let [scale_x, scale_y] = [0, 1].map(|axis| f64::from(size[axis]) / f64::from(of[axis]));
        let [x, y] = [0, 1].map(|axis| 2.0 * f64::from(origin[axis]) / f64::from(of[axis]) - 1.0);
        Self { tile: [scale_x, scale_y, x + scale_x, -y - scale_y].map(|number| number as f32), ..Self::WHOLE }
    }

    /// Limits the drawn part of the image of `size` to ranges of pixels in x and y, of which the
    /// first row is the upper one. `None` is an empty part.
    pub(crate) fn limited(self, part: Option<[[u32; 2]; 2]>, size: [u32; 2]) -> Self {
        let Some([x, y]) = part else { return Self { edges: [1.0, 1.0, -1.0, -1.0], ..self } };
        let clip = |pixel: u32, axis: usize| 2.0 * pixel as f32 / size[axis] as f32 - 1.0;
        Self { edges: [clip(x[0], 0), -clip(y[1], 1), clip(x[1], 0), -clip(y[0], 1)], ..self }
    }
}

/// Light in the uniform buffer. `common.wgsl` declares the same structure.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct LightUniforms {
    /// Position; for a directional light the direction towards it.
    position: [f32; 4],
    /// Axis of the cone; spot exponent.
    axis: [f32; 4],
    /// Constant, linear and quadratic attenuation; cosine of the cutoff angle.
    attenuation: [f32; 4],
    ambient: [f32; 4],
    diffuse: [f32; 4],
    specular: [f32; 4],
}

/// Shadow map in the uniform buffer. `common.wgsl` declares the same structure.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct ShadowUniforms {
    /// Projection from world space to texels and depths.
    texels: [[f32; 4]; 4],
    /// Coordinates of the first and of the last texel.
    bounds: [f32; 4],
    /// Farthest depth.
    farthest: [f32; 4],
}

impl ViewUniforms {
    /// Computes the uniforms of a view frustum.
    pub(crate) fn new(
        frustum: &ViewFrustum,
        settings: &VisualSettings,
        [width, height]: [u32; 2],
        has_fog: bool,
    ) -> Self {
        let [x, y, z] = frustum.position.map(|coordinate| coordinate as f32);
        let [start, end] = settings.fog;
        // Fog that ends before it starts hides what is near. OpenGL does not define fog that ends
        // where it starts; Mesa computes a slope of 1.
        let slope = if start == end { 1.0 } else { 1.0 / (start - end) };
        let slope = slope.clamp(-MAX_MAGNITUDE, MAX_MAGNITUDE);
        let fog = if has_fog { [slope, -slope * end] } else { [0.0, 1.0] };
        let [red, green, blue, _] = settings.haze_color;
        Self {
            clip: to_f32(&frustum.clip),
            camera: [x, y, z, 1.0],
            depth: frustum.depth.map(|number| number as f32),
            ambient: [0.0; 4],
            fog_color: settings.fog_color,
            fog: [fog[0], fog[1], 0.0, 0.0],
            plane: [0.0, 0.0, 0.0, 1.0],
            pixels: [width as f32, height as f32, settings.line_width, frustum.range[0] as f32],
            sky: [red, green, blue, frustum.sky_distance() as f32],
            place: Place::WHOLE,
        }
    }

    /// Returns the uniforms of a shadow map, of which only the projection and the place are used.
    pub(crate) fn of_shadow_map(clip: &Matrix4, place: Place) -> Self {
        Self { clip: to_f32(clip), place, ..bytemuck::Zeroable::zeroed() }
    }
}

/// Contents of the uniform buffer of a view, or of the storage buffer of several views.
#[derive(Debug, Default)]
pub(crate) struct UniformData {
    bytes: Vec<u8>,
}

impl UniformData {
    /// Vectors of four numbers in a view without lights, in a light, and in a shadow map.
    pub(crate) const VECTORS: [usize; 3] =
        [size_of::<ViewUniforms>() / 16, size_of::<LightUniforms>() / 16, size_of::<ShadowUniforms>() / 16];

    /// Creates the uniforms of a view without lights.
    pub(crate) fn unlit(view: &ViewUniforms) -> Self {
        let mut uniforms = Self::default();
        uniforms.push_unlit(view);
        uniforms
    }

    /// Appends a view without lights.
    pub(crate) fn push_unlit(&mut self, view: &ViewUniforms) {
        self.push(view);
    }

    /// Appends a view with lights, and with shadow maps of `shadow_size` texels unless `regions` is
    /// empty.
    pub(crate) fn push_lit(
        &mut self,
        view: &ViewUniforms,
        lights: &Lights,
        regions: &[ShadowRegion],
        shadow_size: u32,
    ) {
        let mut view = *view;
        if lights.ambient_only {
            view.ambient = [0.3, 0.3, 0.3, 1.0];
        }
        self.push(&view);
        for active in &lights.active {
            let light = &active.light;
            let dir = unit(light.dir.map(f64::from)).map(|part| part as f32);
            let vec4 = |[x, y, z]: [f32; 3], w: f32| [x, y, z, w];
            let position = if active.features.directional { dir.map(|part| -part) } else { light.pos };
            // Code for a spotlight has no effect on other lights.
            let exponent = if active.features.focused { light.exponent } else { 0.0 };
            let cutoff = if active.features.spot { light.cutoff.to_radians().cos() } else { -2.0 };
            self.push(&LightUniforms {
                position: vec4(position, 0.0),
                axis: vec4(dir, exponent),
                attenuation: vec4(light.attenuation, cutoff),
                ambient: vec4(light.ambient, 0.0),
                diffuse: vec4(light.diffuse, 0.0),
                specular: vec4(light.specular, 0.0),
            });
        }
        for (matrix, region) in lights.shadows().zip(regions) {
            let clip_to_texels = region.clip_to_texels(shadow_size);
            debug_assert_eq!(row(&clip_to_texels, 3), [0.0, 0.0, 0.0, 1.0], "w must be unchanged");
            let [first, last] =
                [[0, 0], region.size.map(|length| length - 1)].map(|[x, y]| [region.place[0] + x, region.place[1] + y]);
            self.push(&ShadowUniforms {
                texels: to_f32(&product(&clip_to_texels, matrix)),
                bounds: [first[0], first[1], last[0], last[1]].map(|texel| texel as f32),
                farthest: [region.depth_range()[1], 0.0, 0.0, 0.0],
            });
        }
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn push(&mut self, value: &impl bytemuck::NoUninit) {
        self.bytes.extend_from_slice(bytemuck::bytes_of(value));
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use wgpu::naga::TypeInner;
    use wgpu::naga::front::wgsl;

    use super::{LightUniforms, Place, ShadowUniforms, ViewUniforms};
    use crate::render::shader::{Output, ShaderKind, ShaderVariant, Shading, TextureKind};
    use crate::render::view::LightFeatures;

    /// Names and offsets of the fields of a structure, and its size.
    type Layout = (Vec<(String, u32)>, u32);

    macro_rules! layout {
        ($type:ident { $($field:ident),* }) => {{
            let fields = vec![$((stringify!($field).to_owned(), offset_of!($type, $field) as u32)),*];
            (fields, size_of::<$type>() as u32)
        }};
    }

    #[test]
    fn the_shaders_declare_the_same_structures() {
        let lights = [LightFeatures {
            directional: false,
            attenuated: true,
            spot: true,
            focused: true,
            ambient: true,
            specular: true,
            shadow: true,
        }];
        let variant = ShaderVariant {
            kind: ShaderKind::Surface,
            output: Output::Color,
            texture_kind: TextureKind::None,
            shading: Shading::Pixel,
            lights: &lights,
            fog: true,
            blended: false,
            quad_edges: false,
            clip: true,
            aliased: false,
            vectors: None,
        };
        let module = wgsl::parse_str(&variant.source()).unwrap();
        let layout_of = |name: &str| -> Layout {
            let (_, structure) = module.types.iter().find(|(_, of)| of.name.as_deref() == Some(name)).unwrap();
            let TypeInner::Struct { members, span } = &structure.inner else { panic!("{name} is no structure") };
            (members.iter().map(|member| (member.name.clone().unwrap(), member.offset)).collect(), *span)
        };
        let light = layout!(LightUniforms { position, axis, attenuation, ambient, diffuse, specular });
        assert_eq!(layout_of("Light"), light);
        let shadow = layout!(ShadowUniforms { texels, bounds, farthest });
        assert_eq!(layout_of("Shadow"), shadow);
        // The lights and the shadow maps follow.
        let (mut fields, size) =
            layout!(ViewUniforms { clip, camera, depth, ambient, fog_color, fog, plane, pixels, sky, place });
        assert_eq!(layout_of("Place"), layout!(Place { tile, edges }));
        fields.extend([("lights".to_owned(), size), ("shadows".to_owned(), size + light.1)]);
        assert_eq!(layout_of("View"), (fields, size + light.1 + shadow.1));
    }
}
