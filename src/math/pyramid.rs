//! Contact forces, as normal and tangential components and as the edges of a friction pyramid.
//!
//! A contact of dimension `dim` has a normal force and `dim − 1` frictional ones, with as many coefficients `mu`. The pyramid has
//! two edges for each, `normal ± mu[i] tangent[i]`, and the force is a sum of the edges with coefficients that are not negative.
//! A contact without friction (`dim` of 1) has one number in either form.

use mujoco_sys as sys;

use super::count;
use crate::error::{Error, Result};

/// The coefficients of the edges, `2 (dim − 1)` or 1, from the force, `dim`: normal, then tangential. Friction beyond what the
/// pyramid allows is cut off on one side, so [`decode_pyramid`] brings back only forces inside.
///
/// # Errors
///
/// [`Error::Shape`] unless `force` has one number more than `mu`, and `pyramid` twice as many (or one, if `mu` is empty).
///
/// ```
/// use mujoco_safe::math;
///
/// let (mu, force) = ([0.5, 0.5], [10.0, 1.0, -2.0]);
/// let mut pyramid = [0.0; 4];
/// math::encode_pyramid(&mut pyramid, &force, &mu)?;
/// let mut again = [0.0; 3];
/// math::decode_pyramid(&mut again, &pyramid, &mu)?;
/// assert_eq!(again, force);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[doc(alias = "mju_encodePyramid")]
pub fn encode_pyramid(pyramid: &mut [f64], force: &[f64], mu: &[f64]) -> Result<()> {
    Error::check_length("the pyramid of encode_pyramid", pyramid.len(), edges(mu))?;
    Error::check_length("the force of encode_pyramid", force.len(), mu.len().saturating_add(1))?;
    let dim = count("encode_pyramid", force.len())?;
    count("encode_pyramid", pyramid.len())?;
    if mu.is_empty() {
        pyramid.copy_from_slice(force);
        return Ok(());
    }
    // SAFETY: 2 (dim − 1) numbers to write, dim and dim − 1 to read.
    unsafe { sys::mju_encodePyramid(pyramid.as_mut_ptr(), force.as_ptr(), mu.as_ptr(), dim) };
    Ok(())
}

/// The force, `dim`: normal, then tangential, from the coefficients of the edges, `2 (dim − 1)` or 1.
///
/// # Errors
///
/// [`Error::Shape`] unless `force` has one number more than `mu`, and `pyramid` twice as many (or one, if `mu` is empty).
#[doc(alias = "mju_decodePyramid")]
pub fn decode_pyramid(force: &mut [f64], pyramid: &[f64], mu: &[f64]) -> Result<()> {
    Error::check_length("the pyramid of decode_pyramid", pyramid.len(), edges(mu))?;
    Error::check_length("the force of decode_pyramid", force.len(), mu.len().saturating_add(1))?;
    let dim = count("decode_pyramid", force.len())?;
    count("decode_pyramid", pyramid.len())?;
    // SAFETY: dim numbers to write, 2 (dim − 1) and dim − 1 to read; with dim of 1 the engine reads one number of the pyramid,
    // which it has.
    unsafe { sys::mju_decodePyramid(force.as_mut_ptr(), pyramid.as_ptr(), mu.as_ptr(), dim) };
    Ok(())
}

fn edges(mu: &[f64]) -> usize {
    if mu.is_empty() { 1 } else { mu.len().saturating_mul(2) }
}
