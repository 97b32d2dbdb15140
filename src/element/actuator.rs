//! Actuators.

use super::{View, ViewMut};
use crate::data::Data;
use crate::id::kind;
use crate::model::{Model, ModelMut};

fields!(Actuator on Model {
    /// The group, for display.
    group: i32 = actuator_group;
    /// Whether the control is clamped to [`ctrlrange`](Self::ctrlrange).
    ctrllimited: {bool} = |actuator| actuator.owner.actuator_ctrllimited()[actuator.index()] != 0;
    /// Whether the force is clamped to [`forcerange`](Self::forcerange).
    forcelimited: {bool} = |actuator| actuator.owner.actuator_forcelimited()[actuator.index()] != 0;
    /// Whether the activation is clamped to [`actrange`](Self::actrange).
    actlimited: {bool} = |actuator| actuator.owner.actuator_actlimited()[actuator.index()] != 0;
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
});
