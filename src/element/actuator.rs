//! Views of actuators.

use std::ffi::{CStr, c_int};
use std::ops::Range;

use mujoco_sys as sys;

use super::tendon::JacobianRow;
use super::{View, ViewMut};
use crate::data::Data;
use crate::enums::{ActuatorBias, ActuatorDynamics, ActuatorGain, TransmissionType};
use crate::ffi;
use crate::id::{BodyId, Id, JointId, SiteId, TendonId};
use crate::kind;
use crate::model::{Model, ModelMut};

/// # Methods of [`ActuatorDataMut`](super::ActuatorDataMut)
impl ViewMut<'_, Data, kind::Actuator> {
    /// Returns a mutable reference to `act`, the first one of several.
    pub fn act_mut(&mut self) -> Option<&mut f64> {
        let activation = self.view().in_model().activation()?;
        Some(&mut self.owner.act_mut()[activation])
    }
}

fields!(Actuator on Model {
    /// Transmission: the element that the actuator acts on.
    #[doc(alias = "trntype")]
    #[doc(alias = "trnid")]
    transmission: {Transmission} = |actuator| {
        let ids = actuator.owner.actuator_trnid()[actuator.index()];
        let lineage = actuator.owner.lineage();
        let end = ffi::size(ids[0]);
        match TransmissionType::of_field(actuator.owner.actuator_trntype()[actuator.index()]) {
            TransmissionType::Joint => Transmission::Joint(Id::new(end, lineage)),
            TransmissionType::JointInParent => Transmission::JointInParent(Id::new(end, lineage)),
            TransmissionType::SliderCrank => {
                Transmission::SliderCrank { crank: Id::new(end, lineage), slider: Id::new(ffi::size(ids[1]), lineage) }
            }
            TransmissionType::Tendon => Transmission::Tendon(Id::new(end, lineage)),
            TransmissionType::Site => Transmission::Site(Id::new(end, lineage)),
            TransmissionType::Body => Transmission::Body(Id::new(end, lineage)),
            TransmissionType::So3 => match usize::try_from(ids[1]) {
                Ok(reference) => {
                    Transmission::SiteOrientation { site: Id::new(end, lineage), reference: Id::new(reference, lineage) }
                }
                Err(_) => Transmission::JointOrientation(Id::new(end, lineage)),
            },
        }
    };
    /// Type of the activation dynamics.
    #[doc(alias = "dyntype")]
    dynamics: {ActuatorDynamics} = |actuator| ActuatorDynamics::of_field(actuator.owner.actuator_dyntype()[actuator.index()]);
    /// Type of the gain, which multiplies the control or the activation.
    #[doc(alias = "gaintype")]
    gain: {ActuatorGain} = |actuator| ActuatorGain::of_field(actuator.owner.actuator_gaintype()[actuator.index()]);
    /// Type of the bias, which is added to the force.
    #[doc(alias = "biastype")]
    bias: {ActuatorBias} = |actuator| ActuatorBias::of_field(actuator.owner.actuator_biastype()[actuator.index()]);
    /// Visualisation group.
    group: i32 = actuator_group, set_group;
    /// Indices in `ctrl`. Actuators of the types `pid` and `orientation` have several controls, all
    /// others one.
    #[doc(alias = "ctrladr")]
    #[doc(alias = "ctrlnum")]
    controls: {Range<usize>} = |actuator| actuator.owner.controls_of(actuator.index());
    /// Indices in the arrays with a row per force, such as `actuator_force` and `actuator_length`.
    /// Actuators of the type `orientation` have three forces, all others one.
    #[doc(alias = "outadr")]
    #[doc(alias = "outnum")]
    outputs: {Range<usize>} = |actuator| actuator.owner.outputs_of(actuator.index());
    /// Indices in `act`, empty without activation.
    #[doc(alias = "actadr")]
    #[doc(alias = "actnum")]
    activations: {Range<usize>} = |actuator| actuator.owner.activations_of(actuator.index());
    /// Returns `true` if the (first) control is clamped to [`ctrlrange`](Self::ctrlrange).
    ctrllimited: bool = actuator_ctrllimited by first_control, set_ctrllimited;
    /// Returns `true` if the force is clamped to [`forcerange`](Self::forcerange).
    forcelimited: bool = actuator_forcelimited, set_forcelimited;
    /// Returns `true` if the activation is clamped to [`actrange`](Self::actrange).
    actlimited: bool = actuator_actlimited, set_actlimited;
    /// Index of the (first) activation in `act`; `None` without activation.
    #[doc(alias = "actadr")]
    activation: {Option<usize>} = |actuator| actuator.owner.activation_of(actuator.index());
    /// Parameters of the activation dynamics.
    dynprm: [f64; 10] = actuator_dynprm, dynprm_mut in actuator_dynprm_mut;
    /// Parameters of the gain.
    gainprm: [f64; 10] = actuator_gainprm, gainprm_mut in actuator_gainprm_mut;
    /// Parameters of the bias.
    biasprm: [f64; 10] = actuator_biasprm, biasprm_mut in actuator_biasprm_mut;
    /// Limits of the (first) control.
    ctrlrange: [f64; 2] = actuator_ctrlrange by first_control, ctrlrange_mut in actuator_ctrlrange_mut;
    /// Limits of the force, N or N·m.
    forcerange: [f64; 2] = actuator_forcerange, forcerange_mut in actuator_forcerange_mut;
    /// Limits of the activation.
    actrange: [f64; 2] = actuator_actrange, actrange_mut in actuator_actrange_mut;
    /// Gear: scale of the (first) length along each axis of the transmission.
    gear: [f64; 6] = actuator_gear by first_output, gear_mut in actuator_gear_mut;
    /// Length of the crank of a slider-crank, m.
    cranklength: f64 = actuator_cranklength, set_cranklength in actuator_cranklength_mut;
    /// Acceleration from a unit of the (first) force in the reference configuration.
    acc0: f64 = actuator_acc0 by first_output;
    /// The (first) length in the reference configuration.
    length0: f64 = actuator_length0 by first_output;
    /// Range of the (first) length.
    lengthrange: [f64; 2] = actuator_lengthrange by first_output, lengthrange_mut in actuator_lengthrange_mut;
    /// User data.
    user: [f64] = actuator_user, user_mut in actuator_user_mut;
});

