//! Derivatives of equality constraints.
//!
//! - **Joint, tendon:** the position of the first is a polynomial p of the displacement d of the
//!   second, so row `J = row₁ − p'(d) row₂` and `∂J = −p''(d) row₂ row₂ᵀ`. `∂pos = J`.
//! - **Connect:** the difference of an anchor p₁ on the first body and p₂ on the second, in the
//!   world's axes. `∂pos = J`.
//! - **Weld:** the same, and a rotation: for the orientations q₁ and q₂, the relative pose ρ and
//!   the scale τ of torques, the rows are `τ Q (ω₁ − ω₂)`, `Q y = Im(q̄₂ y q₁ ρ)/2`. 2.2.2 scales J
//!   by τ, but not the positions of these rows.
//!
//! The impedance of all rows of a constraint is a function of the norm of their positions, for a
//! weld with τ applied.

use std::array;

use super::Constraints;
use super::chains::{multiply, multiply_transposed};
use super::rows::Rows;
use crate::data::Data;
use crate::derivative::analytic::tree::Tree;
use crate::enums::EqualityType;
use crate::ffi;
use crate::math;
use crate::matrix::Matrix;
use crate::model::Model;
use crate::numerics::linear_algebra::add as add_to;
use crate::numerics::spatial::{Vec3, add, add_scaled, angular, cross, spatial, sub, velocity_at, wrench};

/// Signs of the two bodies in the rows, and of the forces on them.
const SIGNS: [f64; 2] = [1.0, -1.0];

/// Returns the number of rows of an equality constraint.
pub(super) fn row_count(model: &Model, equality: usize) -> usize {
    match EqualityType::from_raw(model.eq_type()[equality]) {
        Some(EqualityType::Connect) => 3,
        Some(EqualityType::Weld) => 6,
        _ => 1,
    }
}

/// Adds the derivatives of an equality constraint to the derivatives of the rows, and the
/// derivatives of its Jacobian to the residual. Returns `false` for a type without a formula.
pub(super) fn differentiate(
    constraints: &mut Constraints,
    data: &Data,
    tree: &Tree,
    row: usize,
    residual: &mut Matrix,
) -> bool {
    let equality = ffi::size(data.efc_id()[row]);
    match EqualityType::from_raw(data.model().eq_type()[equality]) {
        // Their reference contains the derivative of the Jacobian by time since 3.7, for which
        // there is no formula here.
        Some(EqualityType::Connect | EqualityType::Weld) if cfg!(engine_since = "3.7.0") => return false,
        Some(EqualityType::Connect) => differentiate_bodies(constraints, data, tree, row, false, residual),
        Some(EqualityType::Weld) => differentiate_bodies(constraints, data, tree, row, true, residual),
        Some(kind @ (EqualityType::Joint | EqualityType::Tendon)) => {
            differentiate_polynomial(constraints, data, row, kind, residual);
        }
        _ => return false,
    }
    true
}

fn differentiate_polynomial(
    constraints: &mut Constraints,
    data: &Data,
    row: usize,
    kind: EqualityType,
    residual: &mut Matrix,
) {
    let (model, equality) = (data.model(), ffi::size(data.efc_id()[row]));
    let Constraints { rows, row: second, .. } = constraints;
    rows.load(data, row, 1, None);
    finish(rows, data, 1.0);
    let Ok(object) = usize::try_from(model.eq_obj2id()[equality]) else { return };
    let displacement = if kind == EqualityType::Joint {
        let at = ffi::size(model.jnt_qposadr()[object]);
        second.fill(0.0);
        second[ffi::size(model.jnt_dofadr()[object])] = 1.0;
        data.qpos()[at] - model.qpos0()[at]
    } else {
        data.tendon_row(object).write_into(second);
        data.ten_length()[object] - model.tendon_length0()[object]
    };
    let [_, _, c2, c3, c4, ..] = model.eq_data()[equality];
    let curvature = 2.0 * c2 + 6.0 * c3 * displacement + 12.0 * c4 * displacement * displacement;
    let damping = data.efc_KBIP()[row][1];
    let rate: f64 =
        second.iter().zip(data.qacc()).zip(data.qvel()).map(|((row, qacc), qvel)| row * (qacc + damping * qvel)).sum();
    // The Jacobian may have zeros where the second row has none.
    let nv = second.len();
    let start = second.iter().position(|&value| value != 0.0).unwrap_or(nv).min(rows.span.start);
    let end = second.iter().rposition(|&value| value != 0.0).map_or(0, |last| last + 1).max(rows.span.end);
    rows.widen(start..end);
    let span = rows.span.clone();
    add_to(&mut rows.residual.row_mut(0)[span.clone()], &second[span], -curvature * rate);
    let force = data.efc_force()[row];
    for (dof, &value) in second.iter().enumerate() {
        if value != 0.0 {
            add_to(&mut residual.row_mut(dof)[..nv], second, curvature * force * value);
        }
    }
}

