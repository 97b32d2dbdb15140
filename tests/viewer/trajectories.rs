//! Keys and wheel in the trajectory mode.

use mujoco_safe::viewer::{Viewer, ViewerOptions};
use mujoco_safe::{Data, Trajectory, ZeroController, sample};

use crate::harness::{SIZE, on_timeline, press, show_with, state};
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
    show_with(ViewerOptions::default(), Viewer::new().with_trajectories(both), data, |input| {
        assert_eq!((state().mode.as_str(), state().playback), ("Trajectory", Some([0, 0])));
        assert_eq!(state().qpos, first, "the first record is shown at once");
        let frame = || state().playback.unwrap()[1];

        press(input, "Right", "one record forward", |state| state.playback == Some([0, 1]));
        press(input, "Left", "one record back", |state| state.playback == Some([0, 0]));
        press(input, "Left", "the records are cyclic", |state| state.playback == Some([0, lengths[0] - 1]));
        press(input, "Up", "the last record of the next, shorter trajectory", |state| {
            state.playback == Some([1, lengths[1] - 1])
        });
        press(input, "Down", "the previous trajectory", |state| {
            state.playback.is_some_and(|playback| playback[0] == 0)
        });
        press(input, "BackSpace", "the first record", |state| state.playback == Some([0, 0]));

        input.click(on_timeline(0.5), 1, 1);
        wait_until("a click on the timeline shows a record", || (100..200).contains(&frame()));
        let shown = frame();
        press(input, "Left", "the window has the keyboard", |state| state.playback == Some([0, shown - 1]));
        input.drag(on_timeline(0.5), [-40, 0], 1, &[]);
        wait_until("a drag on the timeline shows an earlier record", || (1..shown - 10).contains(&frame()));
        press(input, "BackSpace", "the first record", |state| state.playback == Some([0, 0]));

        press(input, "ctrl+r", "playback is reversed", |state| state.playback_flags[0]);
        press(input, "space", "the trajectory plays in reverse", |state| state.status == "Reverse Simulation");
        wait_until("the index of the record decreases", || (1..lengths[0] - 1).contains(&frame()));
        press(input, "shift+Down", "playback is slower and still reversed", |state| {
            state.target_speed < 1.0 && state.playback_flags[0]
        });
        let previous = frame();
        wait_until("playback continues", || frame() != previous);
        press(input, "space", "playback is paused", |state| state.status == "Paused");
        press(input, "ctrl+Right", "the passive mode is selected", |state| state.mode == "Passive Dynamics");
        let time = state().time;
        press(input, "space", "the simulation runs forward", |state| {
            state.status == "Forward Simulation" && state.time > time
        });
        press(input, "space", "the simulation is paused", |state| state.status == "Paused");
        press(input, "ctrl+Left", "the trajectory mode is selected", |state| state.mode == "Trajectory");

        let geoms = state().ngeom;
        press(input, "ctrl+b", "the burst adds geoms to the scene", |state| {
            state.playback_flags[1] && state.ngeom > geoms
        });
        press(input, "ctrl+d", "the Doppler shading is on", |state| state.playback_flags[2]);
        let [factor, gamma] = state().burst;
        let middle = SIZE.map(|pixels| pixels as i32 / 2);
        input.hold(&["ctrl"]);
        input.click(middle, 4, 1);
        input.release_modifiers(&["ctrl"]);
        wait_until("Ctrl and the wheel: the burst has more records", || state().burst[0] > factor);
        input.hold(&["shift"]);
        input.click(middle, 5, 1);
        input.release_modifiers(&["shift"]);
        wait_until("Shift and the wheel: the fading changes", || state().burst[1] < gamma);
        press(input, "ctrl+d", "the Doppler shading is off", |state| !state.playback_flags[2]);
        press(input, "ctrl+b", "the burst is off", |state| !state.playback_flags[1] && state.ngeom == geoms);
    });
}
