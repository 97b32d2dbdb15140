//! Camera panes: images of the model's cameras over the scene.

use egui::{CollapsingHeader, Context, Id, Image, Ui, Window};

use super::{PanelContext, display_name, layout};
use crate::viewer::view::{Pane, PaneKind};

/// Width of the labels, points.
const LABEL_WIDTH: f32 = 96.0;
/// Width of the margins of a pane, points.
const FRAME: f32 = 14.0;

/// Shows which cameras have panes.
pub(super) fn show_choice(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let model = cx.snapshot.model.clone();
    CollapsingHeader::new("camera panes").default_open(false).show_unindented(ui, |ui| {
        for camera in model.cameras() {
            let name = display_name(camera.name(), camera.index());
            let (panes, id) = (&mut cx.view.panes, camera.id());
            layout::labelled(ui, &name, LABEL_WIDTH, |ui| {
                for (kind, text) in
                    [(PaneKind::Colour, "colour"), (PaneKind::Depth, "depth"), (PaneKind::Segmentation, "segments")]
                {
                    let pane = Pane { camera: id, kind };
                    let mut on = panes.contains(&pane);
                    if ui.toggle_value(&mut on, text).changed() {
                        if on { panes.push(pane) } else { panes.retain(|other| *other != pane) }
                    }
                }
            });
        }
    });
}

/// Shows the open panes, at first from the upper right corner of the image downwards.
pub(super) fn show(context: &Context, cx: &mut PanelContext<'_>, right: f32) {
    let mut corner = context.content_rect().right_top() + egui::vec2(-right - layout::GAP, layout::GAP);
    let mut closed = Vec::new();
    for image in cx.panes {
        let camera = cx.snapshot.model.camera(image.pane.camera);
        let name = display_name(camera.name(), camera.index());
        let title = match image.pane.kind {
            PaneKind::Colour => name,
            kind => format!("{name}, {kind:?}"),
        };
        let mut open = true;
        let [width, height] = image.size;
        Window::new(title)
            .id(Id::unique(("pane", image.pane)))
            .default_pos(corner - egui::vec2(width + FRAME, 0.0))
            .open(&mut open)
            .fixed_size([width + FRAME, height])
            .collapsible(false)
            .show(context, |ui| ui.add(Image::new((image.texture.id(), egui::vec2(width, height)))));
        corner.y += height + 42.0;
        if !open {
            closed.push(image.pane);
        }
    }
    cx.view.panes.retain(|pane| !closed.contains(pane));
}
