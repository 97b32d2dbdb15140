//! Derivatives of sensors of constraint forces, from those at constant acceleration
//! (`../constraint/force_sensors.rs`).

use super::{Point, Rows};
use crate::numerics::linear_algebra::{add, add_product};

pub(super) fn differentiate(point: Point<'_>, sensor: usize, rows: &mut Rows<'_>) {
    let nv = point.data.model().nv();
    let (by_state, by_acceleration) = point.forces.derivative(sensor).split_at(2 * nv);
    let row = rows.row_mut(0);
    add(&mut row[..2 * nv], by_state, 1.0);
    add_product(row, point.deceleration, by_acceleration, -1.0);
}
