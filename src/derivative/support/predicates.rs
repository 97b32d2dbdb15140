//! Statements about the values of fields that are understood in part, by the names in
//! `build/knowledge/derivative.tsv`. Enumerations and flags are understood by name, so a value that
//! a new engine adds is not.

use crate::derivative::analytic;
use crate::derivative::method::Fallback;
use crate::enums::{
    ActuatorBias, ActuatorDynamics, ActuatorGain, Cone, EqualityType, GeomType, Integrator, JacobianStorage, JointType,
    SensorType, Solver, TransmissionType, WrapType,
};
use crate::model::{DisableFlags, EnableFlags, FIRST_ABSENT_FLAG, Model};

/// Returns the obstacle for the first value that is not understood.
fn find<T: Copy>(field: &'static str, values: &[T], is_understood: impl Fn(T) -> bool) -> Option<Fallback> {
    let element = values.iter().position(|&value| !is_understood(value))?;
    Some(Fallback::NotUnderstood { field, element })
}

/// Returns the obstacle for a value of an option.
fn unless(is_understood: bool, field: &'static str) -> Option<Fallback> {
    (!is_understood).then_some(Fallback::NotUnderstood { field, element: 0 })
}

/// Defines predicates of arrays with the values of an enumeration: each names the variants that are
/// understood.
macro_rules! enumerations {
    ($($(#[$doc:meta])* $name:ident: $array:ident, $enum:ident { $($variant:ident)|+ };)*) => {$(
        $(#[$doc])*
        pub(super) fn $name(model: &Model) -> Option<Fallback> {
            find(stringify!($array), model.$array(), |raw| matches!($enum::from_raw(raw), Some($($enum::$variant)|+)))
        }
    )*};
}

enumerations! {
    joint: jnt_type, JointType { Free | Ball | Slide | Hinge };
    equality: eq_type, EqualityType { Connect | Weld | Joint | Tendon };
    wrap: wrap_type, WrapType { Joint | Pulley | Site | Sphere | Cylinder };
    /// Actuators whose force changes with the control in constant moments, as the differences of
    /// inverse dynamics assume.
    transmission: actuator_trntype, TransmissionType { Joint | JointInParent | SliderCrank | Tendon | Site | Body };
    /// Dynamics whose step `actuation.rs` repeats.
    dynamics: actuator_dyntype, ActuatorDynamics { None | Integrator | Filter | FilterExact | Muscle | User };
    /// Gains and biases for which the force is linear in the control or the activation.
    gain: actuator_gaintype, ActuatorGain { Fixed | Affine | Muscle | User };
    bias: actuator_biastype, ActuatorBias { None | Affine | Muscle | User };
    /// Sensors of positions, velocities and accelerations, and the forces of actuators. All others
    /// that depend on a control directly would lack that part of D.
    sensor: sensor_type, SensorType {
        Touch | Accelerometer | Velocimeter | Gyro | Force | Torque | Magnetometer | Rangefinder | JointPosition
            | JointVelocity | TendonPosition | TendonVelocity | ActuatorPosition | ActuatorVelocity | ActuatorForce
            | BallQuaternion | BallAngularVelocity | JointLimitPosition | JointLimitVelocity | JointLimitForce
            | TendonLimitPosition | TendonLimitVelocity | TendonLimitForce | FramePosition | FrameQuaternion
            | FrameXAxis | FrameYAxis | FrameZAxis | FrameLinearVelocity | FrameAngularVelocity
            | FrameLinearAcceleration | FrameAngularAcceleration | SubtreeCom | SubtreeLinearVelocity
            | SubtreeAngularMomentum | Clock | User | CameraProjection | GeomDistance | GeomNormal | GeomFromTo
            | PotentialEnergy | KineticEnergy | InsideSite
    };
}

/// Joints of fixed tendons whose position is a length or an angle. Compilers before 4.0 accept
/// others.
pub(super) fn wrapped_joints(model: &Model) -> Option<Fallback> {
    let is_scalar = |joint: i32| {
        let kind = JointType::from_raw(model.jnt_type()[crate::ffi::size(joint)]);
        matches!(kind, Some(JointType::Slide | JointType::Hinge))
    };
    let mut wraps = model.wrap_type().iter().zip(model.wrap_objid());
    let element = wraps.position(|(&kind, &joint)| kind == WrapType::Joint.raw() && !is_scalar(joint))?;
    Some(Fallback::NotUnderstood { field: "wrap_objid", element })
}

/// Sensors whose rows are differences of inverse dynamics, which are also those that are
/// differenced beside closed forms.
pub(super) fn sensors_by_differences(model: &Model) -> Option<Fallback> {
    let pulls = analytic::reads_tendons(model);
    let reads = |raw: i32| matches!(SensorType::from_raw(raw), Some(SensorType::Force | SensorType::Torque));
    sensor(model).or_else(|| find("sensor_type", model.sensor_type(), |raw| !(pulls && reads(raw))))
}

/// Sites on which touch sensors measure. On a mesh the engine raises an error in each step.
pub(super) fn touched_sites(model: &Model) -> Option<Fallback> {
    use GeomType::{Box, Capsule, Cylinder, Ellipsoid, Sphere};
    let touch = SensorType::Touch.raw();
    let sensors = model.sensor_type().iter().zip(model.sensor_objid()).filter(|(kind, _)| **kind == touch);
    let mut sites = sensors.map(|(_, &site)| crate::ffi::size(site));
    let is_solid = |site: usize| {
        matches!(GeomType::from_raw(model.site_type()[site]), Some(Sphere | Capsule | Ellipsoid | Cylinder | Box))
    };
    let element = sites.find(|&site| !is_solid(site))?;
    Some(Fallback::NotUnderstood { field: "site_type", element })
}

#[cfg_attr(not(engine_since = "3.2.0"), allow(dead_code, reason = "older engines have no array"))]
pub(super) fn sites(model: &Model) -> Option<Fallback> {
    let element = (0..model.neq()).find(|&equality| model.couples_sites(equality))?;
    Some(Fallback::NotUnderstood { field: "eq_objtype", element })
}

#[cfg_attr(not(engine_since = "2.3.0"), allow(dead_code, reason = "older engines have no array"))]
pub(super) fn single_control(model: &Model) -> Option<Fallback> {
    let has_one = |actuator: &usize| {
        model.controls_of(*actuator).len() == 1
            && model.outputs_of(*actuator).len() == 1
            && model.activations_of(*actuator).len() <= 1
    };
    let element = (0..model.nactuator()).find(|actuator| !has_one(actuator))?;
    Some(Fallback::NotUnderstood { field: "actuator_ctrlnum", element })
}

pub(super) fn actuator(model: &Model) -> Option<Fallback> {
    analytic::actuator_obstacle(model)
}

pub(super) fn fluid(model: &Model) -> Option<Fallback> {
    analytic::has_fluid_obstacle(model).then_some(Fallback::Fluid)
}

/// Integrators with the inverse dynamics of continuous time.
pub(super) fn integrator_of_forces(model: &Model) -> Option<Fallback> {
    let integrator = Integrator::from_raw(model.raw().opt.integrator);
    let is_understood = matches!(
        integrator,
        Some(Integrator::Euler | Integrator::Rk4 | Integrator::Implicit | Integrator::ImplicitFast)
    );
    unless(is_understood, "opt.integrator")
}

/// Integrators with a closed form.
pub(super) fn integrator(model: &Model) -> Option<Fallback> {
    match Integrator::from_raw(model.raw().opt.integrator) {
        Some(Integrator::Euler) => None,
        Some(Integrator::Implicit) => {
            analytic::has_implicit_step_obstacle(model).then_some(Fallback::ImplicitIntegrator)
        }
        _ => integrator_of_differences(model),
    }
}

/// Integrators that inverse dynamics inverts.
pub(super) fn integrator_of_differences(model: &Model) -> Option<Fallback> {
    match Integrator::from_raw(model.raw().opt.integrator) {
        Some(Integrator::Euler) => None,
        Some(Integrator::Rk4) => Some(Fallback::RungeKutta),
        Some(Integrator::Implicit | Integrator::ImplicitFast | Integrator::Discrete) => {
            Some(Fallback::ImplicitIntegrator)
        }
        None => unless(false, "opt.integrator"),
    }
}

/// Integrators whose stages the engine's differences do not mix.
pub(super) fn stages(model: &Model) -> Option<Fallback> {
    (Integrator::from_raw(model.raw().opt.integrator) == Some(Integrator::Rk4)).then_some(Fallback::RungeKutta)
}

pub(super) fn noslip(model: &Model) -> Option<Fallback> {
    (model.raw().opt.noslip_iterations > 0).then_some(Fallback::NoSlip)
}

pub(super) fn cone(model: &Model) -> Option<Fallback> {
    let cone = Cone::from_raw(model.raw().opt.cone);
    unless(matches!(cone, Some(Cone::Pyramidal | Cone::Elliptic)), "opt.cone")
}

/// Solvers of the same convex problem, whose result is refined.
pub(super) fn solver(model: &Model) -> Option<Fallback> {
    let solver = Solver::from_raw(model.raw().opt.solver);
    unless(matches!(solver, Some(Solver::Pgs | Solver::Cg | Solver::Newton)), "opt.solver")
}

pub(super) fn jacobian(model: &Model) -> Option<Fallback> {
    let storage = JacobianStorage::from_raw(model.raw().opt.jacobian);
    let is_understood =
        matches!(storage, Some(JacobianStorage::Dense | JacobianStorage::Sparse | JacobianStorage::Auto));
    unless(is_understood, "opt.jacobian")
}

/// Flags that disable features of 2.2.2, with those that newer engines split off, and those that
/// select the engine's algorithms.
const DISABLED: DisableFlags = DisableFlags::CONSTRAINT
    .union(DisableFlags::EQUALITY)
    .union(DisableFlags::FRICTIONLOSS)
    .union(DisableFlags::LIMIT)
    .union(DisableFlags::CONTACT)
    .union(DisableFlags::PASSIVE)
    .union(DisableFlags::GRAVITY)
    .union(DisableFlags::CLAMPCTRL)
    .union(DisableFlags::WARMSTART)
    .union(DisableFlags::FILTERPARENT)
    .union(DisableFlags::ACTUATION)
    .union(DisableFlags::REFSAFE)
    .union(DisableFlags::SENSOR)
    .union(DisableFlags::MIDPHASE)
    .union(DisableFlags::NATIVECCD)
    .union(DisableFlags::ISLAND)
    .union(DisableFlags::MULTICCD);

/// The flag that keeps the engine from resetting a simulation with numbers that are not finite.
#[cfg(engine_since = "3.5.0")]
const AUTORESET: u32 = mujoco_sys::mjDSBL_AUTORESET;
#[cfg(not(engine_since = "3.5.0"))]
const AUTORESET: u32 = 0;

/// Returns `true` if an option of the engine has no other flags than these. A flag that the engine
/// lacks is above all that it has.
fn has_only(raw: i32, flags: u32) -> bool {
    raw as u32 & !(flags & (FIRST_ABSENT_FLAG - 1)) == 0
}

fn disables_only(model: &Model, flags: DisableFlags) -> Option<Fallback> {
    unless(has_only(model.raw().opt.disableflags, flags.bits() | AUTORESET), "opt.disableflags")
}

/// The equations of motion without springs but with dampers have no closed form here.
pub(super) fn disabled_motion(model: &Model) -> Option<Fallback> {
    let raw = model.raw().opt.disableflags as u32;
    let passive = raw & DisableFlags::PASSIVE.bits();
    disables_only(model, DISABLED | DisableFlags::EULERDAMP)
        .or_else(|| unless(passive == 0 || passive == DisableFlags::PASSIVE.bits(), "opt.disableflags"))
}

pub(super) fn disabled_actuators(model: &Model) -> Option<Fallback> {
    disables_only(model, DISABLED | DisableFlags::EULERDAMP)
}

/// The implicit damping of the Euler integrator cannot be disabled alone here.
pub(super) fn disabled_integrator(model: &Model) -> Option<Fallback> {
    disables_only(model, DISABLED)
}

pub(super) fn disabled_for_differences(model: &Model) -> Option<Fallback> {
    disables_only(model, DISABLED)
}

/// Flags that change no equation, or only parameters of contacts.
pub(super) fn enabled(model: &Model) -> Option<Fallback> {
    let flags = EnableFlags::OVERRIDE
        | EnableFlags::ENERGY
        | EnableFlags::FWDINV
        | EnableFlags::SENSORNOISE
        | EnableFlags::MULTICCD;
    unless(has_only(model.raw().opt.enableflags, flags.bits()), "opt.enableflags")
}
