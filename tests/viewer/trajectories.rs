//! Keys and wheel in the trajectory mode.

use mujoco_safe::viewer::Viewer;
use mujoco_safe::{Data, Trajectory, ZeroController, sample};

use crate::harness::{SIZE, press, show, state};
use crate::input::wait_until;

/// Records two trajectories of different lengths.
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
    show(Viewer::new().trajectories(both), data, |input| {
        assert_eq!((state().mode.as_str(), state().playback), ("Trajectory", Some([0, 0])));
        assert_eq!(state().qpos, first, "the first record is shown at once");
        let frame = || state().playback.unwrap()[1];

        press(input, "Right", "a record forward", |state| state.playback == Some([0, 1]));
        press(input, "Left", "a record back", |state| state.playback == Some([0, 0]));
        press(input, "Left", "and round to the last", |state| state.playback == Some([0, lengths[0] - 1]));
        press(input, "Up", "the next trajectory, as far as it goes", |state| {
            state.playback == Some([1, lengths[1] - 1])
        });
        press(input, "Down", "the one before", |state| state.playback.is_some_and(|playback| playback[0] == 0));
        press(input, "BackSpace", "its first record", |state| state.playback == Some([0, 0]));

        press(input, "ctrl+r", "in reverse", |state| state.playback_flags[0]);
        press(input, "space", "it plays back from the end", |state| state.status == "Reverse Simulation");
        wait_until("records go down", || (1..lengths[0] - 1).contains(&frame()));
        press(input, "shift+Down", "slower, and still in reverse", |state| {
            state.target_speed < 1.0 && state.playback_flags[0]
        });
        let then = frame();
        wait_until("it still plays", || frame() != then);
        press(input, "space", "paused", |state| state.status == "Paused");
        press(input, "ctrl+Right", "another mode", |state| state.mode == "Passive Dynamics");
        let then = state().time;
        press(input, "space", "which is not frozen", |state| state.status == "Forward Simulation" && state.time > then);
        press(input, "space", "paused", |state| state.status == "Paused");
        press(input, "ctrl+Left", "back to the trajectories", |state| state.mode == "Trajectory");

        let geoms = state().ngeom;
        press(input, "ctrl+b", "other moments are in the picture", |state| {
            state.playback_flags[1] && state.ngeom > geoms
        });
        press(input, "ctrl+d", "red and blue", |state| state.playback_flags[2]);
        let [factor, gamma] = state().burst;
        let middle = SIZE.map(|pixels| pixels as i32 / 2);
        input.hold(&["ctrl"]);
        input.click(middle, 4, 1);
        input.release_modifiers(&["ctrl"]);
        wait_until("Ctrl and the wheel: more moments", || state().burst[0] > factor);
        input.hold(&["shift"]);
        input.click(middle, 5, 1);
        input.release_modifiers(&["shift"]);
        wait_until("Shift and the wheel: other fading", || state().burst[1] < gamma);
        press(input, "ctrl+d", "no colours", |state| !state.playback_flags[2]);
        press(input, "ctrl+b", "one moment", |state| !state.playback_flags[1] && state.ngeom == geoms);
    });
}
