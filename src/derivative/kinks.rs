//! Kinks of a step as a function of controls and activations, and the side on which it is
//! differentiated there.
//!
//! At a kink the derivatives of the two sides differ. The rule is: an input moves into its range,
//! and where both directions are possible, a muscle contracts. So the control of a muscle that
//! equals its activation grows, as the next control probably does, and the activation decreases.
//! The closed forms use the formulas of that side, and differences perturb the input to that side
//! only.

use std::ops::Range;

use super::method::{Kinks, Step};
use super::perturbation::{Input, Settings};
use super::{Differences, sizes};
use crate::data::Data;
use crate::enums::{ActuatorDynamics, ActuatorGain, GeomType, Integrator};
use crate::error::Result;
use crate::id::GeomId;
use crate::model::{DisableFlags, Model};

/// Distance from a kink within which a value counts as at the kink. Controls, activations and
/// forces at a kink are there up to rounding: a steady activation stops as many units of rounding
/// from its control as the time constant has steps.
const TOLERANCE: f64 = 1e-12;

/// Largest disagreement of differences to the right and to the left, relative to an entry, and
/// relative to the largest entry of a column or to 1. In a smooth step they differ by the step
/// times the curvature.
const MAX_DISAGREEMENT: [f64; 2] = [0.02, 1e-4];

/// Largest disagreement, as a multiple of the disagreement of a smooth step, with which differences
/// are not repeated. Where the curvature jumps, such as at contacts as deep as the width of
/// `solimp`, it is twice the error.
const SMOOTH: f64 = 0.1;

/// Largest of some values, for comparison with the disagreement of an entry among them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    largest: f64,
}

impl Scale {
    pub(super) fn of(values: impl Iterator<Item = f64>) -> Self {
        Self { largest: values.fold(1.0, |largest, value| largest.max(value.abs())) }
    }

    /// Returns the difference to the right minus that to the left of an entry, as a multiple of the
    /// largest one of a smooth step.
    pub(super) fn disagreement(self, difference: f64, entry: f64) -> f64 {
        let [by_entry, by_largest] = MAX_DISAGREEMENT;
        let ratio = difference.abs() / (by_entry * entry.abs() + by_largest * self.largest);
        if ratio.is_nan() { f64::INFINITY } else { ratio }
    }
}

/// Returns the largest disagreement of the differences of a sample at the base point, to its right
/// and to its left by `eps`, as a multiple of the disagreement of a smooth step, in the entries
/// except those that `keep` marks.
pub(super) fn disagreement([base, right, left]: [&[f64]; 3], keep: &[bool], eps: f64) -> f64 {
    let slopes = || {
        base.iter().zip(right.iter().zip(left)).map(|(base, (right, left))| ((right - base) / eps, (base - left) / eps))
    };
    let scale = Scale::of(slopes().map(|(right, left)| right.abs().max(left.abs())));
    let is_kept = |row: usize| keep.get(row).is_some_and(|&keep| keep);
    let of_entry = |(row, (right, left)): (usize, (f64, f64))| {
        if is_kept(row) { 0.0 } else { scale.disagreement(right - left, right.abs().max(left.abs())) }
    };
    slopes().enumerate().map(of_entry).fold(0.0, f64::max)
}

/// Returns `true` if geoms are in contact whose collision function can jump: an iteration stops at
/// a tolerance, and the nearest faces of polyhedra change.
pub(super) fn has_contact_that_jumps(data: &Data) -> bool {
    use GeomType::{Capsule, Plane, Sphere};
    let kind = |geom: GeomId| GeomType::of_field(data.model().geom_type()[geom.index()]);
    let is_smooth =
        |geoms: [GeomId; 2]| matches!(geoms.map(kind), [Plane, _] | [_, Plane] | [Sphere | Capsule, Sphere | Capsule]);
    data.contacts().any(|contact| !contact.geoms().is_some_and(is_smooth))
}

/// Trials of a column of differences with one step after another, of which the one with the least
/// disagreement is kept.
#[derive(Debug, Default)]
pub(super) struct Trials {
    best: Vec<f64>,
    least: f64,
    /// Column with the present step, while that with its double is computed.
    present: Vec<f64>,
}

