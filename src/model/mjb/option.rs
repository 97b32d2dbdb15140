//! `mjOption`: the numbers that select code or bound loops.
//!
//! The integers of `mjVisual` need no check: the renderer clamps them.

use std::mem::offset_of;
use std::ops::RangeInclusive;

use mujoco_sys::{
    mjCOL_DYNAMIC, mjCONE_ELLIPTIC, mjINT_IMPLICIT, mjJAC_AUTO, mjNDISABLE, mjNENABLE, mjOption, mjSOL_NEWTON,
};

use super::invalid::Invalid;
use super::rule::must_be;
use super::view::View;

/// 2^31 iterations at a tolerance of zero practically never end.
const MOST_ITERATIONS: i64 = 1_000_000;

/// The solvers treat a negative number of iterations as zero. (libccd casts it to an unsigned integer, so `mpr_iterations` must
/// not be negative.)
const SOLVER_ITERATIONS: RangeInclusive<i64> = i32::MIN as i64..=MOST_ITERATIONS;

/// Offsets and permitted values in a struct.
type Rules<const N: usize> = [(&'static str, usize, RangeInclusive<i64>); N];

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    let timestep: f64 = view.option(offset_of!(mjOption, timestep));
    if !(timestep.is_finite() && timestep > 0.0) {
        return Err(Invalid::scalar("opt.timestep", timestep, "it must be finite and positive"));
    }
    let options: Rules<10> = [
        ("opt.integrator", offset_of!(mjOption, integrator), 0..=mjINT_IMPLICIT.into()),
        ("opt.collision", offset_of!(mjOption, collision), 0..=mjCOL_DYNAMIC.into()),
        ("opt.cone", offset_of!(mjOption, cone), 0..=mjCONE_ELLIPTIC.into()),
        ("opt.jacobian", offset_of!(mjOption, jacobian), 0..=mjJAC_AUTO.into()),
        ("opt.solver", offset_of!(mjOption, solver), 0..=mjSOL_NEWTON.into()),
        ("opt.iterations", offset_of!(mjOption, iterations), SOLVER_ITERATIONS),
        ("opt.noslip_iterations", offset_of!(mjOption, noslip_iterations), SOLVER_ITERATIONS),
        ("opt.mpr_iterations", offset_of!(mjOption, mpr_iterations), 0..=MOST_ITERATIONS),
        ("opt.disableflags", offset_of!(mjOption, disableflags), 0..=(1 << mjNDISABLE) - 1),
        ("opt.enableflags", offset_of!(mjOption, enableflags), 0..=(1 << mjNENABLE) - 1),
    ];
    for (name, offset, range) in options {
        in_range(name, view.option(offset), &range)?;
    }
    Ok(())
}

fn in_range(name: &str, value: i32, range: &RangeInclusive<i64>) -> Result<(), Invalid> {
    if range.contains(&value.into()) { Ok(()) } else { Err(Invalid::scalar(name, value, must_be(range))) }
}
