//! How far the pipeline has been computed.

use std::fmt;

/// How far the quantities of a [`Data`](crate::Data) have been computed for its present model, each stage on top of the one
/// before. A reset and a change of the model take it back to nothing; a change of the state does not, since it is usual to
/// read what was computed before it.
///
/// A call that needs more than there is returns [`Error::NotComputed`](crate::Error::NotComputed). Otherwise the engine would
/// read one layout as another, or answer with numbers of an earlier state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[doc(alias = "mjtStage")]
pub enum Stage {
    /// Nothing since the last reset, or since the model was changed.
    Nothing,
    /// What depends on positions: poses, the inertia matrix, contacts, the constraint Jacobian.
    Position,
    /// What depends on velocities too: bias and passive forces.
    Velocity,
    /// Everything: actuator forces, accelerations, contact forces.
    Acceleration,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nothing => "no quantities",
            Self::Position => "position-dependent quantities",
            Self::Velocity => "velocity-dependent quantities",
            Self::Acceleration => "forces and accelerations",
        })
    }
}
