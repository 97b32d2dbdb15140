//! Set-point: a pose in which gravity, contact forces and motor forces are in equilibrium.

use mujoco_safe::id::KeyframeId;
use mujoco_safe::nalgebra::DVector;
use mujoco_safe::{Data, Result};

/// Pose, and the controls that hold it.
#[derive(Clone, Debug)]
pub struct SetPoint {
    pub qpos: Vec<f64>,
    pub ctrl: Vec<f64>,
    /// Vertical offset from the keyframe, m.
    pub offset: f64,
    /// Generalised forces of inverse dynamics at the keyframe, N and N·m.
    pub at_keyframe: Vec<f64>,
    /// Generalised forces of inverse dynamics at the set-point, N and N·m.
    pub wanted: Vec<f64>,
    /// Generalised forces of the actuators under `ctrl`, N and N·m.
    pub actual: Vec<f64>,
}

/// Vertical force of inverse dynamics against the height.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Vertical offsets from the keyframe, m.
    pub heights: Vec<f64>,
    /// Vertical forces, N.
    pub forces: Vec<f64>,
}

/// Index of the vertical coordinate of the root's free joint, in `qpos` and `qvel`.
const VERTICAL: usize = 2;

/// Number of heights to evaluate within ±1 mm.
const HEIGHTS: usize = 2001;

impl SetPoint {
    /// Finds the set-point near a keyframe, by a search over the height.
    pub fn near(data: &mut Data, keyframe: KeyframeId) -> Result<(Self, Sweep)> {
        // Compute the forces that keep the robot at rest at the keyframe. A force on the free joint
        // is unphysical, because it has no motor: the feet penetrate the floor too much or too
        // little to support the weight.
        let at_keyframe = inverse_at(data, keyframe, 0.0)?;

        // Find the height at which the floor supports the weight.
        let heights: Vec<f64> = (0..HEIGHTS).map(|index| -1e-3 + 2e-3 * index as f64 / (HEIGHTS - 1) as f64).collect();
        let forces = heights
            .iter()
            .map(|&height| Ok(inverse_at(data, keyframe, height)?[VERTICAL]))
            .collect::<Result<Vec<f64>>>()?;
        let best = (0..HEIGHTS).min_by(|&a, &b| forces[a].abs().total_cmp(&forces[b].abs())).unwrap_or(0);
        let offset = heights[best];

        // Solve for the controls: qfrc_actuator = momentᵀ · force, and the force of a motor is its
        // control. `transposed` returns the row-major moment as a column-major view, which is
        // momentᵀ.
        let wanted = inverse_at(data, keyframe, offset)?;
        let qpos = data.qpos().to_vec();
        let moment_transposed = data.full_moment()?.transposed().into_owned();
        let ctrl = moment_transposed
            .svd(true, true)
            .solve(&DVector::from_column_slice(&wanted), 1e-12)
            .expect("the SVD computed both factors");
        data.ctrl_mut().copy_from_slice(ctrl.as_slice());

        // Evaluate the forces that these controls produce. They match on all joints except the free
        // joint.
        data.forward()?;
        let actual = data.qfrc_actuator().to_vec();
        let ctrl = ctrl.as_slice().to_vec();
        Ok((Self { qpos, ctrl, offset, at_keyframe, wanted, actual }, Sweep { heights, forces }))
    }

    /// Resets a simulation to the set-point.
    pub fn apply(&self, data: &mut Data) -> Result<()> {
        data.reset()?;
        data.qpos_mut().copy_from_slice(&self.qpos);
        data.ctrl_mut().copy_from_slice(&self.ctrl);
        data.forward()
    }

    /// Returns the largest difference between required and actual forces on these degrees of
    /// freedom.
    pub fn force_error(&self, joint_dofs: std::ops::Range<usize>) -> f64 {
        joint_dofs.map(|dof| (self.wanted[dof] - self.actual[dof]).abs()).fold(0.0, f64::max)
    }
}

/// Returns the forces that keep the keyframe at rest when it is raised by `height`.
fn inverse_at(data: &mut Data, keyframe: KeyframeId, height: f64) -> Result<Vec<f64>> {
    data.reset_to_key(keyframe)?;
    data.forward()?;
    data.qacc_mut().fill(0.0);
    data.qpos_mut()[VERTICAL] += height;
    data.inverse()?;
    Ok(data.qfrc_inverse().to_vec())
}
