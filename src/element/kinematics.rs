//! The kinematic tree: bodies and the joints between them.

#![allow(non_snake_case, reason = "M0, qLDiagInv: the engine's own spelling")]

use std::ops::Range;

use super::{View, ViewMut, range};
use crate::data::Data;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{BodyId, Ids};
use crate::kind;
use crate::model::{Model, ModelMut};

/// Value of `body_sameframe` for a body whose inertial frame equals its frame. Newer engines have
/// others for equal orientations.
const SAME_FRAME: u8 = 1;

/// # Methods of [`BodyMut`](super::BodyMut)
impl ViewMut<'_, ModelMut<'_>, kind::Body> {
    /// Sets `mass`, kg. The moments of inertia do not change, which suits a point mass.
    /// [`scale_mass`](Self::scale_mass) changes both, like a change of density.
    ///
    /// Call [`update_constants`](ModelMut::update_constants) afterwards. It updates the quantities
    /// derived from masses: `body_subtreemass`, `body_invweight0`, `dof_invweight0`,
    /// `tendon_invweight0`, `actuator_acc0`, and the means in
    /// [`Statistics`](crate::model::Statistics).
    pub fn set_mass(&mut self, mass: f64) {
        self.owner.body_mass_mut()[self.id.index()] = mass;
    }

    /// Multiplies `mass` and `inertia` by a factor, like a change of the density of all geoms of
    /// the body. The centre of mass, the axes of inertia and the bodies below do not change.
    ///
    /// Call [`update_constants`](ModelMut::update_constants) afterwards, as for
    /// [`set_mass`](Self::set_mass).
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the factor is positive and finite, and the new mass and inertia
    /// are finite. The model is unchanged after an error.
    ///
    /// ```
    /// use mujoco_safe::sample;
    ///
    /// let mut model = sample::cartpole();
    /// let (mass, inertia) = (model.body("pole")?.mass(), *model.body("pole")?.inertia());
    /// let mut edit = model.edit();
    /// edit.body_mut("pole")?.scale_mass(2.0)?;
    /// edit.update_constants()?;
    /// assert_eq!(model.body("pole")?.mass(), 2.0 * mass);
    /// assert_eq!(*model.body("pole")?.inertia(), inertia.map(|moment| 2.0 * moment));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn scale_mass(&mut self, factor: f64) -> Result<()> {
        let index = self.id.index();
        let (mass, inertia) = (self.owner.body_mass()[index], self.owner.body_inertia()[index]);
        let is_valid = factor.is_finite() && factor > 0.0;
        let (mass, inertia) = (mass * factor, inertia.map(|moment| moment * factor));
        if !is_valid || !mass.is_finite() || inertia.iter().any(|moment| !moment.is_finite()) {
            let expected = "positive and finite, and leave mass and inertia finite";
            return Err(Error::out_of_range(format!("the factor for the mass of {self:?}"), factor, expected));
        }
        self.owner.body_mass_mut()[index] = mass;
        self.owner.body_inertia_mut()[index] = inertia;
        Ok(())
    }
}

/// # Methods of [`BodyDataMut`](super::BodyDataMut)
impl ViewMut<'_, Data, kind::Body> {
    /// Returns a mutable reference to `mocap_pos`.
    pub fn mocap_pos_mut(&mut self) -> Option<&mut [f64; 3]> {
        let mocap = self.view().in_model().mocap()?;
        Some(&mut self.owner.mocap_pos_mut()[mocap])
    }

    /// Returns a mutable reference to `mocap_quat`.
    pub fn mocap_quat_mut(&mut self) -> Option<&mut [f64; 4]> {
        let mocap = self.view().in_model().mocap()?;
        Some(&mut self.owner.mocap_quat_mut()[mocap])
    }
}

