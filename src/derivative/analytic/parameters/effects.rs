//! Derivatives of the terms of the equations of motion by parameters.
//!
//! | parameter | ∂g | ∂M w + h ∂Q s of the integrator |
//! |---|---|---|
//! | inertia of a body | `S_k · (∂I a + v ×* ∂I v)`; forces applied at its centre of mass | `S_k · ∂I V_w`, and the same of the Coriolis forces |
//! | gravity | `−S_k · I_k e` | – |
//! | armature | a | w |
//! | damping | v | `−h s` |
//! | friction loss, if its constraint slips | minus the force at the limit, for a loss of one | – |
//! | stiffness, rest position | displacement, `−k` | – |
//! | gain, bias | minus the moment arms times the factor of the parameter | `h m mᵀ s` for factors of the velocity |
//! | solver parameters of constraints | `solver/` | – |
//! | gear | moment arms, lengths and velocities are proportional to it | twice the velocity gain |
//!
//! Q, w and s belong to integrators with implicit forces: see `../integrator.rs`.

use std::ops::Range;

use mujoco_sys::{mjCNSTRSTATE_LINEARNEG, mjCNSTRSTATE_LINEARPOS};

use super::super::actuators::{self, ForceSlopes};
use super::super::implicit_step::for_each_product;
use super::super::integrator::Integrator;
use super::super::sensors::explicit;
use super::super::tree::Tree;
use super::columns::Column;
use super::solver;
use crate::data::Data;
use crate::derivative::newton::constraint_row;
use crate::derivative::parameter::{BodyFrame, BodyMotion, Effect, Factor};
use crate::enums::JointType;
use crate::ffi;
use crate::layout::Row;
use crate::math;
use crate::model::{DisableFlags, Model};
use crate::numerics::spatial::{add_scaled, cross, dot, momentum, spatial};

/// State at which the terms are differentiated.
#[derive(Clone, Copy)]
pub(super) struct Point<'a> {
    pub(super) data: &'a Data,
    pub(super) tree: &'a Tree,
    /// Integrator of the step, or `None` for inverse dynamics, to which forces applied to bodies do
    /// not belong.
    pub(super) integrator: Option<&'a Integrator>,
    pub(super) wants_sensors: bool,
    /// True if actuators are part of g.
    pub(super) has_actuators: bool,
}

/// Terms that are the same in the derivatives by all inertial parameters of a body.
pub(super) struct BodyTerms {
    body: usize,
    frame: BodyFrame,
    motion: BodyMotion,
    /// Motions to whose forces `∂M w + h ∂Q s` is proportional, with factors.
    of_integrator: [(f64, BodyMotion); 4],
}

impl BodyTerms {
    fn new(point: Point<'_>, body: usize) -> Self {
        let frame = BodyFrame::of(point.data, body);
        let mut of_integrator = [(0.0, BodyMotion::default()); 4];
        let motions = point.integrator.into_iter().flat_map(|integrator| integrator.motions_of(body));
        for (term, (factor, motion)) in of_integrator.iter_mut().zip(motions) {
            let [velocity, acceleration] = motion.map(|motion| frame.motion(&motion));
            *term = (factor, BodyMotion { velocity, acceleration });
        }
        Self { body, frame, motion: frame.present_motion(point.data, body), of_integrator }
    }
}