/// Returns the norm of the positions of a connect or weld constraint.
pub(super) fn violation(data: &Data, row: usize, count: usize) -> f64 {
    let torque_scale = if count > 3 { position_torque_scale(data, ffi::size(data.efc_id()[row])) } else { 1.0 };
    let scale = |at: usize| if at < 3 { 1.0 } else { torque_scale };
    let positions = data.efc_pos()[row..row + count].iter().enumerate();
    positions.map(|(at, pos)| (scale(at) * pos).powi(2)).sum::<f64>().sqrt()
}

/// Returns the scale of the Jacobian of the rotation of a weld relative to its positions. Since 3.0
/// the engine scales the positions, too.
fn position_torque_scale(data: &Data, equality: usize) -> f64 {
    if cfg!(engine_since = "3.0.0") { 1.0 } else { data.model().eq_data()[equality][10] }
}

/// Adds the derivatives of the reference and of the impedance, given the derivatives of the
/// positions. `torque_scale` is the scale of the Jacobian of rotations relative to their positions.
fn finish(rows: &mut Rows, data: &Data, torque_scale: f64) {
    let [stiffness, _, impedance, slope] = data.efc_KBIP()[rows.first];
    let positions = &data.efc_pos()[rows.first..rows.first + rows.count];
    let position_scale = |row: usize| if row < 3 { 1.0 } else { torque_scale };
    let norm = violation(data, rows.first, rows.count);
    let span = rows.span.clone();
    // The derivative of the norm. The engine's P of a single position has the sign of the position
    // already.
    if rows.count == 1 {
        add_to(&mut rows.log_inertia[span.clone()], &rows.jacobian.row(0)[span.clone()], 1.0);
    } else if norm > 0.0 {
        for (row, &position) in positions.iter().enumerate() {
            let factor = position_scale(row) * position / norm;
            add_to(&mut rows.log_inertia[span.clone()], &rows.jacobian.row(row)[span.clone()], factor);
        }
    }
    for (row, &position) in positions.iter().enumerate() {
        let unscale = if row < 3 || torque_scale == 0.0 { 1.0 } else { 1.0 / torque_scale };
        let values = &mut rows.residual.row_mut(row)[span.clone()];
        add_to(values, &rows.jacobian.row(row)[span.clone()], stiffness * impedance * unscale);
        add_to(values, &rows.log_inertia[span.clone()], stiffness * slope * position);
    }
    let factor = slope / (impedance * (1.0 - impedance));
    rows.log_inertia[span].iter_mut().for_each(|value| *value *= factor);
}

