//! The arm, the path of its target, and the run.

use std::f64::consts::TAU;
use std::sync::Arc;

use mujoco_safe::control::ilqr::IlqrOptions;
use mujoco_safe::control::predictive::{IlqrPlanner, PredictiveController};
use mujoco_safe::control::residual::{
    Controls, FramePosition, JointVelocity, Needs, Residual, ResidualCost, ResidualJacobian, Term,
};
use mujoco_safe::{Controller, Data, Model, Result, Trajectory};

/// Number of steps of a plan, and between two plans.
const HORIZON: usize = 20;
const INTERVAL: usize = 4;
/// Time of one round of the target, s.
const ROUND: f64 = 4.0;

/// Loads the arm.
pub fn model() -> Result<Model> {
    Model::from_xml_str(include_str!("../../models/arm.xml"))
}

/// Returns the position of the target, which moves on a figure of eight in a vertical plane with up
/// to 0.5 m/s. Unit: metres.
pub fn target(time: f64) -> [f64; 3] {
    let angle = TAU * time / ROUND;
    [0.42, 0.2 * angle.sin(), 0.45 + 0.12 * (2.0 * angle).sin()]
}

/// Position of the hand relative to the target at the time of the step.
struct Track {
    /// Position of the hand in the world.
    hand: FramePosition,
}

impl Residual for Track {
    fn size(&self) -> usize {
        3
    }

    fn needs(&self) -> Needs {
        self.hand.needs()
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        self.hand.evaluate(data, residual)?;
        residual.iter_mut().zip(target(data.time())).for_each(|(residual, target)| *residual -= target);
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        self.hand.differentiate(data, jacobian)
    }
}

/// Recorded run.
pub struct Run {
    pub trajectory: Trajectory,
    /// Distance of the hand from the target after each step, m.
    pub distances: Vec<f64>,
    /// Positions of the hand after each step, m.
    pub hand: Vec<[f64; 3]>,
}

/// Creates the controller, which plans every 20 ms for the next 0.1 s. Its cost measures the
/// distance of the hand from the target, motion and effort.
pub fn controller(data: &Data, threads: usize) -> Result<PredictiveController<IlqrPlanner, ResidualCost>> {
    let model = data.model();
    let cost = ResidualCost::new(
        model,
        [
            Term::new("track", Track { hand: FramePosition::site(model, "hand")? })
                .with_weight(1e3)
                .with_terminal_weight(1e3),
            Term::new("motion", JointVelocity::all(model)).with_weight(1e-3),
            Term::new("effort", Controls::new(model)).with_weight(1e-2),
        ],
    )?;
    let options = IlqrOptions::default().with_iterations(2).with_threads(threads);
    PredictiveController::new(data, IlqrPlanner::new(model, HORIZON, options)?, cost, INTERVAL)
}

/// Shows the target at the present time.
pub fn show_target(data: &mut Data) {
    data.mocap_pos_mut()[0] = target(data.time());
}

/// Simulates the arm under the controller.
pub fn track(model: &Arc<Model>, seconds: f64, threads: usize) -> Result<Run> {
    let mut data = Data::new(model.clone())?;
    data.reset_to_key(model.keyframe("ready")?.id())?;
    let mut controller = controller(&data, threads)?;
    let hand = model.site("hand")?.id();
    let steps = (seconds / model.timestep()).round() as usize;
    let mut run = Run { trajectory: Trajectory::with_capacity(model, steps), distances: Vec::new(), hand: Vec::new() };
    for _ in 0..steps {
        show_target(&mut data);
        controller.control(&mut data)?;
        run.trajectory.push(&data)?;
        data.step()?;
        data.kinematics()?;
        let (hand, target) = (*data.site(hand).xpos(), target(data.time()));
        let squares = hand.iter().zip(target).map(|(hand, target)| (hand - target).powi(2));
        run.distances.push(squares.sum::<f64>().sqrt());
        run.hand.push(hand);
    }
    Ok(run)
}
