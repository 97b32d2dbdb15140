//! Results that a call needs before it.

use std::fmt;

use super::{Computed, Stage};

/// Results that a call needs: those of a whole [`Stage`], or of some parts of the pipeline. An argument of
/// [`Data::require`](crate::Data::require), and a field of [`Error::NotComputed`](crate::Error::NotComputed).
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Needs(Need);

#[derive(Clone, Copy, PartialEq, Eq)]
enum Need {
    Stage(Stage),
    Parts(Computed),
    FirstHalf,
}

impl Needs {
    /// The parts that are missing.
    pub(super) const fn parts(missing: Computed) -> Self {
        Self(Need::Parts(missing))
    }

    /// A first half of a step that is still valid.
    pub(super) const FIRST_HALF: Self = Self(Need::FirstHalf);

    /// The readings of all sensors, `sensordata`. [`Data::forward`](crate::Data::forward), [`step`](crate::Data::step) and
    /// [`inverse`](crate::Data::inverse) compute them.
    pub const SENSORS: Self = Self(Need::Parts(Computed::SENSORS));
    /// Accelerations of bodies and forces on them: `cacc`, `cfrc_int`, `cfrc_ext`.
    /// [`Data::rne_post_constraint`](crate::Data::rne_post_constraint) computes them, `forward` and `step` do not.
    pub const BODY_FORCES: Self = Self(Need::Parts(Computed::POST_CONSTRAINT));
    /// Velocities and angular momenta of subtrees: `subtree_linvel`, `subtree_angmom`.
    /// [`Data::subtree_vel`](crate::Data::subtree_vel) computes them, `forward` and `step` do not.
    pub const SUBTREE_VELOCITIES: Self = Self(Need::Parts(Computed::SUBTREE_VEL));

    /// The results that are missing from `computed`, if any.
    #[inline]
    pub(super) fn missing(self, computed: Computed) -> Option<Self> {
        match self.0 {
            Need::Stage(stage) => (!computed.contains(stage.into())).then_some(self),
            Need::FirstHalf => (!computed.contains(Computed::FIRST_HALF)).then_some(self),
            Need::Parts(parts) => {
                let missing = parts - computed;
                (!missing.is_empty()).then(|| Self::parts(missing))
            }
        }
    }

    /// Since when the results are missing, and which call computes them.
    pub(crate) fn remedy(self) -> &'static str {
        match self.0 {
            Need::Stage(_) => "since the last reset or change of the model: call forward or step first",
            Need::FirstHalf => {
                "since the last step, reset or change of the model: call step1 first, once for each step2"
            }
            Need::Parts(parts) if parts.intersects(Computed::NOT_IN_FORWARD) => {
                "since the last step, reset, change of the model or change of what they are made of: call these after forward \
                 or step, which do not compute them"
            }
            Need::Parts(_) => {
                "since the last step, reset, change of the model or change of what they are made of: call these first, in \
                 this order, or forward"
            }
        }
    }
}

impl From<Stage> for Needs {
    fn from(stage: Stage) -> Self {
        Self(Need::Stage(stage))
    }
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let missing = match self.0 {
            Need::Stage(stage) => return stage.fmt(f),
            Need::FirstHalf => return Stage::Velocity.fmt(f),
            Need::Parts(missing) => missing,
        };
        f.write_str("the results of ")?;
        // The positions of a state that was advanced are those of another one.
        let missing = if missing.contains(Computed::CURRENT) { missing | Computed::KINEMATICS } else { missing };
        let parts = Computed::PARTS.iter().filter(|(part, ..)| missing.contains(*part));
        for (index, (_, _, method)) in parts.enumerate() {
            write!(f, "{}{method}", if index > 0 { ", " } else { "" })?;
        }
        Ok(())
    }
}

impl fmt::Debug for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Needs({self})")
    }
}
