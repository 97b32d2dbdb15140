//! Quantities with limits that are not a degree of freedom: distances between geoms, rotations of
//! balls, and lengths of tendons.

use super::collision::Pair;
use super::limit::Limit;
use crate::data::Data;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{Id, JointId, TendonId};
use crate::math::quat2vel;
use crate::matrix::Matrix;
use crate::model::Model;
use crate::numerics::spatial::norm;

/// Quantity whose limits are a row of the constraints.
#[derive(Clone, Copy, Debug)]
pub(super) enum Inequality {
    Distance(Pair),
    Rotation(Ball),
    Length(TendonId),
}

impl From<Pair> for Inequality {
    fn from(pair: Pair) -> Self {
        Self::Distance(pair)
    }
}

impl Inequality {
    pub(super) fn cause(self) -> Limit {
        match self {
            Self::Distance(pair) => Limit::Distance(pair.geoms[0], pair.geoms[1]),
            Self::Rotation(ball) => Limit::Position(ball.joint),
            Self::Length(tendon) => Limit::Tendon(tendon),
        }
    }

    /// Writes the derivative of the quantity to a row of zeros, and returns its smallest and its
    /// largest change.
    pub(super) fn write(self, data: &mut Data, buffers: &mut [Matrix; 2], row: &mut [f64]) -> Result<[f64; 2]> {
        match self {
            Self::Distance(pair) => Ok([pair.write(data, buffers, row)?, f64::INFINITY]),
            Self::Rotation(ball) => Ok([f64::NEG_INFINITY, ball.write(data, row)]),
            Self::Length(tendon) => {
                data.tendon_row(tendon.index()).iter().for_each(|(dof, moment)| row[dof] = moment);
                room(data, tendon)
            }
        }
    }

    /// Returns the distance of the quantity from its limits, which is not above zero within them.
    pub(super) fn violation(self, data: &mut Data) -> Result<f64> {
        match self {
            Self::Distance(pair) => pair.violation(data),
            Self::Rotation(ball) => Ok(ball.excess(data.model(), data.qpos())),
            Self::Length(tendon) => room(data, tendon).map(|[lower, upper]| lower.max(-upper)),
        }
    }
}

/// Returns the balls and the tendons that have a range.
pub(super) fn of_ranges(model: &Model) -> impl Iterator<Item = Inequality> {
    let is_limited_ball = |joint: &usize| {
        JointType::of_field(model.jnt_type()[*joint]) == JointType::Ball && model.jnt_limited()[*joint] != 0
    };
    let ball = |joint| Inequality::Rotation(Ball { joint: Id::new(joint, model.lineage()), is_inside: false });
    let balls = (0..model.njnt()).filter(is_limited_ball).map(ball);
    let tendons = (0..model.ntendon()).filter(|&tendon| model.tendon_limited()[tendon] != 0);
    balls.chain(tendons.map(|tendon| Inequality::Length(Id::new(tendon, model.lineage()))))
}

/// Returns the distances from the length of a tendon to the ends of its range.
fn room(data: &Data, tendon: TendonId) -> Result<[f64; 2]> {
    let tendon = tendon.index();
    let length = data.ten_length()[tendon];
    let room = data.model().tendon_range()[tendon].map(|end| end - length);
    if room[0] <= room[1] {
        return Ok(room);
    }
    let range = format!("{length} in {:?}", data.model().tendon_range()[tendon]);
    Err(Error::out_of_range(format!("the length of tendon {tendon} and its range"), range, "finite, in this order"))
}

/// Ball with a range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) joint: JointId,
    /// True if the joint was within its range before the last motion.
    pub(super) is_inside: bool,
}

impl Ball {
    /// Returns the largest angle.
    fn range(self, model: &Model) -> f64 {
        model.jnt_range()[self.joint.index()][1]
    }

    /// Returns the axis and the angle of the rotation from the reference, if the axis is defined.
    fn rotation(self, model: &Model, qpos: &[f64]) -> Option<([f64; 3], f64)> {
        let quaternion = qpos[ffi::size(model.jnt_qposadr()[self.joint.index()])..].first_chunk()?;
        let vector = quat2vel(quaternion, 1.0);
        let angle = norm(&vector);
        (angle > 1e-6).then(|| (vector.map(|value| value / angle), angle))
    }

    /// Returns the part of the angle above the range.
    pub(super) fn excess(self, model: &Model, qpos: &[f64]) -> f64 {
        self.rotation(model, qpos).map_or(0.0, |(_, angle)| angle) - self.range(model)
    }

    /// Writes the derivative of the angle, and returns its largest change. A ball outside of its
    /// range does not move farther out.
    fn write(self, data: &Data, row: &mut [f64]) -> f64 {
        let model = data.model();
        let Some((axis, angle)) = self.rotation(model, data.qpos()) else { return f64::INFINITY };
        row[ffi::size(model.jnt_dofadr()[self.joint.index()])..][..3].copy_from_slice(&axis);
        (self.range(model) - angle).max(0.0)
    }

    /// Brings a rotation that exceeds the range back to its end.
    pub(super) fn clamp(self, model: &Model, qpos: &mut [f64]) {
        let (sin, cos) = (0.5 * self.range(model)).sin_cos();
        if let Some((axis, angle)) = self.rotation(model, qpos)
            && angle > self.range(model)
        {
            let quaternion = [cos, sin * axis[0], sin * axis[1], sin * axis[2]];
            qpos[ffi::size(model.jnt_qposadr()[self.joint.index()])..][..4].copy_from_slice(&quaternion);
        }
    }
}
