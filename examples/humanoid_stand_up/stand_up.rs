//! The targets of standing, and the run.

use std::sync::Arc;

use mujoco_safe::control::ilqr::IlqrOptions;
use mujoco_safe::control::predictive::{IlqrPlanner, PredictiveController};
use mujoco_safe::control::residual::ResidualCost;
use mujoco_safe::{Controller, Data, Model, Result, Trajectory, sample};

use crate::standing::Standing;

/// Number of steps of a plan, and between two plans.
const HORIZON: usize = 80;
const INTERVAL: usize = 4;

/// Recorded run.
pub struct Run {
    pub trajectory: Trajectory,
    /// Height of the centre of mass after each step, m.
    pub heights: Vec<f64>,
    /// Speed of the centre of mass after each step, m/s.
    pub speeds: Vec<f64>,
    /// Height of the centre of mass of the standing humanoid, m.
    pub target: f64,
    pub model: Arc<Model>,
}

/// Resets a simulation to a keyframe. Returns the centre of mass and the midpoint of the soles,
/// world frame.
fn place(data: &mut Data, keyframe: &str) -> Result<[[f64; 3]; 2]> {
    let model = data.model().clone();
    data.reset_to_key(model.keyframe(keyframe)?.id())?;
    data.forward()?;
    let [left, right] = [model.site("sole_left")?, model.site("sole_right")?].map(|sole| *data.site(sole).xpos());
    let soles = std::array::from_fn(|axis| 0.5 * (left[axis] + right[axis]));
    Ok([data.subtree_com()[model.body("torso")?.index()], soles])
}

/// Returns the cost of standing where the feet of the squat are, and the height of the centre of
/// mass there.
fn standing(model: &Arc<Model>) -> Result<(ResidualCost, f64)> {
    let mut data = Data::new(model.clone())?;
    let [_, present] = place(&mut data, "squat")?;
    let [centre, soles] = place(&mut data, "stand")?;
    let centre: [f64; 3] = std::array::from_fn(|axis| centre[axis] - soles[axis] + present[axis]);
    let standing = Standing { centre, qpos: data.qpos(), ctrl: &vec![0.0; model.nu()], momentum: 0.1, posture: 1.0 };
    Ok((standing.cost(model)?, centre[2]))
}

/// Simulates the humanoid from its keyframe `squat`. It plans every 20 ms for the next 0.4 s.
pub fn stand_up(seconds: f64, threads: usize) -> Result<Run> {
    let model = Arc::new(sample::humanoid());
    let (cost, target) = standing(&model)?;
    let options = IlqrOptions::default()
        .with_iterations(1)
        .with_threads(threads)
        .with_step_sizes([1.0, 0.5, 0.2, 0.05])
        .with_sufficient_decrease(0.3);
    let mut data = Data::new(model.clone())?;
    data.reset_to_key(model.keyframe("squat")?.id())?;
    let planner = IlqrPlanner::new(&model, HORIZON, options)?;
    let mut controller = PredictiveController::new(&data, planner, cost, INTERVAL)?;
    let torso = model.body("torso")?.index();
    let steps = (seconds / model.timestep()).round() as usize;
    let trajectory = Trajectory::with_capacity(&model, steps);
    let mut run = Run { trajectory, heights: Vec::new(), speeds: Vec::new(), target, model };
    for _ in 0..steps {
        controller.control(&mut data)?;
        run.trajectory.push(&data)?;
        data.step()?;
        data.subtree_vel()?;
        run.heights.push(data.subtree_com()[torso][2]);
        run.speeds.push(data.subtree_linvel()[torso].iter().map(|value| value * value).sum::<f64>().sqrt());
    }
    Ok(run)
}
