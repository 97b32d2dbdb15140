//! Controller, trajectories, passive dynamics.

use super::{Bench, trajectories};
use crate::viewer::link::{Mode, PlaybackRequest, Request, SimulationRequest, Status, link};
use crate::{Data, Error, Trajectory, sample};

fn cartpole() -> Data {
    Data::new(sample::cartpole()).unwrap()
}

/// Creates a bench that plays trajectories.
fn playing() -> Bench {
    let mut bench = Bench::with(cartpole(), None, trajectories());
    bench.send(Request::Pause(false));
    bench
}

fn frame(bench: &mut Bench) -> usize {
    bench.snapshot().playback.unwrap().frame
}

#[test]
fn viewer_starts_in_the_first_available_mode() {
    let mut bench = Bench::with(cartpole(), None, trajectories());
    assert_eq!(bench.mode(), Mode::Trajectory);
    assert_eq!(bench.snapshot().qpos, trajectories()[0].qpos(0), "the first record is shown");
    assert_eq!(bench.snapshot().status, Status::Paused);
    let mut bench = Bench::with(cartpole(), Some(Box::new(crate::ZeroController)), Vec::new());
    assert_eq!((bench.mode(), bench.snapshot().modes.len()), (Mode::Controller, 2));
    assert_eq!(Bench::new(cartpole()).mode(), Mode::Passive);
}

#[test]
fn trajectory_is_played_in_real_time_and_repeats() {
    let mut bench = playing();
    let interval = 0.01;
    bench.pass(20.0 * interval + 0.001);
    let at = frame(&mut bench);
    assert!((20..=21).contains(&at), "{at}");
    assert_eq!(bench.snapshot().qpos, trajectories()[0].qpos(at));
    assert_eq!(bench.snapshot().time, trajectories()[0].times()[at]);
    bench.pass(40.0 * interval);
    assert!(frame(&mut bench).abs_diff(at) <= 1);
}

#[test]
fn reverse_playback_works_at_any_speed() {
    let mut bench = playing();
    bench.send(PlaybackRequest::ToggleReverse);
    assert_eq!(bench.snapshot().status, Status::Reversed);
    bench.pass(0.1);
    let at = frame(&mut bench);
    assert!((29..=31).contains(&at), "{at}");
    // The speed does not change the direction.
    bench.send(SimulationRequest::SetSpeed(0.5));
    bench.pass(0.1);
    let slower = frame(&mut bench);
    assert!((4..=6).contains(&(at - slower)), "{at} to {slower}");
    // The direction does not affect the passive mode.
    bench.send(SimulationRequest::SetMode(Mode::Passive));
    assert_eq!(bench.snapshot().status, Status::Running);
    let time = bench.snapshot().time;
    bench.pass(0.5);
    assert!(bench.snapshot().time > time + 0.2);
}

#[test]
fn trajectories_of_different_lengths_are_cycled() {
    let mut bench = Bench::with(cartpole(), None, trajectories());
    bench.send(PlaybackRequest::SetFrame(30));
    bench.send(PlaybackRequest::CycleTrajectory(1));
    assert_eq!((frame(&mut bench), bench.snapshot().playback.unwrap().frames), (9, 10), "limited to the last record");
    bench.send(PlaybackRequest::CycleTrajectory(-2));
    assert_eq!(bench.snapshot().playback.unwrap().trajectory, 2);
    bench.send(PlaybackRequest::SetTrajectory(99));
    assert_eq!(bench.snapshot().playback.unwrap().trajectory, 2);
    bench.send(PlaybackRequest::SetFrame(1_000_000));
    assert_eq!(frame(&mut bench), 199);
    bench.send(PlaybackRequest::SetTrajectory(0));
    bench.send(SimulationRequest::Step(i32::MIN));
    bench.send(SimulationRequest::Step(i32::MAX));
    assert!(frame(&mut bench) < 40);
}

