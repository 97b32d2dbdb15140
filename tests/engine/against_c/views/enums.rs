//! Constants of the header for the variants of enums that the engine renumbers.

use mujoco_safe::enums::{ActuatorBias, ActuatorDynamics, ActuatorGain, SensorType};
use mujoco_safe::sys;

macro_rules! constants {
    ($($(#[$doc:meta])* $function:ident($type:ident): $($variant:ident = $constant:ident)*;)*) => {$(
        $(#[$doc])*
        pub(super) fn $function(value: $type) -> u32 {
            match value {
                $($type::$variant => sys::$constant,)*
                other => panic!("unexpected value: {other:?}"),
            }
        }
    )*};
}

constants! {
    /// Returns the `mjtDyn`.
    dynamics(ActuatorDynamics):
        None = mjDYN_NONE
        Integrator = mjDYN_INTEGRATOR
        Filter = mjDYN_FILTER
        Muscle = mjDYN_MUSCLE
        User = mjDYN_USER
        FilterExact = mjDYN_FILTEREXACT
    ;
    /// Returns the `mjtGain`.
    gain(ActuatorGain):
        Fixed = mjGAIN_FIXED
        Affine = mjGAIN_AFFINE
        Muscle = mjGAIN_MUSCLE
        User = mjGAIN_USER
    ;
    /// Returns the `mjtBias`.
    bias(ActuatorBias):
        None = mjBIAS_NONE
        Affine = mjBIAS_AFFINE
        Muscle = mjBIAS_MUSCLE
        User = mjBIAS_USER
    ;
    /// Returns the `mjtSensor`.
    sensor_type(SensorType):
        Touch = mjSENS_TOUCH
        Accelerometer = mjSENS_ACCELEROMETER
        Velocimeter = mjSENS_VELOCIMETER
        Gyro = mjSENS_GYRO
        Force = mjSENS_FORCE
        Torque = mjSENS_TORQUE
        Magnetometer = mjSENS_MAGNETOMETER
        Rangefinder = mjSENS_RANGEFINDER
        JointPosition = mjSENS_JOINTPOS
        JointVelocity = mjSENS_JOINTVEL
        TendonPosition = mjSENS_TENDONPOS
        TendonVelocity = mjSENS_TENDONVEL
        ActuatorPosition = mjSENS_ACTUATORPOS
        ActuatorVelocity = mjSENS_ACTUATORVEL
        ActuatorForce = mjSENS_ACTUATORFRC
        BallQuaternion = mjSENS_BALLQUAT
        BallAngularVelocity = mjSENS_BALLANGVEL
        JointLimitPosition = mjSENS_JOINTLIMITPOS
        JointLimitVelocity = mjSENS_JOINTLIMITVEL
        JointLimitForce = mjSENS_JOINTLIMITFRC
        TendonLimitPosition = mjSENS_TENDONLIMITPOS
        TendonLimitVelocity = mjSENS_TENDONLIMITVEL
        TendonLimitForce = mjSENS_TENDONLIMITFRC
        FramePosition = mjSENS_FRAMEPOS
        FrameQuaternion = mjSENS_FRAMEQUAT
        FrameXAxis = mjSENS_FRAMEXAXIS
        FrameYAxis = mjSENS_FRAMEYAXIS
        FrameZAxis = mjSENS_FRAMEZAXIS
        FrameLinearVelocity = mjSENS_FRAMELINVEL
        FrameAngularVelocity = mjSENS_FRAMEANGVEL
        FrameLinearAcceleration = mjSENS_FRAMELINACC
        FrameAngularAcceleration = mjSENS_FRAMEANGACC
        SubtreeCom = mjSENS_SUBTREECOM
        SubtreeLinearVelocity = mjSENS_SUBTREELINVEL
        SubtreeAngularMomentum = mjSENS_SUBTREEANGMOM
        Clock = mjSENS_CLOCK
        User = mjSENS_USER
    ;
}
