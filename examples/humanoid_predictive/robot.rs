//! The robot standing on both feet, and its regulator.

use std::sync::Arc;

use mujoco_safe::{Data, Differences, Lqr, LqrWeights, Model, Result, sample};

use crate::set_point::SetPoint;
use crate::simulate::{PUSH_AT, Push};
use crate::weights::{Dofs, weights};

/// Force of a push, N. The regulator alone withstands 140 N along the main axes and 100 N along the
/// diagonals.
pub const NEWTONS: f64 = 180.0;
/// Duration of a push, s.
pub const PUSH_DURATION: f64 = 0.1;

pub struct Robot {
    pub model: Arc<Model>,
    pub set_point: SetPoint,
    /// Height of the centre of mass at the set-point, m.
    pub height: f64,
    pub lqr: Lqr,
}

impl Robot {
    /// Computes the set-point and the regulator.
    pub fn new() -> Result<Self> {
        let model = Arc::new(sample::humanoid());
        let mut data = Data::new(model.clone())?;
        let (set_point, _) = SetPoint::near(&mut data, model.keyframe("stand")?.id())?;
        set_point.apply(&mut data)?;
        let torso = model.body("torso")?;
        let height = data.body(torso).subtree_com()[2];

        // Sum the weights for both feet, each as in the example `humanoid_lqr`.
        let [left, right] = ["foot_left", "foot_right"].map(|foot| {
            let foot = model.body(foot)?;
            weights(&mut data, torso, foot, &Dofs::of(&model, torso, foot))
        });
        let (left, right) = (left?, right?);
        let cost = LqrWeights::new(left.q.to_nalgebra() + right.q.to_nalgebra(), left.r);
        let system = data.transition_fd(Lqr::EPS, Differences::Central)?;
        let solution = Lqr::solve(&system, &cost)?;
        let lqr = Lqr::with_gain(&data, solution.k)?;
        Ok(Self { model, set_point, height, lqr })
    }
}

/// Returns the push for a seed. Successive directions differ by the golden angle, so that all
/// directions are well separated.
pub fn push(newtons: f64, seed: u64) -> Push {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let angle = seed as f64 * GOLDEN_ANGLE;
    Push { force: [newtons * angle.cos(), newtons * angle.sin()], start: PUSH_AT, duration: PUSH_DURATION }
}