#[test]
fn burst_shows_several_records_in_one_scene() {
    let mut bench = Bench::with(cartpole(), None, trajectories());
    let alone = bench.snapshot().scene.ngeom();
    bench.send(PlaybackRequest::SetTrajectory(2));
    bench.send(PlaybackRequest::ToggleBurst);
    let with = bench.snapshot().scene.ngeom();
    assert!(with > 4 * alone, "{with} geoms, {alone} without");
    let faint = bench.snapshot().scene.geoms().skip(alone).filter(|geom| geom.rgba()[3] < 0.5).count();
    assert!(faint > 0);
    bench.send(PlaybackRequest::ChangeBurstFactor(-100.0));
    assert!(bench.snapshot().scene.ngeom() < with);
    bench.send(PlaybackRequest::ChangeBurstFactor(0.4));
    assert_eq!(bench.snapshot().playback.unwrap().burst.factor, 1.4, "touchpads change it by fractions");
    bench.send(PlaybackRequest::ChangeBurstFactor(100.0));
    bench.send(PlaybackRequest::SetFrame(100));
    bench.send(PlaybackRequest::ToggleDoppler);
    let scene = &bench.snapshot().scene;
    assert!(scene.geoms().skip(alone).all(|geom| geom.rgba()[1] == 0.0), "no green");
    let (red, blue): (Vec<_>, Vec<_>) =
        scene.geoms().skip(alone).map(|geom| geom.rgba()).partition(|rgba| rgba[0] > rgba[2]);
    assert!(!red.is_empty() && !blue.is_empty());
    bench.send(PlaybackRequest::ToggleBurst);
    assert_eq!(bench.snapshot().scene.ngeom(), alone);
}

#[test]
fn burst_of_a_single_record_is_valid() {
    let data = cartpole();
    let mut single = Trajectory::new(data.model());
    single.push(&data).unwrap();
    let mut bench = Bench::with(data, None, vec![single]);
    bench.send(PlaybackRequest::ToggleBurst);
    bench.send(PlaybackRequest::ChangeBurstFactor(100.0));
    bench.send(Request::Pause(false));
    bench.pass(0.1);
    assert_eq!(frame(&mut bench), 0);
    assert_eq!(bench.snapshot().problem, "");
}

#[test]
fn info_panel_shows_the_playback() {
    let mut bench = Bench::with(cartpole(), None, trajectories());
    bench.send(SimulationRequest::Step(3));
    let text = |bench: &mut Bench| -> Vec<String> {
        bench.snapshot().info.iter().map(|line| format!("{}: {}", line.name, line.value)).collect()
    };
    let expected = [
        "Record: 4/40",
        "Trajectory: 1/3 one",
        "Burst: Off",
        "Burst Density: 20/40",
        "Burst Fading: 20/40",
        "Burst Doppler: Off",
    ];
    assert_eq!(text(&mut bench), expected);
    bench.send(SimulationRequest::SetMode(Mode::Passive));
    assert_eq!(text(&mut bench), [""; 0]);
}

#[test]
fn controls_and_forces_of_a_controller_do_not_persist() {
    let controller = |data: &mut Data| {
        data.ctrl_mut()[0] = 0.3;
        data.qfrc_applied_mut()[1] = 0.2;
    };
    let mut data = cartpole();
    data.qfrc_applied_mut()[0] = 0.1;
    let mut bench = Bench::with(data, Some(Box::new(controller)), Vec::new());
    bench.send(SimulationRequest::Step(10));
    assert_eq!(bench.snapshot().ctrl, [0.3]);
    let info = bench.snapshot().info[0].clone();
    assert!(info.name == "Max Speed" && info.value.ends_with('x'), "{info:?}");
    bench.send(SimulationRequest::SetMode(Mode::Passive));
    assert_eq!(bench.snapshot().ctrl, [0.0]);
    let data = bench.simulation.into_data();
    assert_eq!(data.qfrc_applied(), [0.1, 0.0], "the forces of the start state are restored");
}

#[test]
fn controlled_simulation_equals_a_program_with_the_same_controller() {
    let lqr = || {
        let mut data = cartpole();
        let weights = crate::LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
        let lqr = crate::Lqr::at_present_state(&mut data, &weights).unwrap();
        data.qpos_mut()[1] = 0.1;
        (data, lqr)
    };
    let (mut data, mut controller) = lqr();
    Trajectory::new(data.model()).record(&mut data, &mut controller, 100).map_err(|error| error.to_string()).unwrap();
    let (start, controller) = lqr();
    let mut bench = Bench::with(start, Some(Box::new(controller)), Vec::new());
    bench.send(SimulationRequest::Step(100));
    assert_eq!(bench.snapshot().qpos, data.qpos());
    assert_eq!(bench.snapshot().qvel, data.qvel());
}

#[test]
fn unsuitable_trajectories_are_rejected() {
    let reject = |trajectories| {
        let (_window, physics) = link(|| ());
        crate::viewer::simulation::Simulation::new(cartpole(), None, trajectories, physics).err()
    };
    assert!(matches!(
        reject(vec![("empty".to_owned(), Trajectory::new(&sample::cartpole()))]),
        Some(Error::Invalid { .. })
    ));
    let mut other = Trajectory::new(&sample::humanoid());
    other.push(&Data::new(sample::humanoid()).unwrap()).unwrap();
    assert!(matches!(reject(vec![("other".to_owned(), other)]), Some(Error::Shape { .. })));
}
