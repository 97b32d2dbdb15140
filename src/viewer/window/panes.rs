//! Images of the camera panes.

use egui::{ColorImage, Context, TextureHandle, TextureOptions};

use crate::render::{Gpu, Lighting, RenderError, Renderer, RendererOptions, RgbImage};
use crate::scene::Viewpoint;
use crate::viewer::link::{PaneView, Snapshot};
use crate::viewer::view::{Pane, PaneKind};

/// Height of a pane, points, and the ratio of width to height of a camera that has none.
const HEIGHT: f32 = 150.0;
const ASPECT: f32 = 4.0 / 3.0;

/// Image of a pane.
pub(in crate::viewer) struct PaneImage {
    pub pane: Pane,
    pub texture: TextureHandle,
    /// Width and height, points.
    pub size: [f32; 2],
    /// Number of the snapshot that it shows.
    number: u64,
}

/// Renderer of the camera panes. They have a smaller size than the scene, so that one renderer for
/// both would allocate its targets for each image.
pub(super) struct Panes {
    lighting: Lighting,
    /// Generation of the model, and its renderer.
    renderer: Option<(u64, Renderer)>,
    images: Vec<PaneImage>,
}

impl Panes {
    pub fn new(lighting: Lighting) -> Self {
        Self { lighting, renderer: None, images: Vec::new() }
    }

    /// Drops the GPU resources.
    pub fn drop_renderer(&mut self) {
        self.renderer = None;
    }

    /// Returns the images of the last update.
    pub fn images(&self) -> &[PaneImage] {
        &self.images
    }

    /// Renders the open panes whose snapshots contain their viewpoints, unless they show this
    /// snapshot already.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        context: &Context,
        snapshot: &mut Snapshot,
        panes: &[Pane],
    ) -> Result<(), RenderError> {
        self.images.retain(|image| panes.contains(&image.pane));
        if panes.is_empty() {
            self.renderer = None;
            return Ok(());
        }
        for view in snapshot.panes.clone() {
            for &pane in panes.iter().filter(|pane| pane.camera == view.camera) {
                self.show(gpu, context, snapshot, (pane, &view))?;
            }
        }
        Ok(())
    }

    fn show(
        &mut self,
        gpu: &Gpu,
        context: &Context,
        snapshot: &mut Snapshot,
        (pane, view): (Pane, &PaneView),
    ) -> Result<(), RenderError> {
        let scale = context.pixels_per_point();
        let points = [HEIGHT * aspect(&view.viewpoints[0]), HEIGHT].map(|length| (length * scale).round() / scale);
        let known = self.images.iter().position(|image| image.pane == pane);
        let is_current = |image: &PaneImage| image.number == snapshot.number && image.size == points;
        if known.is_some_and(|index| is_current(&self.images[index])) {
            return Ok(());
        }
        let size = points.map(|length| ((length * scale) as usize).max(1));
        let kept = self.renderer.take().filter(|(generation, _)| *generation == snapshot.generation);
        let renderer = if let Some((_, renderer)) = kept {
            renderer
        } else {
            let options = RendererOptions::default().with_lighting(self.lighting).with_font_scale(scale.into());
            Renderer::on(gpu, &snapshot.model, size[0], size[1], options)?
        };
        let (_, renderer) = self.renderer.insert((snapshot.generation, renderer));
        if renderer.size() != size {
            renderer.resize(size[0], size[1])?;
        }
        let before = (snapshot.scene.viewpoints(), snapshot.scene.headlight());
        snapshot.scene.set_viewpoints(view.viewpoints)?;
        snapshot.scene.set_headlight(view.viewpoints[0].pos, view.viewpoints[0].forward);
        let picture = draw(renderer, snapshot, pane.kind);
        snapshot.scene.set_viewpoints(before.0)?;
        if let Some([pos, dir]) = before.1 {
            snapshot.scene.set_headlight(pos, dir);
        }
        let image = ColorImage::from_rgb(size, picture?.as_bytes());
        let number = snapshot.number;
        if let Some(index) = known {
            let shown = &mut self.images[index];
            shown.texture.set(image, TextureOptions::LINEAR);
            (shown.number, shown.size) = (number, points);
        } else {
            let texture = context.load_texture("camera pane", image, TextureOptions::LINEAR);
            self.images.push(PaneImage { pane, texture, size: points, number });
        }
        Ok(())
    }
}

fn draw(renderer: &mut Renderer, snapshot: &Snapshot, kind: PaneKind) -> Result<RgbImage, RenderError> {
    Ok(match kind {
        PaneKind::Colour => renderer.rgb(&snapshot.scene)?,
        PaneKind::Depth => {
            let depth = renderer.depth(&snapshot.scene)?;
            depth.to_rgb(depth.range().unwrap_or([0.0, 1.0]))
        }
        PaneKind::Segmentation => renderer.segmentation(&snapshot.scene)?.to_rgb(),
    })
}

/// Returns the ratio of width to height of the images of a camera, within limits.
fn aspect(viewpoint: &Viewpoint) -> f32 {
    let height = viewpoint.frustum_top - viewpoint.frustum_bottom;
    let ratio = 2.0 * viewpoint.frustum_width / height;
    if viewpoint.frustum_width > 0.0 && ratio.is_finite() { ratio.clamp(0.3, 3.0) } else { ASPECT }
}
