//! Regressors, inertial parameters and derivatives of inverse dynamics.

use mujoco_safe::data::Accelerations;
use mujoco_safe::derivative::{InertialParameters, InverseForce, ModelParameter, TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Lineariser, Model, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{deviation, vary_friction, with_formulas, without_formulas};
use crate::cases::cases;
use crate::transition::analytic::random_models::xml;
use crate::transition::analytic::randomise;

/// Rounding error of inverse dynamics, relative to the largest force.
const ROUNDING: f64 = 4e-15;

/// Returns random models at random states with random accelerations.
fn random_data(first: u64, count: u64) -> impl Iterator<Item = Data> {
    (first..first + count).map(|seed| {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut data = Data::new(Model::from_xml_str(&xml(seed)).unwrap()).unwrap();
        randomise(&mut data, &mut random);
        data.forward().unwrap();
        data.qacc_mut().iter_mut().for_each(|qacc| *qacc = random.random_range(-5.0..5.0));
        data
    })
}

fn all_parameters(model: &Model) -> Vec<f64> {
    model.bodies().flat_map(|body| InertialParameters::of(model, body.id()).0).collect()
}

#[test]
fn joint_regressors_give_inverse_dynamics_of_the_bodies() {
    for data in random_data(0, cases(30, 60)) {
        let (model, regressor) = (data.model(), data.joint_regressor().unwrap());
        let parameters = all_parameters(model);
        let ours: Vec<f64> =
            regressor.rows().map(|row| row.iter().zip(&parameters).map(|(a, b)| a * b).sum()).collect();
        let mut expected = vec![0.0; model.nv()];
        data.clone().rne_into(Accelerations::Present, &mut expected).unwrap();
        let scale = expected.iter().fold(1.0, |largest: f64, value| largest.max(value.abs()));
        assert!(deviation(&ours, &expected).0 <= 1e-11 * scale, "{ours:?}, {expected:?}");
    }
}

#[test]
fn body_regressors_give_the_force_between_bodies() {
    // A single free body: the force on it is the force of inverse dynamics, of which the last three
    // are the torque in its axes.
    let mut data = Data::new(
        Model::from_xml_str(
            r#"<mujoco><worldbody><body pos="1 2 3"><freejoint/><geom type="box" size=".1 .2 .3" pos=".3 -.1 .2" euler="10 20 30"/>
                 </body></worldbody></mujoco>"#,
        )
        .unwrap(),
    )
    .unwrap();
    randomise(&mut data, &mut Xoshiro256PlusPlus::seed_from_u64(1));
    data.forward().unwrap();
    data.qacc_mut().copy_from_slice(&[1.0, -2.0, 3.0, 0.5, -0.7, 0.9]);
    let model = data.model().clone();
    let body = model.bodies().nth(1).unwrap().id();
    let regressor = data.body_regressor(body).unwrap();
    let parameters = InertialParameters::of(&model, body).0;
    let force: Vec<f64> = regressor.rows().map(|row| row.iter().zip(&parameters).map(|(a, b)| a * b).sum()).collect();
    let mut expected = vec![0.0; 6];
    data.clone().rne_into(Accelerations::Present, &mut expected).unwrap();
    assert!(deviation(&force[..3], &expected[3..]).0 < 1e-11, "{force:?}, {expected:?}");
    let rotation = data.xmat()[body.index()];
    let world: Vec<f64> = (0..3).map(|row| (0..3).map(|i| rotation[3 * row + i] * force[3 + i]).sum()).collect();
    assert!(deviation(&world, &expected[..3]).0 < 1e-10, "{force:?}, {expected:?}");
}

#[test]
fn log_cholesky_coordinates_are_inverse_functions_with_exact_derivatives() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    for _ in 0..200 {
        let coordinates: [f64; 10] = std::array::from_fn(|_| random.random_range(-1.0..1.0));
        let parameters = InertialParameters::from_log_cholesky(&coordinates);
        let back = parameters.log_cholesky().unwrap();
        assert!(deviation(&coordinates, &back).0 < 1e-11, "{coordinates:?}, {back:?}");
        let derivative = InertialParameters::log_cholesky_derivative(&coordinates);
        for (at, row) in derivative.iter().enumerate() {
            let step = 1e-3;
            let slope = |step: f64| -> [f64; 10] {
                let [right, left] = [step, -step].map(|by| {
                    let mut varied = coordinates;
                    varied[at] += by;
                    InertialParameters::from_log_cholesky(&varied).0
                });
                std::array::from_fn(|i| (right[i] - left[i]) / (2.0 * step))
            };
            let (fine, coarse) = (slope(0.5 * step), slope(step));
            let better: [f64; 10] = std::array::from_fn(|i| (4.0 * fine[i] - coarse[i]) / 3.0);
            assert!(deviation(row, &better).0 < 1e-8, "{at}: {row:?}, {better:?}");
        }
    }
}

#[test]
fn parameters_of_bodies_are_read_as_they_are_written() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(4);
    let mut model = sample::humanoid();
    let body = model.body("torso").unwrap().id();
    for _ in 0..50 {
        let coordinates: [f64; 10] = std::array::from_fn(|_| random.random_range(-1.0..1.0));
        let parameters = InertialParameters::from_log_cholesky(&coordinates);
        parameters.write(&mut model.edit(), body).unwrap();
        let read = InertialParameters::of(&model, body);
        assert!(deviation(&parameters.0, &read.0).0 < 1e-13, "{parameters:?}, {read:?}");
        for parameter in (0..10).map(|at| ModelParameter::LogCholesky(body, at)) {
            let value = parameter.value(&model).unwrap() + 0.1;
            parameter.set(&mut model.edit(), value).unwrap();
            assert!((parameter.value(&model).unwrap() - value).abs() < 1e-11);
        }
    }
    // A body whose mass is not spread in space has no coordinates.
    let flat = InertialParameters([1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 0.0, 0.0, 0.0]);
    assert_eq!(flat.log_cholesky(), None);
    assert_eq!(InertialParameters([0.0; 10]).log_cholesky(), None);
}

