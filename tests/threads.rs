//! One model, any number of threads.
#![forbid(unsafe_code)]

use std::sync::Arc;
use std::thread;

use mujoco_safe::{Data, Error, Model, RandomController, Trajectory, sample};

fn is_send<T: Send>() {}
fn is_sync<T: Sync>() {}

#[test]
fn models_are_shared_and_simulations_are_sent_between_threads() {
    is_send::<Model>();
    is_sync::<Model>();
    is_send::<Data>();
    is_sync::<Data>();
    is_send::<Error>();
    is_sync::<Error>();
}

/// A second of random motion.
fn motion(model: &Arc<Model>, seed: u64) -> Trajectory {
    let mut data = Data::new(model.clone()).expect("there is memory");
    let mut trajectory = Trajectory::new(model);
    trajectory.record(&mut data, &mut RandomController::new(seed), 200).expect("it is stable");
    trajectory
}

#[test]
fn simulations_of_one_model_in_several_threads_are_those_of_one_thread() {
    let model = Arc::new(sample::humanoid());
    let alone: Vec<Trajectory> = (0..8).map(|seed| motion(&model, seed)).collect();
    let together: Vec<Trajectory> = thread::scope(|scope| {
        let threads: Vec<_> = (0..8)
            .map(|seed| {
                scope.spawn({
                    let model = &model;
                    move || motion(model, seed)
                })
            })
            .collect();
        threads.into_iter().map(|thread| thread.join().expect("it does not panic")).collect()
    });
    assert!(alone == together, "the same seeds gave other motions");
    assert!(alone[0] != alone[1], "different seeds gave the same motion");
}

#[test]
fn models_load_in_several_threads_at_once_and_each_error_stays_in_its_own() {
    thread::scope(|scope| {
        for index in 0..4 {
            scope.spawn(move || {
                for _ in 0..20 {
                    let good = format!(r#"<mujoco><worldbody><geom name="g{index}" size=".1"/></worldbody></mujoco>"#);
                    let bad = format!("<mujoco><worldbody><wrong{index}/></worldbody></mujoco>");
                    let model = Model::from_xml_str(&good).expect("it is valid");
                    assert_eq!(model.geom(0).expect("there is one").name(), Some(&*format!("g{index}")));
                    let error = Model::from_xml_str(&bad).expect_err("it is not valid").to_string();
                    assert!(error.contains(&format!("'wrong{index}'")), "{error}");
                }
            });
        }
    });
}

#[test]
fn a_simulation_is_read_by_several_threads_at_once() {
    let mut data = Data::new(sample::humanoid()).expect("there is memory");
    data.reset_to_key("stand").expect("it has this keyframe");
    data.forward().expect("the engine computes");
    let torso = data.model().body("torso").expect("it has a torso").id();
    let expected = data.jac_body_com(torso).expect("positions are computed");
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(data.jac_body_com(torso).expect("positions are computed"), expected));
        }
    });
}
