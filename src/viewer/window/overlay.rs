//! Layer of the panels: the egui context, its input, and the render pass that draws the panels over the scene.

use std::time::Duration;

use arboard::Clipboard;
use egui::epaint::ClippedShape;
use egui::{ClippedPrimitive, Context, Order, Ui, ViewportId};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
use egui_winit::State;
use winit::event::WindowEvent;
use winit::keyboard::ModifiersState;
use winit::window::Window;

use super::input::modifiers as viewer_modifiers;
use crate::render::Gpu;
use crate::viewer::input::Modifiers;
use crate::viewer::panel::apply_style;

/// Result of a pass of the panels.
pub(super) struct PanelPass {
    /// The panels differ from those of the previous pass.
    pub has_changed: bool,
    /// Time until the panels may change by themselves; [`Duration::MAX`] if they do not.
    pub repaint_delay: Duration,
}

/// Pointer events since the last pass.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PendingPointerEvents {
    None,
    /// Motions only.
    Motion,
    /// The press or the release of a button.
    Button,
}

/// Layer of the panels.
pub(super) struct Overlay {
    context: Context,
    input: State,
    painter: Renderer,
    /// Output of the last pass, and its triangles.
    shapes: Vec<ClippedShape>,
    triangles: Vec<ClippedPrimitive>,
    scale: f32,
    /// Texture updates since the panels were last painted.
    textures: egui::TexturesDelta,
    pending: PendingPointerEvents,
    /// System clipboard, opened on first use. `None` if the system has none.
    clipboard: Option<Clipboard>,
}

impl Overlay {
    pub fn new(window: &Window, device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let context = Context::default();
        apply_style(&context);
        let side = device.limits().max_texture_dimension_2d as usize;
        let scale = Some(window.scale_factor() as f32);
        let input = State::new(context.clone(), ViewportId::ROOT, window, scale, None, Some(side));
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let painter = Renderer::new(device, format, options);
        Self {
            context,
            input,
            painter,
            shapes: Vec::new(),
            triangles: Vec::new(),
            scale: 1.0,
            textures: egui::TexturesDelta::default(),
            pending: PendingPointerEvents::None,
            clipboard: None,
        }
    }

    /// Returns `true` while the user edits a text, so that keys are text input.
    pub fn is_editing(&self) -> bool {
        self.context.text_edit_focused()
    }

    /// Removes the keyboard focus from the panels.
    pub fn stop_editing(&self) {
        self.context.memory_mut(|memory| {
            if let Some(focused) = memory.focused() {
                memory.surrender_focus(focused);
            }
        });
    }

    /// Returns `true` if the pointer at a position, in pixels, belongs to the panels: a panel is at this position or holds the pointer.
    /// All panels are in layers above the background layer, which is empty.
    pub fn is_over(&self, position: [f64; 2]) -> bool {
        let scale = self.context.pixels_per_point();
        let position = egui::pos2(position[0] as f32 / scale, position[1] as f32 / scale);
        let layer = self.context.layer_id_at(position);
        self.context.egui_is_using_pointer() || layer.is_some_and(|layer| layer.order != Order::Background)
    }

    /// Returns `true` while the pointer drags a widget.
    pub fn is_dragging(&self) -> bool {
        self.context.egui_is_using_pointer()
    }

    /// Returns the widget of the last pass at a position, in pixels, for example to determine if its highlight changes.
    pub fn widget_at(&self, position: [f64; 2]) -> Option<egui::Id> {
        let scale = self.context.pixels_per_point();
        let position = egui::pos2(position[0] as f32 / scale, position[1] as f32 / scale);
        let layer = self.context.layer_id_at(position).filter(|layer| layer.order != Order::Background)?;
        // The widgets are in painting order. `prev_pass` contains the last complete pass.
        self.context.viewport(|viewport| {
            let widgets = viewport.prev_pass.widgets.get_layer(layer);
            widgets.filter(|widget| widget.interact_rect.contains(position)).last().map(|widget| widget.id)
        })
    }

    /// Returns the number of pixels per point.
    pub fn pixels_per_point(&self) -> f32 {
        self.context.pixels_per_point()
    }

    /// Returns the rectangles of the panels with these names, from the upper left to the lower right corner, in pixels.
    #[cfg(feature = "test-hooks")]
    pub fn panel_rects(&self, names: &[&'static str]) -> Vec<(&'static str, [[f32; 2]; 2])> {
        let scale = self.context.pixels_per_point();
        let rect = |name: &&'static str| {
            let id = egui::Id::unique(*name);
            let is_visible =
                self.context.memory(|memory| memory.areas().is_visible(&egui::LayerId::new(Order::Middle, id)));
            let rect = self.context.memory(|memory| memory.area_rect(id)).filter(|_| is_visible)?;
            Some((*name, [rect.min, rect.max].map(|corner| [corner.x * scale, corner.y * scale])))
        };
        names.iter().filter_map(rect).collect()
    }

