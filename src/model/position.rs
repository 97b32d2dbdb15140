//! Differentiation and integration of positions. A position contains quaternions, so it can have
//! more components than degrees of freedom. The difference of two positions is a velocity in the
//! tangent space, not the difference of the vectors.

use mujoco_sys as sys;

use super::Model;
use crate::error::{Error, Result};

/// # Differences and integrals of positions
impl Model {
    /// Computes the constant velocity `qvel` (`nv`) that leads from `qpos1` to `qpos2` (`nq` each)
    /// in the time `dt` in seconds. If `dt` is 1, the result is the difference of the positions in
    /// the tangent space, which is the state error of a controller.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length, [`Error::Invalid`] if `dt` is zero or not finite.
    ///
    /// ```
    /// use mujoco_safe::sample;
    ///
    /// let model = sample::humanoid();
    /// let (from, mut to) = (model.qpos0().to_vec(), model.qpos0().to_vec());
    /// let velocity = vec![0.1; model.nv()];
    /// model.integrate_pos(&mut to, &velocity, 1.0)?;
    /// let mut difference = vec![0.0; model.nv()];
    /// model.differentiate_pos_into(1.0, &from, &to, &mut difference)?;
    /// assert!(difference.iter().zip(&velocity).all(|(a, b)| (a - b).abs() < 1e-12));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_differentiatePos")]
    #[inline]
    pub fn differentiate_pos_into(&self, dt: f64, qpos1: &[f64], qpos2: &[f64], qvel: &mut [f64]) -> Result<()> {
        Error::check_length("qvel of differentiate_pos_into", qvel.len(), self.nv())?;
        Error::check_length("qpos1 of differentiate_pos_into", qpos1.len(), self.nq())?;
        Error::check_length("qpos2 of differentiate_pos_into", qpos2.len(), self.nq())?;
        check_interval(dt, dt != 0.0, "finite and not zero")?;
        // SAFETY: the lengths are those that the engine writes and reads; no value is used as an
        // index or address.
        unsafe { sys::mj_differentiatePos(self.as_ptr(), qvel.as_mut_ptr(), dt, qpos1.as_ptr(), qpos2.as_ptr()) }
        Ok(())
    }

    /// Integrates the velocity `qvel` (`nv`) over the time `dt` in seconds and adds the result to
    /// `qpos` (`nq`).
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length, [`Error::Invalid`] if `dt` is not finite.
    #[doc(alias = "mj_integratePos")]
    #[inline]
    pub fn integrate_pos(&self, qpos: &mut [f64], qvel: &[f64], dt: f64) -> Result<()> {
        Error::check_length("qpos of integrate_pos", qpos.len(), self.nq())?;
        Error::check_length("qvel of integrate_pos", qvel.len(), self.nv())?;
        check_interval(dt, true, "finite")?;
        // SAFETY: as above.
        unsafe { sys::mj_integratePos(self.as_ptr(), qpos.as_mut_ptr(), qvel.as_ptr(), dt) }
        Ok(())
    }

    /// Normalises every quaternion in `qpos` (`nq`). A zero quaternion becomes the identity.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length.
    ///
    /// ```
    /// use mujoco_safe::sample;
    ///
    /// let model = sample::humanoid();
    /// let mut qpos = vec![2.0; model.nq()];
    /// model.normalize_quat(&mut qpos)?;
    /// assert_eq!(qpos[2..8], [2.0, 0.5, 0.5, 0.5, 0.5, 2.0]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_normalizeQuat")]
    pub fn normalize_quat(&self, qpos: &mut [f64]) -> Result<()> {
        Error::check_length("qpos of normalize_quat", qpos.len(), self.nq())?;
        // SAFETY: the length is that which the engine writes.
        unsafe { sys::mj_normalizeQuat(self.as_ptr(), qpos.as_mut_ptr()) };
        Ok(())
    }

    /// Writes the difference between two physics states `[qpos; qvel; act]` in tangent coordinates,
    /// `(2 nv + na)`.
    pub(crate) fn differentiate_state_into(&self, from: &[f64], to: &[f64], result: &mut [f64]) -> Result<()> {
        let (nq, nv) = (self.nq(), self.nv());
        self.differentiate_pos_into(1.0, &from[..nq], &to[..nq], &mut result[..nv])?;
        let rest = from[nq..].iter().zip(&to[nq..]);
        result[nv..].iter_mut().zip(rest).for_each(|(result, (from, to))| *result = to - from);
        Ok(())
    }

    /// Moves a physics state by a vector of tangent coordinates.
    pub(crate) fn integrate_state(&self, state: &mut [f64], by: &[f64]) -> Result<()> {
        let (nq, nv) = (self.nq(), self.nv());
        self.integrate_pos(&mut state[..nq], &by[..nv], 1.0)?;
        state[nq..].iter_mut().zip(&by[nv..]).for_each(|(value, by)| *value += by);
        Ok(())
    }
}

fn check_interval(dt: f64, allowed: bool, expected: &str) -> Result<()> {
    if dt.is_finite() && allowed { Ok(()) } else { Err(Error::out_of_range("dt", dt, expected)) }
}
