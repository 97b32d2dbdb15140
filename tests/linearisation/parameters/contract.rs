//! Contracts of the derivatives by parameters: shapes, errors, unchanged simulations, kinks.

use mujoco_safe::callback::Callbacks;
use mujoco_safe::derivative::{
    DifferencedTerms, InertialParameters, InverseForce, ModelParameter, ParameterJacobian, ParameterOutputs,
    TransitionOptions,
};
use mujoco_safe::rollout::Parameter;
use mujoco_safe::{Data, Lineariser, Matrix, StateSpec, sample};

fn cartpole() -> (Data, Lineariser) {
    let data = Data::new(sample::cartpole()).unwrap();
    let lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    (data, lineariser)
}

#[test]
fn shapes_are_checked() {
    let (mut data, mut lineariser) = cartpole();
    let body = data.model().body("pole").unwrap().id();
    let parameters = [ModelParameter::Mass(body), ModelParameter::Inertia(body, 5)];
    let mut wrong = Matrix::zeros(4, 3);
    let outputs = ParameterOutputs { state: Some(&mut wrong), sensors: None };
    let error = lineariser.parameter_jacobian_into(&mut data, &parameters, outputs).unwrap_err();
    assert!(error.to_string().contains("(4, 2)"), "{error}");
    let force = InverseForce::Total;
    assert!(lineariser.inverse_parameter_jacobian_into(&mut data, &parameters, force, &mut wrong).is_err());
    data.forward().unwrap();
    assert!(data.body_regressor_into(body, &mut wrong).is_err());
    assert!(data.joint_regressor_into(&mut wrong).is_err());
    let (jacobian, _) = lineariser.parameter_jacobian(&mut data, &[]).unwrap();
    assert_eq!(jacobian, ParameterJacobian::zeros(data.model(), 0));
}

#[test]
fn components_and_values_are_checked() {
    let mut model = sample::cartpole();
    let body = model.body("pole").unwrap().id();
    let world = model.bodies().next().unwrap().id();
    let error = ModelParameter::Inertia(body, 6).name(&model).unwrap_err();
    assert!(error.to_string().contains("less than 6"), "{error}");
    let error = ModelParameter::LogCholesky(world, 0).value(&model).unwrap_err();
    assert!(error.to_string().contains("no mass"), "{error}");
    let mut set = |parameter: ModelParameter, value: f64| parameter.set(&mut model.edit(), value);
    assert!(set(ModelParameter::Mass(body), -1.0).is_err());
    assert!(set(ModelParameter::Mass(body), f64::NAN).is_err());
    assert!(set(ModelParameter::Inertia(body, 0), -1.0).is_err());
    assert!(set(ModelParameter::LogCholesky(body, 0), f64::INFINITY).is_err());
    assert!(set(ModelParameter::LogCholesky(body, 0), 1e4).is_err());
    assert!(set(Parameter::Gravity(2).into(), -3.7).is_ok());
    assert!(set(Parameter::Gravity(3).into(), -3.7).is_err());
}

#[test]
#[should_panic(expected = "model")]
fn elements_of_another_model_panic() {
    let (mut data, mut lineariser) = cartpole();
    let other = sample::humanoid().body("torso").unwrap().id();
    let _ = lineariser.parameter_jacobian(&mut data, &[ModelParameter::Mass(other)]);
}

#[test]
fn regressors_need_velocities() {
    let data = Data::new(sample::cartpole()).unwrap();
    assert!(data.joint_regressor().is_err());
    assert!(data.body_regressor(data.model().body("pole").unwrap().id()).is_err());
}

#[test]
fn the_simulation_is_unchanged() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    (0..3).for_each(|_| data.step().unwrap());
    let model = data.model().clone();
    let mut lineariser = Lineariser::new(model.clone(), TransitionOptions::default()).unwrap();
    let parameters = [
        ModelParameter::Mass(model.body("torso").unwrap().id()),
        ModelParameter::field(&model, "body_pos", 1, 0).unwrap(),
    ];
    let (before, sensors) = (data.state(StateSpec::INTEGRATION), data.sensordata().to_vec());
    let (first, report) = lineariser.parameter_jacobian(&mut data, &parameters).unwrap();
    assert!(report.differenced.contains(DifferencedTerms::PARAMETERS));
    assert_eq!(lineariser.differenced_parameters(&parameters).unwrap(), parameters[1..]);
    assert_eq!((data.state(StateSpec::INTEGRATION), data.sensordata().to_vec()), (before, sensors));
    assert_eq!(lineariser.parameter_jacobian(&mut data, &parameters).unwrap().0, first);
    // A change of the model takes effect.
    data.edit_model(|model| model.geom_friction_mut()[0][0] *= 1.5).unwrap();
    assert_ne!(lineariser.parameter_jacobian(&mut data, &parameters).unwrap().0, first);
}

#[test]
fn callbacks_are_rejected() {
    let (mut data, mut lineariser) = cartpole();
    data.set_callbacks(Callbacks::new().with_passive(|_| ()));
    assert!(lineariser.parameter_jacobian(&mut data, &[Parameter::Gravity(0).into()]).is_err());
}

#[test]
fn hostile_values_are_errors_or_numbers() {
    let mut model = sample::cartpole();
    let body = model.body("pole").unwrap().id();
    for mass in [0.0, f64::NAN, f64::INFINITY, -1.0, 1e300] {
        model.edit().body_mass_mut()[body.index()] = mass;
        let mut data = Data::new(model.clone()).unwrap();
        let _ = InertialParameters::of(&model, body).log_cholesky();
        let mut lineariser = Lineariser::new(model.clone(), TransitionOptions::default()).unwrap();
        let parameters =
            [ModelParameter::Mass(body), ModelParameter::Inertia(body, 3), Parameter::MassFactor(body).into()];
        let _ = lineariser.parameter_jacobian(&mut data, &parameters);
        let _ = lineariser.inverse_parameter_jacobian(&mut data, &parameters, InverseForce::Total);
        let _ = lineariser.parameter_jacobian(&mut data, &[ModelParameter::LogCholesky(body, 0)]);
    }
}
