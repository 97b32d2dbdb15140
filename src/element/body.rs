//! Bodies.

use std::ops::Range;

use super::{View, ViewMut, range};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{BodyId, Ids, kind};
use crate::model::{Model, ModelMut};

fields!(Body on Model {
    /// The body that this one is attached to; the world for the world itself.
    parent: {BodyId} = |body| body.id_in(body.owner.body_parentid());
    /// The body below the world that this one is attached to, over however many others.
    root: {BodyId} = |body| body.id_in(body.owner.body_rootid());
    /// The body that this one moves with: the next towards the world that has joints, itself if it has some.
    #[doc(alias = "weldid")]
    weld: {BodyId} = |body| body.id_in(body.owner.body_weldid());
    /// How many joints move it against its parent.
    njnt: {usize} = |body| ffi::size(body.owner.body_jntnum()[body.index()]);
    /// How many geoms it has.
    ngeom: {usize} = |body| ffi::size(body.owner.body_geomnum()[body.index()]);
    /// The joints that move it against its parent.
    #[doc(alias = "jntadr")]
    joints: {Ids<kind::Joint>} = |body| body.ids_in(body.owner.body_jntadr(), body.owner.body_jntnum());
    /// Its geoms.
    #[doc(alias = "geomadr")]
    geoms: {Ids<kind::Geom>} = |body| body.ids_in(body.owner.body_geomadr(), body.owner.body_geomnum());
    /// Where its degrees of freedom are in `qvel` and everything else of length `nv`.
    dofs: {Range<usize>} = |body| range(body.owner.body_dofadr(), body.owner.body_dofnum(), body.index());
    /// Whether its part of the inertia matrix is diagonal, so that the engine need not compute it.
    simple: bool = body_simple;
    /// Whether its inertial frame is its own frame.
    sameframe: bool = body_sameframe;
    /// Its index among the mocap bodies, if it is one.
    #[doc(alias = "mocapid")]
    mocap: {Option<usize>} = |body| usize::try_from(body.owner.body_mocapid()[body.index()]).ok();
    /// Position in the frame of the parent, m.
    pos: [f64; 3] = body_pos, pos_mut in body_pos_mut;
    /// Orientation in the frame of the parent: a unit quaternion `[w, x, y, z]`.
    quat: [f64; 4] = body_quat, quat_mut in body_quat_mut;
    /// Centre of mass, m, in the body's own frame.
    ipos: [f64; 3] = body_ipos, ipos_mut in body_ipos_mut;
    /// Orientation of the inertial frame in the body's own: a unit quaternion `[w, x, y, z]`.
    iquat: [f64; 4] = body_iquat, iquat_mut in body_iquat_mut;
    /// Mass, kg.
    mass: f64 = body_mass;
    /// Mass of the body and everything below it, kg. Derived from the masses.
    subtreemass: f64 = body_subtreemass;
    /// Moments of inertia along the axes of the inertial frame, kg·m².
    inertia: [f64; 3] = body_inertia, inertia_mut in body_inertia_mut;
    /// Mean inverse inertia in the reference configuration: translation, rotation.
    invweight0: [f64; 2] = body_invweight0;
    /// The user's own numbers.
    user: [f64] = body_user, user_mut in body_user_mut;
});

fields!(Body on Data {
    /// Applied force, N, and torque, N·m, at the centre of mass, world frame: an input.
    #[doc(alias = "applied")]
    xfrc_applied: [f64; 6] = xfrc_applied, xfrc_applied_mut in xfrc_applied_mut;
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
    /// Centre of mass of the body and everything below it, m, world frame.
    #[doc(alias = "com")]
    subtree_com: [f64; 3] = subtree_com;
    /// Inertia and mass, about the centre of mass of the tree.
    cinert: [f64; 10] = cinert;
    /// Inertia and mass of the body and everything below it, about the centre of mass of the tree.
    crb: [f64; 10] = crb;
    /// Velocity about the centre of mass of the tree: rotation, then translation.
    cvel: [f64; 6] = cvel;
    /// Linear velocity of the subtree's centre of mass, m/s. [`Data::subtree_vel`] computes it; `forward` and `step` do not.
    #[doc(alias = "linvel")]
    subtree_linvel: [f64; 3] = subtree_linvel after SUBTREE_VEL;
    /// Angular momentum of the subtree about its centre of mass, kg·m²/s. [`Data::subtree_vel`] computes it; `forward` and `step`
    /// do not.
    #[doc(alias = "angmom")]
    subtree_angmom: [f64; 3] = subtree_angmom after SUBTREE_VEL;
    /// Acceleration about the centre of mass of the tree: rotation, then translation. [`Data::rne_post_constraint`] computes it;
    /// `forward` and `step` do not.
    cacc: [f64; 6] = cacc after POST_CONSTRAINT;
    /// Force between the body and its parent: torque, then force. [`Data::rne_post_constraint`] computes it; `forward` and `step`
    /// do not.
    #[doc(alias = "int")]
    cfrc_int: [f64; 6] = cfrc_int after POST_CONSTRAINT;
    /// External force on the body: torque, then force. [`Data::rne_post_constraint`] computes it; `forward` and `step` do not.
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
    /// Position that a mocap body is given, m, world frame: an input. `None` if it is not one.
    mocap_pos: {Option<&'a [f64; 3]>} = |body| Some(&body.owner.mocap_pos()[body.in_model().mocap()?]);
    /// Orientation that a mocap body is given: a unit quaternion `[w, x, y, z]`, and an input. `None` if it is not one.
    mocap_quat: {Option<&'a [f64; 4]>} = |body| Some(&body.owner.mocap_quat()[body.in_model().mocap()?]);
});

impl ViewMut<'_, ModelMut<'_>, kind::Body> {
    /// Sets `mass`, kg. The moments of inertia stay as they are, which suits a point mass: [`scale_mass`](Self::scale_mass)
    /// changes both, as another density does.
    ///
    /// Call [`update_constants`](ModelMut::update_constants) afterwards, for what is derived from masses: `body_subtreemass`,
    /// `body_invweight0`, `dof_invweight0`, `tendon_invweight0`, `actuator_acc0`, and the means in
    /// [`Statistics`](crate::Statistics).
    pub fn set_mass(&mut self, mass: f64) {
        self.owner.body_mass_mut()[self.id.index()] = mass;
    }

    /// Multiplies `mass` and `inertia` by a factor, which is what another density of all the body's geoms does. The centre of
    /// mass and the axes of inertia stay as they are, and so do the bodies below.
    ///
    /// Call [`update_constants`](ModelMut::update_constants) afterwards, as for [`set_mass`](Self::set_mass).
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the factor is positive and finite, and the mass and inertia with it finite. Nothing is changed
    /// then.
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
            return Err(Error::invalid(format!("the factor for the mass of {self:?}"), factor, expected));
        }
        self.owner.body_mass_mut()[index] = mass;
        self.owner.body_inertia_mut()[index] = inertia;
        Ok(())
    }
}

impl ViewMut<'_, Data, kind::Body> {
    /// `mocap_pos`, to be written to.
    pub fn mocap_pos_mut(&mut self) -> Option<&mut [f64; 3]> {
        let mocap = self.as_view().in_model().mocap()?;
        Some(&mut self.owner.mocap_pos_mut()[mocap])
    }

    /// `mocap_quat`, to be written to.
    pub fn mocap_quat_mut(&mut self) -> Option<&mut [f64; 4]> {
        let mocap = self.as_view().in_model().mocap()?;
        Some(&mut self.owner.mocap_quat_mut()[mocap])
    }
}
