//! Prediction of the state after the pending requests.

use std::collections::VecDeque;

use super::{
    Appearance, Burst, ControlNoise, EndpointRequest, Mode, PlaybackRequest, Request, SimulationRequest, Snapshot,
    Status,
};
use crate::id::{ActuatorId, EqualityId, JointId};
use crate::model::Options;

/// Predicted state after the pending requests. The window interprets keys, buttons and edits by it,
/// because the newest snapshot may be older than the last request while the simulation is busy.
///
/// Panels base every edit on a predicted value, never on the value of the snapshot. A text field
/// discards its text if its number changes while the user types: with the number of an older
/// snapshot, all digits but the last would be lost. A toggle or a difference would be computed from
/// the previous value twice.
///
/// Requests are numbered from 1. A snapshot contains the number of the last request that was
/// executed before it.
#[derive(Debug, Default)]
pub(crate) struct PredictedState {
    /// Number of the last request that may select a body.
    selection: u64,
    /// Other requests, each with its number, from the oldest to the newest.
    pending: VecDeque<(u64, Request)>,
}

impl PredictedState {
    /// Updates the prediction for a request that was sent with this number.
    pub fn update(&mut self, request: Request, number: u64, snapshot: &Snapshot) {
        while self.pending.front().is_some_and(|(number, _)| *number <= snapshot.executed) {
            self.pending.pop_front();
        }
        let request = match request {
            Request::Endpoint(EndpointRequest::Select(_) | EndpointRequest::SelectBody(Some(_))) => {
                self.selection = number;
                return;
            }
            Request::Endpoint(EndpointRequest::SelectBody(None)) => {
                self.selection = 0;
                return;
            }
            Request::Simulation(SimulationRequest::CycleMode(step)) => {
                let modes = &snapshot.modes;
                let Some(present) = modes.iter().position(|mode| *mode == self.mode(snapshot)) else { return };
                let next = (present as i32 + step).rem_euclid(modes.len() as i32) as usize;
                SimulationRequest::SetMode(modes[next]).into()
            }
            Request::Simulation(SimulationRequest::Load(..)) => {
                *self = Self::default();
                return;
            }
            request => request,
        };
        if let Some((last, pending)) = self.pending.back_mut()
            && pending.merge(&request)
        {
            *last = number;
        } else {
            self.pending.push_back((number, request));
        }
    }

    /// Returns the pending requests, from the newest to the oldest.
    fn pending(&self, snapshot: &Snapshot) -> impl DoubleEndedIterator<Item = &Request> {
        let executed = self.pending.partition_point(|(number, _)| *number <= snapshot.executed);
        self.pending.range(executed..).rev().map(|(_, request)| request)
    }

    /// Returns the value that the last pending request of a kind sets, if there is one.
    fn set<T>(&self, snapshot: &Snapshot, value: impl FnMut(&Request) -> Option<T>) -> Option<T> {
        self.pending(snapshot).find_map(value)
    }

    /// Returns `true` if a body is selected or may be.
    pub fn may_be_selected(&self, snapshot: &Snapshot) -> bool {
        snapshot.selected.is_some() || self.selection > snapshot.executed
    }

    /// Returns `true` if the simulation is paused.
    pub fn is_paused(&self, snapshot: &Snapshot) -> bool {
        self.pending(snapshot).rev().fold(snapshot.status == Status::Paused, |paused, request| match request {
            Request::Pause(paused) => *paused,
            Request::TogglePause => !paused,
            _ => paused,
        })
    }

    /// Returns the mode.
    pub fn mode(&self, snapshot: &Snapshot) -> Mode {
        let mode = self.set(snapshot, |request| match request {
            Request::Simulation(SimulationRequest::SetMode(mode)) if snapshot.modes.contains(mode) => Some(*mode),
            _ => None,
        });
        mode.unwrap_or(snapshot.mode)
    }

