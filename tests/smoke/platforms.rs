//! The worked example has the same numbers on each platform.

use mujoco_safe::{Data, Differences, Lqr, LqrWeights, sample};

/// A and B of the cart-pole by rows, computed on x86-64 Linux with Debian's library of 2.2.2.
const A_AND_B: [f64; 20] = [
    1.0,
    -0.000_209_335_394_345_964_22,
    0.009_996_967_283_677_69,
    7.112_993_351_890_879e-6,
    0.0,
    1.002_791_836_375_928_7,
    7.112_993_351_890_878e-6,
    0.009_905_136_378_663_615,
    0.0,
    -0.020_933_539_434_596_422,
    0.999_696_728_367_768_9,
    0.000_711_299_335_189_088,
    0.0,
    0.279_183_637_592_873_9,
    0.000_711_299_335_189_087_8,
    0.990_513_637_866_361_5,
    0.003_032_716_322_311_237_6,
    -0.007_112_993_351_890_878,
    0.303_271_632_231_123_74,
    -0.711_299_335_189_087_8,
];

/// The gain.
const K: [f64; 4] =
    [-0.467_416_684_499_119_55, -5.592_715_041_469_39, -0.843_667_710_589_341_3, -1.444_866_856_902_237_4];

/// Largest differences of the entries of A and B, and of K. With 2.2.2, A and B are the same bits
/// on Linux for x86-64 and aarch64 and on Windows, and K on Linux. Newer engines may order some
/// sums differently.
const BOUNDS: [f64; 2] = if cfg!(engine_since = "2.3.0") { [1e-9, 1e-8] } else { [0.0, 1e-12] };

#[test]
fn the_regulator_of_the_cart_pole_is_the_same_on_each_platform() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let system = data.transition_fd(1e-6, Differences::Central).unwrap();
    let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
    let k = Lqr::solve(&system, &weights).unwrap().k;
    let (a, b, k) = (system.a.as_slice(), system.b.as_slice(), k.as_slice());
    println!("A = {a:?}\nB = {b:?}\nK = {k:?}");
    for (found, expected, bound) in [(&[a, b].concat()[..], &A_AND_B[..], BOUNDS[0]), (k, &K[..], BOUNDS[1])] {
        assert_eq!(found.len(), expected.len());
        let is_near = |(found, expected): (&f64, &f64)| (found - expected).abs() <= bound;
        assert!(found.iter().zip(expected).all(is_near), "{found:?} instead of {expected:?}");
    }
}
