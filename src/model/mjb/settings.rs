//! Sizes and options.
//!
//! The checks of sizes cover those that nothing else in the file bounds. They determine the memory
//! of a model and its data, and the magnitude of products that the engine computes in C ints. The
//! checks of `mjOption` cover the values that select code or bound loops. The integers of
//! `mjVisual` need no check, because the renderer clamps them.

use std::mem::offset_of;
use std::ops::RangeInclusive;

use mujoco_sys::{mjCONE_ELLIPTIC, mjJAC_AUTO, mjNDISABLE, mjNENABLE, mjOption, mjSOL_NEWTON};

use super::invalid::Invalid;
use super::layout::{Array, DATA_ARRAYS, MODEL_ARRAYS, Size, size};
use super::rule::{must_be, size_is};
use super::view::{View, array_bytes};

/// Alignment in bytes of each array in the engine's buffers.
const ALIGNMENT: u128 = 64;

/// Largest memory of the engine's stack, 8 GiB, in the unit of the size. In 2.2.2 the engine's
/// buffer sizes, stack marks and products are C ints. The engine adds the size of the next block to
/// a stack mark before it compares the sum with the end of the stack, so the sum must not overflow.
/// The compiler assigns hundreds of millions to models with many contacts. Newer engines compute
/// with 64 bits. Their limit is 1 TiB, which no machine has.
#[cfg(not(engine_since = "3.5.0"))]
const STACK: (Size, usize, &str) = (size::nstack, (1 << 30) - 1, "numbers, which is 8 GiB");
#[cfg(engine_since = "3.5.0")]
const STACK: (Size, usize, &str) = (size::narena, 1 << 40, "bytes");

const LARGEST_PRODUCT: u64 = 1 << 30;

/// Limit on solver iterations: 2^31 iterations with a tolerance of zero practically never end.
const MOST_ITERATIONS: i64 = 1_000_000;

/// The solvers treat a negative number of iterations as zero. (libccd casts it to an unsigned
/// integer, so `mpr_iterations` must not be negative.)
const SOLVER_ITERATIONS: RangeInclusive<i64> = i32::MIN as i64..=MOST_ITERATIONS;

/// Name, offset and valid values of a field of `mjOption`.
type Rule = (&'static str, usize, RangeInclusive<i64>);

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    sizes(view)?;
    options(view)
}

fn sizes(view: &View<'_>) -> Result<(), Invalid> {
    if view.size(size::nbody) == 0 {
        return Err(Invalid::scalar("nbody", 0, "it must be at least 1, for the world body"));
    }
    let model = buffer_bytes(MODEL_ARRAYS, view);
    size_is(view, size::nbuffer, u64::try_from(model).unwrap_or(u64::MAX), "the bytes of its arrays in memory")?;

    let data = buffer_bytes(DATA_ARRAYS, view);
    if data > i32::MAX as u128 {
        return Err(Invalid::file(format!(
            "the simulation data would have {data} bytes (njmax {}, nconmax {}, nv {}, …); the engine can address {}",
            view.size(size::njmax),
            view.size(size::nconmax),
            view.size(size::nv),
            i32::MAX
        )));
    }
    let (stack, largest, unit) = STACK;
    if view.size(stack) > largest {
        return Err(Invalid::scalar(stack.name(), view.size(stack), format!("it must be at most {largest} {unit}")));
    }
    products(view)
}