/// Passes the derivatives by a parameter on. `terms` are those of the last inertial parameter at
/// this point, if there was one.
pub(super) fn differentiate(point: Point<'_>, effect: &Effect, terms: &mut Option<BodyTerms>, column: &mut Column<'_>) {
    let Point { data, integrator, .. } = point;
    let model = data.model();
    let has_passive = model.raw().opt.disableflags as u32 & DisableFlags::PASSIVE.bits() == 0;
    match *effect {
        Effect::Coefficient { .. } | Effect::Gear(_) if !point.has_actuators => {}
        Effect::Inertial { body, ref change, ref centre } => {
            let terms = match terms {
                Some(terms) if terms.body == body => terms,
                _ => terms.insert(BodyTerms::new(point, body)),
            };
            inertial(point, terms, change, centre, column);
        }
        Effect::Gravity(axis) => add_gravity(point, axis, column),
        Effect::Armature(ref dofs) => {
            for dof in dofs.clone() {
                column.residual(dof, data.qacc()[dof]);
                if let Some(integrator) = integrator {
                    column.spread(dof, integrator.spread()[dof]);
                }
            }
        }
        Effect::Damping(ref dofs) => {
            let h = model.raw().opt.timestep;
            for dof in dofs.clone() {
                if has_passive {
                    column.residual(dof, data.qvel()[dof]);
                }
                if let Some(integrator) = integrator
                    && (has_passive || !integrator.is_implicit())
                {
                    column.spread(dof, -h * integrator.acceleration()[dof]);
                }
            }
        }
        Effect::FrictionLoss { kind, ref ids } => add_friction(data, kind, ids, column),
        Effect::Stiffness(joint) if has_passive => add_displacement(data, joint, column),
        Effect::SpringReference { dof, stiffness } if has_passive => column.residual(dof, -stiffness),
        Effect::TendonStiffness(tendon) if has_passive => {
            let (length, [low, high]) = (data.ten_length()[tendon], model.tendon_rest_length(tendon));
            let displacement = if length > high { length - high } else { (length - low).min(0.0) };
            add_tendon(data, tendon, displacement, column);
        }
        Effect::TendonRestLength { tendon, is_lower, is_upper } if has_passive => {
            let (length, [low, high]) = (data.ten_length()[tendon], model.tendon_rest_length(tendon));
            if (is_upper && length > high) || (is_lower && length < low) {
                add_tendon(data, tendon, -model.tendon_stiffness()[tendon], column);
            }
        }
        Effect::TendonDamping(tendon) if has_passive => {
            add_tendon(data, tendon, data.ten_velocity()[tendon], column);
            add_damping(point, data.tendon_row(tendon), -1.0, column);
        }
        Effect::Coefficient { actuator, factor, is_gain } => {
            let input_of = |input: f64| if is_gain { input } else { 1.0 };
            let input = ForceSlopes::new(data, actuator).map_or(0.0, |slopes| input_of(slopes.input));
            add_actuator(point, actuator, input * value_of(data, actuator, factor), column);
            if factor == Factor::Velocity
                && let Some((input, _)) = actuators::velocity_gain_input(data, actuator)
            {
                add_damping(point, data.moment_row(actuator), input_of(input), column);
            }
        }
        Effect::TimeConstant { actuator, activation } => {
            column.activation(activation, by_time_constant(data, actuator, activation));
        }
        Effect::Gear(actuator) => add_gear(point, actuator, column),
        Effect::Solver(number) => solver::differentiate(data, number, column),
        _ => {}
    }
}

/// Adds the derivatives by the inertia of a body.
fn inertial(point: Point<'_>, terms: &BodyTerms, change: &[f64; 10], centre: &[f64; 3], column: &mut Column<'_>) {
    let Point { data, tree, .. } = point;
    let BodyTerms { body, frame, motion, ref of_integrator } = *terms;
    let axes = data.cdof();
    let mut force = frame.force(&motion.force(change));
    let [fx, fy, fz, ..] = data.xfrc_applied()[body];
    if point.integrator.is_some() {
        // The point of application moves.
        add_scaled(&mut force, &spatial(&cross(&frame.to_world(centre), &[fx, fy, fz]), &[0.0; 3]), -1.0);
    }
    for dof in tree.chain(tree.last[body]) {
        column.residual(dof, dot(&axes[dof], &force));
    }
    if point.wants_sensors {
        explicit::add_force(data, body, &force, |address, value| column.sensor(address, value));
    }
    let mut local = [0.0; 6];
    for (factor, motion) in of_integrator.iter().filter(|(factor, _)| *factor != 0.0) {
        add_scaled(&mut local, &motion.force(change), *factor);
    }
    if local == [0.0; 6] {
        return;
    }
    let force = frame.force(&local);
    for dof in tree.chain(tree.last[body]) {
        column.spread(dof, dot(&axes[dof], &force));
    }
}

fn add_gravity(point: Point<'_>, axis: usize, column: &mut Column<'_>) {
    let data = point.data;
    let model = data.model();
    if model.raw().opt.disableflags as u32 & DisableFlags::GRAVITY.bits() != 0 {
        return;
    }
    let mut acceleration = [0.0; 6];
    acceleration[3 + axis] = -1.0;
    for (dof, cdof) in data.cdof().iter().enumerate() {
        let inertia = &data.crb()[ffi::size(model.dof_bodyid()[dof])];
        column.residual(dof, dot(cdof, &momentum(inertia, &acceleration)));
    }
    if point.wants_sensors {
        explicit::add_gravity(data, axis, |address, value| column.sensor(address, value));
    }
}

/// Adds the derivative of the forces of dry friction that are at their limits.
fn add_friction(data: &Data, kind: u32, ids: &Range<usize>, column: &mut Column<'_>) {
    for row in 0..data.nefc() {
        let is_at_limit = [mjCNSTRSTATE_LINEARNEG, mjCNSTRSTATE_LINEARPOS].contains(&(data.efc_state()[row] as u32));
        if data.efc_type()[row] as u32 == kind && ids.contains(&ffi::size(data.efc_id()[row])) && is_at_limit {
            let sign = data.efc_force()[row].signum();
            constraint_row(data, row).iter().for_each(|(dof, arm)| column.residual(dof, -sign * arm));
        }
    }
}