/// # Methods of [`Actuator`](super::Actuator)
impl<'a> View<'a, Model, kind::Actuator> {
    /// Returns the name of an input, counted from 0, for example `"position"`. `None` if the type
    /// of the actuator gives its inputs no names, and with engines before 3.11.
    ///
    /// # Panics
    ///
    /// If the actuator has no such input: it has as many as [`controls`](Self::controls).
    #[doc(alias = "mj_actuatorInputName")]
    pub fn input_name(&self, input: usize) -> Option<&'a str> {
        let count = self.controls().len();
        assert!(input < count, "input {input} of {self:?}, which has {count}");
        let (actuator, input) = (self.index() as c_int, input as c_int);
        // SAFETY: an actuator of the model and one of its inputs.
        let name = unsafe { sys::adapted::actuator_input_name(self.owner.as_ptr(), actuator, input) };
        // SAFETY: NULL, or a constant of the engine that ends with NUL.
        (!name.is_null()).then(|| unsafe { CStr::from_ptr(name) }.to_str().ok()).flatten()
    }
}

fields!(Actuator on Data {
    /// Control: an input; the first one of several.
    ctrl: f64 = ctrl by first_control, set_ctrl in ctrl_mut;
    /// All controls.
    ctrls: [f64] = ctrl at controls, ctrls_mut in ctrl_mut;
    /// Length; the first one of several.
    length: f64 = actuator_length by first_output;
    /// Velocity; the first one of several.
    velocity: f64 = actuator_velocity by first_output;
    /// Force in actuator space, N or N·m; the first one of several.
    force: f64 = actuator_force by first_output;
    /// All forces in actuator space, N or N·m.
    forces: [f64] = actuator_force at outputs;
    /// Moment arms: derivative of the (first) length with respect to each degree of freedom.
    #[doc(alias = "actuator_moment")]
    moment: {JacobianRow<'a>} = |actuator| {
        let output = actuator.owner.first_output(actuator.index());
        JacobianRow::new(actuator.owner.moment_row(output), actuator.owner.model().nv())
    };
    /// All activations, a part of the state.
    acts: [f64] = act at activations, acts_mut in act_mut;
    /// Activation, a part of the state; the first one of several. `None` without activation.
    act: {Option<f64>} = |actuator| Some(actuator.owner.act()[actuator.in_model().activation()?]);
    /// Time derivative of the (first) activation. `None` without activation.
    act_dot: {Option<f64>} = |actuator| Some(actuator.owner.act_dot()[actuator.in_model().activation()?]);
});

/// Transmission of an actuator: the element that it acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Transmission {
    /// A joint: a force or torque along its axis; for a ball or free joint, in the frame of the
    /// body.
    Joint(JointId),
    /// A ball or free joint, in the frame of the parent body.
    JointInParent(JointId),
    /// A slider-crank: a slider that a rod connects to a crank.
    SliderCrank {
        /// Site at the end of the crank.
        crank: SiteId,
        /// Site on the slider. Its z axis is the axis of the slider.
        slider: SiteId,
    },
    /// A tendon: a force along it.
    Tendon(TendonId),
    /// A site: a force and a torque in its frame.
    Site(SiteId),
    /// The contacts of a body: adhesion.
    Body(BodyId),
    /// The orientation of a ball joint: a torque about each axis. With engines from 3.11.0.
    JointOrientation(JointId),
    /// The orientation of a site in the frame of another site: a torque about each axis. With
    /// engines from 3.11.0.
    SiteOrientation {
        /// The site that the actuator turns.
        site: SiteId,
        /// The site relative to which it turns.
        reference: SiteId,
    },
}
