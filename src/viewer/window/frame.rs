//! Frames of a session.

use std::time::{Duration, Instant};

use super::canvas::{Canvas, CanvasLayout};
use super::overlay::Overlay;
use super::pixel_rect::PixelRect;
use super::session::{PanelContent, Session};
use super::surface::{SurfaceFrame, WindowSurface};
use crate::render::{Gpu, RenderError};
use crate::viewer::link::{Event, Snapshot};
use crate::viewer::panel::{
    PanelContext, Panels, WindowStatus, has_place_for_sides, limited_scale, side_widths, timeline_height,
};
use crate::viewer::remembered::Layout;
#[cfg(feature = "_test-hooks")]
use crate::viewer::test_hooks;
use crate::viewer::view::View;

/// Delay before the next attempt to acquire a surface that is not ready.
const RETRY_DELAY: Duration = Duration::from_millis(30);
/// Minimum delay before a pass that the panels request. They request one after each pass with
/// input, even if nothing changes.
const MIN_REPAINT_DELAY: Duration = Duration::from_millis(50);
/// Minimum delay before a pass that the panels request after motion of the pointer, which needs no
/// second pass.
const MIN_MOTION_DELAY: Duration = Duration::from_millis(200);
/// Delay before the next frame after an error.
const RECOVERY_DELAY: Duration = Duration::from_secs(1);

/// Minimum time between passes of the panels while the simulation runs or the camera moves. Numbers
/// that change faster cannot be read.
const PANEL_SPACING: Duration = Duration::from_millis(100);

impl Session {
    /// Draws a frame if the window is visible.
    pub(super) fn draw(&mut self) -> Result<(), RenderError> {
        self.scheduler.frame_started(Instant::now());
        self.frame_start = Some(self.now());
        // Updates from here on wake the window again.
        self.waker.acknowledge();
        self.handle_physics_events()?;
        if self.closed {
            return Ok(());
        }
        #[cfg(feature = "_test-hooks")]
        {
            test_hooks::wait_while_held();
            test_hooks::panic_if_requested(&self.options.title);
            if test_hooks::take_surface_loss() {
                self.surface.recreate()?;
            }
            if test_hooks::take_repaint() {
                self.canvas.clear();
            }
        }
        let acquired = self.surface.acquire()?;
        self.hidden = matches!(acquired, SurfaceFrame::Hidden);
        let texture = match acquired {
            SurfaceFrame::Ready(texture) => texture,
            SurfaceFrame::Hidden => {
                // A recording continues while the window is hidden.
                return self.render(None);
            }
            SurfaceFrame::NotReady => {
                self.scheduler.request_after(Instant::now(), RETRY_DELAY);
                return Ok(());
            }
        };
        self.render(Some(&texture))?;
        self.surface.present(texture);
        self.scheduler.frame_finished(Instant::now());
        Ok(())
    }

    /// Runs a pass of the panels if one is due, and requests a frame if the window does not show
    /// the panels of the last pass, whatever has caused that pass.
    pub(super) fn schedule(&mut self, now: Instant) {
        if self.scheduler.pass_due().is_some_and(|due| due <= now) {
            self.run_panels();
        }
        // A hidden window is drawn when it appears, and a frame that failed has requested the next
        // attempt.
        if self.overlay.has_changes() && !self.hidden && self.scheduler.due().is_none() {
            self.scheduler.request(now);
        }
    }

    fn handle_physics_events(&mut self) -> Result<(), RenderError> {
        for event in self.link.take_events() {
            self.panels_stale = true;
            if let Some(view) = &mut self.view {
                view.handle_event(&event);
            }
            match event {
                Event::Copied(text) => {
                    if self.overlay.copy(text) {
                        self.panels.notice("copied to the clipboard".to_owned());
                    } else {
                        self.panels.warn("the system has no clipboard".to_owned());
                    }
                }
                Event::Notice(text) => self.panels.notice(text),
                Event::Asset(asset) => {
                    if let Some(snapshot) = self.link.current() {
                        self.renderer.update(snapshot, asset)?;
                    }
                }
                Event::LookAt(_) | Event::Track(_) | Event::View(_) => {}
            }
        }
        self.update_model();
        self.load_changes();
        self.finish_loading();
        if self.link.is_closing() {
            self.close();
        }
        Ok(())
    }

