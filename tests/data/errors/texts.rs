//! The text of an error is what `unwrap` and a `main` that returns the error print, which is its
//! `Debug` output.

use std::fmt;

use mujoco_safe::control::riccati::RiccatiError;
use mujoco_safe::rollout::Rollout;
use mujoco_safe::{Data, Error, Lqr, LqrWeights, Model, StateSpec, sample};

#[track_caller]
fn assert_debug_is_display(error: &(impl fmt::Debug + fmt::Display)) {
    assert_eq!(format!("{error:?}"), error.to_string());
    assert_eq!(format!("{error:#?}"), error.to_string());
}

#[test]
fn a_main_that_returns_an_error_prints_the_text_of_the_error() {
    let main = || -> Result<(), Error> {
        sample::humanoid().joint("left_kne")?;
        Ok(())
    };
    let error = main().unwrap_err();
    assert_debug_is_display(&error);
    assert!(format!("{error:?}").contains("did you mean 'left_knee'"), "{error:?}");
    assert_debug_is_display(&Model::from_xml_path("no/such/model.xml").unwrap_err());
    assert_debug_is_display(&Model::from_xml_str("<mujoco><worldbod/></mujoco>").unwrap_err());
}

#[test]
fn errors_of_rollouts_and_of_the_riccati_equation_print_their_texts() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let error = Lqr::at_present_state(&mut data, &LqrWeights::diagonal(&[1.0; 4], &[-1.0])).unwrap_err();
    assert_debug_is_display(&error);
    assert_debug_is_display(error.solver::<RiccatiError>().unwrap());

    let states = [f64::NAN, 0.0, 0.0, 0.0];
    let result = Rollout::new(sample::cartpole(), 1, 1).with_initial_state(StateSpec::PHYSICS, &states).run().unwrap();
    let error = result.outcomes()[0].as_ref().unwrap_err();
    assert_debug_is_display(error);
    assert!(format!("{error:?}").starts_with("step 0: the simulation is unstable"), "{error:?}");
}
