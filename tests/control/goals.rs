//! Goals that predictive control reaches: an arm follows a target, and a humanoid gets up from a
//! squat.

use std::sync::Arc;

use crate::{stand_up, tracking};

#[test]
fn the_hand_of_the_arm_follows_its_target() {
    let model = Arc::new(tracking::model().unwrap());
    let run = tracking::track(&model, 1.5, 2).unwrap();
    assert!(run.distances[0] > 0.1, "the target starts away from the hand");
    // The target moves 0.15 m in that time.
    let later = &run.distances[150..];
    assert!(later.iter().all(|&distance| distance < 0.01), "{later:?}");
    let moved = tracking::target(1.5).iter().zip(tracking::target(0.75)).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    assert!(moved.sqrt() > 0.1);
}

#[test]
#[ignore = "takes a minute"]
fn the_humanoid_gets_up_from_a_squat_and_stands() {
    let run = stand_up::stand_up(4.0, 2).unwrap();
    assert!(run.heights[0] < 0.8 * run.target, "the squat is low");
    let last = &run.heights[run.heights.len() - 200..];
    assert!(last.iter().all(|height| (height / run.target - 1.0).abs() < 0.05), "{last:?} of {}", run.target);
    assert!(run.speeds[run.speeds.len() - 200..].iter().all(|&speed| speed < 0.2), "the humanoid sways");
}
