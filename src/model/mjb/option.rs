//! `mjOption` and `mjVisual`: the numbers in them that choose code or measure memory.

use std::mem::offset_of;
use std::ops::RangeInclusive;

use mujoco_sys::{
    mjCOL_DYNAMIC, mjCONE_ELLIPTIC, mjINT_IMPLICIT, mjJAC_AUTO, mjNDISABLE, mjNENABLE, mjOption, mjSOL_NEWTON, mjVisual,
};

use super::invalid::Invalid;
use super::rule::must_be;
use super::view::View;
use crate::model::options::{LARGEST_IMAGE, MOST_SAMPLES, MOST_SLICES};

/// The engine stops for nothing else: two thousand million iterations at a tolerance of zero do not come back.
const MOST_ITERATIONS: i64 = 1_000_000;

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
        ("opt.iterations", offset_of!(mjOption, iterations), 0..=MOST_ITERATIONS),
        ("opt.noslip_iterations", offset_of!(mjOption, noslip_iterations), 0..=MOST_ITERATIONS),
        ("opt.mpr_iterations", offset_of!(mjOption, mpr_iterations), 0..=MOST_ITERATIONS),
        ("opt.disableflags", offset_of!(mjOption, disableflags), 0..=(1 << mjNDISABLE) - 1),
        ("opt.enableflags", offset_of!(mjOption, enableflags), 0..=(1 << mjNENABLE) - 1),
    ];
    for (name, offset, range) in options {
        in_range(name, view.option(offset), &range)?;
    }
    // The head light's `active` is a switch that any number but zero turns on.
    let visuals: Rules<7> = [
        ("vis.global.offwidth", offset_of!(mjVisual, global.offwidth), 1..=LARGEST_IMAGE as i64),
        ("vis.global.offheight", offset_of!(mjVisual, global.offheight), 1..=LARGEST_IMAGE as i64),
        ("vis.quality.shadowsize", offset_of!(mjVisual, quality.shadowsize), 0..=LARGEST_IMAGE as i64),
        ("vis.quality.offsamples", offset_of!(mjVisual, quality.offsamples), 0..=MOST_SAMPLES as i64),
        ("vis.quality.numslices", offset_of!(mjVisual, quality.numslices), 1..=MOST_SLICES as i64),
        ("vis.quality.numstacks", offset_of!(mjVisual, quality.numstacks), 1..=MOST_SLICES as i64),
        ("vis.quality.numquads", offset_of!(mjVisual, quality.numquads), 1..=MOST_SLICES as i64),
    ];
    for (name, offset, range) in visuals {
        in_range(name, view.visual(offset), &range)?;
    }
    Ok(())
}

fn in_range(name: &str, value: i32, range: &RangeInclusive<i64>) -> Result<(), Invalid> {
    if range.contains(&value.into()) { Ok(()) } else { Err(Invalid::scalar(name, value, must_be(range))) }
}
