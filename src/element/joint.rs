//! Joints.

#![allow(non_snake_case, reason = "M0, qLDiagInv: the engine's own spelling")]

use std::ops::Range;

use super::{View, ViewMut};
use crate::data::Data;
use crate::enums::JointType;
use crate::ffi;
use crate::id::{BodyId, kind};
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
    body: {BodyId} = |joint| joint.id_in(joint.owner.jnt_bodyid());
    /// The group, for display.
    group: i32 = jnt_group, set_group;
    /// Whether [`range`](Self::range) is enforced. A limit that was not compiled in has the range `[0, 0]` unless one is set.
    limited: bool = jnt_limited, set_limited;
    /// Time constant and damping ratio of its limit.
    #[doc(alias = "solreflimit")]
    solref: [f64; 2] = jnt_solref, solref_mut in jnt_solref_mut;
    /// Impedance of its limit.
    #[doc(alias = "solimplimit")]
    solimp: [f64; 5] = jnt_solimp, solimp_mut in jnt_solimp_mut;
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
    /// Time constant and damping ratio of the dry friction of each degree of freedom.
    #[doc(alias = "solreffriction")]
    dof_solref: [[f64; 2]] = dof_solref at dofs, dof_solref_mut in dof_solref_mut;
    /// Impedance of the dry friction of each degree of freedom.
    #[doc(alias = "solimpfriction")]
    dof_solimp: [[f64; 5]] = dof_solimp at dofs, dof_solimp_mut in dof_solimp_mut;
    /// Inverse inertia in the reference configuration.
    invweight0: [f64] = dof_invweight0 at dofs;
    /// Diagonal of the inertia matrix in the reference configuration.
    M0: [f64] = dof_M0 at dofs;
    /// The degree of freedom before its first one on the way to the world; each of its others follows the one before.
    #[doc(alias = "dof_parentid")]
    parent_dof: {Option<usize>} = |joint| usize::try_from(joint.owner.dof_parentid()[joint.dofs().start]).ok();
    /// Where the rows of its degrees of freedom begin in the packed inertia matrix `qM`.
    Madr: [i32] = dof_Madr at dofs;
    /// How many degrees of freedom from each on are of bodies whose part of the inertia matrix is diagonal.
    simplenum: [i32] = dof_simplenum at dofs;
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
    /// Acceleration without constraints, m/s² or rad/s².
    qacc_smooth: [f64] = qacc_smooth at dofs;
    /// Motion that each degree of freedom makes about the centre of mass of the tree: rotation, then translation.
    cdof: [[f64; 6]] = cdof at dofs;
    /// Time derivative of `cdof`.
    cdof_dot: [[f64; 6]] = cdof_dot at dofs;
    /// Inverse diagonal of the factorised inertia matrix.
    qLDiagInv: [f64] = qLDiagInv at dofs;
    /// Its square root.
    qLDiagSqrtInv: [f64] = qLDiagSqrtInv at dofs;
    /// Inverse diagonal of the inertia matrix that the integrator `Euler` factorises, with damping.
    qHDiagInv: [f64] = qHDiagInv at dofs;
    /// How many elements the rows of its degrees of freedom have in the sparse derivative `qDeriv`.
    D_rownnz: [i32] = D_rownnz at dofs;
    /// Where those rows begin.
    D_rowadr: [i32] = D_rowadr at dofs;
    /// Where the joint is, m, world frame.
    xanchor: [f64; 3] = xanchor;
    /// Its axis, world frame.
    xaxis: [f64; 3] = xaxis;
});
