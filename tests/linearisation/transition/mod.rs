//! Linear systems of steps by every method: against extrapolated differences of the engine's
//! `mj_step`, against its `mjd_transitionFD`, and against each other. The simulation is restored.

pub(crate) mod analytic;
mod contract;
mod disabled;
pub(crate) mod features;
mod kinks;
pub(crate) mod oracle;
pub(crate) mod special_states;

use mujoco_safe::{Data, Matrix, StateSpace, sample};

/// Returns the humanoid on its left leg, held by its actuators, in contact with the floor.
fn standing() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("stand_on_left_leg").unwrap();
    // The foot settles into the floor until the contact carries the weight.
    data.ctrl_mut().iter_mut().enumerate().for_each(|(i, ctrl)| *ctrl = 0.05 * (i as f64).sin());
    (0..5).for_each(|_| data.step().unwrap());
    assert!(data.nefc() > 0);
    data
}

/// Returns the largest difference of two matrices, relative to the largest number of the second.
fn deviation(ours: &Matrix, theirs: &Matrix) -> f64 {
    assert_eq!(ours.shape(), theirs.shape());
    let largest = theirs.as_slice().iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let differences = ours.as_slice().iter().zip(theirs.as_slice()).map(|(a, b)| (a - b).abs());
    // NaN counts as the largest difference.
    let worst = differences.fold(0.0, |worst: f64, difference| if difference <= worst { worst } else { difference });
    if worst == 0.0 { 0.0 } else { worst / largest }
}

#[track_caller]
fn assert_near(what: &str, ours: &StateSpace, theirs: &StateSpace, tolerance: f64) {
    for (name, ours, theirs) in
        [("A", &ours.a, &theirs.a), ("B", &ours.b, &theirs.b), ("C", &ours.c, &theirs.c), ("D", &ours.d, &theirs.d)]
    {
        let deviation = deviation(ours, theirs);
        assert!(deviation <= tolerance, "{what}: {name} deviates by {deviation:e} of its largest number");
    }
}
