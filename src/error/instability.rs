//! Values of a simulation outside the engine's valid range.

use std::fmt;

use crate::kind::Kind;

/// Field with a value outside the engine's valid range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum UnstableField {
    /// A value in `qpos`.
    Position,
    /// A value in `qvel`.
    Velocity,
    /// A value in `qacc`. The state itself was in range.
    Acceleration,
    /// A value in `ctrl`. (The engine would set all controls to zero for one step.)
    Control,
}

/// A value of the simulation that is NaN or beyond ±10¹⁰. The engine itself would reset the
/// simulation, print a warning and continue.
///
/// Positions, velocities and controls are checked before the engine is called. In that case the
/// data is unchanged, and a program can correct the value. An acceleration that is out of range,
/// and a control that a [closure](crate::callback::Callbacks::with_control) sets, are detected
/// during the call, which poisons the data: see [`Error::Poisoned`](crate::Error::Poisoned).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Instability {
    /// The field that is out of range.
    pub field: UnstableField,
    /// Index in `qpos`, `qvel`, `qacc` or `ctrl`.
    pub index: usize,
    /// Name of the joint or actuator that the index belongs to, if it has a name.
    pub name: Option<String>,
    /// The value. `None` for an acceleration, which the engine has overwritten.
    pub value: Option<f64>,
    /// Simulated time, s.
    pub time: f64,
}

impl std::error::Error for Instability {}

impl fmt::Display for Instability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (array, kind) = match self.field {
            UnstableField::Position => ("qpos", Kind::Joint),
            UnstableField::Velocity => ("qvel", Kind::Joint),
            UnstableField::Acceleration => ("qacc", Kind::Joint),
            UnstableField::Control => ("ctrl", Kind::Actuator),
        };
        let problem = if self.field == UnstableField::Control {
            "a control is out of range"
        } else {
            "the simulation is unstable"
        };
        write!(f, "{problem} at time {} s: {array}[{}]", self.time, self.index)?;
        if let Some(name) = &self.name {
            write!(f, " of {kind} '{name}'")?;
        }
        match self.value {
            Some(value) => write!(f, " is {value}, but must be between -1e10 and 1e10"),
            None => write!(
                f,
                " is not between -1e10 and 1e10; try a smaller timestep, or softer contacts and joints with more damping"
            ),
        }
    }
}
