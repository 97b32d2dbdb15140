//! Mathematical functions: against the engine's functions where they exist, and against nalgebra,
//! identities or SciPy's numbers; and their size checks.

#[path = "../common/arbitrary.rs"]
mod arbitrary;

mod band;
mod box_qp;
mod cholesky;
mod matrices;
mod newer_engine;
mod numbers;
mod qp;
mod quaternion_derivatives;
mod rotations;
mod row_major;
mod sizes;
mod vectors;

use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A direct call of the C API.
macro_rules! c {
    ($function:ident($($argument:expr),* $(,)?)) => {
        // SAFETY: every test passes arrays of the required sizes.
        unsafe { mujoco_safe::sys::$function($($argument),*) }
    };
}
use c;

fn random(seed: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(seed)
}

/// Returns numbers between −1 and 1.
fn numbers(random: &mut impl Rng, count: usize) -> Vec<f64> {
    (0..count).map(|_| random.random_range(-1.0..1.0)).collect()
}

fn array<const N: usize>(random: &mut impl Rng) -> [f64; N] {
    std::array::from_fn(|_| random.random_range(-1.0..1.0))
}

/// Returns a unit quaternion.
fn unit(random: &mut impl Rng) -> [f64; 4] {
    let quat: [f64; 4] = array(random);
    let length = quat.iter().map(|value| value * value).sum::<f64>().sqrt();
    quat.map(|value| value / length)
}

/// Asserts equality bit for bit.
#[track_caller]
fn assert_same(ours: &[f64], theirs: &[f64]) {
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert!(bits(ours) == bits(theirs), "{ours:?} is not {theirs:?}");
}

#[track_caller]
fn assert_near(ours: &[f64], theirs: &[f64], tolerance: f64) {
    assert_eq!(ours.len(), theirs.len());
    let far = ours.iter().zip(theirs).find(|(a, b)| (*a - *b).abs() > tolerance || a.is_nan() != b.is_nan());
    assert!(far.is_none(), "{far:?} differ by more than {tolerance}: {ours:?} and {theirs:?}");
}
