//! From where it is seen, and with which effects.

use egui::{ComboBox, DragValue, RichText, Ui};

use super::{Request, Shown, layout, name_of, style, visual};
use crate::scene::{CameraView, RenderFlags};
use crate::viewer::input::Action;

/// Width of the names.
const NAMES: f32 = 64.0;

pub(super) fn show(ui: &mut Ui, shown: &mut Shown<'_>) {
    camera(ui, shown);
    layout::pairs(ui, RenderFlags::all().iter_names(), |ui, (name, flag)| {
        let mut on = shown.view.render.contains(flag);
        if ui.checkbox(&mut on, visual::sentence(name)).changed() {
            shown.view.render.set(flag, on);
        }
    });
    let mut vsync = shown.facts.vsync;
    if ui.checkbox(&mut vsync, "wait for the screen (vsync)").changed() {
        shown.requests.push(Request::Vsync(vsync));
    }
    ui.label(RichText::new(format!("drawn by {}", shown.facts.gpu)).small().color(style::FAINT));
}

fn camera(ui: &mut Ui, shown: &mut Shown<'_>) {
    let model = shown.snapshot.model.clone();
    let selected = shown.snapshot.selected.map(|selected| selected.body);
    let camera = &mut shown.view.camera;
    let text = match camera.view {
        CameraView::Free => "free".to_owned(),
        CameraView::User => "the program's".to_owned(),
        CameraView::Tracking(body) => format!("follows {}", name_of(model.body(body).name(), body.index())),
        CameraView::Fixed(fixed) => name_of(model.camera(fixed).name(), fixed.index()),
    };
    layout::named(ui, "camera", NAMES, |ui| {
        ComboBox::from_id_salt("camera").width(140.0).selected_text(text).show_ui(ui, |ui| {
            ui.selectable_value(&mut camera.view, CameraView::Free, "free");
            if let Some(body) = selected {
                let text = format!("follow {}", name_of(model.body(body).name(), body.index()));
                ui.selectable_value(&mut camera.view, CameraView::Tracking(body), text);
            }
            for fixed in model.cameras() {
                let text = name_of(fixed.name(), fixed.index());
                ui.selectable_value(&mut camera.view, CameraView::Fixed(fixed.id()), text);
            }
        });
    });
    ui.horizontal(|ui| {
        if ui.button("Align").on_hover_text("free, on the whole model").clicked() {
            shown.act(Action::Align);
        }
        if ui.button("Copy camera").on_hover_text("as a <camera> for the model's XML").clicked() {
            shown.act(Action::CopyCamera);
        }
    });
    let camera = &mut shown.view.camera;
    if matches!(camera.view, CameraView::Free | CameraView::Tracking(_)) {
        layout::named(ui, "from", NAMES, |ui| {
            ui.add(DragValue::new(&mut camera.azimuth).suffix("°").fixed_decimals(0));
            ui.add(DragValue::new(&mut camera.elevation).suffix("°").range(-90.0..=90.0).fixed_decimals(0));
            ui.add(DragValue::new(&mut camera.distance).suffix(" m").speed(0.01).range(0.001..=1e6).fixed_decimals(2));
        });
    }
}
