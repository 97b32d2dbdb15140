//! Everything that is seen, in one pass: mirror images, the mirror over them, what is solid, the sky, the haze, what is transparent,
//! texts.

use super::{Draw, Key, Labels, Memory, Shadows, Sky, Step, Target};
use crate::render::frame::{Eye, LightKind, Lights, Uniform, View};
use crate::render::list::{Batch, List, Side};
use crate::render::settings::Settings;
use crate::render::shader::{Coat, Shade};
use crate::render::{Gpu, RenderError};
use crate::scene::RenderFlags;

/// What a picture is drawn on.
pub(crate) struct Canvas<'a> {
    pub(crate) target: &'a Target,
    /// Where the colours end up.
    pub(crate) view: &'a wgpu::TextureView,
    /// The pixels that are drawn to: left, top, width and height.
    pub(crate) viewport: [u32; 4],
    /// Whether what is there already stays.
    pub(crate) keeps: bool,
}

/// The uniforms of the scene and of its mirror image.
#[derive(Debug)]
pub(crate) struct Scenes {
    uniform: Memory,
    mirror: Memory,
    /// With the shadow maps, without them, and that of the mirror image.
    group: Option<wgpu::BindGroup>,
    plain: Option<wgpu::BindGroup>,
    mirror_group: Option<wgpu::BindGroup>,
    /// For which shadow maps the group was made: how many, and their version.
    shadows: (usize, u64),
}

impl Scenes {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let memory = || Memory::new(gpu, wgpu::BufferUsages::UNIFORM);
        Self { uniform: memory(), mirror: memory(), group: None, plain: None, mirror_group: None, shadows: (0, 0) }
    }

    /// Writes the uniforms.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        frame: &Frame<'_>,
        list: &List,
        shadows: &Shadows,
    ) -> Result<(), RenderError> {
        let Frame { eye, lights, settings, size, flags, .. } = *frame;
        let has_fog = flags.contains(RenderFlags::FOG);
        let view = View::new(eye, settings, size, has_fog);
        let now = (shadows.windows().len(), shadows.version());
        if self.uniform.write(gpu, Uniform::lit(&view, lights, shadows.windows(), shadows.size()).bytes())? {
            (self.group, self.plain) = (None, None);
        }
        if self.shadows != now {
            (self.group, self.shadows) = (None, now);
        }
        if let Some(mirror) = &list.mirror {
            let mut view = View::new(&eye.mirrored(&mirror.matrix), settings, size, has_fog);
            view.eye[3] = mirror.reflectance;
            view.plane = mirror.plane;
            if self.mirror.write(gpu, Uniform::lit(&view, lights, &[], 0).bytes())? {
                self.mirror_group = None;
            }
        }
        Ok(())
    }

    /// Makes the groups that are not there.
    fn bind(&mut self, draw: &Draw<'_>, shadows: &Shadows) {
        let group = |memory: &Memory, maps: &[&wgpu::TextureView]| draw.pipelines.group(draw.gpu, memory, maps);
        if self.group.is_none() {
            self.group = Some(group(&self.uniform, &shadows.views().collect::<Vec<_>>()));
        }
        if self.plain.is_none() {
            self.plain = Some(group(&self.uniform, &[]));
        }
        if self.mirror_group.is_none() {
            self.mirror_group = Some(group(&self.mirror, &[]));
        }
    }
}

/// From where and how a picture is drawn.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) eye: &'a Eye,
    pub(crate) lights: &'a Lights,
    pub(crate) settings: &'a Settings,
    pub(crate) size: [u32; 2],
    pub(crate) flags: RenderFlags,
    pub(crate) shade: Shade,
}

impl Scenes {
    /// Draws the scene.
    pub(crate) fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        draw: &mut Draw<'_>,
        frame: &Frame<'_>,
        list: &List,
        (shadows, sky, labels): (&Shadows, &Sky, &Labels),
        canvas: &Canvas<'_>,
    ) {
        self.bind(draw, shadows);
        let (Some(group), Some(plain), Some(mirror_group)) = (&self.group, &self.plain, &self.mirror_group) else {
            return;
        };
        let mut pass = begin(encoder, canvas, list);
        let flags = frame.flags;
        // A shadow is in what the light does not add; a mirror image has none.
        let lights = draw.pipelines.lights(frame.lights.kinds());
        let unshadowed = draw.pipelines.lights(frame.lights.kinds().map(|kind| LightKind { shadow: false, ..kind }));
        let key = Key {
            step: Step::Solid,
            coat: Coat::Flat,
            line: false,
            back: false,
            lights,
            shade: frame.shade,
            fog: flags.contains(RenderFlags::FOG),
            culls: flags.contains(RenderFlags::CULL_FACE),
            wire: flags.contains(RenderFlags::WIREFRAME) && draw.gpu.has(wgpu::Features::POLYGON_MODE_LINE),
            additive: flags.contains(RenderFlags::ADDITIVE),
            format: canvas.target.format,
            samples: canvas.target.samples,
            stencil: canvas.target.stencil,
            turned: frame.eye.turned,
        };
        if list.mirror.is_some() {
            pass.set_bind_group(0, mirror_group, &[]);
            self::mirror(&mut pass, draw, list, plain, mirror_group, &Key { lights: unshadowed, ..key });
        }
        pass.set_bind_group(0, group, &[]);
        for batch in list.reflector.iter().filter(|batch| batch.place.seen) {
            draw.batch(&mut pass, batch, &Key { step: Step::Reflector, ..key });
        }
        for batch in list.solid.iter().filter(|batch| batch.place.seen) {
            draw.batch(&mut pass, batch, &key);
        }
        pass.set_bind_group(0, plain, &[]);
        if flags.contains(RenderFlags::SKYBOX) && sky.is_seen {
            self::sky(&mut pass, draw, sky, &key);
        }
        for batch in clear(list, &key).iter().filter(|batch| batch.place.seen) {
            draw.batch(&mut pass, batch, &Key { step: Step::Clear, lights: unshadowed, ..key });
        }
        if let Some(atlas) = labels.atlas.as_ref().filter(|_| labels.count > 0) {
            let key = Key {
                step: Step::Label,
                coat: Coat::Plain,
                shade: Shade::None,
                fog: false,
                wire: false,
                lights: 0,
                ..key
            };
            pass.set_pipeline(draw.pipelines.get(draw.gpu, key));
            pass.set_bind_group(1, atlas, &[]);
            pass.set_vertex_buffer(0, labels.memory.buffer().slice(..));
            pass.draw(0..4, 0..labels.count);
        }
    }
}