    /// Takes the newest snapshot, and resets the view and the panels if its model was replaced.
    pub(super) fn update_model(&mut self) {
        let had_instruments = self.link.current().is_some_and(Snapshot::has_instruments);
        let previous = self.link.current().map(|snapshot| snapshot.model.clone());
        let Some((snapshot, _)) = self.link.latest() else { return };
        self.panels_stale |= snapshot.has_instruments() != had_instruments;
        let view = self.view.get_or_insert_with(|| {
            let scale = self.window.scale_factor() * limited_scale(self.layout.scale.unwrap_or(1.0));
            let width = f64::from(self.window.inner_size().width) / scale;
            let closed = self.layout.open[..2].iter().filter(|open| **open == Some(false)).count();
            let panels = self.options.panels.unwrap_or(true) && has_place_for_sides(width as f32, 2 - closed);
            let mut view = View { left_panel: panels, right_panel: panels, ..View::new(&snapshot.model) };
            self.layout.apply(&mut view);
            let size = self.options.size;
            self.start = Some(Layout { size, ..self.overlay.layout().with_view(&view) });
            view
        });
        if snapshot.generation != self.generation {
            self.generation = snapshot.generation;
            view.camera = snapshot.camera;
            if let Some(previous) = previous {
                view.adopt_panes(&previous, &snapshot.model);
            }
            self.panels.reset_model();
            self.panels_stale = true;
        }
    }

    /// Renders the newest snapshot and the panels.
    fn render(&mut self, texture: Option<&wgpu::SurfaceTexture>) -> Result<(), RenderError> {
        let gpu = self.surface.gpu().clone();
        // Another snapshot may have arrived since `handle_physics_events`. Its instruments
        // determine the area of the image.
        self.update_model();
        let area = self.picture_area();
        self.mouse.set_area(area.origin.map(f64::from), area.size.map(f64::from));
        let (Some(snapshot), Some(view)) = (self.link.current_mut(), &mut self.view) else {
            if let Some(texture) = texture {
                self.overlay.run(&self.window, 0.0, Panels::show_waiting);
                self.repaint(&texture.texture, PixelRect::default(), false)?;
            }
            return Ok(());
        };
        view.update_snapshot(snapshot)?;
        self.renderer.set_font_scale(self.overlay.pixels_per_point().into());

        self.panels.record(snapshot);
        let report = self.output.save_frame(&mut self.renderer, &gpu, snapshot, area.size);
        self.panels_stale |= report.notice.is_some() || report.problem.is_some();
        report.notice.into_iter().for_each(|notice| self.panels.notice(notice));
        report.problem.into_iter().for_each(|problem| self.panels.warn(problem));
        let Some(texture) = texture else { return Ok(()) };
        let scene_changed = self.renderer.draw(&gpu, snapshot, &view.camera, self.surface.format(), area.size)?;
        self.update_panels();
        self.repaint(&texture.texture, area, scene_changed)?;
        #[cfg(feature = "_test-hooks")]
        if let (Some(snapshot), Some(view)) = (self.link.current(), &self.view) {
            test_hooks::record(test_hooks::Frame {
                snapshot,
                view,
                status: &self.status(&gpu),
                queued: self.link.queued(),
                full_screen: self.window.fullscreen().is_some(),
                editing: self.overlay.is_editing(),
                messages: self.panels.messages(),
                picture: [area.origin, area.size],
                panel_rects: self.overlay.panel_rects(&["left", "right", "info", "timeline", "track"]),
            });
        }
        Ok(())
    }

    /// Repaints the parts of the canvas that have changed since the last frame, and copies the
    /// canvas to the window.
    fn repaint(
        &mut self,
        window: &wgpu::Texture,
        scene_area: PixelRect,
        scene_changed: bool,
    ) -> Result<(), RenderError> {
        let gpu = self.surface.gpu().clone();
        let size = [window.width(), window.height()];
        let layout = CanvasLayout { size, scene: scene_area, background: self.overlay.background() };
        let areas = layout.areas();
        let mut parts = self.overlay.take_changes(areas, size);
        if self.canvas.prepare(&gpu, layout)? {
            parts = areas;
        } else if scene_changed {
            parts[1] = areas[1];
        }
        let parts: Vec<PixelRect> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        #[cfg(feature = "_test-hooks")]
        test_hooks::count_repainted(parts.iter().map(|part| part.pixels()).sum());
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        let mut commands = Vec::new();
        if let Some(view) = self.canvas.view()
            && !parts.is_empty()
        {
            self.canvas.draw_background(&mut encoder, &parts, self.renderer.image());
            commands = self.overlay.paint(&gpu, &mut encoder, view, &parts);
        }
        self.canvas.copy_to(&gpu, &mut encoder, window);
        commands.push(encoder.finish());
        gpu.queue().submit(commands);
        Ok(())
    }

    /// Runs a pass of the panels if it is needed now. A pass for a new snapshot or another camera
    /// may follow later, at a limited rate.
    fn update_panels(&mut self) {
        let (Some(snapshot), Some(view), now) = (self.link.current(), &self.view, Instant::now()) else { return };
        let shows_all = self.shown.as_ref().is_some_and(|shown| shown.shows(snapshot, view));
        if self.panels_stale || !shows_all && self.scheduler.since_pass(now) >= PANEL_SPACING {
            self.run_panels();
        } else if !shows_all {
            self.scheduler.request_pass_spaced(now, PANEL_SPACING);
        }
    }