impl Trials {
    pub(super) fn new(length: usize) -> Self {
        Self { best: vec![0.0; length], least: f64::INFINITY, present: vec![0.0; length] }
    }

    /// Computes a column by a function that returns its disagreement, with the step of the
    /// settings, and then with others as long as the differences disagree. Returns the kinks.
    ///
    /// If a function jumps at the base point by the same amount to the right and to the left, its
    /// differences on both sides are equal, and inversely proportional to the step. So differences
    /// of a function that `may_jump` must also agree with the differences of the double step.
    pub(super) fn run(
        &mut self,
        settings: Settings<'_>,
        may_jump: bool,
        row: &mut [f64],
        mut difference: impl FnMut(Settings<'_>, &mut [f64]) -> Result<f64>,
    ) -> Result<Kinks> {
        self.least = f64::INFINITY;
        for step in settings.step.trials() {
            let mut disagreement = difference(Settings { step, ..settings }, row)?;
            if may_jump && disagreement <= 1.0 && step.differences == Differences::Central {
                let present = &mut self.present[..row.len()];
                present.copy_from_slice(row);
                difference(Settings { step: Step { eps: 2.0 * step.eps, ..step }, ..settings }, row)?;
                disagreement = disagreement.max(change(settings, present, row));
                row.copy_from_slice(present);
            }
            // A step below the tolerance of the solver or of a collision function has no effect on
            // either side.
            if step.eps < settings.step.eps && self.distance(row) > self.least {
                continue;
            }
            if disagreement <= SMOOTH {
                return Ok(Kinks::empty());
            }
            if disagreement < self.least || self.least == f64::INFINITY {
                self.least = disagreement;
                self.best[..row.len()].copy_from_slice(row);
            }
        }
        row.copy_from_slice(&self.best[..row.len()]);
        Ok(if self.least > 1.0 { Kinks::DIFFERENCES } else { Kinks::empty() })
    }

    /// Returns the disagreement of a column with the one that is kept.
    fn distance(&self, row: &[f64]) -> f64 {
        let best = &self.best[..row.len()];
        let scale = Scale::of(best.iter().copied());
        best.iter().zip(row).map(|(best, value)| scale.disagreement(value - best, *best)).fold(0.0, f64::max)
    }
}

/// Returns the largest change of a column, as a multiple of the largest one of a smooth step.
fn change(Settings { model, wanted, keep, .. }: Settings<'_>, present: &[f64], other: &[f64]) -> f64 {
    let (nx, _, _) = sizes(model);
    let part = |range: Range<usize>, keep: &[bool]| {
        let scale = Scale::of(present[range.clone()].iter().copied());
        let is_kept = |row: usize| keep.get(row).is_some_and(|&keep| keep);
        let entries = present[range.clone()].iter().zip(&other[range]).enumerate();
        let changes = entries.filter(|(row, _)| !is_kept(*row)).map(|(_, (a, b))| scale.disagreement(a - b, *a));
        changes.fold(0.0, f64::max)
    };
    let system = if wanted.system { part(0..nx, &[]) } else { 0.0 };
    let sensors = if wanted.sensors { part(nx..present.len(), keep) } else { 0.0 };
    system.max(sensors)
}

/// Returns `true` if a value is an end of a range up to rounding.
pub(super) fn is_at(value: f64, end: f64) -> bool {
    end.is_finite() && (value - end).abs() <= TOLERANCE * (1.0 + end.abs())
}

/// Returns `true` if a value is inside a range or at its ends.
pub(super) fn is_inside(value: f64, [low, high]: [f64; 2]) -> bool {
    (low..=high).contains(&value) || is_at(value, low) || is_at(value, high)
}

/// Side to which an input is perturbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Right,
    Left,
}

/// Sides of the kink of a muscle: true for the side on which the control is above the activation.
#[derive(Clone, Copy, Debug)]
pub(super) struct MuscleSides {
    pub(super) of_control: bool,
    pub(super) of_activation: bool,
}

/// Returns `true` for an actuator whose activation follows the control with a time constant that
/// has a step where they are equal.
fn has_muscle_kink(model: &Model, actuator: usize) -> bool {
    // The width of the transition between the time constants. Before 2.3.6 it is always zero.
    let is_smooth = cfg!(engine_since = "2.3.6") && model.actuator_dynprm()[actuator][2] >= mujoco_sys::mjMINVAL;
    is_muscle(model, actuator) && !is_smooth
}

