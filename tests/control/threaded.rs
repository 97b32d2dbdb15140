//! Predictive control with the planner in a second thread.

use std::sync::mpsc::{Receiver, Sender, channel};

use mujoco_safe::control::TimeVaryingLqr;
use mujoco_safe::control::ilqr::{IlqrOptions, TrajectoryCost};
use mujoco_safe::control::predictive::{IlqrPlanner, PlanReport, Planner, ThreadedPredictiveController};
use mujoco_safe::control::residual::{Controls, JointPosition, ResidualCost, Term};
use mujoco_safe::{Controller, Data, Error, Matrix, Result, StateSpec};

use super::cartpole;

const HORIZON: usize = 8;

/// Next plan of a [`Scripted`] planner: returns the controls of all steps, fails or panics.
type Action = Box<dyn FnOnce(&Data) -> Result<f64> + Send>;

/// Planner that waits for the test to send its next action.
struct Scripted {
    actions: Receiver<Action>,
    resets: usize,
}

impl Planner for Scripted {
    fn horizon(&self) -> usize {
        HORIZON
    }

    fn plan(&mut self, data: &Data, _: &dyn TrajectoryCost, policy: &mut TimeVaryingLqr) -> Result<PlanReport> {
        let ended = |_| Error::Unsupported("the script has ended".to_owned());
        let value = self.actions.recv().map_err(ended)?(data)?;
        let controls = Matrix::from_row_major(HORIZON, 1, vec![value; HORIZON]);
        let (states, gains) = (policy.states().clone(), policy.gains().to_vec());
        policy.overwrite(data, &states, &controls, &gains)?;
        Ok(PlanReport::new(self.resets as f64, value))
    }

    fn reset(&mut self) {
        self.resets += 1;
    }
}

fn effort(data: &Data) -> ResidualCost {
    ResidualCost::new(data.model(), [Term::new("effort", Controls::new(data.model()))]).unwrap()
}

type Controlled = ThreadedPredictiveController<Scripted, ResidualCost>;

/// Returns a cart-pole, a controller whose first plan has the controls 0.1, and the script of its
/// planner.
fn scripted() -> (Data, Controlled, Sender<Action>) {
    let data = cartpole();
    let (script, actions) = channel::<Action>();
    script.send(Box::new(|_| Ok(0.1))).unwrap();
    let controller = ThreadedPredictiveController::new(&data, Scripted { actions, resets: 0 }, effort(&data)).unwrap();
    (data, controller, script)
}

#[test]
fn a_step_does_not_wait_for_the_planner() {
    let (mut data, mut controller, script) = scripted();
    assert_eq!((controller.plans(), controller.policy().controls()[(0, 0)]), (1, 0.1));
    // The planner waits for the script, and the controller follows the first plan.
    for _ in 0..20 {
        controller.control(&mut data).unwrap();
        assert_eq!(data.ctrl(), [0.1]);
        data.step().unwrap();
    }
    script.send(Box::new(|_| Ok(0.2))).unwrap();
    controller.wait().unwrap();
    assert_eq!((controller.plans(), controller.report().cost), (2, 0.2));
    // The plan starts at the time of its state, the first step.
    assert_eq!(controller.policy().start(), 0.0);
    drop(script);
    controller.control(&mut data).unwrap();
    assert_eq!(data.ctrl(), [0.2]);
}

#[test]
fn plans_are_those_of_the_planner_for_the_states_at_their_request() {
    let mut data = cartpole();
    data.qpos_mut()[1] = 0.2;
    let cost = |data: &Data| {
        let position = JointPosition::all(data.model());
        ResidualCost::new(
            data.model(),
            [Term::new("position", position), Term::new("effort", Controls::new(data.model()))],
        )
        .unwrap()
    };
    let options = IlqrOptions::default().with_iterations(2);
    let planner = || IlqrPlanner::new(data.model(), 20, options.clone()).unwrap();
    let (mut direct, direct_cost) = (planner(), cost(&data));
    let mut controller = ThreadedPredictiveController::new(&data, planner(), cost(&data)).unwrap();
    let mut expected = TimeVaryingLqr::hold_controls(&data, 20).unwrap();
    let mut report = direct.plan(&data, &direct_cost, &mut expected).unwrap();
    for step in 0..10 {
        assert_eq!(controller.report(), report, "step {step}");
        assert_eq!(controller.policy().states(), expected.states(), "step {step}");
        assert_eq!(controller.policy().controls(), expected.controls(), "step {step}");
        assert_eq!(controller.policy().gains(), expected.gains(), "step {step}");
        report = direct.plan(&data, &direct_cost, &mut expected).unwrap();
        controller.control(&mut data).unwrap();
        data.step().unwrap();
        controller.wait().unwrap();
    }
}

