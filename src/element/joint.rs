//! Joints.

use std::ops::Range;

use super::{View, ViewMut};
use crate::data::Data;
use crate::enums::JointType;
use crate::ffi;
use crate::id::{BodyId, Id, kind};
use crate::model::{Model, ModelMut};

fields!(Joint on Model {
    /// Which motions the joint allows.
    joint_type: {JointType} = |joint| JointType::of_field(joint.owner.jnt_type()[joint.index()]);
    /// Where the joint's numbers are in `qpos`: 7 for a free joint, 4 for a ball, 1 for a slide or a hinge.
    #[doc(alias = "qposadr")]
    qpos_range: {Range<usize>} = |joint| {
        let start = ffi::size(joint.owner.jnt_qposadr()[joint.index()]);
        start..start + joint.joint_type().nq()
    };
    /// Where the joint's degrees of freedom are in `qvel` and everything else of length `nv`: 6 for a free joint, 3 for a ball, 1
    /// for a slide or a hinge. This is not the joint's index: behind a free joint the two differ by 5.
    #[doc(alias = "dofadr")]
    dofs: {Range<usize>} = |joint| {
        let start = ffi::size(joint.owner.jnt_dofadr()[joint.index()]);
        start..start + joint.joint_type().nv()
    };
    /// The body that the joint moves.
    body: {BodyId} = |joint| Id::new(ffi::size(joint.owner.jnt_bodyid()[joint.index()]), joint.owner.lineage());
    /// The group, for display.
    group: i32 = jnt_group;
    /// Whether [`range`](Self::range) is enforced.
    limited: {bool} = |joint| joint.owner.jnt_limited()[joint.index()] != 0;
    /// Where the joint is, m, in the frame of its body.
    pos: [f64; 3] = jnt_pos, pos_mut in jnt_pos_mut;
    /// Its axis, in the frame of its body.
    axis: [f64; 3] = jnt_axis, axis_mut in jnt_axis_mut;
    /// Stiffness of its spring, N/m or N·m/rad.
    stiffness: f64 = jnt_stiffness, set_stiffness in jnt_stiffness_mut;
    /// Its limits, m or rad.
    range: [f64; 2] = jnt_range, range_mut in jnt_range_mut;
    /// At which distance from a limit the limit becomes active.
    margin: f64 = jnt_margin, set_margin in jnt_margin_mut;
    /// Position in the reference configuration.
    qpos0: [f64] = qpos0 at qpos_range, qpos0_mut in qpos0_mut;
    /// Position at which its spring is at rest.
    qpos_spring: [f64] = qpos_spring at qpos_range, qpos_spring_mut in qpos_spring_mut;
    /// Inertia of the motor's rotor, kg or kg·m².
    armature: [f64] = dof_armature at dofs, armature_mut in dof_armature_mut;
    /// Damping, N·s/m or N·m·s/rad.
    damping: [f64] = dof_damping at dofs, damping_mut in dof_damping_mut;
    /// Dry friction, N or N·m.
    frictionloss: [f64] = dof_frictionloss at dofs, frictionloss_mut in dof_frictionloss_mut;
    /// The user's own numbers.
    user: [f64] = jnt_user, user_mut in jnt_user_mut;
});

fields!(Joint on Data {
    /// Position: metres, radians or a unit quaternion. See [`Data::qpos`].
    qpos: [f64] = qpos at qpos_range, qpos_mut in qpos_mut;
    /// Velocity, m/s or rad/s.
    qvel: [f64] = qvel at dofs, qvel_mut in qvel_mut;
    /// Acceleration, m/s² or rad/s².
    qacc: [f64] = qacc at dofs, qacc_mut in qacc_mut;
    /// Acceleration from which the solver starts.
    qacc_warmstart: [f64] = qacc_warmstart at dofs, qacc_warmstart_mut in qacc_warmstart_mut;
    /// Applied force, N or N·m: an input.
    qfrc_applied: [f64] = qfrc_applied at dofs, qfrc_applied_mut in qfrc_applied_mut;
    /// Gravity, Coriolis and centrifugal force, N or N·m.
    qfrc_bias: [f64] = qfrc_bias at dofs;
    /// Force of springs, dampers and the medium, N or N·m.
    qfrc_passive: [f64] = qfrc_passive at dofs;
    /// Force of the actuators, N or N·m.
    qfrc_actuator: [f64] = qfrc_actuator at dofs;
    /// All forces but those of constraints, N or N·m.
    qfrc_smooth: [f64] = qfrc_smooth at dofs;
    /// Force of the constraints, N or N·m.
    qfrc_constraint: [f64] = qfrc_constraint at dofs;
    /// Force that inverse dynamics found, N or N·m.
    qfrc_inverse: [f64] = qfrc_inverse at dofs;
    /// Where the joint is, m, world frame.
    xanchor: [f64; 3] = xanchor;
    /// Its axis, world frame.
    xaxis: [f64; 3] = xaxis;
});
