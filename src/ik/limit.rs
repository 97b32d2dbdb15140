//! The limits of a tick, as they are reported.

use crate::id::{GeomId, JointId, TendonId};

/// Limit of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limit {
    /// Range of a joint, also with the distance for braking.
    Position(JointId),
    /// Velocity of a joint.
    Velocity(JointId),
    /// Acceleration of a joint.
    Acceleration(JointId),
    /// Prescribed velocity of a joint.
    Prescribed(JointId),
    /// Range of the length of a tendon.
    Tendon(TendonId),
    /// Distance between two geoms.
    Distance(GeomId, GeomId),
    /// Equality constraint of the model, or a task of a higher priority.
    Equation,
}