fields!(Body on Model {
    /// Parent in the kinematic tree; the world for the world itself.
    parent: {BodyId} = |body| body.id_in(body.owner.body_parentid());
    /// Root of the kinematic tree that contains the body: its ancestor directly below the world.
    root: {BodyId} = |body| body.id_in(body.owner.body_rootid());
    /// Nearest body with joints on the path to the world, starting with the body itself. The body
    /// is rigidly attached to it.
    #[doc(alias = "weldid")]
    weld: {BodyId} = |body| body.id_in(body.owner.body_weldid());
    /// Number of joints between the body and its parent.
    njnt: {usize} = |body| ffi::size(body.owner.body_jntnum()[body.index()]);
    /// Number of geoms attached to the body.
    ngeom: {usize} = |body| ffi::size(body.owner.body_geomnum()[body.index()]);
    /// Joints between the body and its parent.
    #[doc(alias = "jntadr")]
    joints: {Ids<kind::Joint>} = |body| body.ids_in(body.owner.body_jntadr(), body.owner.body_jntnum());
    /// Geoms attached to the body.
    #[doc(alias = "geomadr")]
    geoms: {Ids<kind::Geom>} = |body| body.ids_in(body.owner.body_geomadr(), body.owner.body_geomnum());
    /// Range of its degrees of freedom in `qvel` and every other array of length `nv`.
    dofs: {Range<usize>} = |body| range(body.owner.body_dofadr(), body.owner.body_dofnum(), body.index());
    /// Returns `true` if its block of the inertia matrix is diagonal, so that the engine skips part
    /// of the computation.
    simple: bool = body_simple;
    /// Returns `true` if the inertial frame coincides with the body frame.
    sameframe: {bool} = |body| body.owner.body_sameframe()[body.index()] == SAME_FRAME;
    /// Index among the mocap bodies; `None` for other bodies.
    #[doc(alias = "mocapid")]
    mocap: {Option<usize>} = |body| usize::try_from(body.owner.body_mocapid()[body.index()]).ok();
    /// Position in the frame of the parent, m.
    pos: [f64; 3] = body_pos, pos_mut in body_pos_mut;
    /// Orientation in the frame of the parent: a unit quaternion `[w, x, y, z]`.
    quat: [f64; 4] = body_quat, quat_mut in body_quat_mut;
    /// Centre of mass in the body frame, m.
    ipos: [f64; 3] = body_ipos, ipos_mut in body_ipos_mut;
    /// Orientation of the inertial frame in the body frame: a unit quaternion `[w, x, y, z]`.
    iquat: [f64; 4] = body_iquat, iquat_mut in body_iquat_mut;
    /// Mass, kg.
    mass: f64 = body_mass;
    /// Mass of the subtree that starts at the body, kg. Derived from the masses.
    subtreemass: f64 = body_subtreemass;
    /// Principal moments of inertia, along the axes of the inertial frame, kg·m².
    inertia: [f64; 3] = body_inertia, inertia_mut in body_inertia_mut;
    /// Mean inverse inertia in the reference configuration: translation, rotation.
    invweight0: [f64; 2] = body_invweight0;
    /// User data.
    user: [f64] = body_user, user_mut in body_user_mut;
});

