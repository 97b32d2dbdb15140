//! What a deviation costs.

use std::ops::Range;

use mujoco_safe::element::{Body, Joint};
use mujoco_safe::nalgebra::DMatrix;
use mujoco_safe::{BodyId, Data, JointType, LqrWeights, Model, Result};

/// Keeping the centre of mass over the foot counts most. It is in metres, and the joints are in radians.
const BALANCE: f64 = 1000.0;
/// The joints between the torso and the foot may move a little.
const BALANCE_JOINT: f64 = 3.0;
/// The other joints may do what they like.
const OTHER_JOINT: f64 = 0.3;
/// Makes the cost of the state positive definite.
const ALMOST_NOTHING: f64 = 1e-10;

/// Which degrees of freedom are what.
#[derive(Clone, Debug)]
pub struct Dofs {
    /// The free joint of the root, which has no motor.
    pub free: Range<usize>,
    /// The joints on the way from the torso to the foot.
    pub balance: Vec<usize>,
    /// The rest.
    pub other: Vec<usize>,
}

impl Dofs {
    /// Sorts them. By `dofs()`, not by joint ids: behind the free joint the two differ by 5.
    pub fn of(model: &Model, torso: Body<'_>, foot: Body<'_>) -> Self {
        let is_free = |joint: &Joint<'_>| joint.joint_type() == JointType::Free;
        let free = model.joints().find(is_free).map_or(0..0, |joint| joint.dofs());
        let way = way(model, torso.id(), foot.id());
        let mut balance: Vec<usize> =
            way.iter().flat_map(|&body| model.body(body).dofs()).filter(|dof| !free.contains(dof)).collect();
        balance.sort_unstable();
        let other = (0..model.nv()).filter(|dof| !free.contains(dof) && !balance.contains(dof)).collect();
        Self { free, balance, other }
    }
}

/// The bodies from the foot up to the torso, without the torso.
fn way(model: &Model, torso: BodyId, foot: BodyId) -> Vec<BodyId> {
    let mut way = Vec::new();
    let mut body = foot;
    while body != torso && body.index() != 0 {
        way.push(body);
        body = model.body(body).parent();
    }
    way
}

/// The weights at the present state of `data`.
pub fn weights(data: &mut Data, torso: Body<'_>, foot: Body<'_>, dofs: &Dofs) -> Result<LqrWeights> {
    // How the centre of mass moves against the foot.
    let com = data.jac_subtree_com(torso)?;
    let foot = data.jac_body_com(foot)?.translation;
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
    let mut q = DMatrix::identity(nx, nx) * ALMOST_NOTHING;
    let mut block = q.view_mut((0, 0), (nv, nv));
    block += position;
    Ok(LqrWeights { q, r: DMatrix::identity(nu, nu), s: None })
}
