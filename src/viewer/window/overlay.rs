//! Layer of the panels: the egui context, its input, and the render pass that draws the panels over
//! the scene.

use std::borrow::Cow;
use std::sync::Arc;
use std::time::Duration;

use arboard::Clipboard;
use egui::epaint::{ClippedShape, MarginF32};
use egui::{
    ClippedPrimitive, Context, FallbackRequest, FontData, FontInsert, Order, Rect, SafeAreaInsets, Ui, ViewportId,
};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
use egui_winit::State;
use winit::event::WindowEvent;
use winit::keyboard::ModifiersState;
use winit::window::Window;

use super::canvas::begin_pass;
use super::pixel_rect::PixelRect;
use super::shape_changes::{changed_rects, clip, covered_pixels};
use crate::render::{self, FontFile, Gpu};
use crate::viewer::input::Modifiers;
use crate::viewer::panel::{Sections, apply_style, style_of};
use crate::viewer::remembered::Layout;

/// Result of a pass of the panels.
pub(super) struct PanelPass {
    /// The only input was motion of the pointer.
    pub only_motion: bool,
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
    /// Output of the last pass.
    shapes: Vec<ClippedShape>,
    scale: f32,
    /// Theme of the last pass.
    theme: egui::Theme,
    /// Rectangles that contain the changes of the output since the last call of
    /// [`Overlay::take_changes`], points.
    changes: Vec<Rect>,
    /// Parts of the window that were painted last, and their triangles.
    triangles: (Vec<PixelRect>, Vec<ClippedPrimitive>),
    /// Texture updates since the panels were last painted.
    textures: egui::TexturesDelta,
    pending: PendingPointerEvents,
    /// System clipboard, opened on first use. `None` if the system has none.
    clipboard: Option<Clipboard>,
}

impl Overlay {
    pub fn new(window: &Window, device: &wgpu::Device, format: wgpu::TextureFormat, layout: &Layout) -> Self {
        let context = Context::default();
        context.add_font_provider(Arc::new(font_for));
        apply_style(&context, layout.theme.unwrap_or_default(), layout.scale.unwrap_or(1.0));
        Sections::set(&context, layout.sections.clone());
        // egui measures the time between two passes. With a limit, a click during a slow frame
        // would be lost.
        context.options_mut(|options| options.input_options.max_click_duration = f64::INFINITY);
        let side = device.limits().max_texture_dimension_2d as usize;
        let scale = Some(window.scale_factor() as f32);
        let input = State::new(context.clone(), ViewportId::ROOT, window, scale, None, Some(side));
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let painter = Renderer::new(device, format, options);
        Self {
            theme: context.theme(),
            context,
            input,
            painter,
            shapes: Vec::new(),
            scale: 1.0,
            changes: Vec::new(),
            triangles: (Vec::new(), Vec::new()),
            textures: egui::TexturesDelta::default(),
            pending: PendingPointerEvents::None,
            clipboard: None,
        }
    }

