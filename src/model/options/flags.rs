//! Features that are switched on and off.

use bitflags::bitflags;
use mujoco_sys as sys;

bitflags! {
    /// Standard features that are switched off.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
    #[doc(alias = "mjtDisableBit")]
    pub struct DisableFlags: u32 {
        /// The entire constraint solver.
        const CONSTRAINT = sys::mjDSBL_CONSTRAINT;
        /// Equality constraints.
        const EQUALITY = sys::mjDSBL_EQUALITY;
        /// Friction loss of joints and tendons.
        const FRICTIONLOSS = sys::mjDSBL_FRICTIONLOSS;
        /// Limits of joints and tendons.
        const LIMIT = sys::mjDSBL_LIMIT;
        /// Contacts.
        const CONTACT = sys::mjDSBL_CONTACT;
        /// Springs, dampers and fluid forces.
        const PASSIVE = sys::mjDSBL_PASSIVE;
        /// Gravity.
        const GRAVITY = sys::mjDSBL_GRAVITY;
        /// Clamping of controls to their ranges.
        const CLAMPCTRL = sys::mjDSBL_CLAMPCTRL;
        /// Starting the solver from the last solution.
        const WARMSTART = sys::mjDSBL_WARMSTART;
        /// The exclusion of collisions between a body and its parent.
        const FILTERPARENT = sys::mjDSBL_FILTERPARENT;
        /// Actuator forces.
        const ACTUATION = sys::mjDSBL_ACTUATION;
        /// The lower bound of twice the timestep on constraint time constants.
        const REFSAFE = sys::mjDSBL_REFSAFE;
        /// Sensors.
        const SENSOR = sys::mjDSBL_SENSOR;
    }
}

bitflags! {
    /// Optional features that are switched on.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
    #[doc(alias = "mjtEnableBit")]
    pub struct EnableFlags: u32 {
        /// The contact parameters of the options override those of the geoms.
        const OVERRIDE = sys::mjENBL_OVERRIDE;
        /// Potential and kinetic energy are computed.
        const ENERGY = sys::mjENBL_ENERGY;
        /// Forward and inverse dynamics are compared.
        const FWDINV = sys::mjENBL_FWDINV;
        /// Noise is added to sensor readings.
        const SENSORNOISE = sys::mjENBL_SENSORNOISE;
        /// Several contact points between convex shapes.
        const MULTICCD = sys::mjENBL_MULTICCD;
    }
}