#[test]
fn a_panic_of_the_planner_is_an_error_in_all_later_steps() {
    let (mut data, mut controller, script) = scripted();
    script.send(Box::new(|_| panic!("out of ideas"))).unwrap();
    controller.control(&mut data).unwrap();
    for _ in 0..2 {
        let error = controller.wait().unwrap_err();
        assert!(matches!(&error, Error::Panicked { message, .. } if message == "out of ideas"), "{error}");
        assert!(matches!(controller.control(&mut data), Err(Error::Panicked { .. })));
    }
    assert!(matches!(controller.plan_now(&data), Err(Error::Panicked { .. })));
    assert_eq!(controller.policy().controls()[(0, 0)], 0.1, "the last plan is available");
}

#[test]
fn an_error_of_the_planner_is_returned_once_and_the_next_plan_is_used() {
    let (mut data, mut controller, script) = scripted();
    controller.control(&mut data).unwrap();
    script.send(Box::new(|_| Err(Error::Unsupported("no plan".to_owned())))).unwrap();
    let error = controller.wait().unwrap_err();
    assert!(matches!(&error, Error::Unsupported(text) if text == "no plan"), "{error}");
    controller.control(&mut data).unwrap();
    assert_eq!(data.ctrl(), [0.1]);
    script.send(Box::new(|_| Ok(0.3))).unwrap();
    controller.wait().unwrap();
    drop(script);
    controller.control(&mut data).unwrap();
    assert_eq!(data.ctrl(), [0.3]);

    // An error of the first plan ends the thread.
    let (script, actions) = channel::<Action>();
    drop(script);
    let failed = ThreadedPredictiveController::new(&data, Scripted { actions, resets: 0 }, effort(&data));
    assert!(matches!(failed, Err(Error::Unsupported(_))));
}

#[test]
fn a_simulation_of_another_model_is_an_error_and_the_controller_remains_usable() {
    let (mut data, mut controller, script) = scripted();
    let mut other = cartpole();
    assert!(matches!(controller.control(&mut other), Err(Error::OtherModel { .. })));
    assert!(matches!(controller.plan_now(&other), Err(Error::OtherModel { .. })));
    script.send(Box::new(|_| Ok(0.2))).unwrap();
    controller.plan_now(&data).unwrap();
    drop(script);
    controller.control(&mut data).unwrap();
    assert_eq!(data.ctrl(), [0.2]);
}

#[test]
fn after_a_reset_the_step_waits_for_a_plan_from_the_new_state() {
    let (mut data, mut controller, script) = scripted();
    assert_eq!(controller.report().initial_cost, 1.0, "the first plan does not start from an earlier one");
    data.step().unwrap();
    controller.control(&mut data).unwrap();
    data.reset().unwrap();
    data.qpos_mut()[0] = 0.4;
    // The plan in progress, which started before the reset, and the plan after it.
    script.send(Box::new(|_| Err(Error::Unsupported("before the reset".to_owned())))).unwrap();
    script.send(Box::new(|data| Ok(data.qpos()[0]))).unwrap();
    drop(script);
    controller.control(&mut data).unwrap();
    assert_eq!((data.ctrl(), controller.report().initial_cost), (&[0.4][..], 2.0));
}

#[test]
fn edits_apply_to_the_next_plan_and_edits_of_the_model_too() {
    let (mut data, mut controller, script) = scripted();
    controller.edit(|planner, cost| {
        planner.resets = 10;
        cost.term_mut("effort").unwrap().weight = 7.0;
    });
    data.edit_model(|model| model.actuator_ctrlrange_mut()[0] = [-0.5, 0.5]).unwrap();
    data.qfrc_applied_mut()[0] = 3.0;
    let applied = data.state(StateSpec::INTEGRATION);
    controller.control(&mut data).unwrap();
    script
        .send(Box::new(move |data| {
            assert_eq!(data.state(StateSpec::INTEGRATION), applied);
            Ok(data.model().actuator_ctrlrange()[0][1])
        }))
        .unwrap();
    controller.wait().unwrap();
    assert_eq!((controller.report().cost, controller.report().initial_cost), (0.5, 10.0));
    controller.edit(|_, _| panic!("a bad edit"));
    drop(script);
    controller.control(&mut data).unwrap();
    assert!(matches!(controller.wait(), Err(Error::Panicked { message, .. }) if message == "a bad edit"));
}
