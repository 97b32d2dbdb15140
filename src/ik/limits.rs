//! Limits of the positions, velocities and accelerations of joints, as bounds of the displacement.
//!
//! With a limit a of the acceleration, a hinge must be able to stop at a distance d before the end
//! of its range. From the speed `(k + f) a dt` with an integer k and `0 ≤ f < 1` it stops after k
//! more ticks, on the way `(k + 1)(k/2 + f) a dt²`. The largest speed is the inverse of this
//! function of d. It leaves the same freedom in the next tick, so the bounds never contradict each
//! other.

use super::inequality::Inequality;
use super::limit::Limit;
use crate::data::Data;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{Id, JointId};
use crate::model::Model;

#[derive(Debug)]
pub(super) struct JointLimits {
    /// `(nv)` each
    pub(super) velocities: Vec<f64>,
    pub(super) accelerations: Vec<f64>,
    pub(super) prescribed: Vec<Option<f64>>,
    pub(super) margin: f64,
    /// `(nv)`: bounds of the displacement, and the limits of the lower and the upper ones.
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    pub(super) causes: Vec<[Option<Limit>; 2]>,
}

/// Interval of a displacement, with the causes of its ends.
#[derive(Clone, Copy, Debug)]
struct Interval {
    ends: [f64; 2],
    causes: [Option<Limit>; 2],
}

impl Interval {
    /// Intersects with another interval. If they have no common point, keeps the point nearest to
    /// the other, and returns `false` unless rounding explains the gap.
    fn intersect(&mut self, [lower, upper]: [f64; 2], cause: Option<Limit>) -> bool {
        const ROUNDING: f64 = 1e-12;
        let (lower, upper) = (lower.min(f64::MAX), upper.max(f64::MIN));
        if lower > self.ends[1] {
            self.ends[0] = self.ends[1];
            return lower - self.ends[1] <= ROUNDING * (1.0 + lower.abs());
        }
        if upper < self.ends[0] {
            self.ends[1] = self.ends[0];
            return self.ends[0] - upper <= ROUNDING * (1.0 + upper.abs());
        }
        if lower > self.ends[0] {
            (self.ends[0], self.causes[0]) = (lower, cause);
        }
        if upper < self.ends[1] {
            (self.ends[1], self.causes[1]) = (upper, cause);
        }
        true
    }
}

/// Kind of a tick, which decides about the limits that depend on time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Motion {
    /// Velocities and accelerations are limited, for a time.
    Timed(f64),
    /// Displacements are limited, and prescribed joints do not move.
    Free(f64),
}

impl JointLimits {
    pub(super) fn new(model: &Model) -> Self {
        let nv = model.nv();
        Self {
            velocities: vec![f64::INFINITY; nv],
            accelerations: vec![f64::INFINITY; nv],
            prescribed: vec![None; nv],
            margin: 0.0,
            lower: vec![0.0; nv],
            upper: vec![0.0; nv],
            causes: vec![[None; 2]; nv],
        }
    }

