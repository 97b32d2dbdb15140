//! What a picture costs.

use allocation_counter::measure;

use super::{Bench, trajectories};
use crate::viewer::handle::Handle;
use crate::viewer::link::link;
use crate::viewer::request::Request;
use crate::{Data, sample};

#[test]
fn after_the_first_pictures_nothing_is_allocated() {
    let (mut front, back) = link(|| ());
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let mut handle = Handle::new(back);
    let actuator = data.model().actuator(0).unwrap().id();
    front.ask(Request::Watch(vec!["qpos[2]".parse().unwrap()]));
    let mut picture = |data: &mut Data| {
        front.ask(Request::SetControl(actuator, 0.1));
        data.step().unwrap();
        handle.sync(data).unwrap();
        assert!(front.latest().unwrap().1);
    };
    for _ in 0..200 {
        picture(&mut data);
    }
    data.reset_to_key("squat").unwrap();
    let allocated = measure(|| (0..100).for_each(|_| picture(&mut data)));
    assert_eq!(allocated.count_total, 0);
}

#[test]
fn playing_a_trajectory_allocates_nothing_with_a_burst_neither() {
    let mut bench = Bench::with(Data::new(sample::cartpole()).unwrap(), None, trajectories());
    bench.ask(Request::Burst);
    bench.ask(Request::BurstFactor(20.0));
    bench.ask(Request::Pause(false));
    bench.pass(1.0);
    let allocated = measure(|| _ = bench.pass(1.0));
    assert_eq!(allocated.count_total, 0);
}

#[test]
fn at_most_three_snapshots_go_round_whoever_is_slower() {
    let (mut front, back) = link(|| ());
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut handle = Handle::new(back);
    let mut addresses = std::collections::HashSet::new();
    for round in 0..200 {
        for _ in 0..round % 3 {
            handle.sync(&mut data).unwrap();
        }
        for _ in 0..round % 5 {
            if let Some((snapshot, _)) = front.latest() {
                addresses.insert(std::ptr::from_ref(snapshot) as usize);
            }
        }
    }
    assert!((2..=3).contains(&addresses.len()), "{}", addresses.len());
}