fields!(Body on Data {
    /// Applied force, N, and torque, N·m, at the centre of mass, world frame: an input.
    #[doc(alias = "applied")]
    xfrc_applied: [f64; 6] = xfrc_applied, xfrc_applied_mut in xfrc_applied_mut;
    /// Returns `true` if the engine leaves out the body because it is at rest. Only in models with
    /// the option `sleep`, since 3.4.
    is_asleep: {bool} = |body| body.owner.is_asleep(body.index());
    /// Position, m, world frame.
    xpos: [f64; 3] = xpos;
    /// Orientation: a unit quaternion `[w, x, y, z]`, world frame.
    xquat: [f64; 4] = xquat;
    /// Orientation as a row-major rotation matrix, world frame.
    xmat: [f64; 9] = xmat;
    /// Centre of mass, m, world frame.
    xipos: [f64; 3] = xipos;
    /// Orientation of the inertial frame as a row-major rotation matrix, world frame.
    ximat: [f64; 9] = ximat;
    /// Centre of mass of the subtree that starts at the body, m, world frame.
    #[doc(alias = "com")]
    subtree_com: [f64; 3] = subtree_com;
    /// Inertia and mass about the centre of mass of the kinematic tree.
    cinert: [f64; 10] = cinert;
    /// Composite rigid body inertia: inertia and mass of the subtree about the centre of mass of
    /// the kinematic tree.
    crb: [f64; 10] = crb;
    /// Spatial velocity about the centre of mass of the kinematic tree: angular, then linear.
    cvel: [f64; 6] = cvel;
    /// Linear velocity of the subtree's centre of mass, m/s. [`Data::subtree_vel`] computes it;
    /// `forward` and `step` do not.
    #[doc(alias = "linvel")]
    subtree_linvel: [f64; 3] = subtree_linvel after SUBTREE_VEL;
    /// Angular momentum of the subtree about its centre of mass, kg·m²/s. [`Data::subtree_vel`]
    /// computes it; `forward` and `step` do not.
    #[doc(alias = "angmom")]
    subtree_angmom: [f64; 3] = subtree_angmom after SUBTREE_VEL;
    /// Spatial acceleration about the centre of mass of the kinematic tree: angular, then linear.
    /// [`Data::rne_post_constraint`] computes it; `forward` and `step` do not.
    cacc: [f64; 6] = cacc after POST_CONSTRAINT;
    /// Spatial force between the body and its parent: torque, then force.
    /// [`Data::rne_post_constraint`] computes it; `forward` and `step` do not.
    #[doc(alias = "int")]
    cfrc_int: [f64; 6] = cfrc_int after POST_CONSTRAINT;
    /// External spatial force on the body: torque, then force. [`Data::rne_post_constraint`]
    /// computes it; `forward` and `step` do not.
    ///
    /// ```
    /// use mujoco_safe::{Data, Error, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.reset_to_key("squat")?;
    /// data.step()?;
    /// // The array holds zeros, although the feet touch the floor.
    /// assert!(matches!(data.body("foot_left")?.cfrc_ext(), Err(Error::NotComputed { .. })));
    /// data.rne_post_constraint()?;
    /// assert!(data.body("foot_left")?.cfrc_ext()?[5] > 0.0);
    /// # Ok::<(), Error>(())
    /// ```
    #[doc(alias = "ext")]
    cfrc_ext: [f64; 6] = cfrc_ext after POST_CONSTRAINT;
    /// Prescribed position of a mocap body, m, world frame: an input. `None` for other bodies.
    mocap_pos: {Option<&'a [f64; 3]>} = |body| Some(&body.owner.mocap_pos()[body.in_model().mocap()?]);
    /// Prescribed orientation of a mocap body, a unit quaternion `[w, x, y, z]`: an input. `None`
    /// for other bodies.
    mocap_quat: {Option<&'a [f64; 4]>} = |body| Some(&body.owner.mocap_quat()[body.in_model().mocap()?]);
});

/// # Methods of [`JointData`](super::JointData)
impl<'a> View<'a, Data, kind::Joint> {
    /// Returns the orientation of a free or ball joint, a unit quaternion `[w, x, y, z]`: the last
    /// four values of [`qpos`](Self::qpos). `None` for a slide or a hinge.
    ///
    /// ```
    /// use mujoco_safe::{Data, math, sample};
    ///
    /// let data = Data::new(sample::humanoid())?;
    /// let quat = data.joint("root")?.quat().expect("a free joint");
    /// assert_eq!(math::rot_vec_quat(&[0.0, 0.0, 1.0], quat), [0.0, 0.0, 1.0]); // upright
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[inline]
    pub fn quat(&self) -> Option<&'a [f64; 4]> {
        self.qpos().last_chunk()
    }
}

/// # Methods of [`JointDataMut`](super::JointDataMut)
impl ViewMut<'_, Data, kind::Joint> {
    /// Returns a mutable reference to `quat`, the orientation of a free or ball joint. `None` for a
    /// slide or a hinge.
    ///
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    /// use mujoco_safe::{Data, math, sample};
    ///
    /// // Turn the humanoid by a quarter about the vertical.
    /// let mut data = Data::new(sample::humanoid())?;
    /// let mut root = data.joint_mut("root")?;
    /// math::quat_integrate(root.quat_mut().expect("a free joint"), &[0.0, 0.0, FRAC_PI_2], 1.0);
    /// data.forward()?;
    /// assert!((data.body("torso")?.xmat()[3] - 1.0).abs() < 1e-12); // its x axis points along y
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[inline]
    pub fn quat_mut(&mut self) -> Option<&mut [f64; 4]> {
        self.qpos_mut().last_chunk_mut()
    }
}

