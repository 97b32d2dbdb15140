//! The panels' layer: egui's context, what it hears of the window, and the pass that draws it over the picture.

use std::time::Duration;

use arboard::Clipboard;
use egui::{Context, Order, Ui, ViewportId};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
use egui_winit::State;
use winit::event::WindowEvent;
use winit::keyboard::ModifiersState;
use winit::window::Window;

use super::translate;
use crate::render::Gpu;
use crate::viewer::input::Modifiers;
use crate::viewer::panel::style;

/// What a pass of the panels gave: shapes to be drawn, and when it wants to be drawn again.
pub(super) struct Painted {
    triangles: Vec<egui::ClippedPrimitive>,
    pixels_per_point: f32,
    /// How long until the panels change by themselves; the longest there is if they do not.
    pub again: Duration,
}

/// Events of the pointer since the last pass.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Unseen {
    None,
    Moves,
    /// A button was pressed or released.
    Button,
}

pub(super) struct Overlay {
    context: Context,
    input: State,
    painter: Renderer,
    /// Changes of textures since the panels were painted last.
    textures: egui::TexturesDelta,
    unseen: Unseen,
    /// The system's clipboard, opened when it is first needed; none where there is none.
    clipboard: Option<Clipboard>,
}

impl Overlay {
    pub fn new(window: &Window, device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let context = Context::default();
        style::apply(&context);
        let side = device.limits().max_texture_dimension_2d as usize;
        let scale = Some(window.scale_factor() as f32);
        let input = State::new(context.clone(), ViewportId::ROOT, window, scale, None, Some(side));
        let painter = Self::painter(device, format);
        Self {
            context,
            input,
            painter,
            textures: egui::TexturesDelta::default(),
            unseen: Unseen::None,
            clipboard: None,
        }
    }

    fn painter(device: &wgpu::Device, format: wgpu::TextureFormat) -> Renderer {
        Renderer::new(device, format, RendererOptions { dithering: false, ..RendererOptions::default() })
    }

    /// Whether a text is being edited, so that keys are letters.
    pub fn is_editing(&self) -> bool {
        self.context.text_edit_focused()
    }

    /// Takes the keyboard from a text that is being edited.
    pub fn stop_editing(&self) {
        self.context.memory_mut(|memory| {
            if let Some(focused) = memory.focused() {
                memory.surrender_focus(focused);
            }
        });
    }

    /// Whether a place, in pixels, belongs to the panels: something of them is there, or one of them holds the pointer. They are
    /// all laid out above the background, where nothing of theirs is.
    pub fn is_over(&self, at: [f64; 2]) -> bool {
        let scale = self.context.pixels_per_point();
        let at = egui::pos2(at[0] as f32 / scale, at[1] as f32 / scale);
        let layer = self.context.layer_id_at(at);
        self.context.egui_is_using_pointer() || layer.is_some_and(|layer| layer.order != Order::Background)
    }

    /// Returns `true` if the panels need a pass before the next event. A pass knows only the last position of the pointer and the
    /// last state of a button: with a press and a motion in one pass, a drag on a panel would be lost, and a drag from the picture
    /// to a slider would begin on the slider. And only a pass shows whether a click has begun to edit a text, to
    /// which the next key belongs.
    pub fn needs_pass_before(&self, event: &WindowEvent) -> bool {
        match self.unseen {
            Unseen::None => false,
            Unseen::Moves => matches!(event, WindowEvent::MouseInput { .. }) && self.context.egui_is_using_pointer(),
            Unseen::Button => matches!(
                event,
                WindowEvent::MouseInput { .. }
                    | WindowEvent::CursorMoved { .. }
                    | WindowEvent::MouseWheel { .. }
                    | WindowEvent::KeyboardInput { .. }
            ),
        }
    }

    /// Hands an event to the panels.
    pub fn hear(&mut self, window: &Window, event: &WindowEvent, modifiers: ModifiersState) {
        match event {
            WindowEvent::MouseInput { .. } => self.unseen = Unseen::Button,
            WindowEvent::CursorMoved { .. } if self.unseen == Unseen::None => self.unseen = Unseen::Moves,
            _ => {}
        }
        if let WindowEvent::KeyboardInput { event: key, .. } = event {
            // Without a text to edit, keys are the viewer's: egui would move its focus with Tab, and press buttons with Space.
            if !self.is_editing() {
                return;
            }
            let paste = winit::keyboard::Key::Character("v".into());
            let command = translate::modifiers(modifiers) == Modifiers::COMMAND;
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

    /// Lays the panels out.
    pub fn run(&mut self, window: &Window, panels: impl FnMut(&mut Ui)) -> Painted {
        // A slider that was moved keeps the keyboard, though it is no text.
        if !self.is_editing() {
            self.stop_editing();
        }
        self.unseen = Unseen::None;
        let input = self.input.take_egui_input(window);
        let output = self.context.run_ui(input, panels);
        for command in &output.platform_output.commands {
            if let egui::OutputCommand::CopyText(text) = command {
                self.copy(text.clone());
            }
        }
        let again =
            output.viewport_output.get(&ViewportId::ROOT).map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        self.input.handle_platform_output(window, output.platform_output);
        let triangles = self.context.tessellate(output.shapes, output.pixels_per_point);
        self.textures.append(output.textures_delta);
        Painted { triangles, pixels_per_point: output.pixels_per_point, again }
    }

    /// Draws what a pass gave over what there is.
    pub fn paint(&mut self, gpu: &Gpu, to: &wgpu::TextureView, size: [u32; 2], painted: &Painted) {
        let (device, queue) = (gpu.device(), gpu.queue());
        for (id, deltas) in std::mem::take(&mut self.textures.set) {
            for delta in &deltas {
                self.painter.update_texture(device, queue, id, delta);
            }
        }
        let screen = ScreenDescriptor { size_in_pixels: size, pixels_per_point: painted.pixels_per_point };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("panels") });
        let mut commands = self.painter.update_buffers(device, queue, &mut encoder, &painted.triangles, &screen);
        {
            let mut pass = encoder
                .begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("panels"),
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view: to,
                        depth_slice: None,
                        resolve_target: None,
                        ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
                    })],
                    ..wgpu::RenderPassDescriptor::default()
                })
                .forget_lifetime();
            self.painter.render(&mut pass, &painted.triangles, &screen);
        }
        commands.push(encoder.finish());
        queue.submit(commands);
        for id in std::mem::take(&mut self.textures.free) {
            self.painter.free_texture(&id);
        }
    }

    /// Puts a text into the system's clipboard. Says whether there is one.
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
