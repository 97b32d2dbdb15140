//! Where to balance: a position in which gravity, contacts and motors can be in equilibrium.

use mujoco_safe::nalgebra::DVector;
use mujoco_safe::{Data, KeyframeId, Result};

/// A position, and the controls that hold it.
#[derive(Clone, Debug)]
pub struct SetPoint {
    pub qpos: Vec<f64>,
    pub ctrl: Vec<f64>,
    /// By how much it is higher than the keyframe, m.
    pub offset: f64,
    /// The forces that inverse dynamics calls for at the keyframe itself. N and N·m.
    pub at_keyframe: Vec<f64>,
    /// Those that it calls for here.
    pub wanted: Vec<f64>,
    /// Those that the controls bring about.
    pub actual: Vec<f64>,
}

/// The vertical force that inverse dynamics calls for, against the height.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Offset from the keyframe, m.
    pub heights: Vec<f64>,
    /// N.
    pub forces: Vec<f64>,
}

/// Which entry of `qpos` and `qvel` is vertical: the third of the free joint of the root.
const VERTICAL: usize = 2;

/// How many heights are tried, over ±1 mm.
const HEIGHTS: usize = 2001;

impl SetPoint {
    /// Finds the set-point near a keyframe.
    pub fn near(data: &mut Data, keyframe: KeyframeId) -> Result<(Self, Sweep)> {
        // What force does it take to be at rest at the keyframe? The free joint has no motor, so a force on it is unphysical:
        // the feet are a little too deep in the floor, or not deep enough, to carry the weight.
        let at_keyframe = inverse_at(data, keyframe, 0.0)?;

        // The height at which the floor carries the weight.
        let heights: Vec<f64> = (0..HEIGHTS).map(|index| -1e-3 + 2e-3 * index as f64 / (HEIGHTS - 1) as f64).collect();
        let forces = heights
            .iter()
            .map(|&height| Ok(inverse_at(data, keyframe, height)?[VERTICAL]))
            .collect::<Result<Vec<f64>>>()?;
        let best = (0..HEIGHTS).min_by(|&a, &b| forces[a].abs().total_cmp(&forces[b].abs())).unwrap_or(0);
        let offset = heights[best];

        // The controls that bring the forces about: qfrc_actuator = momentᵀ · force, and a motor's force is its control. The
        // engine's rows are the columns of nalgebra's view, which therefore is momentᵀ.
        let wanted = inverse_at(data, keyframe, offset)?;
        let qpos = data.qpos().to_vec();
        let moment_transposed = data.actuator_moment().transposed().into_owned();
        let ctrl = moment_transposed
            .svd(true, true)
            .solve(&DVector::from_column_slice(&wanted), 1e-12)
            .expect("both factors were computed");
        data.ctrl_mut().copy_from_slice(ctrl.as_slice());

        // The check: these controls do bring the forces about, save those on the free joint.
        data.forward()?;
        let actual = data.qfrc_actuator().to_vec();
        let ctrl = ctrl.as_slice().to_vec();
        Ok((Self { qpos, ctrl, offset, at_keyframe, wanted, actual }, Sweep { heights, forces }))
    }

    /// Sets a simulation to it.
    pub fn apply(&self, data: &mut Data) -> Result<()> {
        data.reset()?;
        data.qpos_mut().copy_from_slice(&self.qpos);
        data.ctrl_mut().copy_from_slice(&self.ctrl);
        data.forward()
    }

    /// The largest difference between the forces that are wanted on the joints and those that the motors give.
    pub fn force_error(&self, joint_dofs: std::ops::Range<usize>) -> f64 {
        joint_dofs.map(|dof| (self.wanted[dof] - self.actual[dof]).abs()).fold(0.0, f64::max)
    }
}

/// The forces that hold the keyframe at rest, when it is moved up by `height`.
fn inverse_at(data: &mut Data, keyframe: KeyframeId, height: f64) -> Result<Vec<f64>> {
    data.reset_to_key(keyframe)?;
    data.forward()?;
    data.qacc_mut().fill(0.0);
    data.qpos_mut()[VERTICAL] += height;
    data.inverse()?;
    Ok(data.qfrc_inverse().to_vec())
}