fn is_muscle(model: &Model, actuator: usize) -> bool {
    model.actuator_dyntype()[actuator] == ActuatorDynamics::Muscle.raw()
}

fn clamps_controls(model: &Model) -> bool {
    model.raw().opt.disableflags as u32 & DisableFlags::CLAMPCTRL.bits() == 0
}

/// Returns the range beyond which a control has no effect. Muscles clamp their controls to the
/// range from 0 to 1.
fn control_range(model: &Model, control: usize, actuator: usize) -> [f64; 2] {
    let is_limited = clamps_controls(model) && model.actuator_ctrllimited()[control] != 0;
    let [low, high] = if is_limited { model.actuator_ctrlrange()[control] } else { [f64::NEG_INFINITY, f64::INFINITY] };
    if is_muscle(model, actuator) { [low.max(0.0), high.min(1.0)] } else { [low, high] }
}

/// Returns `true` if a step depends on a control beyond its range: before 3.17 the implicit
/// integrators multiply the derivative of a gain by the control as it is.
fn is_read_unclamped(model: &Model, actuator: usize) -> bool {
    let is_implicit =
        matches!(Integrator::of_field(model.raw().opt.integrator), Integrator::Implicit | Integrator::ImplicitFast);
    cfg!(not(engine_since = "3.17.0"))
        && is_implicit
        && model.actuator_dyntype()[actuator] == ActuatorDynamics::None.raw()
        && model.actuator_gaintype()[actuator] == ActuatorGain::Affine.raw()
        && model.actuator_gainprm()[actuator][2] != 0.0
}

/// Returns the end of the range of an activation, if the next activation, before clamping, has
/// reached it: `Right` for the upper end.
fn reached_end(model: &Model, actuator: usize, next: f64) -> Option<Side> {
    let [low, high] = model.actuator_actrange()[actuator];
    if model.actuator_actlimited()[actuator] == 0 {
        None
    } else if next > high || is_at(next, high) {
        Some(Side::Right)
    } else if next < low || is_at(next, low) {
        Some(Side::Left)
    } else {
        None
    }
}

/// Returns whether an input is perturbed to the right and to the left: with central differences to
/// both, except at kinks and at the ends of ranges. `next` has the activations after a step from
/// the base point, before clamping.
pub(super) fn sides(data: &Data, input: Input, step: Step, next: &[f64]) -> (bool, bool) {
    let central = step.differences == Differences::Central;
    let (model, eps) = (data.model(), step.eps);
    let (right, left, preferred) = match input {
        Input::Position(_) | Input::Velocity(_) => return (true, central),
        Input::Control(control) => {
            let actuator = model.actuator_of_control(control);
            let ctrl = data.ctrl()[control];
            let mut range = control_range(model, control, actuator);
            if !is_inside(ctrl, range) && is_read_unclamped(model, actuator) {
                let [low, high] = range;
                range = if ctrl > high { [high, f64::INFINITY] } else { [f64::NEG_INFINITY, low] };
            }
            let [low, high] = range;
            let is_free = is_inside(ctrl, range);
            let preferred = Path::of(model, actuator).and_then(|path| {
                let of_control = |sides: MuscleSides| if sides.of_control { Side::Right } else { Side::Left };
                path.inwards(model, next).or_else(|| path.near_muscle_kink(data, eps).map(of_control))
            });
            (is_free && ctrl + eps <= high, is_free && ctrl - eps >= low, preferred)
        }
        Input::Activation(activation) => {
            let path = Path::of(model, model.actuator_of_activation(activation));
            let preferred = path.and_then(|path| {
                let of_activation = |sides: MuscleSides| if sides.of_activation { Side::Left } else { Side::Right };
                let inwards = path.inwards(model, next);
                inwards
                    .or_else(|| path.near_muscle_kink(data, eps).map(of_activation))
                    .or_else(|| path.near_clamp(data, eps))
            });
            (true, true, preferred)
        }
    };
    match preferred {
        Some(Side::Right) if right => (true, false),
        Some(Side::Left) if left => (false, true),
        _ => (right, left && (central || !right)),
    }
}

