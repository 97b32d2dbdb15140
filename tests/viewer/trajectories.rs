//! Keys and wheel where trajectories are played.

use mujoco_safe::viewer::Viewer;
use mujoco_safe::{Data, Trajectory, ZeroController, sample};

use crate::case::{SIZE, press, show, state};
use crate::hand::wait_until;

/// Two of different lengths.
fn trajectories() -> (Data, Vec<Trajectory>) {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut record = |angle: f64, steps: usize| {
        data.reset().unwrap();
        data.qpos_mut()[1] = angle;
        let mut trajectory = Trajectory::new(data.model());
        trajectory.record(&mut data, &mut ZeroController, steps).unwrap();
        trajectory
    };
    let both = vec![record(0.3, 300), record(-0.5, 120)];
    data.reset().unwrap();
    (data, both)
}

pub fn keys_and_wheel() {
    let (data, both) = trajectories();
    let (first, lengths) = (both[0].qpos(0).to_vec(), [both[0].len(), both[1].len()]);
    show(Viewer::new().trajectories(both), data, |hand| {
        assert_eq!((state().mode.as_str(), state().playback), ("Trajectory", Some([0, 0])));
        assert_eq!(state().qpos, first, "the first record is shown at once");
        let frame = || state().playback.unwrap()[1];

        press(hand, "Right", "a record forward", |state| state.playback == Some([0, 1]));
        press(hand, "Left", "a record back", |state| state.playback == Some([0, 0]));
        press(hand, "Left", "and round to the last", |state| state.playback == Some([0, lengths[0] - 1]));
        press(hand, "Up", "the next trajectory, as far as it goes", |state| {
            state.playback == Some([1, lengths[1] - 1])
        });
        press(hand, "Down", "the one before", |state| state.playback.is_some_and(|playback| playback[0] == 0));
        press(hand, "BackSpace", "its first record", |state| state.playback == Some([0, 0]));

        press(hand, "ctrl+r", "in reverse", |state| state.playing[0]);
        press(hand, "space", "it plays back from the end", |state| state.status == "Reverse Simulation");
        wait_until("records go down", || (1..lengths[0] - 1).contains(&frame()));
        press(hand, "shift+Down", "slower, and still in reverse", |state| state.wanted < 1.0 && state.playing[0]);
        let then = frame();
        wait_until("it still plays", || frame() != then);
        press(hand, "space", "paused", |state| state.status == "Paused");
        press(hand, "ctrl+Right", "another mode", |state| state.mode == "Passive Dynamics");
        let then = state().time;
        press(hand, "space", "which is not frozen", |state| state.status == "Forward Simulation" && state.time > then);
        press(hand, "space", "paused", |state| state.status == "Paused");
        press(hand, "ctrl+Left", "back to the trajectories", |state| state.mode == "Trajectory");

        let geoms = state().ngeom;
        press(hand, "ctrl+b", "other moments are in the picture", |state| state.playing[1] && state.ngeom > geoms);
        press(hand, "ctrl+d", "red and blue", |state| state.playing[2]);
        let [factor, gamma] = state().burst;
        let middle = SIZE.map(|pixels| pixels as i32 / 2);
        hand.hold(&["ctrl"]);
        hand.click(middle, 4, 1);
        hand.let_go(&["ctrl"]);
        wait_until("Ctrl and the wheel: more moments", || state().burst[0] > factor);
        hand.hold(&["shift"]);
        hand.click(middle, 5, 1);
        hand.let_go(&["shift"]);
        wait_until("Shift and the wheel: other fading", || state().burst[1] < gamma);
        press(hand, "ctrl+d", "no colours", |state| !state.playing[2]);
        press(hand, "ctrl+b", "one moment", |state| !state.playing[1] && state.ngeom == geoms);
    });
}