fn differentiate_bodies(
    constraints: &mut Constraints,
    data: &Data,
    tree: &Tree,
    row: usize,
    is_weld: bool,
    residual: &mut Matrix,
) {
    let (model, equality) = (data.model(), ffi::size(data.efc_id()[row]));
    let values = model.eq_data()[equality];
    let bodies = [model.eq_obj1id()[equality], model.eq_obj2id()[equality]].map(ffi::size);
    let torque_scale = if is_weld { values[10] } else { 1.0 };
    // A weld has the anchor of the second body first.
    let anchors: [Vec3; 2] =
        [0, 1].map(|side| array::from_fn(|i| values[i + 3 * if is_weld { 1 - side } else { side }]));
    let arms: [Vec3; 2] = array::from_fn(|side| {
        let body = bodies[side];
        let point = add(&data.xpos()[body], &math::rot_vec_mat(&anchors[side], &data.xmat()[body]));
        sub(&point, &data.subtree_com()[ffi::size(model.body_rootid()[body])])
    });
    let Constraints { chains, rows, interactions, .. } = constraints;
    let damping = data.efc_KBIP()[row][1];
    chains.set(tree, data.cdof(), bodies, |dof| data.qacc()[dof] + damping * data.qvel()[dof]);
    rows.load(data, row, if is_weld { 6 } else { 3 }, Some(chains.span()));
    finish(rows, data, if is_weld { position_torque_scale(data, equality) } else { 1.0 });

    let efc_force = |first: usize| array::from_fn(|i| data.efc_force()[first + i]);
    let force: Vec3 = efc_force(row);
    let rotation = is_weld.then(|| {
        let relative = array::from_fn(|i| values[6 + i]);
        let turned = Rotation::new(&data.xquat()[bodies[0]], &data.xquat()[bodies[1]], &relative, torque_scale);
        (turned, efc_force(row + 3))
    });
    let torque = rotation.as_ref().map_or([0.0; 3], |(rotation, force)| multiply_transposed(&rotation.rows(), force));
    let wrenches = arms.map(|arm| wrench(&torque, &force, &arm));
    let is_measured = interactions.begin(bodies, SIGNS);
    if is_measured {
        for component in 0..rows.count {
            let mut unit = [0.0; 3];
            unit[component % 3] = 1.0;
            // The engine's sensors take the forces of the rotational rows as torques in the axes of
            // the world.
            let direction =
                |arm| if component < 3 { wrench(&[0.0; 3], &unit, &arm) } else { spatial(&unit, &[0.0; 3]) };
            interactions.set_direction(component, arms.map(direction));
        }
    }
    let turn = sub(&angular(&chains.velocities[0]), &angular(&chains.velocities[1]));
    for moving in &chains.dofs {
        let (mut linear_change, mut angular_change) = ([0.0; 3], [0.0; 3]);
        let mut shifts = [[0.0; 3]; 2];
        let mut turns = [[0.0; 3]; 2];
        for side in (0..2).filter(|&side| moving.moves[side]) {
            shifts[side] = velocity_at(&moving.axis, &arms[side]);
            turns[side] = angular(&moving.axis);
            let velocity = chains.velocity_change(moving, side);
            let mut change = velocity_at(&velocity, &arms[side]);
            add_scaled(&mut change, &cross(&angular(&chains.velocities[side]), &shifts[side]), 1.0);
            add_scaled(&mut linear_change, &change, SIGNS[side]);
            add_scaled(&mut angular_change, &angular(&velocity), SIGNS[side]);
        }
        for (component, change) in linear_change.into_iter().enumerate() {
            rows.residual[(component, moving.dof)] += change;
        }
        let mut torque_change = [0.0; 3];
        if let Some((rotation, force)) = &rotation {
            let rows_change = rotation.derivative(&turns);
            let change = add(&multiply(&rows_change, &turn), &multiply(&rotation.rows(), &angular_change));
            for (component, change) in change.into_iter().enumerate() {
                rows.residual[(3 + component, moving.dof)] += change;
            }
            torque_change = multiply_transposed(&rows_change, force);
        }
        for side in 0..2 {
            let torque_change = add(&torque_change, &cross(&shifts[side], &force));
            let change = wrench(&torque_change, &[0.0; 3], &arms[side]);
            chains.subtract_force(tree, moving, side, SIGNS[side], (&wrenches[side], &change), residual);
        }
        if is_measured {
            let changes = shifts.map(|shift| spatial(&cross(&shift, &force), &[0.0; 3]));
            interactions.add_change(moving.dof, changes);
        }
    }
}

/// Rotational rows of a weld.
struct Rotation {
    /// q̄₂ and q₁ ρ.
    left: [f64; 4],
    right: [f64; 4],
    torque_scale: f64,
}

impl Rotation {
    fn new(first: &[f64; 4], second: &[f64; 4], relative: &[f64; 4], torque_scale: f64) -> Self {
        Self { left: math::neg_quat(second), right: math::mul_quat(first, relative), torque_scale }
    }

    /// Returns the rows of τ Q.
    fn rows(&self) -> [Vec3; 3] {
        self.matrix(|unit| {
            let product = math::mul_quat(&math::mul_quat(&self.left, unit), &self.right);
            product.map(|value| 0.5 * value)
        })
    }

    /// Returns the derivative of the rows if the bodies turn:
    /// `∂Q y = Im(q̄₂ y ω₁ q₁ ρ − q̄₂ ω₂ y q₁ ρ)/4`.
    fn derivative(&self, turns: &[Vec3; 2]) -> [Vec3; 3] {
        let [first, second] = turns.map(|[x, y, z]| [0.0, x, y, z]);
        self.matrix(|unit| {
            let turned = sub(&math::mul_quat(unit, &first), &math::mul_quat(&second, unit));
            let product = math::mul_quat(&math::mul_quat(&self.left, &turned), &self.right);
            product.map(|value| 0.25 * value)
        })
    }

    /// Returns the scaled rows of the matrix whose columns are the imaginary parts of a function of
    /// unit quaternions.
    fn matrix(&self, column: impl Fn(&[f64; 4]) -> [f64; 4]) -> [Vec3; 3] {
        let mut rows = [[0.0; 3]; 3];
        for axis in 0..3 {
            let mut unit = [0.0; 4];
            unit[axis + 1] = 1.0;
            for (row, value) in rows.iter_mut().zip(&column(&unit)[1..]) {
                row[axis] = self.torque_scale * value;
            }
        }
        rows
    }
}
