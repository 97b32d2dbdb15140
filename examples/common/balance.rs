//! Humanoid balancing on its left leg under LQR, as the example `humanoid_lqr` derives it step by
//! step.

#[path = "../humanoid_lqr/set_point.rs"]
pub mod set_point;
#[path = "../humanoid_lqr/weights.rs"]
pub mod weights;

use mujoco_safe::{Data, Lqr, Result, sample};

use set_point::SetPoint;
use weights::{Dofs, weights};

/// Creates the bundled humanoid at its set-point, together with the set-point and its regulator.
pub fn humanoid() -> Result<(Data, SetPoint, Lqr)> {
    let mut data = Data::new(sample::humanoid())?;
    let model = data.model().clone();
    let (torso, foot) = (model.body("torso")?, model.body("foot_left")?);
    let (set_point, _) = SetPoint::near(&mut data, model.keyframe("stand_on_left_leg")?.id())?;
    set_point.apply(&mut data)?;
    let weights = weights(&mut data, torso, foot, &Dofs::of(&model, torso, foot))?;
    let lqr = Lqr::at_present_state(&mut data, &weights)?;
    set_point.apply(&mut data)?;
    Ok((data, set_point, lqr))
}
