//! Equality constraints that are switched during a simulation: grasps.

use mujoco_sys as sys;

use super::Data;
use crate::enums::EqualityType;
use crate::error::{Error, InvalidKind, Result};
use crate::ffi;
use crate::id::IntoId;
use crate::kind;
use crate::math::{mul_quat, neg_quat, rot_vec_quat};
use crate::model::Model;

/// Number of parameters of a constraint.
const PARAMETERS: usize = sys::mjNEQDATA as usize;

/// # Equality constraints
impl Data {
    /// Sets a constraint of the type weld or connect to the present relative pose of its bodies,
    /// and activates it: a gripper grasps an object.
    /// [`set_equality_active`](Self::set_equality_active) releases it.
    ///
    /// Welds: the relative pose becomes that of the bodies in the present positions. The anchor in
    /// the second body and the scale of torques stay. Connections: the anchor in the first body
    /// stays, and that in the second body becomes the same point. The call computes the poses of
    /// the present state first, also of mocap bodies.
    ///
    /// Both are parameters of the model: a shared model is copied first, as in
    /// [`edit_model`](Self::edit_model), so other simulations do not change. They remain until the
    /// next such call or edit, also after a reset, and
    /// [`update_constants`](crate::ModelMut::update_constants) replaces the second anchor of
    /// connections by that of `qpos0`. All results count as not computed afterwards.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::Invalid`] for a
    /// constraint of another type and for poses that are not finite, [`Error::Unstable`] for an
    /// invalid position, [`Error::Unsupported`] for a constraint of two sites, which has no
    /// parameters, because the engine makes the sites coincide, and the errors of
    /// [`edit_model`](Self::edit_model).
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::{Data, Model};
    ///
    /// let model = Model::from_xml_str(
    ///     r#"<mujoco>
    ///          <worldbody>
    ///            <geom type="plane" size="1 1 0.1"/>
    ///            <body name="hand" mocap="true" pos="0 0 0.3"/>
    ///            <body name="cube" pos="0 0 0.05"><freejoint/><geom type="box" size="0.05 0.05 0.05"/></body>
    ///          </worldbody>
    ///          <equality><weld name="grasp" body1="hand" body2="cube" active="false"/></equality>
    ///        </mujoco>"#,
    /// )?;
    /// let mut data = Data::new(model)?;
    /// data.weld_at_present_pose("grasp")?;
    /// for _ in 0..500 {
    ///     data.mocap_pos_mut()[0][2] += 0.001;                  // the hand rises by half a metre
    ///     data.step()?;
    /// }
    /// data.step_n(500)?;
    /// assert!((data.body("cube")?.xpos()[2] - 0.55).abs() < 0.01);
    /// data.set_equality_active("grasp", false)?;
    /// data.step_n(500)?;
    /// assert!((data.body("cube")?.xpos()[2] - 0.05).abs() < 0.01); // on the floor again
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "relpose")]
    #[doc(alias = "eq_data")]
    pub fn weld_at_present_pose(&mut self, equality: impl IntoId<kind::Equality>) -> Result<()> {
        let id = equality.id_in(&**self.model())?;
        let equality = id.index();
        self.model().check_has_pose(equality)?;
        self.kinematics()?;
        let parameters = self.at_present_pose(equality);
        if let Some(value) = parameters.iter().find(|value| !value.is_finite()) {
            let constraint = self.model().described(kind::Kind::Equality, equality);
            return Err(Error::not_finite(format!("the relative pose of the bodies of {constraint}"), value));
        }
        self.edit_model(|model| model.equality_mut(id).data_mut().copy_from_slice(&parameters))?;
        self.set_equality_active(id, true)
    }

    /// Activates an equality constraint, or releases it. As an edit of the model
    /// ([`EqualityMut::set_active`](crate::element::EqualityMut)), which is copied first if it is
    /// shared; with engines from 3.0 also in this simulation. All results count as not computed
    /// afterwards. [`EqualityData::active`](crate::element::EqualityData) returns the state.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, and the errors of
    /// [`edit_model`](Self::edit_model).
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "eq_active")]
    pub fn set_equality_active(&mut self, equality: impl IntoId<kind::Equality>, active: bool) -> Result<()> {
        let id = equality.id_in(&**self.model())?;
        self.edit_model(|model| model.equality_mut(id).set_active(active))?;
        // The edit changes the simulation only where it changes the model.
        #[cfg(engine_since = "3.0.0")]
        {
            let length = self.model().neq();
            // SAFETY: the engine allocated the array with this length, and `self` is borrowed
            // exclusively.
            unsafe { ffi::array_mut(self.raw_mut().eq_active, length)[id.index()] = active.into() };
        }
        Ok(())
    }

    /// Activates or releases each equality constraint, where the simulation and not the model has
    /// this state.
    #[cfg(engine_since = "3.0.0")]
    pub(crate) fn set_active_equalities(&mut self, active: impl Iterator<Item = bool>) {
        let length = self.model().neq();
        // SAFETY: the engine allocated the array with this length, and `self` is borrowed
        // exclusively.
        let present = unsafe { ffi::array_mut(self.raw_mut().eq_active, length) };
        present.iter_mut().zip(active).for_each(|(present, active)| *present = active.into());
    }

    /// Returns which equality constraints are active: 1 or 0 for each.
    pub(crate) fn active_equalities(&self) -> &[u8] {
        #[cfg(engine_since = "3.0.0")]
        return self.eq_active();
        #[cfg(not(engine_since = "3.0.0"))]
        self.model().equality_active()
    }

    /// Returns the parameters of a weld or a connection for the present poses of its bodies.
    fn at_present_pose(&self, equality: usize) -> [f64; PARAMETERS] {
        let model = self.model();
        let mut parameters = model.eq_data()[equality];
        let body = |ids: &[i32]| ffi::size(ids[equality]);
        let [first, second] = [body(model.eq_obj1id()), body(model.eq_obj2id())];
        let is_weld = EqualityType::of_field(model.eq_type()[equality]) == EqualityType::Weld;
        // A weld keeps its anchor in the second body, a connection that in the first.
        let [keeps, adapts] = if is_weld { [second, first] } else { [first, second] };
        let anchor = rot_vec_quat(&[parameters[0], parameters[1], parameters[2]], &self.xquat()[keeps]);
        let offset = [0, 1, 2].map(|axis| self.xpos()[keeps][axis] + anchor[axis] - self.xpos()[adapts][axis]);
        let adapted = rot_vec_quat(&offset, &neg_quat(&self.xquat()[adapts]));
        parameters[3..6].copy_from_slice(&adapted);
        if is_weld {
            let relative = mul_quat(&neg_quat(&self.xquat()[first]), &self.xquat()[second]);
            parameters[6..10].copy_from_slice(&relative);
            // Newer engines mark poses that they compute from `qpos0` here.
            if let Some(is_computed) = parameters.get_mut(11) {
                *is_computed = 0.0;
            }
        }
        parameters
    }
}

impl Model {
    /// Checks that the parameters of a constraint contain the relative pose of two bodies.
    fn check_has_pose(&self, equality: usize) -> Result<()> {
        let found = EqualityType::of_field(self.eq_type()[equality]);
        if !matches!(found, EqualityType::Weld | EqualityType::Connect) {
            let what = format!("the type of {}", self.described(kind::Kind::Equality, equality));
            return Err(Error::invalid(InvalidKind::Unsuitable, what, format_args!("{found:?}"), "Weld or Connect"));
        }
        if self.couples_sites(equality) {
            return Err(Error::Unsupported(format!(
                "the present pose for {}, whose sites coincide while it is active; a constraint of their bodies has a relative pose",
                self.described(kind::Kind::Equality, equality)
            )));
        }
        Ok(())
    }
}
