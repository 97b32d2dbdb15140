//! Stages of the engine's pipeline, its parts, and the results that a call needs.
//!
//! This module does not depend on [`error`](crate::error), because
//! [`Error::NotComputed`](crate::Error::NotComputed) names the missing results with these types.

mod parts;

use std::fmt;

pub(crate) use self::parts::{PipelineFeatures, PipelineFlags};

/// Progress of the pipeline of a [`Data`](crate::Data) for its present model. Each stage includes
/// the one before it. A reset and a change of the model return it to [`None`](Self::None). A
/// change of the state does not, because programs usually read results after they write the next
/// state.
///
/// A call that needs a later stage returns [`Error::NotComputed`](crate::Error::NotComputed).
/// Without this check the engine would interpret arrays with the wrong layout, or return values of
/// an earlier state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// Nothing has been computed since the last reset or change of the model.
    None,
    /// Quantities that depend on positions: poses, the inertia matrix, contacts, the constraint
    /// Jacobian.
    Position,
    /// Quantities that also depend on velocities: bias and passive forces.
    Velocity,
    /// All quantities, including actuator forces, accelerations and contact forces.
    Acceleration,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "no quantities",
            Self::Position => "position-dependent quantities",
            Self::Velocity => "velocity-dependent quantities",
            Self::Acceleration => "forces and accelerations",
        })
    }
}

/// Effect of [`Data::forward_skip`](crate::Data::forward_skip) and
/// [`Data::inverse_skip`](crate::Data::inverse_skip) on sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SensorUpdate {
    /// Computes the sensors of the stages that are not skipped.
    Compute,
    /// Computes no sensors.
    Skip,
}

impl SensorUpdate {
    /// Returns [`Compute`](Self::Compute) if sensors are needed.
    pub(crate) fn needed(needed: bool) -> Self {
        if needed { Self::Compute } else { Self::Skip }
    }
}

impl From<Stage> for PipelineFlags {
    #[inline]
    fn from(stage: Stage) -> Self {
        match stage {
            Stage::None => Self::empty(),
            Stage::Position => Self::POSITION,
            Stage::Velocity => Self::VELOCITY,
            Stage::Acceleration => Self::FORCES,
        }
    }
}

/// Results that a call needs: the results of a [`Stage`], or of some parts of the pipeline. An
/// argument of [`Data::require`](crate::Data::require), and a field of
/// [`Error::NotComputed`](crate::Error::NotComputed).
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct MissingResults(Missing);

#[derive(Clone, Copy, PartialEq, Eq)]
enum Missing {
    Stage(Stage),
    Parts(PipelineFlags),
    FirstHalf,
}

impl MissingResults {
    /// Valid results of the first half of a step.
    pub(crate) const FIRST_HALF: Self = Self(Missing::FirstHalf);

    /// Readings of all sensors, `sensordata`. [`Data::forward`](crate::Data::forward),
    /// [`step`](crate::Data::step) and [`inverse`](crate::Data::inverse) compute them.
    pub const SENSORS: Self = Self(Missing::Parts(PipelineFlags::SENSORS));
    /// Accelerations of bodies and forces on them: `cacc`, `cfrc_int`, `cfrc_ext`.
    /// [`Data::rne_post_constraint`](crate::Data::rne_post_constraint) computes them; `forward` and
    /// `step` do not.
    pub const BODY_FORCES: Self = Self(Missing::Parts(PipelineFlags::POST_CONSTRAINT));
    /// Velocities and angular momenta of subtrees: `subtree_linvel`, `subtree_angmom`.
    /// [`Data::subtree_vel`](crate::Data::subtree_vel) computes them; `forward` and `step` do not.
    pub const SUBTREE_VELOCITIES: Self = Self(Missing::Parts(PipelineFlags::SUBTREE_VEL));

    /// Returns the results of these parts.
    pub(crate) const fn parts(parts: PipelineFlags) -> Self {
        Self(Missing::Parts(parts))
    }

    /// Returns the results that are not in `valid`, or `None` if all are.
    #[inline]
    pub(crate) fn not_in(self, valid: PipelineFlags) -> Option<Self> {
        match self.0 {
            Missing::Stage(stage) => (!valid.contains(stage.into())).then_some(self),
            Missing::FirstHalf => (!valid.contains(PipelineFlags::FIRST_HALF)).then_some(self),
            Missing::Parts(parts) => {
                let missing = parts - valid;
                (!missing.is_empty()).then(|| Self::parts(missing))
            }
        }
    }

    /// Returns the end of the error text: the events since which the results are missing, and the
    /// call that computes them.
    pub(crate) fn remedy(self) -> &'static str {
        match self.0 {
            Missing::Stage(_) => "since the last reset or change of the model: call forward or step first",
            Missing::FirstHalf => {
                "since the last step, reset or change of the model: call step1 first, once for each step2"
            }
            Missing::Parts(parts) if parts.intersects(PipelineFlags::NOT_IN_FORWARD) => {
                "since the last step, reset, change of the model or change of their inputs: call these after forward or \
                 step, which do not compute them"
            }
            Missing::Parts(_) => {
                "since the last step, reset, change of the model or change of their inputs: call these first, in this \
                 order, or forward"
            }
        }
    }
}

impl From<Stage> for MissingResults {
    fn from(stage: Stage) -> Self {
        Self(Missing::Stage(stage))
    }
}

impl fmt::Display for MissingResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let missing = match self.0 {
            Missing::Stage(stage) => return stage.fmt(f),
            Missing::FirstHalf => return Stage::Velocity.fmt(f),
            Missing::Parts(missing) => missing,
        };
        f.write_str("the results of ")?;
        // After a step the positions belong to the state before it, so they must be computed again.
        let missing =
            if missing.contains(PipelineFlags::CURRENT) { missing | PipelineFlags::KINEMATICS } else { missing };
        for (index, method) in missing.methods().enumerate() {
            write!(f, "{}{method}", if index > 0 { ", " } else { "" })?;
        }
        Ok(())
    }
}

impl fmt::Debug for MissingResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "MissingResults({self})")
    }
}
