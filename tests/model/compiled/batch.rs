//! Parameters of batches: each row equals a simulation of the model with the same edit and
//! `update_constants`, and of the model compiled with the values.

use std::sync::Arc;

use mujoco_safe::enums::GeomType;
use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters};
use mujoco_safe::{Data, Model, StateSpec};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::outcome::is_close;
use super::{generator, part};
use crate::cases::cases;
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

/// Compares batches of random models with edited simulations. Returns the numbers of compared rows
/// and of errors in both.
fn campaign(first_seed: u64, rows: usize) -> [usize; 2] {
    let mut count = [0; 2];
    for seed in first_seed.. {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let Ok(model) = Model::from_xml_str(&generator::xml(seed)) else { continue };
        let model = Arc::new(model);
        let parameter = parameter(&model, &mut random);
        let parameters = Parameters::new().with(&model, parameter, Distribution::Unchanged).unwrap();
        let mut batch = Batch::new(&model, 3).unwrap().with_parameters(parameters).unwrap();
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
    let [rows, errors] = campaign(0, cases(50, 150));
    assert!(errors < rows / 4, "{errors} errors, {rows} rows");
}

#[test]
#[ignore = "takes minutes"]
fn many_rows_of_batches_equal_simulations_of_edited_models() {
    let [rows, errors] = campaign(part("SEED", 1000) as u64, part("EDITS", 5000));
    println!("{rows} rows equal a simulation of the edited model, {errors} edits are rejected by both");
}

/// Returns a model with these values of all parameters.
fn text(
    [gravity, mass, centre, stiffness, damping, loss, armature, friction, size, gain, bias, gear]: [f64; 12],
) -> String {
    let [x, y, z] = [0.02, 0.03, 0.04].map(|moment| mass * moment);
    format!(
        "<mujoco><option gravity='0.5 0 {gravity}'/><worldbody><geom type='plane' size='5 5 .1' friction='.1'/>
           <body name='arm' pos='0 0 .4'>
             <joint name='hinge' axis='0 1 0' stiffness='{stiffness}' damping='{damping}' frictionloss='{loss}' armature='{armature}'/>
             <inertial pos='{centre} 0 .05' mass='{mass}' diaginertia='{x} {y} {z}'/>
             <body pos='.3 0 -.25'><joint type='slide' axis='1 1 0'/><joint type='slide' axis='0 .1 1'/>
               <inertial pos='0 0 0' mass='.5' diaginertia='.01 .01 .01'/><geom name='ball' size='{size}' friction='{friction}'/></body>
           </body></worldbody>
         <actuator><general name='motor' joint='hinge' gainprm='{gain}' biastype='affine' biasprm='{bias} -1 -.1' gear='{gear}'/></actuator>
         </mujoco>"
    )
}

/// Compares a batch with compiled models, in which one parameter at a time or all have other
/// values.
fn compiled_campaign(rows: usize) {
    let usual = [-9.81, 1.0, 0.1, 2.0, 0.5, 0.05, 0.02, 0.5, 0.15, 3.0, 0.2, 1.5];
    let model = Arc::new(Model::from_xml_str(&text(usual)).unwrap());
    let (arm, hinge) = (model.body("arm").unwrap().id(), model.joint("hinge").unwrap().id());
    let (ball, motor) = (model.geom("ball").unwrap().id(), model.actuator("motor").unwrap().id());
    let list = [
        Parameter::Gravity(2),
        Parameter::MassFactor(arm),
        Parameter::CentreOfMass(arm, 0),
        Parameter::JointStiffness(hinge),
        Parameter::JointDamping(hinge),
        Parameter::JointFrictionLoss(hinge),
        Parameter::JointArmature(hinge),
        Parameter::GeomFriction(ball, 0),
        Parameter::GeomSize(ball, 0),
        Parameter::ActuatorGain(motor, 0),
        Parameter::ActuatorBias(motor, 0),
        Parameter::ActuatorGear(motor),
    ];
    let with = |all: Parameters, parameter| all.with(&model, parameter, Distribution::Unchanged).unwrap();
    let mut batch =
        Batch::new(&model, 1).unwrap().with_parameters(list.into_iter().fold(Parameters::new(), with)).unwrap();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(rows as u64);
    let mut usual_end = Vec::new();
    for row in 0..rows {
        let mut values = usual;
        let is_other = |at: usize| row > 0 && (row % 13 == 12 || at == row % 13);
        for (_, value) in values.iter_mut().enumerate().filter(|(at, _)| is_other(*at)) {
            *value *= random.random_range(0.3..2.0);
        }
        batch.set_parameters(|_| true, |_, written| written.copy_from_slice(&values)).unwrap();
        batch.reset_where(|_| true, |_, _, data| data.qvel_mut().fill(0.3)).unwrap();
        let mut single = Data::new(Model::from_xml_str(&text(values)).unwrap()).unwrap();
        single.qvel_mut().fill(0.3);
        single.ctrl_mut().fill(0.5);
        for _ in 0..50 {
            batch.step(|_, controls| controls.as_mut_slice().fill(0.5)).unwrap();
            single.step().unwrap();
        }
        let (found, expected) = (batch.data(0).unwrap(), [single.qpos(), single.qvel()].concat());
        let found = [found.qpos(), found.qvel()].concat();
        let is_equal = found.iter().zip(&expected).all(|(left, right)| is_close(*left, *right, 1e-6));
        assert!(is_equal, "row {row}, {values:?}: {found:?} instead of {expected:?}");
        match row {
            0 => usual_end = found,
            _ => assert_ne!(found, usual_end, "{:?} has an effect", list.get(row % 13)),
        }
    }
}

#[test]
fn parameters_of_a_batch_equal_the_models_compiled_with_the_values() {
    compiled_campaign(130);
}

#[test]
#[ignore = "takes minutes"]
fn many_rows_of_batches_equal_the_models_compiled_with_the_values() {
    compiled_campaign(part("EDITS", 5000));
}