/// Begins the pass, on an empty picture.
fn begin<'e>(encoder: &'e mut wgpu::CommandEncoder, canvas: &Canvas<'_>, list: &List) -> wgpu::RenderPass<'e> {
    let load = if canvas.keeps { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::BLACK) };
    let (view, resolve_target) = match &canvas.target.many {
        Some(many) => (many, Some(canvas.view)),
        None => (canvas.view, None),
    };
    // The samples are of no use once they are mixed.
    let store = if resolve_target.is_some() && canvas.keeps { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard };
    let store = if resolve_target.is_none() { wgpu::StoreOp::Store } else { store };
    let unmarked = u32::from(list.mirror.as_ref().is_none_or(|mirror| mirror.mark.is_none()));
    let stencil_ops = canvas
        .target
        .stencil
        .then_some(wgpu::Operations { load: wgpu::LoadOp::Clear(unmarked), store: wgpu::StoreOp::Discard });
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("scene"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target,
            ops: wgpu::Operations { load, store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &canvas.target.depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
            stencil_ops,
        }),
        ..Default::default()
    });
    let [left, top, width, height] = canvas.viewport;
    pass.set_viewport(left as f32, top as f32, width as f32, height as f32, 0.0, 1.0);
    pass.set_scissor_rect(left, top, width, height);
    pass
}

/// The mirror images of everything but the mirror, where the mirror is.
fn mirror(
    pass: &mut wgpu::RenderPass<'_>,
    draw: &mut Draw<'_>,
    list: &List,
    plain: &wgpu::BindGroup,
    mirror_group: &wgpu::BindGroup,
    key: &Key,
) {
    let Some(mirror) = &list.mirror else { return };
    pass.set_stencil_reference(1);
    if let Some((shape, _)) = mirror.mark {
        // Seen as it is, and with an instance of its own: the last.
        let index = list.instances.len() as u32 - 1;
        let kind = crate::render::list::Kind { shape, coat: Coat::Plain, texture: 0, line: false, back: false };
        let place = crate::render::list::Place { seen: true, side: Side::Across, casts: 0 };
        let batch = Batch { kind, place, instances: index..index + 1 };
        let key =
            Key { step: Step::Mark, coat: Coat::Plain, shade: Shade::None, fog: false, wire: false, lights: 0, ..*key };
        pass.set_bind_group(0, plain, &[]);
        draw.batch(pass, &batch, &key);
        pass.set_bind_group(0, mirror_group, &[]);
    }
    // What is out of sight may be seen in the mirror.
    let sight = draw.sight.take();
    for batch in &list.solid {
        if batch.place.side != Side::Behind {
            let clip = batch.place.side == Side::Across;
            draw.batch(pass, batch, &Key { step: Step::MirrorSolid { clip }, ..*key });
        }
    }
    for batch in clear(list, key) {
        if batch.place.side != Side::Behind {
            let clip = batch.place.side == Side::Across;
            draw.batch(pass, batch, &Key { step: Step::MirrorClear { clip }, ..*key });
        }
    }
    draw.sight = sight;
}

/// What is transparent: front to back, and unless it is added back to front once more.
fn clear<'l>(list: &'l List, key: &Key) -> &'l [Batch] {
    if key.additive { &list.clear[..list.clear_once] } else { &list.clear }
}

fn sky(pass: &mut wgpu::RenderPass<'_>, draw: &mut Draw<'_>, sky: &Sky, key: &Key) {
    let Some(picture) = draw.textures.sky() else { return };
    let key = Key { step: Step::Sky, coat: Coat::Plain, shade: Shade::None, wire: false, lights: 0, ..*key };
    pass.set_pipeline(draw.pipelines.get(draw.gpu, key));
    pass.set_bind_group(1, picture, &[]);
    pass.set_vertex_buffer(0, sky.memory.buffer().slice(..));
    pass.draw(0..sky.corners(), 0..1);
}
