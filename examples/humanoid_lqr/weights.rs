//! Cost weights for balancing on one leg.

use std::ops::Range;

use mujoco_safe::element::{Body, Joint};
use mujoco_safe::enums::JointType;
use mujoco_safe::id::BodyId;
use mujoco_safe::nalgebra::DMatrix;
use mujoco_safe::{Data, LqrWeights, Matrix, Model, Result};

/// Weight of the centre of mass relative to the foot. It dominates: the deviation is in metres,
/// those of joints in radians.
const BALANCE: f64 = 1000.0;
/// Weight of the joints between torso and foot.
const BALANCE_JOINT: f64 = 3.0;
/// Weight of the other joints.
const OTHER_JOINT: f64 = 0.3;
/// Small weight on the whole state, which makes its cost positive definite.
const REGULARISATION: f64 = 1e-10;

/// Classification of the degrees of freedom.
#[derive(Clone, Debug)]
pub struct Dofs {
    /// Free joint of the root, which has no motor.
    pub free: Range<usize>,
    /// Joints between the torso and the foot.
    pub balance: Vec<usize>,
    /// All other joints.
    pub other: Vec<usize>,
}

impl Dofs {
    /// Classifies the degrees of freedom. Uses `dofs()`, because joint ids differ from it by 5
    /// after the free joint.
    pub fn of(model: &Model, torso: Body<'_>, foot: Body<'_>) -> Self {
        let is_free = |joint: &Joint<'_>| joint.joint_type() == JointType::Free;
        let free = model.joints().find(is_free).map_or(0..0, |joint| joint.dofs());
        let chain = chain(model, torso.id(), foot.id());
        let mut balance: Vec<usize> =
            chain.iter().flat_map(|&body| model.body(body).dofs()).filter(|dof| !free.contains(dof)).collect();
        balance.sort_unstable();
        let other = (0..model.nv()).filter(|dof| !free.contains(dof) && !balance.contains(dof)).collect();
        Self { free, balance, other }
    }
}

/// Returns the bodies from the foot up to the torso, excluding the torso.
fn chain(model: &Model, torso: BodyId, foot: BodyId) -> Vec<BodyId> {
    let mut chain = Vec::new();
    let mut body = foot;
    while body != torso && body.index() != 0 {
        chain.push(body);
        body = model.body(body).parent();
    }
    chain
}

/// Computes the weights at the present state of `data`.
pub fn weights(data: &mut Data, torso: Body<'_>, foot: Body<'_>, dofs: &Dofs) -> Result<LqrWeights> {
    // Jacobian of the centre of mass relative to the foot.
    let com = data.jac_subtree_com(torso)?;
    let foot = data.jac_body_com(foot)?.linear;
    let difference = com.to_nalgebra() - foot.to_nalgebra();
    let balance = difference.tr_mul(&difference);

    let (nv, nu, nx) = (data.model().nv(), data.model().nu(), 2 * data.model().nv() + data.model().na());
    let mut position = balance * BALANCE;
    for &dof in &dofs.balance {
        position[(dof, dof)] += BALANCE_JOINT;
    }
    for &dof in &dofs.other {
        position[(dof, dof)] += OTHER_JOINT;
    }
    let mut q = DMatrix::identity(nx, nx) * REGULARISATION;
    let mut block = q.view_mut((0, 0), (nv, nv));
    block += position;
    Ok(LqrWeights::new(q, Matrix::identity(nu)))
}
