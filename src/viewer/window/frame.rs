//! Frames of a session.

use std::time::{Duration, Instant};

use super::overlay::Overlay;
use super::scene_image::{self, PictureArea};
use super::session::Session;
use super::surface::{SurfaceFrame, WindowSurface};
use crate::render::{Gpu, RenderError};
use crate::viewer::link::{Event, Snapshot};
use crate::viewer::panel::{PanelContext, Panels, WindowStatus, side_widths};
#[cfg(feature = "test-hooks")]
use crate::viewer::test_hooks;
use crate::viewer::view::View;

/// Delay before the next attempt to acquire a surface that is not ready.
const RETRY_DELAY: Duration = Duration::from_millis(30);
/// Minimum delay before a pass that the panels request. They request one after each pass with input, even if nothing changes.
const MIN_REPAINT_DELAY: Duration = Duration::from_millis(50);
/// Delay before the next frame after an error.
const RECOVERY_DELAY: Duration = Duration::from_secs(1);

/// Minimum time between passes of the panels while the simulation runs or the camera moves. Numbers that change faster cannot be read.
const PANEL_SPACING: Duration = Duration::from_millis(100);

/// Values that the panels show, except the window's.
pub(super) struct PanelContent {
    /// Generation and number of the snapshot.
    snapshot: (u64, u64),
    view: View,
}

impl PanelContent {
    fn shows(&self, snapshot: &Snapshot, view: &View) -> bool {
        self.snapshot == (snapshot.generation, snapshot.number) && self.view == *view
    }
}

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
        #[cfg(feature = "test-hooks")]
        {
            test_hooks::wait_while_held();
            if test_hooks::take_surface_loss() {
                self.surface.recreate()?;
            }
        }
        let texture = match self.surface.acquire()? {
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

    /// Runs a pass of the panels if one is due, and requests a frame if the panels have changed.
    pub(super) fn run_due_pass(&mut self, now: Instant) {
        if self.scheduler.pass_due().is_some_and(|due| due <= now) && self.run_panels() {
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
        self.finish_loading();
        if self.link.is_closing() {
            self.close();
        }
        Ok(())
    }

    /// Takes the newest snapshot, and resets the view and the panels if its model was replaced.
    pub(super) fn update_model(&mut self) {
        let Some((snapshot, _)) = self.link.latest() else { return };
        let view = self.view.get_or_insert_with(|| View::new(&snapshot.model));
        if snapshot.generation != self.generation {
            self.generation = snapshot.generation;
            view.model_replaced(&snapshot.model);
            self.panels.reset_model();
            self.panels_stale = true;
        }
    }

    /// Renders the newest snapshot and the panels.
    fn render(&mut self, texture: Option<&wgpu::SurfaceTexture>) -> Result<(), RenderError> {
        let gpu = self.surface.gpu().clone();
        let size = self.surface.size();
        let area = self.picture_area();
        self.mouse.set_area(area.origin.map(f64::from), area.size.map(f64::from));
        let target = texture.map(|texture| texture.texture.create_view(&wgpu::TextureViewDescriptor::default()));
        // Another snapshot may have arrived since `handle_physics_events`.
        self.update_model();
        let (Some(snapshot), Some(view)) = (self.link.current_mut(), &mut self.view) else {
            if let Some(target) = &target {
                scene_image::clear(&gpu, target);
                self.overlay.run(&self.window, Panels::show_waiting);
                self.overlay.paint(&gpu, target, size);
            }
            return Ok(());
        };
        view.update_snapshot(snapshot)?;

        self.panels.record(snapshot);
        let report = self.output.save_frame(&mut self.renderer, &gpu, snapshot, area.size);
        self.panels_stale |= report.notice.is_some() || report.problem.is_some();
        report.notice.into_iter().for_each(|notice| self.panels.notice(notice));
        report.problem.into_iter().for_each(|problem| self.panels.warn(problem));
        let Some(target) = target else { return Ok(()) };
        self.renderer.draw(&gpu, snapshot, &view.camera, &target, area)?;

        self.update_panels();
        self.overlay.paint(&gpu, &target, size);
        #[cfg(feature = "test-hooks")]
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
                panel_rects: self.overlay.panel_rects(&["left", "right", "info"]),
            });
        }
        Ok(())
    }

    /// Runs a pass of the panels if it is needed now. A pass for a new snapshot or another camera may follow later, at a limited rate.
    fn update_panels(&mut self) {
        let (Some(snapshot), Some(view), now) = (self.link.current(), &self.view, Instant::now()) else { return };
        let shows_all = self.shown.as_ref().is_some_and(|shown| shown.shows(snapshot, view));
        if self.panels_stale || !shows_all && self.scheduler.since_pass(now) >= PANEL_SPACING {
            self.run_panels();
        } else if !shows_all {
            self.scheduler.request_pass_spaced(now, PANEL_SPACING);
        }
    }

    /// Runs a pass of the panels for the events so far, and performs the resulting actions. Returns `true` if the panels have changed.
    pub(super) fn run_panels(&mut self) -> bool {
        let gpu = self.surface.gpu().clone();
        let now = Instant::now();
        self.scheduler.pass_started(now);
        self.panels_stale = false;
        let status = self.status(&gpu);
        let (Some(snapshot), Some(view)) = (self.link.current(), &mut self.view) else { return false };
        let (options, appearance) = (self.predicted.options(snapshot), self.predicted.appearance(snapshot));
        let mut actions = Vec::new();
        let before = view.clone();
        self.shown = Some(PanelContent { snapshot: (snapshot.generation, snapshot.number), view: before.clone() });
        let pass = self.overlay.run(&self.window, |ui| {
            actions.clear();
            #[cfg(feature = "test-hooks")]
            test_hooks::clear_sliders();
            let mut cx = PanelContext { snapshot, view, options, appearance, status: &status, actions: &mut actions };
            self.panels.show(ui, &mut cx);
        });
        self.link.set_view(&view.scene_view());
        // The frame of an action shows its effect.
        if !actions.is_empty() || *view != before {
            self.panels_stale = true;
            self.scheduler.request(now);
        }
        self.scheduler.request_pass_after(now, pass.repaint_delay.max(MIN_REPAINT_DELAY));
        for action in actions {
            self.act(&action);
        }
        pass.has_changed
    }

    /// Returns the area of the window between the side panels.
    pub(super) fn picture_area(&self) -> PictureArea {
        let [width, height] = self.surface.size();
        let scale = self.overlay.pixels_per_point();
        let sides = self.view.as_ref().map_or([0.0; 2], |view| side_widths(view, width as f32 / scale));
        let [left, right] = sides.map(|points| (points * scale).round() as u32);
        // In a window that is narrower than its panels, the area lies inside the window all the same.
        let left = left.min(width.saturating_sub(1));
        PictureArea { origin: [left, 0], size: [width.saturating_sub(left + right).max(1), height] }
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

    /// Recovers from a frame that could not be drawn. Recreates the GPU resources if they were lost, and shows the problem.
    pub(super) fn recover(&mut self, problem: &RenderError) {
        log::warn!("a frame could not be drawn: {problem}");
        self.renderer.drop_renderer();
        if matches!(problem, RenderError::Lost { .. }) {
            match WindowSurface::new(self.window.clone(), self.surface.has_vsync()) {
                Ok(surface) => {
                    self.surface = surface;
                    self.overlay = Overlay::new(&self.window, self.surface.gpu().device(), self.surface.format());
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
