//! Rigid bodies: frames and velocities, Jacobians, inertia, and moment arms of actuators.

mod frame;
mod inertia;
mod jacobian;
mod jacobian_dot;
mod moment;

pub use self::frame::{Axes, FrameId, SpatialVector};
pub use self::inertia::Accelerations;
pub use self::jacobian::Jacobian;
