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

#[test]
fn a_closure_that_edits_the_model_returns_nothing_or_a_result() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    let edit = |data: &mut Data| -> mujoco_safe::Result<f64> {
        data.edit_model(|model| model.body_mass_mut()[1] = 5.0)?;
        data.edit_model(|model| model.set_timestep(0.001))?;
        let knee = data.edit_model(|model| Ok(model.joint("left_knee")?.id()))?;
        assert_eq!(data.joint(knee).name(), Some("left_knee"));
        data.edit_model(|model| {
            model.body_mut("torso")?.scale_mass(2.0)?;
            model.update_constants()?;
            Ok(model.total_mass())
        })
    };
    let total = edit(&mut data).unwrap();
    assert_eq!(data.model().body_mass()[1], 10.0);
    assert_eq!((data.model().timestep(), data.model().total_mass()), (0.001, total));
}

#[test]
fn an_edit_that_fails_returns_its_error_and_keeps_earlier_changes() {
    let model = Arc::new(sample::humanoid());
    let mut data = Data::new(&model).unwrap();
    let error = data
        .edit_model(|model| {
            model.body_mass_mut()[1] = 5.0;
            model.geom_mut("floors")?.set_contype(2);
            Ok(())
        })
        .unwrap_err();
    assert!(error.to_string().contains("did you mean 'floor'"), "{error}");
    assert_eq!(data.model().body_mass()[1], 5.0);
    assert!(model.body_mass()[1] != 5.0);
    data.step().unwrap();
}