/// Checks the sizes of those blocks on the engine's stack that are products. Products with `njmax`,
/// `ntendon` or `nu` as a factor also occur in `mjData` and are bounded there.
fn products(view: &View<'_>) -> Result<(), Invalid> {
    let [nv, nbody, na, nu, nsensordata] =
        [size::nv, size::nbody, size::na, size::nu, size::nsensordata].map(|size| view.size(size) as u64);
    let state = 2 * nv + na;
    // The rows of the constraint Jacobian without contacts: equalities, friction, limits. In 2.2.2
    // `njmax` bounds them.
    let rows = if cfg!(engine_since = "3.5.0") {
        let [nemax, njnt, ntendon] = [size::nemax, size::njnt, size::ntendon].map(|size| view.size(size) as u64);
        nemax + nv + 2 * njnt + 3 * ntendon
    } else {
        0
    };
    for (name, factors) in [
        ("6 nv nv", [6 * nv, nv]),
        ("6 nbody nv", [6 * nbody, nv]),
        ("nbody nbody", [nbody, nbody]),
        // Linearisation: the matrices A, B, C and D.
        ("(2 nv + na)²", [state, state]),
        ("(2 nv + na) nu", [state, nu]),
        ("(2 nv + na) nsensordata", [state, nsensordata]),
        ("nu nsensordata", [nu, nsensordata]),
        ("the rows of constraints without contacts times nv", [rows, nv]),
    ] {
        // Each factor is below 2^34.
        let product = u128::from(factors[0]) * u128::from(factors[1]);
        if product > u128::from(LARGEST_PRODUCT) {
            return Err(Invalid::scalar(name, product, format!("more than {LARGEST_PRODUCT} overflows in the engine")));
        }
    }
    // The signature of a pair of bodies packs two ids into an int, 16 bits each.
    if nbody >= i16::MAX as u64 {
        return Err(Invalid::scalar("nbody", nbody, format!("it must be below {}", i16::MAX)));
    }
    Ok(())
}

/// Returns the number of bytes that the engine allocates for a list of arrays.
fn buffer_bytes(arrays: &[Array], view: &View<'_>) -> u128 {
    arrays.iter().fold(0, |end: u128, array| end.next_multiple_of(ALIGNMENT) + array_bytes(array, view.sizes()))
}

fn options(view: &View<'_>) -> Result<(), Invalid> {
    let timestep: f64 = view.option(offset_of!(mjOption, timestep));
    if !(timestep.is_finite() && timestep > 0.0) {
        return Err(Invalid::scalar("opt.timestep", timestep, "it must be finite and positive"));
    }
    let rules: [Rule; 7] = [
        ("opt.cone", offset_of!(mjOption, cone), 0..=mjCONE_ELLIPTIC.into()),
        ("opt.jacobian", offset_of!(mjOption, jacobian), 0..=mjJAC_AUTO.into()),
        ("opt.solver", offset_of!(mjOption, solver), 0..=mjSOL_NEWTON.into()),
        ("opt.iterations", offset_of!(mjOption, iterations), SOLVER_ITERATIONS),
        ("opt.noslip_iterations", offset_of!(mjOption, noslip_iterations), SOLVER_ITERATIONS),
        ("opt.disableflags", offset_of!(mjOption, disableflags), 0..=(1 << mjNDISABLE) - 1),
        ("opt.enableflags", offset_of!(mjOption, enableflags), 0..=(1 << mjNENABLE) - 1),
    ];
    for (name, offset, range) in versioned_rules().into_iter().chain(rules) {
        let value: i32 = view.option(offset);
        if !range.contains(&value.into()) {
            return Err(Invalid::scalar(name, value, must_be(&range)));
        }
    }
    Ok(())
}

/// Returns the rules for options that differ between the versions.
#[cfg(not(engine_since = "3.5.0"))]
fn versioned_rules() -> Vec<Rule> {
    vec![
        ("opt.integrator", offset_of!(mjOption, integrator), 0..=mujoco_sys::mjINT_IMPLICIT.into()),
        ("opt.collision", offset_of!(mjOption, collision), 0..=mujoco_sys::mjCOL_DYNAMIC.into()),
        ("opt.mpr_iterations", offset_of!(mjOption, mpr_iterations), 0..=MOST_ITERATIONS),
    ]
}

/// Returns the rules for options that differ between the versions. The bits of `disableactuator`
/// are groups of actuators. The parameters of signed distance fields have no effect without them.
#[cfg(engine_since = "3.5.0")]
fn versioned_rules() -> Vec<Rule> {
    vec![
        ("opt.integrator", offset_of!(mjOption, integrator), 0..=mujoco_sys::mjINT_IMPLICITFAST.into()),
        ("opt.ls_iterations", offset_of!(mjOption, ls_iterations), SOLVER_ITERATIONS),
        // The collision solver has space for its first polytope only if it may iterate.
        ("opt.ccd_iterations", offset_of!(mjOption, ccd_iterations), 1..=MOST_ITERATIONS),
        ("opt.sdf_iterations", offset_of!(mjOption, sdf_iterations), SOLVER_ITERATIONS),
    ]
}
