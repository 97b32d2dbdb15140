//! Prediction of the state after the pending requests.

use super::{Appearance, EndpointRequest, Mode, Request, SimulationRequest, Snapshot};
use crate::model::Options;

/// Predicted state after the pending requests. The window interprets keys, buttons and edits by it, because the newest snapshot may
/// be older than the last request while the simulation is busy.
///
/// Requests are numbered from 1. A snapshot contains the number of the last request that was executed before it.
#[derive(Debug, Default)]
pub(crate) struct PredictedState {
    /// Number of the last request that may select a body.
    selection: u64,
    mode: Option<(u64, Mode)>,
    options: Option<(u64, Options)>,
    appearance: Option<(u64, Appearance)>,
}

impl PredictedState {
    /// Updates the prediction for a request that is about to be sent with this number.
    pub fn update(&mut self, request: &Request, number: u64, snapshot: &Snapshot) {
        match request {
            Request::Endpoint(EndpointRequest::Select(_) | EndpointRequest::SelectBody(Some(_))) => {
                self.selection = number;
            }
            Request::Endpoint(EndpointRequest::SelectBody(None)) => self.selection = 0,
            Request::Endpoint(EndpointRequest::SetOptions(options)) => self.options = Some((number, **options)),
            Request::Endpoint(EndpointRequest::SetAppearance(appearance)) => {
                self.appearance = Some((number, **appearance));
            }
            Request::Simulation(SimulationRequest::SetMode(mode)) if snapshot.modes.contains(mode) => {
                self.mode = Some((number, *mode));
            }
            Request::Simulation(SimulationRequest::CycleMode(step)) => {
                let modes = &snapshot.modes;
                if let Some(present) = modes.iter().position(|mode| *mode == self.mode(snapshot)) {
                    let next = (present as i32 + step).rem_euclid(modes.len() as i32) as usize;
                    self.mode = Some((number, modes[next]));
                }
            }
            Request::Simulation(SimulationRequest::Reload(_)) => *self = Self::default(),
            _ => {}
        }
    }

    /// Returns `true` if a body is selected or may be.
    pub fn may_be_selected(&self, snapshot: &Snapshot) -> bool {
        snapshot.selected.is_some() || self.selection > snapshot.executed
    }

    /// Returns the mode.
    pub fn mode(&self, snapshot: &Snapshot) -> Mode {
        let pending = self.mode.filter(|(number, _)| *number > snapshot.executed);
        pending.map_or(snapshot.mode, |(_, mode)| mode)
    }

    /// Returns the physics options on which the next edit is based.
    pub fn options(&self, snapshot: &Snapshot) -> Options {
        let pending = self.options.filter(|(number, _)| *number > snapshot.executed);
        pending.map_or_else(|| snapshot.model.options(), |(_, options)| options)
    }

    /// Returns the appearance on which the next edit is based.
    pub fn appearance(&self, snapshot: &Snapshot) -> Appearance {
        let pending = self.appearance.filter(|(number, _)| *number > snapshot.executed);
        pending.map_or_else(|| Appearance::of(&snapshot.model), |(_, appearance)| appearance)
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
        predicted.update(&request, bench.window.next_number(&request), bench.window.current().unwrap());
        bench.window.send(request);
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
