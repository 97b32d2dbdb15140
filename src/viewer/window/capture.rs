//! Screenshots and recordings of a session.

use super::session::Session;
use crate::error::{Error, Result};

impl Session {
    /// Requests a screenshot of the next frame.
    pub(super) fn request_screenshot(&mut self) {
        self.output.screenshot_requested = true;
    }

    pub(super) fn toggle_recording(&mut self) {
        if self.output.is_recording() {
            let finished = self.finish_recording();
            self.window.set_resizable(true);
            self.report(finished.map(Option::unwrap_or_default));
        } else {
            let size = self.picture_area().size;
            let started = self.output.start(size);
            self.window.set_resizable(started.is_err());
            self.report(started.map(|path| format!("recording to {}", path.display())));
            // The recording starts now, even if the next frame is drawn much later.
            self.record_newest();
        }
    }

    /// Finishes the running recording with the newest snapshot, so that it includes the time since
    /// the last frame.
    pub(super) fn finish_recording(&mut self) -> Result<Option<String>> {
        self.record_newest();
        let time = self.link.current().map(|snapshot| snapshot.time);
        self.output.finish(time)
    }

    /// Records the newest snapshot, even if the window is hidden.
    fn record_newest(&mut self) {
        if !self.output.is_recording() {
            return;
        }
        self.update_model();
        let (Some(snapshot), Some(view)) = (self.link.current_mut(), &mut self.view) else { return };
        let gpu = self.surface.gpu().clone();
        let problem = match view.update_snapshot(snapshot) {
            Ok(()) => self.output.record(&mut self.renderer, &gpu, snapshot),
            Err(error) => Some(error.to_string()),
        };
        if let Some(problem) = problem {
            self.panels.warn(problem);
        }
    }

    fn report(&mut self, result: Result<String, Error>) {
        match result {
            Ok(notice) => self.panels.notice(notice),
            Err(error) => self.panels.warn(error.to_string()),
        }
    }
}