    /// Returns the factor of simulated over real time.
    pub fn target_speed(&self, snapshot: &Snapshot) -> f64 {
        let factor = self.set(snapshot, |request| match request {
            Request::Simulation(SimulationRequest::SetSpeed(factor)) => Some(*factor),
            _ => None,
        });
        factor.unwrap_or_else(|| snapshot.speed.target())
    }

    /// Returns the noise on the controls.
    pub fn noise(&self, snapshot: &Snapshot) -> ControlNoise {
        let noise = self.set(snapshot, |request| match request {
            Request::Simulation(SimulationRequest::SetNoise(noise)) => Some(*noise),
            _ => None,
        });
        noise.unwrap_or(snapshot.noise)
    }

    /// Returns the index of the current state in the history.
    pub fn history_position(&self, snapshot: &Snapshot) -> usize {
        let index = self.set(snapshot, |request| match request {
            Request::Simulation(SimulationRequest::Scrub(index)) => Some(*index),
            _ => None,
        });
        index.unwrap_or(snapshot.history_position)
    }

    /// Returns the index of a trajectory that the user has chosen, until a snapshot contains it.
    pub fn trajectory(&self, snapshot: &Snapshot) -> Option<usize> {
        self.set(snapshot, |request| match request {
            Request::Playback(PlaybackRequest::SetTrajectory(index)) => Some(*index),
            _ => None,
        })
    }

    /// Returns the index of a record that the user has chosen, until a snapshot contains it.
    pub fn record(&self, snapshot: &Snapshot) -> Option<usize> {
        self.set(snapshot, |request| match request {
            Request::Playback(PlaybackRequest::SetFrame(frame)) => Some(*frame),
            _ => None,
        })
    }

    /// Returns the burst of the playback after the pending changes of a burst.
    pub fn burst(&self, snapshot: &Snapshot, mut burst: Burst) -> Burst {
        for request in self.pending(snapshot).rev() {
            match request {
                Request::Playback(PlaybackRequest::ToggleBurst) => burst.on = !burst.on,
                Request::Playback(PlaybackRequest::ToggleDoppler) => burst.doppler = !burst.doppler,
                Request::Playback(PlaybackRequest::ChangeBurstFactor(notches)) => {
                    burst.factor = Burst::adjusted(burst.factor, *notches);
                }
                Request::Playback(PlaybackRequest::ChangeBurstGamma(notches)) => {
                    burst.gamma = Burst::adjusted(burst.gamma, *notches);
                }
                _ => {}
            }
        }
        burst
    }

    /// Returns the physics options.
    pub fn options(&self, snapshot: &Snapshot) -> Options {
        let options = self.set(snapshot, |request| match request {
            Request::Endpoint(EndpointRequest::SetOptions(options)) => Some(**options),
            _ => None,
        });
        options.unwrap_or_else(|| snapshot.model.options())
    }

    /// Returns the appearance of the model.
    pub fn appearance(&self, snapshot: &Snapshot) -> Appearance {
        let appearance = self.set(snapshot, |request| match request {
            Request::Endpoint(EndpointRequest::SetAppearance(appearance)) => Some(**appearance),
            _ => None,
        });
        appearance.unwrap_or_else(|| Appearance::of(&snapshot.model))
    }

    /// Returns a parameter of the instruments that the user has set, until a snapshot contains it.
    pub fn parameter(&self, snapshot: &Snapshot, name: &str) -> Option<f64> {
        self.set(snapshot, |request| match request {
            Request::Endpoint(EndpointRequest::SetParameter(set, value)) if **set == *name => Some(*value),
            _ => None,
        })
    }

    /// Returns a control of an actuator that the user has set, until a snapshot contains it.
    pub fn control(&self, snapshot: &Snapshot, actuator: ActuatorId, number: usize) -> Option<f64> {
        self.set(snapshot, |request| match request {
            Request::Endpoint(EndpointRequest::SetControl(set, part, value)) if (*set, *part) == (actuator, number) => {
                Some(*value)
            }
            Request::Endpoint(EndpointRequest::ClearControls) => Some(0.0),
            _ => None,
        })
    }

