//! Derivatives of sensors in closed form: C and D.
//!
//! A sensor is a function y(q, v, a, u), and the accelerations a depend on the state and on the
//! controls:
//!
//! ```text
//! dy/dx = ∂y/∂x + ∂y/∂a ∂a/∂x,      ∂a = −H⁻¹ ∂g
//! ```
//!
//! | sensors | formulas |
//! |---|---|
//! | joints, limits of joints and of tendons, tendons, actuators, clock | `linear.rs` |
//! | poses and velocities of frames, magnetometer | `frame.rs`, `pose.rs` |
//! | accelerations of frames | `acceleration.rs`, `pose.rs` |
//! | touch, forces of limits | `force.rs`, `../constraint/force_sensors.rs` |
//! | force and torque between a body and its parent | `interaction.rs`, `../constraint/interactions.rs` |
//! | distance along a ray | `ray.rs` |
//! | centre of mass and momentum of subtrees | `subtree.rs` |
//!
//! Distances to meshes, height fields and signed distance fields, and sensors with a cutoff have no
//! formula here.

mod acceleration;
pub(super) mod explicit;
mod force;
mod frame;
mod interaction;
mod linear;
mod pose;
mod ray;
mod subtree;

use std::ops::Range;

use mujoco_sys::{mjMINVAL, mjOBJ_SITE};

use self::pose::Pose;
use super::actuators;
use super::constraint::{ForceSensors, Interactions};
use super::rigid_body::RigidBodies;
use super::tendon::Tendons;
use super::tree::Tree;
use crate::data::Data;
use crate::derivative::TransitionOutputs;
use crate::enums::{SensorType, WrapType};
use crate::ffi;
use crate::matrix::Matrix;
use crate::model::{DisableFlags, Model};
use crate::numerics::spatial::{Spatial, Vec3};

/// Derivatives of the sensors, with their buffers.
#[derive(Debug)]
pub(super) struct Sensors {
    /// `(nsensordata, columns)`: derivatives by the inputs, of which positions and velocities are
    /// the first.
    rows: Matrix,
    /// `(nsensordata)`: true for rows in closed form.
    in_closed_form: Vec<bool>,
    /// `(nbody)`: momenta of the subtrees.
    momenta: Vec<Spatial>,
}

/// State at which sensors are differentiated, after the derivatives of the rigid bodies were
/// computed.
#[derive(Clone, Copy)]
pub(super) struct Point<'a> {
    pub(super) data: &'a Data,
    pub(super) tree: &'a Tree,
    pub(super) bodies: &'a RigidBodies,
    pub(super) tendons: &'a Tendons,
    pub(super) forces: &'a ForceSensors,
    pub(super) interactions: &'a Interactions,
    /// `(nv, columns)`: negated derivatives of the accelerations by the inputs, `H⁻¹ ∂g` in forward
    /// dynamics.
    pub(super) deceleration: &'a Matrix,
    /// True if the forces of actuators follow the inputs, false for inverse dynamics, which does
    /// not compute them.
    pub(super) has_actuators: bool,
}

/// Group of sensors with common formulas.
#[derive(Clone, Copy)]
enum Formula {
    Linear,
    Frame,
    Acceleration,
    Force,
    Interaction,
    Ray,
    Subtree,
}

impl Formula {
    fn depends_on_accelerations(self) -> bool {
        matches!(self, Self::Acceleration | Self::Force | Self::Interaction)
    }
}

/// Returns `true` if the rows of a sensor have a formula here.
pub(in crate::derivative) fn is_covered(model: &Model, sensor: usize) -> bool {
    formula(model, sensor).is_some()
}

/// Returns `true` if the readings of force and torque sensors contain the forces of spatial tendons
/// at their sites, as in newer engines.
pub(in crate::derivative) fn reads_tendons(model: &Model) -> bool {
    let is_site = |&wrap: &i32| WrapType::from_raw(wrap) == Some(WrapType::Site);
    cfg!(engine_since = "2.3.0") && model.wrap_type().iter().any(is_site)
}

/// Returns the formula of a sensor.
fn formula(model: &Model, sensor: usize) -> Option<Formula> {
    let is_disabled = model.raw().opt.disableflags as u32 & DisableFlags::SENSOR.bits() != 0;
    if is_disabled || model.sensor_cutoff()[sensor] != 0.0 || model.has_history(sensor) {
        return None;
    }
    let object = ffi::size(model.sensor_objid()[sensor]);
    let has_pose = || Pose::is_known(model, sensor);
    let (formula, is_covered) = match SensorType::from_raw(model.sensor_type()[sensor])? {
        SensorType::JointPosition
        | SensorType::JointVelocity
        | SensorType::TendonPosition
        | SensorType::TendonVelocity
        | SensorType::BallQuaternion
        | SensorType::BallAngularVelocity
        | SensorType::JointLimitPosition
        | SensorType::TendonLimitPosition
        | SensorType::TendonLimitVelocity
        | SensorType::ActuatorForce
        | SensorType::Clock => (Formula::Linear, true),
        SensorType::ActuatorPosition | SensorType::ActuatorVelocity => {
            (Formula::Linear, actuators::has_differentiable_length(model, object))
        }
        // The axis of a ball's limit turns.
        SensorType::JointLimitVelocity => (Formula::Linear, !linear::is_ball(model, object)),
        SensorType::FramePosition
        | SensorType::FrameQuaternion
        | SensorType::FrameXAxis
        | SensorType::FrameYAxis
        | SensorType::FrameZAxis
        | SensorType::FrameLinearVelocity
        | SensorType::FrameAngularVelocity => (Formula::Frame, has_pose() && Pose::has_known_reference(model, sensor)),
        SensorType::Magnetometer | SensorType::Velocimeter | SensorType::Gyro => (Formula::Frame, has_pose()),
        SensorType::Accelerometer | SensorType::FrameLinearAcceleration | SensorType::FrameAngularAcceleration => {
            (Formula::Acceleration, has_pose())
        }
        SensorType::Touch | SensorType::JointLimitForce | SensorType::TendonLimitForce => (Formula::Force, true),
        // Cameras have rangefinders for each pixel.
        SensorType::Rangefinder => {
            let is_site = model.sensor_objtype()[sensor] as u32 == mjOBJ_SITE;
            (Formula::Ray, is_site && model.sensor_dim()[sensor] == 1)
        }
        // The bodies below the world have different reference points.
        SensorType::Force | SensorType::Torque => {
            (Formula::Interaction, has_pose() && model.site_bodyid()[object] > 0 && !reads_tendons(model))
        }
        // The engine has other formulas for a subtree without mass.
        SensorType::SubtreeCom | SensorType::SubtreeLinearVelocity | SensorType::SubtreeAngularMomentum => {
            (Formula::Subtree, model.body_subtreemass()[object] >= mjMINVAL && subtree::has_sums(model, object))
        }
        _ => return None,
    };
    is_covered.then_some(formula)
}