fields!(Joint on Model {
    /// Type of the joint.
    joint_type: {JointType} = |joint| JointType::of_field(joint.owner.jnt_type()[joint.index()]);
    /// Range of the joint's positions in `qpos`: 7 for a free joint, 4 for a ball, 1 for a slide or
    /// a hinge.
    #[doc(alias = "qposadr")]
    qpos_range: {Range<usize>} = |joint| {
        let start = ffi::size(joint.owner.jnt_qposadr()[joint.index()]);
        start..start + joint.joint_type().nq()
    };
    /// Range of the joint's degrees of freedom in `qvel` and every other array of length `nv`: 6
    /// for a free joint, 3 for a ball, 1 for a slide or a hinge. This is not the joint's index:
    /// after a free joint the two differ by 5.
    #[doc(alias = "dofadr")]
    dofs: {Range<usize>} = |joint| {
        let start = ffi::size(joint.owner.jnt_dofadr()[joint.index()]);
        start..start + joint.joint_type().nv()
    };
    /// Body that the joint moves.
    body: {BodyId} = |joint| joint.id_in(joint.owner.jnt_bodyid());
    /// Visualisation group.
    group: i32 = jnt_group, set_group;
    /// Returns `true` if [`range`](Self::range) is enforced. A joint compiled without a limit has
    /// the range `[0, 0]` until one is set.
    limited: bool = jnt_limited, set_limited;
    /// Solver reference parameters of the limit: time constant and damping ratio.
    #[doc(alias = "solreflimit")]
    solref: [f64; 2] = jnt_solref, solref_mut in jnt_solref_mut;
    /// Solver impedance parameters of the limit.
    #[doc(alias = "solimplimit")]
    solimp: [f64; 5] = jnt_solimp, solimp_mut in jnt_solimp_mut;
    /// Anchor of the joint in the body frame, m.
    pos: [f64; 3] = jnt_pos, pos_mut in jnt_pos_mut;
    /// Axis in the body frame.
    axis: [f64; 3] = jnt_axis, axis_mut in jnt_axis_mut;
    /// Stiffness of the spring, N/m or N·m/rad.
    stiffness: f64 = jnt_stiffness, set_stiffness in jnt_stiffness_mut;
    /// Limits, m or rad.
    range: [f64; 2] = jnt_range, range_mut in jnt_range_mut;
    /// Distance from a limit at which the limit constraint becomes active.
    margin: f64 = jnt_margin, set_margin in jnt_margin_mut;
    /// Position in the reference configuration.
    qpos0: [f64] = qpos0 at qpos_range, qpos0_mut in qpos0_mut;
    /// Rest position of the spring.
    qpos_spring: [f64] = qpos_spring at qpos_range, qpos_spring_mut in qpos_spring_mut;
    /// Armature: inertia of the motor's rotor, kg or kg·m².
    armature: [f64] = dof_armature at dofs, armature_mut in dof_armature_mut;
    /// Damping, N·s/m or N·m·s/rad.
    damping: [f64] = dof_damping at dofs, damping_mut in dof_damping_mut;
    /// Dry friction, N or N·m.
    frictionloss: [f64] = dof_frictionloss at dofs, frictionloss_mut in dof_frictionloss_mut;
    /// Solver reference parameters of the dry friction of each degree of freedom: time constant and
    /// damping ratio.
    #[doc(alias = "solreffriction")]
    dof_solref: [[f64; 2]] = dof_solref at dofs, dof_solref_mut in dof_solref_mut;
    /// Solver impedance parameters of the dry friction of each degree of freedom.
    #[doc(alias = "solimpfriction")]
    dof_solimp: [[f64; 5]] = dof_solimp at dofs, dof_solimp_mut in dof_solimp_mut;
    /// Inverse inertia in the reference configuration.
    invweight0: [f64] = dof_invweight0 at dofs;
    /// Diagonal of the inertia matrix in the reference configuration.
    M0: [f64] = dof_M0 at dofs;
    /// Parent of its first degree of freedom in the kinematic tree. The parent of each further
    /// degree of freedom is the previous one.
    #[doc(alias = "dof_parentid")]
    parent_dof: {Option<usize>} = |joint| usize::try_from(joint.owner.dof_parentid()[joint.dofs().start]).ok();
    /// Offsets of the rows of its degrees of freedom in the packed inertia matrix `qM`.
    Madr: [i32] = dof_Madr at dofs;
    /// For each of its degrees of freedom, the length of the run of consecutive degrees of freedom
    /// that starts there and whose bodies have a diagonal block of the inertia matrix.
    simplenum: [i32] = dof_simplenum at dofs;
    /// User data.
    user: [f64] = jnt_user, user_mut in jnt_user_mut;
});