    /// Returns an element of a joint's position that the user has set, until a snapshot contains
    /// it.
    pub fn position(&self, snapshot: &Snapshot, joint: JointId, part: usize) -> Option<f64> {
        self.set(snapshot, |request| match request {
            Request::Endpoint(EndpointRequest::SetPosition(set, index, value)) if (*set, *index) == (joint, part) => {
                Some(*value)
            }
            _ => None,
        })
    }

    /// Returns the state of an equality constraint that the user has set, until a snapshot contains
    /// it.
    pub fn equality(&self, snapshot: &Snapshot, equality: EqualityId) -> Option<bool> {
        self.set(snapshot, |request| match request {
            Request::Endpoint(EndpointRequest::SetEquality(set, active)) if *set == equality => Some(*active),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::PredictedState;
    use crate::viewer::link::{EndpointRequest, Mode, Request, SimulationRequest};
    use crate::viewer::tests::{Bench, trajectories};
    use crate::{Data, sample};

    /// Sends a request as the window does, without a tick of the simulation.
    fn send(bench: &Bench, predicted: &mut PredictedState, request: impl Into<Request>) {
        let request = request.into();
        let number = bench.window.send(request.clone()).unwrap();
        predicted.update(request, number, bench.window.current().unwrap());
    }

    #[test]
    fn pending_selection_counts_as_selected() {
        let (mut bench, mut predicted) = (Bench::humanoid(), PredictedState::default());
        let torso = bench.snapshot().model.body("torso").unwrap().id();
        assert!(!predicted.may_be_selected(bench.snapshot()));
        send(&bench, &mut predicted, EndpointRequest::SelectBody(Some(torso)));
        assert!(predicted.may_be_selected(bench.snapshot()));
        bench.tick();
        assert!(predicted.may_be_selected(bench.snapshot()));
        bench.send(EndpointRequest::SelectBody(None));
        assert!(!predicted.may_be_selected(bench.snapshot()), "the snapshot overrides the prediction");
    }

    #[test]
    fn pending_mode_determines_the_meaning_of_keys() {
        let mut bench = Bench::with(Data::new(sample::cartpole()).unwrap(), None, trajectories());
        let mut predicted = PredictedState::default();
        assert_eq!(predicted.mode(bench.snapshot()), Mode::Trajectory);
        for mode in [Mode::Passive, Mode::Trajectory, Mode::Passive] {
            send(&bench, &mut predicted, SimulationRequest::CycleMode(1));
            assert_eq!(predicted.mode(bench.snapshot()), mode);
        }
        send(&bench, &mut predicted, SimulationRequest::SetMode(Mode::Controller));
        assert_eq!(predicted.mode(bench.snapshot()), Mode::Passive, "there is no controller");
        bench.tick();
        assert_eq!((bench.mode(), predicted.mode(bench.window.current().unwrap())), (Mode::Passive, Mode::Passive));
        bench.send(SimulationRequest::SetMode(Mode::Trajectory));
        assert_eq!(predicted.mode(bench.snapshot()), Mode::Trajectory, "the snapshot overrides the prediction");
    }

    #[test]
    fn consecutive_edits_of_the_options_are_cumulative() {
        let (mut bench, mut predicted) = (Bench::humanoid(), PredictedState::default());
        let mut options = predicted.options(bench.snapshot());
        options.gravity = [0.0, 0.0, -1.0];
        send(&bench, &mut predicted, EndpointRequest::SetOptions(Box::new(options)));
        let mut options = predicted.options(bench.snapshot());
        options.iterations = 7;
        send(&bench, &mut predicted, EndpointRequest::SetOptions(Box::new(options)));
        bench.tick();
        let model = bench.snapshot().model.clone();
        assert_eq!((model.options().gravity, model.options().iterations), ([0.0, 0.0, -1.0], 7));
        // The next edit is not based on rejected options.
        let mut options = predicted.options(bench.snapshot());
        options.timestep = -1.0;
        send(&bench, &mut predicted, EndpointRequest::SetOptions(Box::new(options)));
        bench.tick();
        assert_eq!(predicted.options(bench.snapshot()), model.options());
    }
}
