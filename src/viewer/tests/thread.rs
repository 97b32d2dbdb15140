//! Physics thread, circulation of the snapshots, and allocations per frame.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use allocation_counter::measure;

use super::{Bench, trajectories};
use crate::viewer::endpoint::Watch;
use crate::viewer::handle::ViewerHandle;
use crate::viewer::link::{
    EndpointRequest, PlaybackRequest, Request, SimulationRequest, Snapshot, Status, WindowEnd, link,
};
use crate::viewer::simulation::{PhysicsThread, Simulation};
use crate::{Data, sample};

/// Starts the physics thread. Returns the counter of its wake-ups of the window.
fn started() -> (WindowEnd, PhysicsThread, Arc<AtomicUsize>) {
    let woken = Arc::new(AtomicUsize::new(0));
    let counter = woken.clone();
    let (window, physics) = link(move || {
        counter.fetch_add(1, Ordering::Relaxed);
    });
    let data = Data::new(sample::cartpole()).unwrap();
    let simulation = Simulation::new(data, None, Vec::new(), physics).unwrap();
    (window, PhysicsThread::start(simulation).unwrap(), woken)
}

/// Time limit of a wait, generous for a loaded machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Waits for a snapshot that satisfies a condition.
fn wait_for(window: &mut WindowEnd, what: &str, condition: impl Fn(&Snapshot) -> bool) {
    let start = Instant::now();
    while !window.latest().is_some_and(|(snapshot, _)| condition(snapshot)) {
        assert!(start.elapsed() < TIMEOUT, "no snapshot in which {what}");
        thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn thread_runs_pauses_and_ends_with_the_window() {
    let (mut window, physics, woken) = started();
    wait_for(&mut window, "it is paused", |snapshot| snapshot.status == Status::Paused);
    window.send(Request::Pause(false));
    wait_for(&mut window, "time passes", |snapshot| snapshot.time > 0.1);
    assert!(woken.load(Ordering::Relaxed) > 1);
    window.send(Request::Pause(true));
    wait_for(&mut window, "it is paused", |snapshot| snapshot.status == Status::Paused);
    assert!(!window.is_finished());
    window.close();
    let data = physics.join().expect("no panic");
    assert!(window.is_finished());
    assert_eq!(window.current().unwrap().time, data.time());
}

#[test]
fn thread_does_not_wait_for_the_window() {
    let (window, physics, woken) = started();
    window.send(SimulationRequest::SetSpeed(100.0));
    window.send(Request::Pause(false));
    let start = Instant::now();
    while woken.load(Ordering::Relaxed) < 30 {
        assert!(start.elapsed() < TIMEOUT, "the thread publishes no more snapshots");
        window.send(EndpointRequest::Watch(Vec::new()));
        thread::sleep(Duration::from_millis(1));
    }
    drop(window);
    assert!(physics.join().expect("no panic").time() > 0.0);
}

#[test]
fn paused_thread_sleeps_until_the_next_request() {
    let (mut window, physics, woken) = started();
    wait_for(&mut window, "it is paused", |snapshot| snapshot.status == Status::Paused);
    // The thread may be preempted before it sleeps. Once it sleeps, it publishes nothing.
    let start = Instant::now();
    loop {
        let before = woken.load(Ordering::Relaxed);
        thread::sleep(Duration::from_millis(100));
        if woken.load(Ordering::Relaxed) == before {
            break;
        }
        assert!(start.elapsed() < TIMEOUT, "the thread does not sleep");
    }
    window.send(SimulationRequest::Step(1));
    wait_for(&mut window, "a step was taken", |snapshot| snapshot.time > 0.0);
    window.close();
    physics.join().unwrap();
}

#[test]
fn dropping_the_window_ends_the_thread() {
    let (window, physics, _) = started();
    window.send(Request::Pause(false));
    drop(window);
    assert!(physics.join().is_some());
}

#[test]
fn dropping_the_handle_closes_the_window() {
    let (window, physics) = link(|| ());
    let mut handle = ViewerHandle::new(physics);
    let mut data = Data::new(sample::cartpole()).unwrap();
    handle.sync(&mut data).unwrap();
    assert!(handle.is_running() && !window.is_closing());
    drop(handle);
    assert!(window.is_closing() && window.is_finished());
}

#[test]
fn steady_state_frames_do_not_allocate() {
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let mut handle = ViewerHandle::new(physics);
    let actuator = data.model().actuator(0).unwrap().id();
    window.send(EndpointRequest::Watch(Watch::parse("qpos[2]", &sample::humanoid()).unwrap()));
    let mut frame = |data: &mut Data| {
        window.send(EndpointRequest::SetControl(actuator, 0, 0.1));
        data.step().unwrap();
        handle.sync(data).unwrap();
        assert!(window.latest().unwrap().1);
    };
    for _ in 0..200 {
        frame(&mut data);
    }
    data.reset_to_key("squat").unwrap();
    let allocated = measure(|| (0..100).for_each(|_| frame(&mut data)));
    assert_eq!(allocated.count_total, 0);
}

#[test]
fn playback_with_a_burst_does_not_allocate() {
    let mut bench = Bench::with(Data::new(sample::cartpole()).unwrap(), None, trajectories());
    bench.send(PlaybackRequest::ToggleBurst);
    bench.send(PlaybackRequest::ChangeBurstFactor(20.0));
    bench.send(Request::Pause(false));
    bench.pass(1.0);
    let allocated = measure(|| _ = bench.pass(1.0));
    assert_eq!(allocated.count_total, 0);
}

#[test]
fn at_most_three_snapshots_circulate() {
    let (mut window, physics) = link(|| ());
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut handle = ViewerHandle::new(physics);
    let mut addresses = std::collections::HashSet::new();
    for round in 0..200 {
        for _ in 0..round % 3 {
            handle.sync(&mut data).unwrap();
        }
        for _ in 0..round % 5 {
            if let Some((snapshot, _)) = window.latest() {
                addresses.insert(std::ptr::from_ref(snapshot) as usize);
            }
        }
    }
    assert!((2..=3).contains(&addresses.len()), "{}", addresses.len());
}