fields!(Joint on Data {
    /// Position: metres, radians or a unit quaternion. See [`Data::qpos`].
    qpos: [f64] = qpos at qpos_range, qpos_mut in qpos_mut;
    /// Velocity, m/s or rad/s.
    qvel: [f64] = qvel at dofs, qvel_mut in qvel_mut;
    /// Acceleration, m/s² or rad/s².
    qacc: [f64] = qacc at dofs, qacc_mut in qacc_mut;
    /// Initial guess of the constraint solver for the acceleration.
    qacc_warmstart: [f64] = qacc_warmstart at dofs, qacc_warmstart_mut in qacc_warmstart_mut;
    /// Applied force, N or N·m: an input.
    qfrc_applied: [f64] = qfrc_applied at dofs, qfrc_applied_mut in qfrc_applied_mut;
    /// Gravity, Coriolis and centrifugal force, N or N·m.
    qfrc_bias: [f64] = qfrc_bias at dofs;
    /// Passive force of springs, dampers and the medium, N or N·m.
    qfrc_passive: [f64] = qfrc_passive at dofs;
    /// Actuator force, N or N·m.
    qfrc_actuator: [f64] = qfrc_actuator at dofs;
    /// Sum of all forces except constraint forces, N or N·m.
    qfrc_smooth: [f64] = qfrc_smooth at dofs;
    /// Constraint force, N or N·m.
    qfrc_constraint: [f64] = qfrc_constraint at dofs;
    /// Result of inverse dynamics, N or N·m.
    qfrc_inverse: [f64] = qfrc_inverse at dofs;
    /// Acceleration without constraints, m/s² or rad/s².
    qacc_smooth: [f64] = qacc_smooth at dofs;
    /// Spatial motion axis of each degree of freedom about the centre of mass of the kinematic
    /// tree: angular, then linear.
    cdof: [[f64; 6]] = cdof at dofs;
    /// Time derivative of `cdof`.
    cdof_dot: [[f64; 6]] = cdof_dot at dofs;
    /// Inverse diagonal of the factorised inertia matrix.
    qLDiagInv: [f64] = qLDiagInv at dofs;
    /// Inverse diagonal of the damped inertia matrix that the integrator `Euler` factorises.
    qHDiagInv: [f64] = qHDiagInv at dofs;
    /// Anchor, m, world frame.
    xanchor: [f64; 3] = xanchor;
    /// Axis, world frame.
    xaxis: [f64; 3] = xaxis;
});