/// Adds the displacement of the spring of a joint.
fn add_displacement(data: &Data, joint: usize, column: &mut Column<'_>) {
    let model = data.model();
    let (mut dof, mut at) = (ffi::size(model.jnt_dofadr()[joint]), ffi::size(model.jnt_qposadr()[joint]));
    let (position, rest) = (data.qpos(), model.qpos_spring());
    let kind = JointType::of_field(model.jnt_type()[joint]);
    if kind == JointType::Free {
        (0..3).for_each(|axis| column.residual(dof + axis, position[at + axis] - rest[at + axis]));
        (dof, at) = (dof + 3, at + 3);
    }
    if matches!(kind, JointType::Free | JointType::Ball) {
        let quat = |values: &[f64]| *values[at..].first_chunk::<4>().expect("Bug: the quaternion is in qpos");
        let mut present = quat(position);
        math::normalize4(&mut present);
        let displacement = math::sub_quat(&present, &quat(rest));
        (0..3).for_each(|axis| column.residual(dof + axis, displacement[axis]));
    } else {
        column.residual(dof, position[at] - rest[at]);
    }
}

fn add_tendon(data: &Data, tendon: usize, force: f64, column: &mut Column<'_>) {
    if force != 0.0 {
        data.tendon_row(tendon).iter().for_each(|(dof, moment)| column.residual(dof, moment * force));
    }
}

/// Adds the change of the damping matrix by `factor · rowᵀ row` to the implicit integrator.
fn add_damping(point: Point<'_>, row: Row<'_>, factor: f64, column: &mut Column<'_>) {
    let Some(integrator) = point.integrator.filter(|integrator| integrator.is_implicit()) else { return };
    let (h, acceleration) = (point.data.model().raw().opt.timestep, integrator.acceleration());
    for_each_product(point.tree, row, |dof, other, product| {
        column.spread(dof, h * factor * product * acceleration[other]);
    });
}

/// Returns the quantity that a coefficient of a gain or a bias multiplies.
fn value_of(data: &Data, actuator: usize, factor: Factor) -> f64 {
    match factor {
        Factor::One => 1.0,
        Factor::Length => data.actuator_length()[actuator],
        Factor::Velocity => data.actuator_velocity()[actuator],
        Factor::Zero => 0.0,
    }
}

/// Adds a derivative of the force of an actuator.
fn add_actuator(point: Point<'_>, actuator: usize, force: f64, column: &mut Column<'_>) {
    let data = point.data;
    if force == 0.0 || actuators::actuation_is_disabled(data.model()) {
        return;
    }
    data.moment_row(actuator).iter().for_each(|(dof, arm)| column.residual(dof, -arm * force));
    if point.wants_sensors {
        explicit::add_actuator_force(data.model(), actuator, force, |address, value| column.sensor(address, value));
    }
}

fn add_gear(point: Point<'_>, actuator: usize, column: &mut Column<'_>) {
    let data = point.data;
    let model = data.model();
    let inverse = 1.0 / model.actuator_gear()[actuator][0];
    let [length, velocity] =
        [data.actuator_length(), data.actuator_velocity()].map(|values| inverse * values[actuator]);
    if point.wants_sensors {
        explicit::add_transmission(model, actuator, [length, velocity], |address, value| column.sensor(address, value));
    }
    if actuators::actuation_is_disabled(model) {
        return;
    }
    let slope = ForceSlopes::new(data, actuator)
        .map_or(0.0, |slopes| slopes.by_length * length + slopes.by_velocity * velocity);
    add_actuator(point, actuator, slope, column);
    let force = inverse * data.actuator_force()[actuator];
    data.moment_row(actuator).iter().for_each(|(dof, arm)| column.residual(dof, -arm * force));
    let change = 2.0 * inverse * actuators::velocity_gain(data, actuator).total;
    add_damping(point, data.moment_row(actuator), change, column);
}

/// Returns the derivative of the activation after a step by the time constant of its filter.
fn by_time_constant(data: &Data, actuator: usize, activation: usize) -> f64 {
    let model: &Model = data.model();
    let h = model.raw().opt.timestep;
    if !actuators::is_next_activation_free(data, actuator, activation) {
        return 0.0;
    }
    -h * data.act_dot()[activation] / model.actuator_dynprm()[actuator][0]
}
