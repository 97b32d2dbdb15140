//! Panels of the visualisation: labels, frames, parts of the scene, groups, effects and camera.

use egui::{ComboBox, DragValue, RichText, Ui};

use super::{PanelContext, display_name, layout, panes};
use crate::enums::GeomType;
use crate::model::Model;
use crate::scene::{Camera, CameraView, FrameMode, LabelMode, RenderFlags, SceneOptions, VisualFlags};
use crate::viewer::input::{Action, BINDINGS, ViewAction, WindowAction};
use crate::viewer::link::EndpointRequest;
use crate::viewer::view::View;

/// Width of the labels, points.
const LABEL_WIDTH: f32 = 64.0;

pub(super) fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let options = &mut cx.view.options;
    layout::labelled(ui, "label", LABEL_WIDTH, |ui| {
        choice(ui, "label", &mut options.label, (0..).map_while(LabelMode::from_raw));
    });
    layout::labelled(ui, "frame", LABEL_WIDTH, |ui| {
        choice(ui, "frame", &mut options.frame, (0..).map_while(FrameMode::from_raw));
    });
    let flags = BINDINGS.iter().filter_map(|binding| match binding.action {
        Action::View(ViewAction::Visual(flag)) => Some((flag, binding)),
        _ => None,
    });
    layout::two_columns(ui, flags, |ui, (flag, binding)| {
        let mut on = options.flags.contains(flag);
        let text = words(&flag.iter_names().map(|(name, _)| name).collect::<String>());
        if layout::checkbox(ui, &mut on, &text).on_hover_text(format!("{} ({})", binding.help, binding.key)).changed() {
            options.flags.set(flag, on);
        }
    });
    if cfg!(engine_since = "3.0.0") {
        show_newer(ui, &mut cx.view.options, &cx.snapshot.model);
    }
}

/// Flags without a key, which engines from 3.0 have, with their names and their effects.
const NEWER: [(VisualFlags, &str, &str); 8] = [
    (VisualFlags::FLEXVERT, "flex vertices", "Vertices of flexes"),
    (VisualFlags::FLEXEDGE, "flex edges", "Edges of flexes"),
    (VisualFlags::FLEXFACE, "flex faces", "Faces of flexes, without the smooth surface"),
    (VisualFlags::FLEXSKIN, "flex skin", "Smooth surfaces of flexes, instead of their other parts"),
    (VisualFlags::ISLAND, "islands", "Colours of the constraint islands"),
    (VisualFlags::BODYBVH, "body BVH", "Bounding volumes of bodies"),
    (VisualFlags::MESHBVH, "mesh BVH", "Bounding volumes of meshes"),
    (VisualFlags::SDFITER, "SDF iterations", "Iterations of the collision of signed distance fields"),
];

/// Shows the flags without a key that have an effect on a model, and the layers that they show.
fn show_newer(ui: &mut Ui, options: &mut SceneOptions, model: &Model) {
    let flexes = VisualFlags::FLEXVERT | VisualFlags::FLEXEDGE | VisualFlags::FLEXFACE | VisualFlags::FLEXSKIN;
    let has_effect = |flag: VisualFlags| match flag {
        VisualFlags::MESHBVH => model.nmesh() > 0,
        VisualFlags::SDFITER => model.geoms().any(|geom| geom.geom_type() == GeomType::Sdf),
        _ => !flexes.contains(flag) || model.nflex() > 0,
    };
    let flags = NEWER.iter().filter(|(flag, ..)| has_effect(*flag));
    layout::two_columns(ui, flags, |ui, &(flag, name, help)| {
        let mut on = options.flags.contains(flag);
        if ui.checkbox(&mut on, name).on_hover_text(help).changed() {
            options.flags.set(flag, on);
        }
    });
    if options.flags.contains(VisualFlags::FLEXFACE) && model.nflex() > 0 {
        layout::labelled(ui, "flex layer", LABEL_WIDTH, |ui| {
            ui.add(DragValue::new(&mut options.flex_layer).speed(0.05))
        });
    }
    if options.flags.intersects(VisualFlags::BODYBVH | VisualFlags::MESHBVH) {
        layout::labelled(ui, "BVH depth", LABEL_WIDTH, |ui| ui.add(DragValue::new(&mut options.bvh_depth).speed(0.05)));
    }
}

/// Shows a combo box with the names of values.
pub(super) fn choice<T: Copy + PartialEq + std::fmt::Debug>(
    ui: &mut Ui,
    id: &str,
    value: &mut T,
    values: impl IntoIterator<Item = T>,
) -> bool {
    let before = *value;
    ComboBox::from_id_salt(id).width(140.0).selected_text(format!("{value:?}")).show_ui(ui, |ui| {
        for item in values {
            ui.selectable_value(value, item, format!("{item:?}"));
        }
    });
    *value != before
}

