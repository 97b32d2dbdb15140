//! Actuators.

use super::{View, ViewMut};
use crate::data::Data;
use crate::enums::{ActuatorBias, ActuatorDynamics, ActuatorGain, TransmissionType};
use crate::ffi;
use crate::id::{BodyId, Id, JointId, SiteId, TendonId, kind};
use crate::model::{Model, ModelMut};

fields!(Actuator on Model {
    /// What it acts on.
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
        }
    };
    /// How its activation follows its control.
    #[doc(alias = "dyntype")]
    dynamics: {ActuatorDynamics} = |actuator| ActuatorDynamics::of_field(actuator.owner.actuator_dyntype()[actuator.index()]);
    /// What its control or activation is multiplied by.
    #[doc(alias = "gaintype")]
    gain: {ActuatorGain} = |actuator| ActuatorGain::of_field(actuator.owner.actuator_gaintype()[actuator.index()]);
    /// What is added to its force.
    #[doc(alias = "biastype")]
    bias: {ActuatorBias} = |actuator| ActuatorBias::of_field(actuator.owner.actuator_biastype()[actuator.index()]);
    /// The group, for display.
    group: i32 = actuator_group, set_group;
    /// Whether the control is clamped to [`ctrlrange`](Self::ctrlrange).
    ctrllimited: bool = actuator_ctrllimited, set_ctrllimited;
    /// Whether the force is clamped to [`forcerange`](Self::forcerange).
    forcelimited: bool = actuator_forcelimited, set_forcelimited;
    /// Whether the activation is clamped to [`actrange`](Self::actrange).
    actlimited: bool = actuator_actlimited, set_actlimited;
    /// Where its activation is in `act`, if it has one: the last `na` actuators do.
    activation: {Option<usize>} = |actuator| actuator.index().checked_sub(actuator.owner.nu() - actuator.owner.na());
    /// Parameters of its dynamics.
    dynprm: [f64; 10] = actuator_dynprm, dynprm_mut in actuator_dynprm_mut;
    /// Parameters of its gain.
    gainprm: [f64; 10] = actuator_gainprm, gainprm_mut in actuator_gainprm_mut;
    /// Parameters of its bias.
    biasprm: [f64; 10] = actuator_biasprm, biasprm_mut in actuator_biasprm_mut;
    /// Limits of its control.
    ctrlrange: [f64; 2] = actuator_ctrlrange, ctrlrange_mut in actuator_ctrlrange_mut;
    /// Limits of its force, N or N·m.
    forcerange: [f64; 2] = actuator_forcerange, forcerange_mut in actuator_forcerange_mut;
    /// Limits of its activation.
    actrange: [f64; 2] = actuator_actrange, actrange_mut in actuator_actrange_mut;
    /// Scale of its length, along each axis of its transmission.
    gear: [f64; 6] = actuator_gear, gear_mut in actuator_gear_mut;
    /// Length of the crank of a slider-crank, m.
    cranklength: f64 = actuator_cranklength, set_cranklength in actuator_cranklength_mut;
    /// Acceleration from a unit force in the reference configuration.
    acc0: f64 = actuator_acc0;
    /// Length in the reference configuration.
    length0: f64 = actuator_length0;
    /// Range of its length.
    lengthrange: [f64; 2] = actuator_lengthrange, lengthrange_mut in actuator_lengthrange_mut;
    /// The user's own numbers.
    user: [f64] = actuator_user, user_mut in actuator_user_mut;
});

fields!(Actuator on Data {
    /// Control: an input.
    ctrl: f64 = ctrl, set_ctrl in ctrl_mut;
    /// Length.
    length: f64 = actuator_length;
    /// Velocity.
    velocity: f64 = actuator_velocity;
    /// Force, N or N·m, in the space of the actuator.
    force: f64 = actuator_force;
    /// Derivative of its length by each degree of freedom.
    moment: [f64] = actuator_moment;
    /// Activation: a part of the state. `None` if it has none.
    act: {Option<f64>} = |actuator| Some(actuator.owner.act()[actuator.in_model().activation()?]);
    /// Time derivative of its activation. `None` if it has none.
    act_dot: {Option<f64>} = |actuator| Some(actuator.owner.act_dot()[actuator.in_model().activation()?]);
});

impl ViewMut<'_, Data, kind::Actuator> {
    /// `act`, to be written to.
    pub fn act_mut(&mut self) -> Option<&mut f64> {
        let activation = self.as_view().in_model().activation()?;
        Some(&mut self.owner.act_mut()[activation])
    }
}

/// What an actuator acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[doc(alias = "mjtTrn")]
pub enum Transmission {
    /// A joint: a force or torque along its axis; for a ball or free joint, in the frame of the body.
    Joint(JointId),
    /// A ball or free joint, in the frame of the parent body.
    JointInParent(JointId),
    /// A slider that a rod connects to a crank.
    SliderCrank {
        /// The site at the end of the crank.
        crank: SiteId,
        /// The site on the slider, whose z axis is the slider's.
        slider: SiteId,
    },
    /// A tendon: a force along it.
    Tendon(TendonId),
    /// A site: a force and a torque in its frame.
    Site(SiteId),
    /// The contacts of a body: adhesion.
    Body(BodyId),
}