/// Control, actuator and activation of an actuator with one of each.
#[derive(Clone, Copy)]
struct Path {
    control: usize,
    actuator: usize,
    activation: usize,
}

impl Path {
    fn of(model: &Model, actuator: usize) -> Option<Self> {
        let activation = model.activation_of(actuator)?;
        let is_single = model.controls_of(actuator).len() == 1 && model.activations_of(actuator).len() == 1;
        is_single.then(|| Self { control: model.first_control(actuator), actuator, activation })
    }

    /// Returns the direction into the range of the activation, if the next activation has reached
    /// an end.
    fn inwards(self, model: &Model, next: &[f64]) -> Option<Side> {
        match reached_end(model, self.actuator, next[self.activation])? {
            Side::Right => Some(Side::Left),
            Side::Left => Some(Side::Right),
        }
    }

    /// Returns the clamped control of a muscle minus its activation.
    fn excess(self, data: &Data) -> f64 {
        let [low, high] = control_range(data.model(), self.control, self.actuator);
        data.ctrl()[self.control].max(low).min(high) - data.act()[self.activation]
    }

    /// Returns the sides of a muscle that a perturbation by `eps` could move across its kink.
    fn near_muscle_kink(self, data: &Data, eps: f64) -> Option<MuscleSides> {
        let is_near = has_muscle_kink(data.model(), self.actuator) && self.excess(data).abs() < eps;
        is_near.then(|| self.muscle_sides(data))
    }

    /// Returns the side of an activation near 0 or 1, within which it affects the time constant of
    /// a muscle.
    fn near_clamp(self, data: &Data, eps: f64) -> Option<Side> {
        let act = data.act()[self.activation];
        if !is_muscle(data.model(), self.actuator) {
            None
        } else if act.abs() < eps {
            Some(if act > 0.0 || is_at(act, 0.0) { Side::Right } else { Side::Left })
        } else if (act - 1.0).abs() < eps {
            Some(if act < 1.0 || is_at(act, 1.0) { Side::Left } else { Side::Right })
        } else {
            None
        }
    }

    fn muscle_sides(self, data: &Data) -> MuscleSides {
        let (model, excess) = (data.model(), self.excess(data));
        if !is_at(excess, 0.0) {
            return MuscleSides { of_control: excess > 0.0, of_activation: excess > 0.0 };
        }
        let [_, high] = control_range(model, self.control, self.actuator);
        let ctrl = data.ctrl()[self.control];
        let at_end = reached_end(model, self.actuator, data.act()[self.activation]);
        MuscleSides { of_control: ctrl < high && !is_at(ctrl, high), of_activation: at_end != Some(Side::Left) }
    }
}

/// Returns the sides on which a muscle is differentiated.
pub(super) fn muscle_sides(data: &Data, actuator: usize, activation: usize) -> MuscleSides {
    Path { control: data.model().first_control(actuator), actuator, activation }.muscle_sides(data)
}

/// Returns the kinks in the controls and activations, for the activations `next` after a step,
/// before clamping, if they are known.
pub(super) fn of_inputs(data: &Data, next: Option<&[f64]>) -> Kinks {
    let model = data.model();
    let mut kinks = Kinks::empty();
    for actuator in 0..model.nactuator() {
        for control in model.controls_of(actuator) {
            let [low, high] = control_range(model, control, actuator);
            let ctrl = data.ctrl()[control];
            if is_at(ctrl, low) || is_at(ctrl, high) {
                kinks |= Kinks::CONTROLS;
            }
        }
        if model.na() == 0 {
            continue;
        }
        let Some(path) = Path::of(model, actuator) else { continue };
        if is_muscle(model, actuator) {
            let (act, is_steady) = (data.act()[path.activation], is_at(path.excess(data), 0.0));
            let is_clamped = !is_steady && (is_at(act, 0.0) || is_at(act, 1.0));
            if is_clamped || (is_steady && has_muscle_kink(model, actuator)) {
                kinks |= Kinks::MUSCLES;
            }
        }
        let [low, high] = model.actuator_actrange()[actuator];
        let is_limited = model.actuator_actlimited()[actuator] != 0;
        if next
            .is_some_and(|next| is_limited && (is_at(next[path.activation], low) || is_at(next[path.activation], high)))
        {
            kinks |= Kinks::ACTIVATIONS;
        }
    }
    kinks
}