#[test]
fn inverse_dynamics_agrees_with_its_differences() {
    let mut compared = 0;
    for (number, mut data) in random_data(100, cases(10, 25)).enumerate() {
        vary_friction(&mut data);
        let model = data.model().clone();
        let (formulas, others) = (with_formulas(&model), without_formulas(&model));
        let parameters: Vec<_> = formulas
            .iter()
            .skip(number % 7)
            .step_by(11)
            .chain(others.iter().skip(number % 7).step_by(29))
            .copied()
            .collect();
        data.inverse().unwrap();
        for force in [InverseForce::Total, InverseForce::WithoutActuators] {
            let mut by_formulas = Lineariser::new(model.clone(), TransitionOptions::default()).unwrap();
            let (ours, report) = by_formulas.inverse_parameter_jacobian(&mut data, &parameters, force).unwrap();
            assert_eq!(report.method, TransitionMethod::Analytic);
            let differenced = by_formulas.differenced_parameters(&parameters).unwrap();
            for (index, &parameter) in parameters.iter().enumerate() {
                let name = parameter.name(&model).unwrap();
                let value = parameter.value(&model).unwrap();
                let largest = data.qfrc_inverse().iter().fold(1.0, |largest: f64, value| largest.max(value.abs()));
                let inverse = |by: f64| {
                    let mut data = data.clone();
                    data.edit_model(|model| parameter.set(model, value + by)).ok()?;
                    data.inverse().unwrap();
                    let total = data.qfrc_inverse().to_vec();
                    if force == InverseForce::Total {
                        return Some(total);
                    }
                    data.fwd_actuation().unwrap();
                    Some(total.iter().zip(data.qfrc_actuator()).map(|(total, actuator)| total - actuator).collect())
                };
                let slope = |step: f64| -> Option<Vec<f64>> {
                    let (right, left): (Vec<f64>, Vec<f64>) = (inverse(step)?, inverse(-step)?);
                    Some(right.iter().zip(&left).map(|(right, left)| (right - left) / (2.0 * step)).collect())
                };
                if value.abs() < 1e-6 {
                    continue;
                }
                let column: Vec<f64> = ours.rows().map(|row| row[index]).collect();
                let scale = column.iter().fold(1e-3, |largest: f64, value| largest.max(value.abs()));
                let errors = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6].map(|step| {
                    let step = step * value.abs().max(0.05);
                    let (Some(fine), Some(coarse)) = (slope(0.5 * step), slope(step)) else { return 0.0 };
                    let better: Vec<f64> =
                        fine.iter().zip(&coarse).map(|(fine, coarse)| (4.0 * fine - coarse) / 3.0).collect();
                    (deviation(&column, &better).0 - ROUNDING * largest / step) / scale
                });
                let error = errors.into_iter().fold(f64::INFINITY, f64::min);
                // Ours are differences, too, with a step of at least 10⁻⁵.
                let rounding = ROUNDING * largest / (1e-5 * scale);
                let tolerance = if differenced.contains(&parameter) { 1e-4 + rounding } else { 1e-7 };
                assert!(error < tolerance, "{name}, {force:?}, {}: {errors:?}", differenced.contains(&parameter));
                compared += 1;
            }
        }
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn inverse_dynamics_opposes_dry_friction() {
    let text = r#"<mujoco><worldbody><body><joint name="j" axis="0 0 1" frictionloss=".3"/><geom size=".1" pos=".2 0 0"/></body></worldbody></mujoco>"#;
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    data.qvel_mut()[0] = 2.0;
    let model = data.model().clone();
    let parameters = [mujoco_safe::rollout::Parameter::JointFrictionLoss(model.joint("j").unwrap().id()).into()];
    let mut lineariser = Lineariser::new(model, TransitionOptions::default()).unwrap();
    for force in [InverseForce::Total, InverseForce::WithoutActuators] {
        let (forces, report) = lineariser.inverse_parameter_jacobian(&mut data, &parameters, force).unwrap();
        assert_eq!((report.method, forces[(0, 0)]), (TransitionMethod::Analytic, 1.0));
    }
}

#[test]
fn differences_of_steps_are_the_fallback() {
    // Contacts of the humanoid, with Runge–Kutta steps and with another method.
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    let model = data.model().clone();
    let knee = model.joint("right_knee").unwrap().id();
    let parameters =
        [mujoco_safe::rollout::Parameter::JointDamping(knee), mujoco_safe::rollout::Parameter::JointArmature(knee)]
            .map(ModelParameter::from);
    let (closed, _) = Lineariser::new(model.clone(), TransitionOptions::default())
        .unwrap()
        .parameter_jacobian(&mut data, &parameters)
        .unwrap();
    let options = TransitionOptions::default().with_method(TransitionMethod::Columns);
    let (steps, report) = Lineariser::new(model, options).unwrap().parameter_jacobian(&mut data, &parameters).unwrap();
    assert_eq!((report.method, report.fallback), (TransitionMethod::Columns, None));
    let scale = closed.state.as_slice().iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let error = deviation(closed.state.as_slice(), steps.state.as_slice()).0;
    assert!(error < 1e-6 * scale, "{error:e} of {scale:e}");
}
