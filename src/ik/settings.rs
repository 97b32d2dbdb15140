//! The limits of joints, as settings.

use super::Ik;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::IntoId;
use crate::kind;

/// # Limits
impl Ik {
    /// Sets the largest speed of a joint, m/s or rad/s, of each of its degrees of freedom; infinity
    /// for no limit.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown joint, [`Error::Invalid`] for
    /// a negative number or NaN.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn set_velocity_limit(&mut self, joint: impl IntoId<kind::Joint>, limit: f64) -> Result<()> {
        check("a limit of velocity", limit)?;
        let dofs = self.dofs(joint)?;
        self.limits.velocities[dofs].fill(limit);
        Ok(())
    }

    /// Sets the largest speed of all joints except free ones.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for a negative number or NaN.
    pub fn set_velocity_limits(&mut self, limit: f64) -> Result<()> {
        check("a limit of velocity", limit)?;
        let model = self.model.clone();
        for joint in 0..model.njnt() {
            if JointType::of_field(model.jnt_type()[joint]) != JointType::Free {
                self.set_velocity_limit(joint, limit)?;
            }
        }
        Ok(())
    }

    /// Sets the largest acceleration of a joint, m/s² or rad/s², with respect to the velocity of
    /// the last tick; infinity for no limit. A hinge or a slide then also brakes before the end of
    /// its range.
    ///
    /// # Errors
    ///
    /// As for [`set_velocity_limit`](Self::set_velocity_limit).
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn set_acceleration_limit(&mut self, joint: impl IntoId<kind::Joint>, limit: f64) -> Result<()> {
        check("a limit of acceleration", limit)?;
        let dofs = self.dofs(joint)?;
        self.limits.accelerations[dofs].fill(limit);
        Ok(())
    }

    /// Sets the distance, m or rad, that hinges and slides keep from the ends of their ranges; 0 by
    /// default.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for a number that is negative or not finite.
    pub fn set_position_margin(&mut self, margin: f64) -> Result<()> {
        Error::check_not_negative("a margin of positions", margin)?;
        self.limits.margin = margin;
        Ok(())
    }

    /// Prescribes the velocity of a joint, as in `qvel`, which then ignores its limits: zero keeps
    /// a base where it is. `None` makes the joint free again.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown joint, [`Error::Shape`] for a
    /// wrong length, [`Error::Invalid`] for a number that is not finite.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn prescribe_velocity(&mut self, joint: impl IntoId<kind::Joint>, velocity: Option<&[f64]>) -> Result<()> {
        let dofs = self.dofs(joint)?;
        let Some(velocity) = velocity else {
            self.limits.prescribed[dofs].fill(None);
            return Ok(());
        };
        Error::check_length("a prescribed velocity", velocity.len(), dofs.len())?;
        Error::check_finite(velocity, |_| "a prescribed velocity".to_owned())?;
        self.limits.prescribed[dofs].iter_mut().zip(velocity).for_each(|(place, value)| *place = Some(*value));
        Ok(())
    }

    /// Sets the damping of the displacement relative to the mean diagonal of the matrix of the
    /// tasks; 1e-9 by default. It selects the shortest displacement where the tasks leave freedom.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for a number that is negative or not finite.
    pub fn set_regularisation(&mut self, regularisation: f64) -> Result<()> {
        Error::check_not_negative("the regularisation", regularisation)?;
        self.objective.regularisation = regularisation;
        Ok(())
    }

    fn dofs(&self, joint: impl IntoId<kind::Joint>) -> Result<std::ops::Range<usize>> {
        let joint = joint.id_in(&*self.model)?.index();
        let first = ffi::size(self.model.jnt_dofadr()[joint]);
        let next = self.model.jnt_dofadr().get(joint + 1).map_or(self.model.nv(), |next| ffi::size(*next));
        Ok(first..next)
    }
}

fn check(what: &str, limit: f64) -> Result<()> {
    Error::check_range(limit >= 0.0, what, limit, "not negative")
}
