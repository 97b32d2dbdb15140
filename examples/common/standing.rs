//! The cost of a humanoid that stands, for plans over a receding horizon.

use std::sync::Arc;

use mujoco_safe::control::residual::{
    Controls, FrameOrientation, JointPosition, JointVelocity, ResidualCost, Subtree, Term,
};
use mujoco_safe::{Model, Result};

/// Targets of the cost, and those of its weights that depend on the motion.
pub struct Standing<'a> {
    /// Centre of mass, world frame, m.
    pub centre: [f64; 3],
    pub qpos: &'a [f64],
    pub ctrl: &'a [f64],
    /// Weight of the angular momentum.
    pub momentum: f64,
    /// Weight of the joint positions.
    pub posture: f64,
}

impl Standing<'_> {
    /// Returns the cost: position and velocity of the centre of mass, angular momentum, upright
    /// torso, posture, motion and effort.
    pub fn cost(&self, model: &Arc<Model>) -> Result<ResidualCost> {
        // The first six degrees of freedom are those of the free joint.
        let joints: Vec<f64> = (0..model.nv()).map(|dof| f64::from(u8::from(dof >= 6))).collect();
        let terms = [
            Term::new("com", Subtree::com(model, "torso")?.with_target(self.centre))
                .with_weight(100.0)
                .with_terminal_weight(1e3),
            Term::new("drift", Subtree::velocity(model, "torso")?).with_weight(10.0).with_terminal_weight(100.0),
            Term::new("momentum", Subtree::angular_momentum(model, "torso")?).with_weight(self.momentum),
            Term::new("upright", FrameOrientation::body(model, "torso")?).with_weight(5.0),
            Term::new("posture", JointPosition::all(model).with_target(self.qpos)?)
                .with_scales(joints)
                .with_weight(self.posture),
            Term::new("motion", JointVelocity::all(model)).with_weight(0.01),
            Term::new("effort", Controls::new(model).with_target(self.ctrl)?).with_weight(0.1),
        ];
        ResidualCost::new(model, terms)
    }
}