    /// Returns the context of the panels.
    pub fn context(&self) -> &Context {
        &self.context
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

    /// Returns `true` if the pointer at a position, in pixels, belongs to the panels: a panel is at
    /// this position or holds the pointer. All panels are in layers above the background layer,
    /// which is empty.
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

    /// Returns the widget of the last pass at a position, in pixels, for example to determine if
    /// its highlight changes.
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

    /// Returns the theme, the scale and the sections of the panels.
    pub fn layout(&self) -> Layout {
        let (theme, scale) = style_of(&self.context);
        let sections = Sections::of(&self.context);
        Layout { theme: Some(theme), scale: Some(scale), sections, ..Layout::default() }
    }

    /// Returns the number of pixels per point.
    pub fn pixels_per_point(&self) -> f32 {
        self.context.pixels_per_point()
    }

    /// Returns the colour of the panels' background.
    pub fn background(&self) -> wgpu::Color {
        let [red, green, blue, _] = self.context.global_style().visuals.panel_fill.to_opaque().to_array();
        let [r, g, b] = [red, green, blue].map(|part| f64::from(part) / 255.0);
        wgpu::Color { r, g, b, a: 1.0 }
    }

    /// Returns the rectangles of the panels and widgets with these names, in pixels: their upper
    /// left and lower right corners.
    #[cfg(feature = "_test-hooks")]
    pub fn panel_rects(&self, names: &[&'static str]) -> Vec<(&'static str, [[f32; 2]; 2])> {
        let scale = self.context.pixels_per_point();
        let rect = |name: &&'static str| {
            let id = egui::Id::unique(*name);
            let is_visible =
                self.context.memory(|memory| memory.areas().is_visible(&egui::LayerId::new(Order::Middle, id)));
            let area = self.context.memory(|memory| memory.area_rect(id)).filter(|_| is_visible);
            let rect = area.or_else(|| self.context.read_response(id).map(|widget| widget.rect))?;
            Some((*name, [rect.min, rect.max].map(|corner| [corner.x * scale, corner.y * scale])))
        };
        names.iter().filter_map(rect).collect()
    }

    /// Returns `true` if the panels need a pass before the next event. A pass uses only the last
    /// position of the pointer and the last state of a button. With a press and a motion in one
    /// pass, a drag on a panel would be lost, and a drag from the scene to a slider would start on
    /// the slider. A pass also determines if a click has started to edit a text, which receives the
    /// next key.
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
            // Outside of text fields the viewer handles all keys: egui would move its focus with
            // Tab and press buttons with Space.
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

    /// Runs a pass of the panels. They leave a space of this height, points, at the bottom of the
    /// window for the timeline.
    pub fn run(&mut self, window: &Window, timeline: f32, panels: impl FnMut(&mut Ui)) -> PanelPass {
        // egui leaves the keyboard focus on a slider that was moved.
        if !self.is_editing() {
            self.stop_editing();
        }
        self.pending = PendingPointerEvents::None;
        let mut input = self.input.take_egui_input(window);
        input.safe_area_insets = Some(SafeAreaInsets(MarginF32 { bottom: timeline, ..MarginF32::ZERO }));
        let is_motion = |event: &egui::Event| matches!(event, egui::Event::PointerMoved(_));
        let only_motion = !input.events.is_empty() && input.events.iter().all(is_motion);
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
        let theme = std::mem::replace(&mut self.theme, self.context.theme());
        #[cfg(feature = "_test-hooks")]
        crate::viewer::test_hooks::set_texts(&output.shapes, scale);
        let changes = if (scale, self.theme) == (self.scale, theme) {
            changed_rects(&self.shapes, &output.shapes)
        } else {
            vec![Rect::EVERYTHING]
        };
        if !changes.is_empty() || !output.textures_delta.is_empty() {
            self.triangles.0.clear();
        }
        (self.shapes, self.scale) = (output.shapes, scale);
        self.changes.extend(changes);
        self.textures.append(output.textures_delta);
        PanelPass { only_motion, repaint_delay }
    }

    /// Returns `true` if the panels have changed since the last call of [`Overlay::take_changes`].
    pub fn has_changes(&self) -> bool {
        !self.changes.is_empty()
    }

    /// Returns for each of these areas of a window the smallest rectangle that contains the changes
    /// of the panels since the last call.
    pub fn take_changes<const N: usize>(&mut self, areas: [PixelRect; N], window: [u32; 2]) -> [PixelRect; N] {
        let changes: Vec<_> = self.changes.drain(..).map(|rect| covered_pixels(rect, self.scale, window)).collect();
        areas.map(|area| {
            let parts = changes.iter().map(|change| change.intersection(area));
            parts.fold(PixelRect::default(), PixelRect::union)
        })
    }

    /// Draws parts of the panels of the last pass over the scene. Returns commands that precede the
    /// encoder's.
    pub fn paint(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        parts: &[PixelRect],
    ) -> Vec<wgpu::CommandBuffer> {
        let (device, queue) = (gpu.device(), gpu.queue());
        for (id, deltas) in std::mem::take(&mut self.textures.set) {
            for delta in &deltas {
                self.painter.update_texture(device, queue, id, delta);
            }
        }
        // The parts are the same while only the scene changes.
        if self.triangles.0 != parts {
            let triangles = self.context.tessellate(clip(&self.shapes, parts, self.scale), self.scale);
            self.triangles = (parts.to_vec(), triangles);
        }
        let texture = target.texture();
        let screen =
            ScreenDescriptor { size_in_pixels: [texture.width(), texture.height()], pixels_per_point: self.scale };
        let triangles = &self.triangles.1;
        let commands = self.painter.update_buffers(device, queue, encoder, triangles, &screen);
        if !triangles.is_empty() {
            let pass = begin_pass(encoder, "panels", target);
            self.painter.render(&mut pass.forget_lifetime(), triangles, &screen);
        }
        for id in std::mem::take(&mut self.textures.free) {
            self.painter.free_texture(&id);
        }
        commands
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
        // A window can be closed between a pass and the next frame. epaint panics if texture
        // updates are dropped without this call.
        self.textures.clear();
    }
}

/// Returns a font with a character that egui's fonts lack.
fn font_for(request: &FallbackRequest<'_>) -> Option<FontInsert> {
    let FontFile { bytes, index, name } = request.cluster.chars().next().and_then(render::font_for)?;
    let data = match bytes {
        Cow::Borrowed(bytes) => FontData::from_static(bytes),
        Cow::Owned(bytes) => FontData::from_owned(bytes),
    };
    Some(FontInsert { name, data: FontData { index, ..data }, families: Vec::new() })
}

/// Returns the modifiers that are held.
pub(super) fn viewer_modifiers(state: ModifiersState) -> Modifiers {
    Modifiers::held(state.shift_key(), state.control_key(), state.alt_key(), state.super_key())
}
