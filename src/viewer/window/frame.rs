//! A session's frames.

use std::time::{Duration, Instant};

use winit::event_loop::ActiveEventLoop;

use super::canvas::Canvas;
use super::overlay::{Overlay, Painted};
use super::screen::{Place, Screen};
use super::session::Session;
use crate::render::{Gpu, RenderError};
use crate::viewer::event::Event;
use crate::viewer::panel::{Facts, Panels, Request as PanelRequest, Shown};
use crate::viewer::probe;
use crate::viewer::view::View;

/// How long a surface that is not ready is left alone.
const RETRY: Duration = Duration::from_millis(30);

impl Session {
    /// Draws a frame, if the window can be seen.
    pub(super) fn draw(&mut self, _: &ActiveEventLoop) -> Result<(), RenderError> {
        let now = Instant::now();
        self.pace.drawn(now);
        self.frame_began = Some(self.now());
        // What comes from here on wakes it again.
        self.waker.looked();
        self.hear()?;
        if self.over {
            return Ok(());
        }
        probe::wait_while_held();
        if probe::takes_surface() {
            self.screen.remake()?;
        }
        let texture = match self.screen.place()? {
            Place::Ready(texture) => texture,
            Place::Hidden => {
                // Nothing is seen of it, and what is recorded goes on.
                self.show(None)?;
                return Ok(());
            }
            Place::Soon => {
                self.pace.ask_after(now, RETRY);
                return Ok(());
            }
        };
        self.mouse.resize(self.screen.size().map(f64::from));
        let again = self.show(Some(&texture))?;
        self.screen.present(texture);
        self.pace.ask_after(now, again);
        Ok(())
    }

    /// Listens to what the physics has to say.
    fn hear(&mut self) -> Result<(), RenderError> {
        for event in self.front.events() {
            if let Some(view) = &mut self.view {
                view.take(&event);
            }
            match event {
                Event::Copied(text) => {
                    if self.overlay.copy(text) {
                        self.panels.notice("copied to the clipboard".to_owned());
                    } else {
                        self.panels.warn("there is no clipboard to copy to".to_owned());
                    }
                }
                Event::Notice(text) => self.panels.notice(text),
                Event::Asset(asset) => {
                    if let Some(snapshot) = self.front.drawn() {
                        self.canvas.update(snapshot, asset)?;
                    }
                }
                Event::LookAt(_) | Event::Track(_) | Event::View(_) => {}
            }
        }
        self.meet();
        if self.front.is_closing() {
            self.close();
        }
        Ok(())
    }

    /// Looks at the newest snapshot's model: a camera of another one is of no use.
    pub(super) fn meet(&mut self) {
        let Some((snapshot, _)) = self.front.latest() else { return };
        let view = self.view.get_or_insert_with(|| View::new(&snapshot.model));
        if snapshot.generation != self.generation {
            self.generation = snapshot.generation;
            view.model_replaced(&snapshot.model);
            self.panels.forget_model();
        }
    }

    /// Draws the newest snapshot and the panels over it. Returns how long until the panels change by themselves.
    fn show(&mut self, texture: Option<&wgpu::SurfaceTexture>) -> Result<Duration, RenderError> {
        let gpu = self.screen.gpu().clone();
        let size = self.screen.size();
        let target = texture.map(|texture| texture.texture.create_view(&wgpu::TextureViewDescriptor::default()));
        // One that may have come in between is looked at anew.
        self.meet();
        let (Some(snapshot), Some(view)) = (self.front.drawn_mut(), &mut self.view) else {
            if let Some(target) = &target {
                Canvas::draw_nothing(&gpu, target);
                let painted = self.overlay.run(&self.window, Panels::wait);
                self.overlay.paint(&gpu, target, size, &painted);
            }
            return Ok(Duration::MAX);
        };
        view.prepare(snapshot)?;

        let outcome = self.output.take(&mut self.canvas, &gpu, snapshot, size);
        outcome.notice.into_iter().for_each(|notice| self.panels.notice(notice));
        outcome.problem.into_iter().for_each(|problem| self.panels.warn(problem));
        let Some(target) = target else { return Ok(Duration::MAX) };
        self.canvas.draw(&gpu, snapshot, &target, size)?;

        let Some(painted) = self.lay_out() else { return Ok(Duration::MAX) };
        self.overlay.paint(&gpu, &target, size, &painted);
        if probe::is_on()
            && let (Some(snapshot), Some(view)) = (self.front.drawn(), &self.view)
        {
            let asked = self.front.asked();
            let messages = self.panels.messages();
            probe::put(snapshot, asked, view, &self.facts(&gpu), messages, self.overlay.is_editing());
        }
        Ok(painted.again)
    }

    /// Lays the panels out for the events so far, and executes the requests that they make.
    pub(super) fn lay_out(&mut self) -> Option<Painted> {
        let gpu = self.screen.gpu().clone();
        let facts = self.facts(&gpu);
        let (Some(snapshot), Some(view)) = (self.front.drawn(), &mut self.view) else { return None };
        let options = self.expected.options(snapshot);
        let mut requests = Vec::new();
        let painted = self.overlay.run(&self.window, |ui| {
            requests.clear();
            let mut shown = Shown { snapshot, view, options, facts: &facts, requests: &mut requests };
            self.panels.show(ui, &mut shown);
        });
        let look = view.look();
        self.front.look(&look);
        for request in requests {
            match request {
                PanelRequest::Physics(request) => self.ask(*request),
                PanelRequest::Act(action) => self.act(action),
                PanelRequest::Vsync(vsync) => self.screen.set_vsync(vsync),
            }
            self.pace.ask(Instant::now());
        }
        Some(painted)
    }

    fn facts<'a>(&self, gpu: &'a Gpu) -> Facts<'a> {
        Facts {
            size: self.screen.size(),
            rate: self.pace.rate(),
            recording: self.output.frames(),
            vsync: self.screen.has_vsync(),
            full_screen: self.window.fullscreen().is_some(),
            gpu: gpu.name(),
        }
    }

    /// After a frame that could not be drawn: makes what was lost anew, or says why there is nothing.
    pub(super) fn recover(&mut self, problem: &RenderError) {
        log::warn!("a frame could not be drawn: {problem}");
        self.canvas.clear();
        if matches!(problem, RenderError::Lost { .. }) {
            match Screen::new(self.window.clone(), self.screen.has_vsync()) {
                Ok(screen) => {
                    self.screen = screen;
                    self.overlay = Overlay::new(&self.window, self.screen.gpu().device(), self.screen.format());
                }
                Err(error) => {
                    log::error!("{error}");
                    self.close();
                    return;
                }
            }
        }
        self.panels.warn(problem.to_string());
        // Not at once: what fails each time is not to be tried all the time.
        self.pace.ask_after(Instant::now(), Duration::from_secs(1));
    }
}