impl Sensors {
    pub(super) fn new(model: &Model, columns: usize) -> Self {
        let ny = model.nsensordata();
        Self {
            rows: Matrix::zeros(ny, columns),
            in_closed_form: vec![false; ny],
            momenta: vec![[0.0; 6]; model.nbody()],
        }
    }

    /// Returns the flags of the rows in closed form, `(nsensordata)`.
    pub(super) fn in_closed_form(&self) -> &[bool] {
        &self.in_closed_form
    }

    /// Differentiates the sensors that have a formula, or only those of them that depend on
    /// accelerations. The rows of the others are then zero, as their derivatives by accelerations
    /// are.
    pub(super) fn differentiate(&mut self, point: Point<'_>, only_by_accelerations: bool) {
        let model = point.data.model();
        let Self { rows, in_closed_form, momenta } = self;
        rows.as_mut_slice().fill(0.0);
        in_closed_form.fill(false);
        let mut has_momenta = false;
        for sensor in 0..model.nsensor() {
            let Some(formula) = formula(model, sensor) else { continue };
            let first = ffi::size(model.sensor_adr()[sensor]);
            let count = ffi::size(model.sensor_dim()[sensor]);
            if only_by_accelerations && !formula.depends_on_accelerations() {
                in_closed_form[first..first + count].fill(true);
                continue;
            }
            let output = &mut Rows { matrix: rows, first };
            match formula {
                Formula::Linear => linear::differentiate(point, sensor, output),
                Formula::Frame => frame::differentiate(point, sensor, output),
                Formula::Acceleration => acceleration::differentiate(point, sensor, output),
                Formula::Force => force::differentiate(point, sensor, output),
                Formula::Interaction => interaction::differentiate(point, sensor, output),
                Formula::Ray => ray::differentiate(point, sensor, output),
                Formula::Subtree => {
                    if !has_momenta {
                        subtree::sum_momenta(point.data, momenta);
                        has_momenta = true;
                    }
                    subtree::differentiate(point, sensor, momenta, output);
                }
            }
            for (row, flag) in in_closed_form.iter_mut().enumerate().skip(first).take(count) {
                *flag = rows.row(row).iter().all(|value| value.is_finite());
            }
        }
    }

    /// Returns the derivatives of a reading by the inputs.
    pub(super) fn row(&self, address: usize) -> &[f64] {
        self.rows.row(address)
    }

    /// Writes a block of columns of the rows in closed form to a matrix, transposed.
    pub(super) fn write_transposed(&self, columns: Range<usize>, output: &mut Matrix) {
        for row in (0..self.in_closed_form.len()).filter(|&row| self.in_closed_form[row]) {
            for (input, value) in self.rows.row(row)[columns.clone()].iter().enumerate() {
                output[(input, row)] = *value;
            }
        }
    }

    /// Writes the rows in closed form to C and D, if they are wanted.
    pub(super) fn write(&self, outputs: &mut TransitionOutputs<'_>) {
        for row in (0..self.in_closed_form.len()).filter(|&row| self.in_closed_form[row]) {
            let nu = outputs.d.as_ref().map_or(0, |d| d.ncols());
            let nx = outputs.c.as_ref().map_or(self.rows.ncols() - nu, |c| c.ncols());
            let (of_state, of_controls) = self.rows.row(row).split_at(nx);
            if let Some(c) = &mut outputs.c {
                c.row_mut(row).copy_from_slice(of_state);
            }
            if let Some(d) = &mut outputs.d {
                d.row_mut(row).copy_from_slice(of_controls);
            }
        }
    }
}

/// Rows of one sensor.
struct Rows<'a> {
    /// `(nsensordata, columns)`
    matrix: &'a mut Matrix,
    first: usize,
}

impl Rows<'_> {
    /// Adds the derivative of consecutive components by one input.
    fn add(&mut self, column: usize, values: &Vec3) {
        for (row, value) in values.iter().enumerate() {
            self.matrix[(self.first + row, column)] += value;
        }
    }

    /// Returns a row.
    fn row_mut(&mut self, component: usize) -> &mut [f64] {
        self.matrix.row_mut(self.first + component)
    }
}
