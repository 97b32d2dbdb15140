//! One turn of the thread's loop: requests, steps that are due, a snapshot.

use std::time::{Duration, Instant};

use super::Simulation;
use crate::data::Data;
use crate::scene::{Scene, SceneOptions};
use crate::viewer::clock::Due;
use crate::viewer::mode::Mode;
use crate::viewer::request::Request;
use crate::viewer::snapshot::Snapshot;

/// How often the window sees something new at most.
const BETWEEN_SNAPSHOTS: Duration = Duration::from_millis(8);

impl Simulation {
    /// Runs until the window is closed.
    pub fn run(mut self) -> Data {
        let epoch = Instant::now();
        while !self.bridge.back.is_closed() {
            let until = self.turn(&|| epoch.elapsed());
            self.bridge.back.wait(until.map(|until| epoch + until));
        }
        self.into_data()
    }

    /// Executes the queued requests, takes the steps that are due and publishes a snapshot of what has changed. Returns the time
    /// of the next turn, or `None` if the simulation rests until the next request. `now` is any clock.
    ///
    /// Every request of a batch takes effect before the next one is executed, as if each had come in its own turn: a gesture that
    /// begins and ends while the thread is busy is not lost.
    pub fn turn(&mut self, now: &dyn Fn() -> Duration) -> Option<Duration> {
        let mut asked = false;
        while let Some(request) = self.bridge.back.next() {
            self.take_owed_step(&request, now);
            self.execute(request);
            if self.paused {
                self.drag();
            }
            asked = true;
        }
        asked |= self.bridge.take_look();
        self.unseen |= asked;
        if self.paused { self.stand(now) } else { self.go(asked, now) }
    }

    /// Takes the step that a run or a pull is owed if the next request ends it, even if no step is due yet.
    fn take_owed_step(&mut self, next: &Request, now: &dyn Fn() -> Duration) {
        if !self.owes_step || self.paused || !(next.pauses() || next.ends_pull()) {
            return;
        }
        if let Some(simulated) = self.step() {
            self.clock.stepped(simulated, now());
        }
    }

    /// Moves the selected body to the pose that the mouse has dragged it to.
    fn drag(&mut self) {
        let dragged = self.bridge.drag(&mut self.data);
        if self.note(dragged) == Some(true) {
            self.stale = true;
        }
    }

    fn stand(&mut self, now: &dyn Fn() -> Duration) -> Option<Duration> {
        self.clock.stop();
        self.drag();
        if self.stale && self.data.check_usable().is_ok() {
            self.refresh();
        }
        let now = now();
        // A camera that follows a body comes nearer with each picture.
        let lags = self.bridge.camera_lags(&self.data);
        if self.unseen || (lags && now >= self.published + BETWEEN_SNAPSHOTS) {
            self.publish(now);
        }
        (lags || self.unseen).then_some(self.published + 2 * BETWEEN_SNAPSHOTS)
    }

    fn go(&mut self, asked: bool, now: &dyn Fn() -> Duration) -> Option<Duration> {
        let mut time = now();
        let until = loop {
            match self.clock.due(time, self.speed()) {
                Due::At(at) => break at,
                Due::Now => {
                    let Some(simulated) = self.step() else { return self.stand(now) };
                    time = now();
                    self.clock.stepped(simulated, time);
                    // The window is not to wait for long, neither for a picture nor for an answer.
                    if time >= self.published + BETWEEN_SNAPSHOTS || self.bridge.back.is_waited_for() {
                        break time;
                    }
                }
            }
        };
        if self.stale && self.data.check_usable().is_ok() {
            self.refresh();
        }
        if self.unseen && (asked || time >= self.published + BETWEEN_SNAPSHOTS) {
            self.publish(time);
        }
        // What was not shown for being too early is shown in time.
        Some(if self.unseen { until.min(self.published + BETWEEN_SNAPSHOTS) } else { until })
    }

    fn publish(&mut self, now: Duration) {
        let (status, pace, mode) = (self.status(), self.pace(), self.mode);
        let Self { data, bridge, player, modes, history, effort, problem, lines, paused, .. } = self;
        let moves = !*paused && mode != Mode::Trajectory;
        if moves {
            // So that it is shown. The next step computes it anew, and tells if it cannot.
            let _ = bridge.apply_perturbation(data);
        }
        let model = data.model().clone();
        let mut player = player.as_mut().filter(|_| mode == Mode::Trajectory);
        match (&player, mode) {
            (Some(player), _) => player.describe(lines),
            (None, Mode::Controller) => effort.describe(model.timestep(), lines),
            (None, _) => lines.clear(),
        }
        let playback = player.as_ref().map(|player| player.playback());
        let add = |scene: &mut Scene, options: &SceneOptions| match player.as_deref_mut() {
            Some(player) if player.burst.on => player.add_burst(scene, &model, options),
            _ => Ok(()),
        };
        let published = bridge.publish(data, add, |snapshot: &mut Snapshot| {
            (snapshot.status, snapshot.pace, snapshot.mode) = (status, pace, mode);
            snapshot.problem.clone_from(problem);
            snapshot.modes.clone_from(modes);
            snapshot.playback = playback;
            (snapshot.history, snapshot.moment) = (history.len(), history.moment());
            if let Some(selected) = snapshot.selected.as_mut().filter(|_| !moves) {
                selected.force = [0.0; 6];
            }
            std::mem::swap(&mut snapshot.info, lines);
        });
        bridge.remove_perturbation(data);
        (self.unseen, self.published) = (false, now);
        if let Err(error) = published {
            // What is in the way of a picture is there for the next one too, and the window knows then.
            let problem = error.to_string();
            if self.problem != problem {
                self.fail(problem);
            }
        }
    }
}