    /// Runs a pass of the panels for the events so far, and performs the resulting actions.
    pub(super) fn run_panels(&mut self) {
        let gpu = self.surface.gpu().clone();
        let now = Instant::now();
        self.scheduler.pass_started(now);
        #[cfg(feature = "_test-hooks")]
        test_hooks::count_pass();
        self.panels_stale = false;
        let (status, timeline) = (self.status(&gpu), self.timeline_height());
        if let (Some(snapshot), Some(view)) = (self.link.current_mut(), &self.view)
            && let Err(error) = self.panes.update(&gpu, self.overlay.context(), snapshot, &view.panes)
        {
            log::warn!("a camera pane could not be drawn: {error}");
        }
        let (Some(snapshot), Some(view)) = (self.link.current(), &mut self.view) else { return };
        let mut actions = Vec::new();
        let before = view.clone();
        self.shown = Some(PanelContent { snapshot: (snapshot.generation, snapshot.number), view: before.clone() });
        let pass = self.overlay.run(&self.window, timeline, |ui| {
            actions.clear();
            #[cfg(feature = "_test-hooks")]
            test_hooks::clear_widgets();
            let mut cx = PanelContext {
                snapshot,
                view,
                predicted: &self.predicted,
                status: &status,
                panes: self.panes.images(),
                released_keys: &self.options.released_keys,
                actions: &mut actions,
            };
            self.panels.show(ui, &mut cx);
        });
        self.link.set_view(&view.scene_view());
        // The frame of an action shows its effect.
        if !actions.is_empty() || *view != before {
            self.panels_stale = true;
            self.scheduler.request(now);
        }
        let min_delay = if pass.only_motion { MIN_MOTION_DELAY } else { MIN_REPAINT_DELAY };
        self.scheduler.request_pass_after(now, pass.repaint_delay.max(min_delay));
        for action in actions {
            self.act(&action);
        }
    }

    /// Returns the height of the timeline, points.
    fn timeline_height(&self) -> f32 {
        let height = self.surface.size()[1] as f32 / self.overlay.pixels_per_point();
        let (Some(view), Some(snapshot)) = (&self.view, self.link.current()) else { return 0.0 };
        timeline_height(view, snapshot, height)
    }

    /// Returns the area of the window between the side panels and above the timeline.
    pub(super) fn picture_area(&self) -> PixelRect {
        let [width, height] = self.surface.size();
        let scale = self.overlay.pixels_per_point();
        let has_instruments = self.link.current().is_some_and(Snapshot::has_instruments);
        let sides =
            self.view.as_ref().map_or([0.0; 2], |view| side_widths(view, has_instruments, width as f32 / scale));
        let [left, right] = sides.map(|points| (points * scale).round() as u32);
        // The area is inside the window, even if the window is narrower than its panels.
        let left = left.min(width.saturating_sub(1));
        let timeline = (self.timeline_height() * scale).round() as u32;
        let size = [width.saturating_sub(left + right).max(1), height.saturating_sub(timeline).max(1)];
        PixelRect { origin: [left, 0], size }
    }

    fn status<'a>(&self, gpu: &'a Gpu) -> WindowStatus<'a> {
        WindowStatus {
            size: self.surface.size(),
            rate: self.scheduler.rate(Instant::now()),
            recording: self.output.frames(),
            loading: self.loader.as_ref().map(|loader| loader.path().display().to_string()),
            vsync: self.surface.has_vsync(),
            gpu: gpu.name(),
        }
    }

    /// Recovers from a frame that could not be drawn. Recreates the GPU resources if they were
    /// lost, and shows the problem.
    pub(super) fn recover(&mut self, problem: &RenderError) {
        log::warn!("a frame could not be drawn: {problem}");
        self.renderer.drop_renderer();
        self.panes.drop_renderer();
        self.canvas.clear();
        if matches!(problem, RenderError::Lost { .. }) {
            let surface = WindowSurface::new(self.window.clone(), self.surface.has_vsync());
            match surface.and_then(|surface| Ok((Canvas::new(surface.gpu(), surface.format())?, surface))) {
                Ok((canvas, surface)) => {
                    let layout = self.overlay.layout();
                    self.overlay = Overlay::new(&self.window, surface.gpu().device(), surface.format(), &layout);
                    (self.canvas, self.surface) = (canvas, surface);
                }
                Err(error) => {
                    log::error!("{error}");
                    self.close();
                    return;
                }
            }
        }
        self.panels.warn(problem.to_string());
        self.panels_stale = true;
        // The delay limits the load of a permanent error.
        self.scheduler.request_after(Instant::now(), RECOVERY_DELAY);
    }
}