    /// Returns `true` if the panels need a pass before the next event. A pass uses only the last position of the pointer and the last
    /// state of a button. With a press and a motion in one pass, a drag on a panel would be lost, and a drag from the scene to a
    /// slider would start on the slider. A pass also determines if a click has started to edit a text, which receives the next key.
    pub fn needs_pass_before(&self, event: &WindowEvent) -> bool {
        match self.pending {
            PendingPointerEvents::None => false,
            PendingPointerEvents::Motion => {
                matches!(event, WindowEvent::MouseInput { .. }) && self.context.egui_is_using_pointer()
            }
            PendingPointerEvents::Button => matches!(
                event,
                WindowEvent::MouseInput { .. }
                    | WindowEvent::CursorMoved { .. }
                    | WindowEvent::MouseWheel { .. }
                    | WindowEvent::KeyboardInput { .. }
            ),
        }
    }

    /// Passes an event to the panels.
    pub fn handle_event(&mut self, window: &Window, event: &WindowEvent, modifiers: ModifiersState) {
        match event {
            WindowEvent::MouseInput { .. } => self.pending = PendingPointerEvents::Button,
            WindowEvent::CursorMoved { .. } if self.pending == PendingPointerEvents::None => {
                self.pending = PendingPointerEvents::Motion;
            }
            _ => {}
        }
        if let WindowEvent::KeyboardInput { event: key, .. } = event {
            // Outside of text fields the viewer handles all keys: egui would move its focus with Tab and press buttons with Space.
            if !self.is_editing() {
                return;
            }
            let paste = winit::keyboard::Key::Character("v".into());
            let command = viewer_modifiers(modifiers) == Modifiers::COMMAND;
            if key.state.is_pressed()
                && command
                && key.logical_key == paste
                && let Some(text) = self.clipboard().and_then(|clipboard| clipboard.get_text().ok())
            {
                self.input.set_clipboard_text(text);
            }
        }
        let _ = self.input.on_window_event(window, event);
    }

    /// Runs a pass of the panels. The triangles are computed only if the panels have changed.
    pub fn run(&mut self, window: &Window, panels: impl FnMut(&mut Ui)) -> PanelPass {
        // egui leaves the keyboard focus on a slider that was moved.
        if !self.is_editing() {
            self.stop_editing();
        }
        self.pending = PendingPointerEvents::None;
        let input = self.input.take_egui_input(window);
        let output = self.context.run_ui(input, panels);
        for command in &output.platform_output.commands {
            if let egui::OutputCommand::CopyText(text) = command {
                self.copy(text.clone());
            }
        }
        let repaint_delay =
            output.viewport_output.get(&ViewportId::ROOT).map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        self.input.handle_platform_output(window, output.platform_output);
        let scale = output.pixels_per_point;
        let has_changed = output.shapes != self.shapes || scale != self.scale || !output.textures_delta.is_empty();
        if has_changed {
            self.triangles = self.context.tessellate(output.shapes.clone(), scale);
            (self.shapes, self.scale) = (output.shapes, scale);
        }
        self.textures.append(output.textures_delta);
        PanelPass { has_changed, repaint_delay }
    }

    /// Draws the panels of the last pass over the scene.
    pub fn paint(&mut self, gpu: &Gpu, target: &wgpu::TextureView, size: [u32; 2]) {
        let (device, queue) = (gpu.device(), gpu.queue());
        for (id, deltas) in std::mem::take(&mut self.textures.set) {
            for delta in &deltas {
                self.painter.update_texture(device, queue, id, delta);
            }
        }
        let screen = ScreenDescriptor { size_in_pixels: size, pixels_per_point: self.scale };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("panels") });
        let mut commands = self.painter.update_buffers(device, queue, &mut encoder, &self.triangles, &screen);
        {
            let mut pass = encoder
                .begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("panels"),
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view: target,
                        depth_slice: None,
                        resolve_target: None,
                        ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
                    })],
                    ..wgpu::RenderPassDescriptor::default()
                })
                .forget_lifetime();
            self.painter.render(&mut pass, &self.triangles, &screen);
        }
        commands.push(encoder.finish());
        queue.submit(commands);
        for id in std::mem::take(&mut self.textures.free) {
            self.painter.free_texture(&id);
        }
    }

    /// Copies a text to the system clipboard. Returns `false` if there is none.
    pub fn copy(&mut self, text: String) -> bool {
        self.clipboard().is_some_and(|clipboard| clipboard.set_text(text).is_ok())
    }

    fn clipboard(&mut self) -> Option<&mut Clipboard> {
        if self.clipboard.is_none() {
            self.clipboard = Clipboard::new().inspect_err(|error| log::warn!("no clipboard: {error}")).ok();
        }
        self.clipboard.as_mut()
    }
}

impl Drop for Overlay {
    fn drop(&mut self) {
        // A window can be closed between a pass and the next frame. epaint panics if texture updates are dropped without this call.
        self.textures.clear();
    }
}