    /// Computes the bounds. Appends limits that contradict each other to `conflicts`.
    pub(super) fn compute(
        &mut self,
        data: &Data,
        motion: Motion,
        last: &[f64],
        conflicts: &mut Vec<Limit>,
    ) -> Result<()> {
        let model = &**data.model();
        for (dof, last) in last.iter().enumerate() {
            let joint = ffi::size(model.dof_jntid()[dof]);
            let id: JointId = Id::new(joint, model.lineage());
            if let Some(velocity) = self.prescribed[dof] {
                let dt = if let Motion::Timed(dt) = motion { dt } else { 0.0 };
                let change = (velocity * dt).clamp(f64::MIN, f64::MAX);
                (self.lower[dof], self.upper[dof]) = (change, change);
                self.causes[dof] = [Some(Limit::Prescribed(id)); 2];
                continue;
            }
            let mut interval = Interval { ends: [f64::NEG_INFINITY, f64::INFINITY], causes: [None; 2] };
            let mut intersect = |ends: [f64; 2], cause: Option<Limit>| {
                if !interval.intersect(ends, cause) {
                    conflicts.extend(cause);
                }
            };
            match motion {
                Motion::Free(largest) => intersect([-largest, largest], None),
                Motion::Timed(dt) => {
                    let (change, largest) = (self.accelerations[dof] * dt, self.velocities[dof] * dt);
                    intersect([(last - change) * dt, (last + change) * dt], Some(Limit::Acceleration(id)));
                    intersect([-largest, largest], Some(Limit::Velocity(id)));
                }
            }
            if has_range(model, joint) {
                let q = data.qpos()[ffi::size(model.jnt_qposadr()[joint])];
                let [from, to] = model.jnt_range()[joint];
                if from.is_nan() || to.is_nan() {
                    return Err(Error::not_finite(format!("the range of joint {joint}"), format!("[{from}, {to}]")));
                }
                let mut ends = [from + self.margin - q, to - self.margin - q];
                if let (Motion::Timed(dt), true) = (motion, self.accelerations[dof] < f64::INFINITY) {
                    let unit = self.accelerations[dof] * dt * dt;
                    ends = [-braking(-ends[0], unit), braking(ends[1], unit)];
                }
                // A range that the margin empties keeps its middle.
                if ends[0] > ends[1] {
                    ends = [0.5 * (ends[0] + ends[1]); 2];
                }
                intersect(ends, Some(Limit::Position(id)));
            }
            [self.lower[dof], self.upper[dof]] = interval.ends;
            self.causes[dof] = interval.causes;
        }
        Ok(())
    }
}

/// Returns the largest distance of a hinge or a slide from its range.
pub(super) fn violation(data: &Data) -> f64 {
    let excess = |(place, [from, to]): (usize, [f64; 2])| (from - data.qpos()[place]).max(data.qpos()[place] - to);
    ranges(data.model()).map(excess).fold(0.0, f64::max)
}

/// Moves positions by a velocity for a time. Brings joints that are within their ranges before, and
/// exceed them by rounding or by the curvature of rotations, back to the ends.
pub(super) fn integrate(inequalities: &mut [Inequality], data: &mut Data, velocity: &[f64], dt: f64) -> Result<()> {
    const ROUNDING: f64 = 1e-9;
    let model = data.model().clone();
    let qpos = data.qpos_mut();
    for inequality in inequalities.iter_mut() {
        if let Inequality::Rotation(ball) = inequality {
            ball.is_inside = ball.excess(&model, qpos) <= ROUNDING;
        }
    }
    model.integrate_pos(qpos, velocity, dt)?;
    for (place, [from, to]) in ranges(&model) {
        let q = &mut qpos[place];
        if *q < from && *q >= from - ROUNDING * (1.0 + from.abs()) {
            *q = from;
        }
        if *q > to && *q <= to + ROUNDING * (1.0 + to.abs()) {
            *q = to;
        }
    }
    for inequality in inequalities {
        if let Inequality::Rotation(ball) = inequality
            && ball.is_inside
        {
            ball.clamp(&model, qpos);
        }
    }
    Ok(())
}

/// Returns the position in `qpos` and the range of each hinge and slide that has one.
fn ranges(model: &Model) -> impl Iterator<Item = (usize, [f64; 2])> {
    let ranged = (0..model.njnt()).filter(|&joint| has_range(model, joint));
    ranged.map(|joint| (ffi::size(model.jnt_qposadr()[joint]), model.jnt_range()[joint]))
}

fn has_range(model: &Model, joint: usize) -> bool {
    model.jnt_limited()[joint] != 0
        && matches!(JointType::of_field(model.jnt_type()[joint]), JointType::Hinge | JointType::Slide)
}

/// Returns the largest displacement in a tick from which a joint can stop within a distance, if a
/// tick changes its displacement by at most `unit`.
fn braking(distance: f64, unit: f64) -> f64 {
    let ticks = distance / unit;
    if !(distance > 0.0 && ticks.is_finite()) {
        return distance;
    }
    let whole = (0.5 * ((1.0 + 8.0 * ticks).sqrt() - 1.0)).floor();
    let fraction = ticks / (whole + 1.0) - 0.5 * whole;
    ((whole + fraction) * unit).min(distance)
}
