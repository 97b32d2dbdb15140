//! The physics thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::viewer::handle::Handle;
use crate::viewer::link::{Front, link};
use crate::viewer::request::Request;
use crate::viewer::simulation::Simulation;
use crate::viewer::snapshot::{Snapshot, Status};
use crate::viewer::worker::Worker;
use crate::{Data, sample};

fn started() -> (Front, Worker, Arc<AtomicUsize>) {
    let woken = Arc::new(AtomicUsize::new(0));
    let counter = woken.clone();
    let (front, back) = link(move || {
        counter.fetch_add(1, Ordering::Relaxed);
    });
    let data = Data::new(sample::cartpole()).unwrap();
    let simulation = Simulation::new(data, None, Vec::new(), back).unwrap();
    (front, Worker::start(simulation).unwrap(), woken)
}

/// A thread that needs longer has not only lost its processor to others.
const MOST: Duration = Duration::from_secs(60);

/// Waits until a snapshot is as it should be.
fn until(front: &mut Front, what: &str, is_so: impl Fn(&Snapshot) -> bool) {
    let start = Instant::now();
    while !front.latest().is_some_and(|(snapshot, _)| is_so(snapshot)) {
        assert!(start.elapsed() < MOST, "no snapshot where {what}");
        thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn it_runs_shows_pauses_and_ends_when_the_window_is_closed() {
    let (mut front, worker, woken) = started();
    until(&mut front, "it is paused", |snapshot| snapshot.status == Status::Paused);
    front.ask(Request::Pause(false));
    until(&mut front, "time passes", |snapshot| snapshot.time > 0.1);
    assert!(woken.load(Ordering::Relaxed) > 1);
    front.ask(Request::Pause(true));
    until(&mut front, "it is paused", |snapshot| snapshot.status == Status::Paused);
    assert!(!front.is_over());
    front.close();
    let data = worker.join().expect("no panic");
    assert!(front.is_over());
    assert_eq!(front.drawn().unwrap().time, data.time());
}

#[test]
fn it_does_not_wait_for_a_window_that_never_looks() {
    let (front, worker, woken) = started();
    front.ask(Request::SetSpeed(100.0));
    front.ask(Request::Pause(false));
    let start = Instant::now();
    while woken.load(Ordering::Relaxed) < 30 {
        assert!(start.elapsed() < MOST, "no more snapshots are published");
        front.ask(Request::Watch(Vec::new()));
        thread::sleep(Duration::from_millis(1));
    }
    drop(front);
    assert!(worker.join().expect("no panic").time() > 0.0);
}

#[test]
fn while_paused_it_sleeps_until_something_is_asked_for() {
    let (mut front, worker, woken) = started();
    until(&mut front, "it is paused", |snapshot| snapshot.status == Status::Paused);
    // The thread may have no processor for some of the time. Once it rests, it rests.
    let start = Instant::now();
    loop {
        let before = woken.load(Ordering::Relaxed);
        thread::sleep(Duration::from_millis(100));
        if woken.load(Ordering::Relaxed) == before {
            break;
        }
        assert!(start.elapsed() < MOST, "it does not rest");
    }
    front.ask(Request::Step(1));
    until(&mut front, "a step was taken", |snapshot| snapshot.time > 0.0);
    front.close();
    worker.join().unwrap();
}

#[test]
fn a_window_that_is_dropped_ends_it() {
    let (front, worker, _) = started();
    front.ask(Request::Pause(false));
    drop(front);
    assert!(worker.join().is_some());
}

#[test]
fn a_program_that_ends_closes_the_window() {
    let (front, back) = link(|| ());
    let mut handle = Handle::new(back);
    let mut data = Data::new(sample::cartpole()).unwrap();
    handle.sync(&mut data).unwrap();
    assert!(handle.is_running() && !front.is_closing());
    drop(handle);
    assert!(front.is_closing() && front.is_over());
}
