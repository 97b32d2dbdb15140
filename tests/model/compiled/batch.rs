//! Parameters of batches on random models: each row equals a simulation of the model with the same edit and `update_constants`.

use std::sync::Arc;

use mujoco_safe::enums::GeomType;
use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters};
use mujoco_safe::{Data, Model, StateSpec};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::generator;
use crate::parameter_edits::edit;

/// Returns a random parameter of the model.
fn parameter(model: &Model, random: &mut Xoshiro256PlusPlus) -> Parameter {
    let geom = model.geom(random.random_range(0..model.ngeom())).unwrap();
    let body = model.body(random.random_range(1..model.nbody())).unwrap().id();
    let joint = (model.njnt() > 0).then(|| model.joint(random.random_range(0..model.njnt())).unwrap().id());
    let actuator =
        (model.nactuator() > 0).then(|| model.actuator(random.random_range(0..model.nactuator())).unwrap().id());
    match (random.random_range(0..12), joint, actuator) {
        (0, ..) => Parameter::Gravity(random.random_range(0..3)),
        (1, ..) => Parameter::MassFactor(body),
        (2, ..) => Parameter::CentreOfMass(body, random.random_range(0..3)),
        (3, Some(joint), _) => Parameter::JointStiffness(joint),
        (4, Some(joint), _) => Parameter::JointDamping(joint),
        (5, Some(joint), _) => Parameter::JointFrictionLoss(joint),
        (6, Some(joint), _) => Parameter::JointArmature(joint),
        (7, _, Some(actuator)) => Parameter::ActuatorGain(actuator, 0),
        (8, _, Some(actuator)) => Parameter::ActuatorBias(actuator, random.random_range(0..3)),
        (9, _, Some(actuator)) => Parameter::ActuatorGear(actuator),
        (10, ..) => Parameter::GeomFriction(geom.id(), random.random_range(0..3)),
        _ if matches!(geom.geom_type(), GeomType::Sphere | GeomType::Box) => Parameter::GeomSize(geom.id(), 0),
        _ => Parameter::Gravity(2),
    }
}

/// Compares batches of random models with edited simulations. Returns the numbers of compared rows and of errors in both.
fn campaign(first_seed: u64, rows: usize) -> [usize; 2] {
    let mut count = [0; 2];
    for seed in first_seed.. {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let Ok(model) = Model::from_xml_str(&generator::xml(seed)) else { continue };
        let model = Arc::new(model);
        let parameter = parameter(&model, &mut random);
        let parameters = Parameters::new().with(&model, parameter, Distribution::Unchanged).unwrap();
        let mut batch = Batch::new(&model, 3).unwrap().vary(parameters).unwrap();
        for row in 0..3 {
            let value = random.random_range(0.05..1.5);
            let written = batch.set_parameters(|index| index == row, |_, values| values[0] = value);
            let mut single = Data::new(&model).unwrap();
            let edited = single
                .edit_model(|copy| if edit(parameter, value, &model, copy) { copy.update_constants() } else { Ok(()) });
            assert_eq!(written.is_ok(), edited.is_ok(), "seed {seed}, {parameter:?} {value}: {written:?}, {edited:?}");
            if written.is_err() {
                count[1] += 1;
                continue;
            }
            let mut result = Ok(());
            for _ in 0..5 {
                result = result.and_then(|()| batch.step(|_, _| ()).map(drop)).and_then(|()| single.step());
            }
            if result.is_err() {
                break;
            }
            let state = single.state(StateSpec::INTEGRATION);
            assert_eq!(batch.states().row(row), &state[..], "seed {seed}, {parameter:?} {value}");
            count[0] += 1;
            batch.reset_where(|_| true, |_, _, _| ()).unwrap();
        }
        if count[0] >= rows {
            break;
        }
    }
    count
}

#[test]
fn rows_of_a_batch_equal_simulations_of_edited_models() {
    let [rows, errors] = campaign(0, 150);
    assert!(errors < rows / 4, "{errors} errors, {rows} rows");
}

#[test]
#[ignore = "takes minutes"]
fn many_rows_of_batches_equal_simulations_of_edited_models() {
    let [rows, errors] = campaign(1000, 5000);
    println!("{rows} rows equal a simulation of the edited model, {errors} edits are rejected by both");
}
