//! Derivatives of sensors of constraint forces: touch sensors, and forces of limits of joints and
//! tendons.
//!
//! The value is a force f of a row, or the sum of the normal forces of several contacts, so
//! `rows.rs` computes its derivatives. A contact counts if it is between the sensor's body and
//! another, and if the normal force through it meets the shape of the sensor's site. Both count as
//! they are at present.

use mujoco_sys::{mjCNSTR_LIMIT_JOINT, mjCNSTR_LIMIT_TENDON};

use super::rows::Rows;
use crate::data::Data;
use crate::derivative::newton::contacts;
use crate::enums::{GeomType, SensorType};
use crate::ffi;
use crate::math;
use crate::matrix::Matrix;
use crate::model::Model;
use crate::numerics::spatial::{Vec3, scale};

/// Sensors of constraint forces, with their derivatives.
#[derive(Debug)]
pub(in crate::derivative::analytic) struct ForceSensors {
    /// Indices of the sensors.
    sensors: Vec<usize>,
    /// `(sensors, 3 nv)`: derivatives by positions, velocities and accelerations.
    derivatives: Matrix,
}

impl ForceSensors {
    pub(super) fn new(model: &Model) -> Self {
        let kind = |sensor: usize| SensorType::from_raw(model.sensor_type()[sensor]);
        let is_force = |&sensor: &usize| {
            matches!(kind(sensor), Some(SensorType::Touch | SensorType::JointLimitForce | SensorType::TendonLimitForce))
        };
        let sensors: Vec<usize> = (0..model.nsensor()).filter(is_force).collect();
        Self { derivatives: Matrix::zeros(sensors.len(), 3 * model.nv()), sensors }
    }

    pub(super) fn clear(&mut self) {
        self.derivatives.as_mut_slice().fill(0.0);
    }

    /// Returns the derivatives of a sensor by positions, velocities and accelerations, `(3 nv)`.
    pub(in crate::derivative::analytic) fn derivative(&self, sensor: usize) -> &[f64] {
        let index = self.sensors.iter().position(|&other| other == sensor);
        self.derivatives.row(index.expect("Bug: a sensor of another kind"))
    }

    /// Adds the derivatives of the forces of a constraint, whose rows are loaded, to the
    /// derivatives of the sensors that measure it.
    pub(super) fn add(&mut self, data: &Data, rows: &mut Rows) {
        let model = data.model();
        let (row, id) = (rows.first, data.efc_id()[rows.first]);
        let constraint = data.efc_type()[row] as u32;
        // Number of rows, from the first on, whose forces a sensor adds up.
        let limited = |kind: u32, object: i32| {
            let is_same = |other: usize| data.efc_type()[other] as u32 == kind && data.efc_id()[other] == object;
            // A joint in a narrow range has two rows, of which the sensor measures the first.
            usize::from(constraint == kind && id == object && !(0..row).any(is_same))
        };
        for (index, &sensor) in self.sensors.iter().enumerate() {
            let object = model.sensor_objid()[sensor];
            let derivative = self.derivatives.row_mut(index);
            let measured = match SensorType::from_raw(model.sensor_type()[sensor]) {
                Some(SensorType::JointLimitForce) => limited(mjCNSTR_LIMIT_JOINT, object),
                Some(SensorType::TendonLimitForce) => limited(mjCNSTR_LIMIT_TENDON, object),
                _ if super::is_contact(constraint) && is_touched(data, row, rows.count, ffi::size(object)) => {
                    normal_rows(model, rows.count)
                }
                _ => 0,
            };
            (0..measured).for_each(|row| rows.add_force(data, row, derivative));
        }
    }
}

/// Returns the number of rows whose sum is the normal force: the edges of a pyramid, or the first
/// row.
fn normal_rows(model: &Model, count: usize) -> usize {
    if model.is_pyramidal() { count } else { 1 }
}

/// Returns `true` if a touch sensor at a site measures a contact.
fn is_touched(data: &Data, row: usize, count: usize, site: usize) -> bool {
    let model = data.model();
    let contact = &contacts(data)[ffi::size(data.efc_id()[row])];
    let bodies = [contact.geom1, contact.geom2].map(|geom| model.geom_bodyid()[ffi::size(geom)]);
    let body = model.site_bodyid()[site];
    let force: f64 = data.efc_force()[row..row + normal_rows(model, count)].iter().sum();
    if !bodies.contains(&body) || force <= 0.0 {
        return false;
    }
    let normal: Vec3 = [contact.frame[0], contact.frame[1], contact.frame[2]];
    let ray = scale(&normal, if body == bodies[1] { -1.0 } else { 1.0 });
    let shape = GeomType::of_field(model.site_type()[site]);
    let (position, rotation) = (&data.site_xpos()[site], &data.site_xmat()[site]);
    math::ray_geom(position, rotation, &model.site_size()[site], &contact.pos, &ray, shape)
        .is_ok_and(|distance| distance.is_some())
}
