//! Loop of the physics thread. Each tick executes the queued requests, takes the steps that are due
//! and publishes a snapshot.

use std::time::{Duration, Instant};

use super::Simulation;
use super::clock::Due;
use crate::data::Data;
use crate::scene::{Scene, SceneOptions};
use crate::viewer::link::{Mode, Request, Snapshot};

/// Minimum time between two snapshots.
const SNAPSHOT_INTERVAL: Duration = Duration::from_millis(8);

impl Simulation {
    /// Ticks until the window is closed.
    pub fn run(mut self) -> Data {
        let epoch = Instant::now();
        while !self.endpoint.link.is_closed() {
            let next = self.tick(&|| epoch.elapsed());
            self.endpoint.link.wait(next.map(|next| epoch + next));
        }
        self.into_data()
    }

    /// Executes the queued requests, takes the steps that are due and publishes a snapshot if
    /// anything has changed. Returns the time of the next tick, or `None` if there is nothing to do
    /// until the next request. `now` is any monotonic clock.
    ///
    /// Each request of a batch takes effect before the next request is executed, as if each had a
    /// separate tick. A gesture that starts and ends while the thread is busy is therefore not
    /// lost.
    pub fn tick(&mut self, now: &dyn Fn() -> Duration) -> Option<Duration> {
        let mut requested = false;
        while let Some(request) = self.endpoint.link.next() {
            self.take_pending_step(&request, now);
            self.execute(request);
            if self.paused {
                self.drag();
            }
            requested = true;
        }
        requested |= self.endpoint.update_view();
        self.unpublished |= requested;
        if self.paused { self.tick_paused(now) } else { self.tick_running(requested, now) }
    }

    /// Takes the pending step if the next request ends the run or the pull that requires it, even
    /// if no step is due yet.
    fn take_pending_step(&mut self, next: &Request, now: &dyn Fn() -> Duration) {
        if !self.step_pending || self.paused || !(next.pauses() || next.ends_perturbation()) {
            return;
        }
        if let Some(simulated) = self.step() {
            self.clock.stepped(simulated, now());
        }
    }

    /// Sets the pose of the selected body to the target of the mouse.
    fn drag(&mut self) {
        let dragged = self.endpoint.drag(&mut self.data);
        if self.check(dragged) == Some(true) {
            self.stale = true;
        }
    }

    fn tick_paused(&mut self, now: &dyn Fn() -> Duration) -> Option<Duration> {
        self.clock.stop();
        self.drag();
        if self.stale && self.data.check_usable().is_ok() {
            self.refresh();
        }
        let now = now();
        // A tracking camera approaches its body with each snapshot.
        let lags = self.endpoint.camera_lags(&self.data);
        if self.unpublished || (lags && now >= self.published + SNAPSHOT_INTERVAL) {
            self.publish(now);
        }
        (lags || self.unpublished).then_some(self.published + 2 * SNAPSHOT_INTERVAL)
    }

    fn tick_running(&mut self, requested: bool, now: &dyn Fn() -> Duration) -> Option<Duration> {
        let mut time = now();
        let next = loop {
            match self.clock.due(time, self.speed().target()) {
                Due::At(at) => break at,
                Due::Now => {
                    let Some(simulated) = self.step() else { return self.tick_paused(now) };
                    time = now();
                    self.clock.stepped(simulated, time);
                    // Limits the latency of snapshots and requests.
                    if time >= self.published + SNAPSHOT_INTERVAL || self.endpoint.link.has_work() {
                        break time;
                    }
                }
            }
        };
        if self.stale && self.data.check_usable().is_ok() {
            self.refresh();
        }
        if self.unpublished && (requested || time >= self.published + SNAPSHOT_INTERVAL) {
            self.publish(time);
        }
        // A change that is too early for a snapshot is published at the end of the interval.
        Some(if self.unpublished { next.min(self.published + SNAPSHOT_INTERVAL) } else { next })
    }

    fn publish(&mut self, now: Duration) {
        self.declare_instruments();
        let (status, speed, mode, noise) = (self.status(), self.speed(), self.mode, self.noise.settings);
        let Self { data, endpoint, player, modes, history, timing, problem, lines, timeline, paused, .. } = self;
        let moves = !*paused && mode != Mode::Trajectory;
        if moves {
            // The scene shows an arrow for this force. The next step applies the perturbation again
            // and reports errors.
            let _ = endpoint.apply_perturbation(data);
        }
        let model = data.model().clone();
        let mut player = player.as_mut().filter(|_| mode == Mode::Trajectory);
        match (&player, mode) {
            (Some(player), _) => player.describe(lines),
            (None, Mode::Controller) => timing.describe(model.timestep(), lines),
            (None, _) => lines.clear(),
        }
        let playback = player.as_ref().map(|player| player.state());
        match &player {
            Some(player) => player.describe_times(timeline),
            None => history.describe(data, timeline),
        }
        let names = player.as_ref().map_or_else(Default::default, |player| player.names().clone());
        let add = |scene: &mut Scene, options: &SceneOptions| match player.as_deref_mut() {
            Some(player) if player.burst.on => player.add_burst(scene, &model, options),
            _ => Ok(()),
        };
        let published = endpoint.publish(data, add, |snapshot: &mut Snapshot| {
            (snapshot.status, snapshot.speed, snapshot.mode, snapshot.noise) = (status, speed, mode, noise);
            snapshot.problem.clone_from(problem);
            snapshot.modes.clone_from(modes);
            snapshot.playback = playback;
            (snapshot.history_len, snapshot.history_position) = (history.len(), history.position());
            std::mem::swap(&mut snapshot.timeline, timeline);
            snapshot.trajectories = names;
            if let Some(selected) = snapshot.selected.as_mut().filter(|_| !moves) {
                selected.force = [0.0; 6];
            }
            std::mem::swap(&mut snapshot.info, lines);
        });
        endpoint.remove_perturbation(data);
        (self.unpublished, self.published) = (false, now);
        if let Err(error) = published {
            self.fail_once(error.to_string());
        }
    }
}
