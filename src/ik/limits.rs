//! Limits of the positions, velocities and accelerations of joints, as bounds of the displacement.
//!
//! With a limit a of the acceleration, a hinge must be able to stop at a distance d before the end
//! of its range. From the speed `(k + f) a dt` with an integer k and `0 ≤ f < 1` it stops after k
//! more ticks, on the way `(k + 1)(k/2 + f) a dt²`. The largest speed is the inverse of this
//! function of d. It leaves the same freedom in the next tick, so the bounds never contradict each
//! other.

use super::limit::Limit;
use crate::data::Data;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{Id, JointId};
use crate::math::quat2vel;
use crate::model::Model;

/// Positions and degrees of freedom of a ball with a range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) joint: usize,
    qpos: usize,
    pub(super) dof: usize,
    /// True if the joint was within its range before the last motion.
    is_inside: bool,
}

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
    pub(super) limited_balls: Vec<Ball>,
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
        let balls = (0..model.njnt()).filter(|&joint| {
            JointType::of_field(model.jnt_type()[joint]) == JointType::Ball && model.jnt_limited()[joint] != 0
        });
        let ball = |joint| Ball {
            joint,
            qpos: ffi::size(model.jnt_qposadr()[joint]),
            dof: ffi::size(model.jnt_dofadr()[joint]),
            is_inside: false,
        };
        Self {
            velocities: vec![f64::INFINITY; nv],
            accelerations: vec![f64::INFINITY; nv],
            prescribed: vec![None; nv],
            margin: 0.0,
            lower: vec![0.0; nv],
            upper: vec![0.0; nv],
            causes: vec![[None; 2]; nv],
            limited_balls: balls.map(ball).collect(),
        }
    }

    pub(super) fn fill_velocities(&mut self, model: &Model, limit: f64) {
        for (dof, velocity) in self.velocities.iter_mut().enumerate() {
            let joint = ffi::size(model.dof_jntid()[dof]);
            if JointType::of_field(model.jnt_type()[joint]) != JointType::Free {
                *velocity = limit;
            }
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
            let mut interval = Interval { ends: [f64::NEG_INFINITY, f64::INFINITY], causes: [None; 2] };
            match (self.prescribed[dof], motion) {
                (Some(velocity), _) => {
                    let dt = if let Motion::Timed(dt) = motion { dt } else { 0.0 };
                    let change = (velocity * dt).clamp(f64::MIN, f64::MAX);
                    interval = Interval { ends: [change; 2], causes: [Some(Limit::Prescribed(id)); 2] };
                }
                (None, Motion::Free(largest)) => {
                    interval.intersect([-largest, largest], None);
                }
                (None, Motion::Timed(dt)) => {
                    let change = self.accelerations[dof] * dt;
                    if change < f64::INFINITY {
                        let ends = [(last - change) * dt, (last + change) * dt];
                        interval.intersect(ends, Some(Limit::Acceleration(id)));
                    }
                    let largest = self.velocities[dof] * dt;
                    if !interval.intersect([-largest, largest], Some(Limit::Velocity(id))) {
                        conflicts.push(Limit::Velocity(id));
                    }
                }
            }
            if self.prescribed[dof].is_none() && has_range(model, joint) {
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
                if !interval.intersect(ends, Some(Limit::Position(id))) {
                    conflicts.push(Limit::Position(id));
                }
            }
            [self.lower[dof], self.upper[dof]] = interval.ends;
            self.causes[dof] = interval.causes;
        }
        Ok(())
    }

    /// Returns the largest distance of a position from its range.
    pub(super) fn violation(&self, data: &Data) -> f64 {
        let model = &**data.model();
        let scalars = (0..model.njnt()).filter(|&joint| has_range(model, joint)).map(|joint| {
            let q = data.qpos()[ffi::size(model.jnt_qposadr()[joint])];
            let [from, to] = model.jnt_range()[joint];
            (from - q).max(q - to)
        });
        let balls = self
            .limited_balls
            .iter()
            .map(|ball| ball.rotation(data.qpos()).map_or(0.0, |(_, angle)| angle - model.jnt_range()[ball.joint][1]));
        scalars.chain(balls).fold(0.0, f64::max)
    }

    /// Brings positions that exceed their range by rounding, or by the curvature of rotations, back
    /// to its end.
    fn clamp(&self, model: &Model, qpos: &mut [f64]) {
        const ROUNDING: f64 = 1e-9;
        for joint in (0..model.njnt()).filter(|&joint| has_range(model, joint)) {
            let q = &mut qpos[ffi::size(model.jnt_qposadr()[joint])];
            let [from, to] = model.jnt_range()[joint];
            if *q < from && *q >= from - ROUNDING * (1.0 + from.abs()) {
                *q = from;
            }
            if *q > to && *q <= to + ROUNDING * (1.0 + to.abs()) {
                *q = to;
            }
        }
        for ball in self.limited_balls.iter().filter(|ball| ball.is_inside) {
            let Some((axis, angle)) = ball.rotation(qpos) else { continue };
            let largest = model.jnt_range()[ball.joint][1];
            if angle > largest {
                let (sin, cos) = (0.5 * largest).sin_cos();
                let quaternion = [cos, sin * axis[0], sin * axis[1], sin * axis[2]];
                qpos[ball.qpos..ball.qpos + 4].copy_from_slice(&quaternion);
            }
        }
    }

    /// Moves positions by a displacement for a time, within the ranges of joints that are within
    /// them before.
    pub(super) fn integrate(&mut self, model: &Model, qpos: &mut [f64], velocity: &[f64], dt: f64) -> Result<()> {
        for ball in &mut self.limited_balls {
            let angle = ball.rotation(qpos).map_or(0.0, |(_, angle)| angle);
            ball.is_inside = angle <= model.jnt_range()[ball.joint][1] + 1e-9;
        }
        model.integrate_pos(qpos, velocity, dt)?;
        self.clamp(model, qpos);
        Ok(())
    }
}

impl Ball {
    /// Returns the axis and the angle of the rotation from the reference, if the axis is defined.
    pub(super) fn rotation(self, qpos: &[f64]) -> Option<([f64; 3], f64)> {
        let quaternion: &[f64; 4] = qpos[self.qpos..].first_chunk()?;
        let vector = quat2vel(quaternion, 1.0);
        let angle = vector.iter().map(|value| value * value).sum::<f64>().sqrt();
        (angle > 1e-6).then(|| (vector.map(|value| value / angle), angle))
    }
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
