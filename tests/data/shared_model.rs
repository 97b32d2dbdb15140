//! Simulations that share a model, and the types of a model that a constructor takes.

use std::sync::Arc;

use mujoco_safe::control::ilqr::{Ilqr, IlqrOptions};
use mujoco_safe::derivative::TransitionOptions;
use mujoco_safe::rollout::Workers;
use mujoco_safe::{Batch, Data, Lineariser, Rollout, sample};

#[test]
fn a_simulation_takes_a_model_or_an_arc_or_a_reference_to_an_arc() {
    let model = Arc::new(sample::cartpole());
    let first = Data::new(&model).unwrap();
    let second = Data::new(model.clone()).unwrap();
    let third = Data::new(first.model()).unwrap();
    assert!([&first, &second, &third].iter().all(|data| Arc::ptr_eq(data.model(), &model)), "a model was copied");
    assert_eq!(Arc::strong_count(&model), 4);
    assert_eq!(Arc::strong_count(Data::new(sample::cartpole()).unwrap().model()), 1);
}

#[test]
fn every_constructor_takes_a_reference_to_a_shared_model() {
    let model = Arc::new(sample::cartpole());
    assert!(Arc::ptr_eq(Workers::new(&model).model(), &model));
    assert!(Rollout::new(&model, 2, 3).run().is_ok());
    assert!(Batch::new(&model, 2).is_ok());
    assert!(Lineariser::new(&model, TransitionOptions::default()).is_ok());
    assert!(Ilqr::new(&model, IlqrOptions::default()).is_ok());
}