/// Converts the engine's name of a flag to words.
pub(super) fn words(name: &str) -> String {
    let known = [
        ("CONVEXHULL", "convex hull"),
        ("RANGEFINDER", "rangefinder"),
        ("SCLINERTIA", "scaled inertia"),
        ("PERTFORCE", "perturb force"),
        ("PERTOBJ", "perturb object"),
        ("CONTACTPOINT", "contact point"),
        ("CONTACTFORCE", "contact force"),
        ("CONTACTSPLIT", "contact split"),
        ("AUTOCONNECT", "auto connect"),
        ("COM", "centre of mass"),
        ("SELECT", "select point"),
        ("STATIC", "static body"),
        ("IDCOLOR", "id colour"),
    ];
    known
        .iter()
        .find(|(spelling, _)| *spelling == name)
        .map_or_else(|| name.to_lowercase().replace('_', " "), |(_, words)| (*words).to_owned())
}

/// Width of the labels, points.
const GROUP_LABEL_WIDTH: f32 = 72.0;

pub(super) fn show_groups(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let options = &mut cx.view.options;
    for (name, groups) in [
        ("geoms", &mut options.geomgroup),
        ("sites", &mut options.sitegroup),
        ("joints", &mut options.jointgroup),
        ("tendons", &mut options.tendongroup),
        ("actuators", &mut options.actuatorgroup),
        ("skins", &mut options.skingroup),
        ("flexes", &mut options.flexgroup),
    ] {
        layout::labelled(ui, name, GROUP_LABEL_WIDTH, |ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            for (number, on) in groups.iter_mut().enumerate() {
                ui.toggle_value(on, number.to_string());
            }
        });
    }
}

pub(super) fn show_rendering(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    camera(ui, cx);
    if cx.snapshot.model.ncam() > 0 {
        panes::show_choice(ui, cx);
    }
    layout::two_columns(ui, RenderFlags::all().iter_names(), |ui, (name, flag)| {
        let mut on = cx.view.render.contains(flag);
        if layout::checkbox(ui, &mut on, &words(name)).changed() {
            cx.view.render.set(flag, on);
        }
    });
    let mut vsync = cx.status.vsync;
    if ui.checkbox(&mut vsync, "vertical synchronisation").changed() {
        cx.actions.push(Action::Window(WindowAction::SetVsync(vsync)));
    }
    ui.label(RichText::new(format!("GPU: {}", cx.status.gpu)).small().weak());
}

/// Returns the name of a camera for the user.
pub(super) fn camera_name(camera: &Camera, model: &Model) -> String {
    match camera.view {
        CameraView::Free => "free".to_owned(),
        CameraView::User => "set by the program".to_owned(),
        CameraView::Tracking(body) if body.lineage() == model.lineage() => {
            format!("tracking {}", display_name(model.body(body).name(), body.index()))
        }
        CameraView::Fixed(fixed) if fixed.lineage() == model.lineage() => {
            display_name(model.camera(fixed).name(), fixed.index())
        }
        // Of a model that was replaced.
        CameraView::Tracking(_) | CameraView::Fixed(_) => String::new(),
    }
}

fn camera(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let model = cx.snapshot.model.clone();
    let selected = cx.snapshot.selected.map(|selected| selected.body);
    let text = camera_name(&cx.view.camera, &model);
    let camera = &mut cx.view.camera;
    layout::labelled(ui, "camera", LABEL_WIDTH, |ui| {
        ComboBox::from_id_salt("camera").width(140.0).selected_text(text).show_ui(ui, |ui| {
            ui.selectable_value(&mut camera.view, CameraView::Free, "free");
            if let Some(body) = selected {
                let text = format!("track {}", display_name(model.body(body).name(), body.index()));
                ui.selectable_value(&mut camera.view, CameraView::Tracking(body), text);
            }
            for fixed in model.cameras() {
                let text = display_name(fixed.name(), fixed.index());
                ui.selectable_value(&mut camera.view, CameraView::Fixed(fixed.id()), text);
            }
        });
    });
    ui.horizontal(|ui| {
        if ui.button("Align").on_hover_text("free camera on the whole model").clicked() {
            cx.actions.push(Action::View(ViewAction::Align));
        }
        if ui.button("Copy camera").on_hover_text("as a <camera> for the model's XML").clicked() {
            cx.send(EndpointRequest::CopyCamera);
        }
    });
    let View { camera, orthographic, .. } = &mut *cx.view;
    if matches!(camera.view, CameraView::Free | CameraView::Tracking(_)) {
        if cfg!(engine_since = "3.2.0") {
            ui.checkbox(orthographic, "orthographic").on_hover_text("without perspective");
        }
        layout::labelled(ui, "from", LABEL_WIDTH, |ui| {
            ui.add(DragValue::new(&mut camera.azimuth).suffix("°").fixed_decimals(0));
            ui.add(DragValue::new(&mut camera.elevation).suffix("°").range(-90.0..=90.0).fixed_decimals(0));
            ui.add(DragValue::new(&mut camera.distance).suffix(" m").speed(0.01).range(0.001..=1e6).fixed_decimals(2));
        });
    }
}
