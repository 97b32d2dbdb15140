//! Gradients of costs along trajectories against extrapolated differences of the whole cost.

use mujoco_safe::derivative::{CostSlopes, ModelParameter, TransitionMethod, TransitionOptions};
use mujoco_safe::rollout::Parameter;
use mujoco_safe::{Data, Lineariser, Matrix, Model, StateSpec, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::oracle;

/// Weights of a quadratic cost of velocities, controls and sensors.
#[derive(Clone)]
struct Cost {
    velocities: Vec<f64>,
    controls: Vec<f64>,
    sensors: Vec<f64>,
}

impl Cost {
    fn random(model: &Model, random: &mut Xoshiro256PlusPlus, has_sensors: bool) -> Self {
        let mut weights = |count: usize| (0..count).map(|_| random.random_range(-1.0..1.0)).collect::<Vec<f64>>();
        let sensors = if has_sensors { model.nsensordata() } else { 0 };
        Self { velocities: weights(model.nv()), controls: weights(model.nu()), sensors: weights(sensors) }
    }

    /// Writes the slopes and returns the cost of a step.
    fn evaluate(&self, data: &Data, slopes: &mut CostSlopes<'_>) -> f64 {
        let nv = data.model().nv();
        let mut cost = 0.0;
        let mut add = |weights: &[f64], values: &[f64], slopes: &mut [f64]| {
            for ((weight, value), slope) in weights.iter().zip(values).zip(slopes) {
                cost += 0.5 * weight * value * value;
                *slope += weight * value;
            }
        };
        add(&self.velocities, data.qvel(), &mut slopes.state[nv..2 * nv]);
        add(&self.sensors, data.sensordata(), &mut *slopes.sensors);
        if !slopes.controls.is_empty() {
            add(&self.controls, data.ctrl(), &mut *slopes.controls);
        }
        cost
    }

    /// Returns the cost of a trajectory.
    fn of_trajectory(&self, mut data: Data, controls: &Matrix) -> f64 {
        let square = |weights: &[f64], values: &[f64]| -> f64 {
            weights.iter().zip(values).map(|(weight, value)| 0.5 * weight * value * value).sum()
        };
        let mut total = 0.0;
        for step in 0..=controls.nrows() {
            let is_end = step == controls.nrows();
            if !is_end {
                data.ctrl_mut().copy_from_slice(controls.row(step));
                total += square(&self.controls, data.ctrl());
            }
            data.forward().unwrap();
            total += square(&self.velocities, data.qvel()) + square(&self.sensors, data.sensordata());
            if !is_end {
                data.step().unwrap();
            }
        }
        total
    }
}

/// Returns the derivative of a function at zero by extrapolated differences, with steps of which
/// the best one is chosen by the caller.
fn slope(function: &dyn Fn(f64) -> f64, step: f64) -> f64 {
    let central = |step: f64| (function(step) - function(-step)) / (2.0 * step);
    let [coarse, middle, fine] = [1.0, 0.5, 0.25].map(|part| central(part * step));
    let (first, second) = ((4.0 * middle - coarse) / 3.0, (4.0 * fine - middle) / 3.0);
    (16.0 * second - first) / 15.0
}

#[track_caller]
fn assert_slope(what: &str, ours: f64, scale: f64, function: &dyn Fn(f64) -> f64) {
    let errors = [1e-3, 1e-4, 1e-2, 1e-5].map(|step| (slope(function, step) - ours).abs() / ours.abs().max(scale));
    let least = errors.into_iter().fold(f64::INFINITY, f64::min);
    assert!(least < 1e-6, "{what}: {ours:e}, errors {errors:?}");
}

/// Compares the gradient by random controls, the initial state and parameters.
fn check(data: &mut Data, steps: usize, parameters: &[ModelParameter], has_sensors: bool, method: TransitionMethod) {
    data.edit_model(|model| {
        model.edit_options(|options| {
            options.tolerance = 0.0;
            options.iterations = 200;
        })
    })
    .unwrap();
    let model = data.model().clone();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
    let cost = Cost::random(&model, &mut random, has_sensors);
    let mut controls = Matrix::zeros(steps, model.nu());
    controls.as_mut_slice().iter_mut().for_each(|value| *value = random.random_range(-0.3..0.3));
    let before = data.state(StateSpec::INTEGRATION);
    let mut lineariser = Lineariser::new(model.clone(), TransitionOptions::default()).unwrap();
    let (gradient, report) =
        lineariser.cost_gradient(data, &controls, parameters, |_, data, slopes| cost.evaluate(data, slopes)).unwrap();
    assert_eq!(report.method, method, "{report:?}");
    assert_eq!(data.state(StateSpec::INTEGRATION), before);
    let total = cost.of_trajectory(data.clone(), &controls);
    assert!((gradient.cost - total).abs() <= 1e-12 * total.abs().max(1.0), "{} {total}", gradient.cost);

    let mut direction = Matrix::zeros(steps, model.nu());
    direction.as_mut_slice().iter_mut().for_each(|value| *value = random.random_range(-1.0..1.0));
    let product = |one: &[f64], other: &[f64]| -> f64 { one.iter().zip(other).map(|(one, other)| one * other).sum() };
    let scale = 1e-3 * total.abs().max(1e-3);
    let by_controls = product(gradient.controls.as_slice(), direction.as_slice());
    assert_slope("controls", by_controls, scale, &|by| {
        let mut varied = controls.clone();
        varied.as_mut_slice().iter_mut().zip(direction.as_slice()).for_each(|(value, slope)| *value += by * slope);
        cost.of_trajectory(data.clone(), &varied)
    });

    let (nv, na) = (model.nv(), model.na());
    let direction: Vec<f64> = (0..2 * nv + na).map(|_| random.random_range(-0.1..0.1)).collect();
    assert_slope("initial state", product(&gradient.initial_state, &direction), scale, &|by| {
        let mut varied = data.clone();
        model.integrate_pos(varied.qpos_mut(), &direction[..nv], by).unwrap();
        varied.qvel_mut().iter_mut().zip(&direction[nv..]).for_each(|(value, slope)| *value += by * slope);
        varied.act_mut().iter_mut().zip(&direction[2 * nv..]).for_each(|(value, slope)| *value += by * slope);
        cost.of_trajectory(varied, &controls)
    });

    for (parameter, &ours) in parameters.iter().zip(&gradient.parameters) {
        let value = parameter.value(&model).unwrap();
        let size = if value == 0.0 { 1.0 } else { value.abs() };
        assert_slope(&parameter.name(&model).unwrap(), ours * size, scale, &|by| {
            let mut varied = data.clone();
            oracle::set(&mut varied, *parameter, value + by * size).unwrap();
            cost.of_trajectory(varied, &controls)
        });
    }
}

/// Returns an arm with sensors, a spring, a tendon, and a filter.
fn arm(option: &str) -> Data {
    let text = format!(
        r#"<mujoco><option {option}/><worldbody><body name="a"><joint name="i" axis="0 1 0" damping=".3" armature=".02"/>
             <geom name="g" type="capsule" size=".04 .2" pos=".2 0 0" euler="0 90 5"/>
             <body name="b" pos=".4 0 0"><joint name="j" type="ball" damping=".1" stiffness="2"/><site name="s" pos=".1 0 .1" euler="20 30 40"/>
             <geom type="box" size=".1 .05 .03" pos=".1 .02 0"/>
             <body name="c" pos=".2 0 0"><joint name="k" axis="0 0 1" frictionloss=".05"/><geom size=".05" pos=".1 0 0"/></body></body></body></worldbody>
           <tendon><fixed name="t" stiffness="3" damping=".2"><joint joint="i" coef="1"/><joint joint="k" coef="-.7"/></fixed></tendon>
           <actuator><position name="p" joint="i" kp="5"/>
             <general name="v" joint="k" gaintype="affine" gainprm="1 .3 .2" biastype="affine" biasprm=".1 -1 -.2"/>
             <general name="f" tendon="t" dyntype="filter" dynprm=".05" gainprm="2"/></actuator>
           <sensor><accelerometer site="s"/><gyro site="s"/><force site="s"/><torque site="s"/><actuatorfrc actuator="v"/><subtreecom body="b"/></sensor></mujoco>"#
    );
    let mut data = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
    data.qvel_mut().copy_from_slice(&[0.5, -0.4, 0.8, 0.3, -0.6]);
    data.qpos_mut()[0] = 0.7;
    data
}

fn parameters_of_arm(model: &Model) -> Vec<ModelParameter> {
    let body = |name: &str| model.body(name).unwrap().id();
    let field = |array: &str, row: usize, column: usize| ModelParameter::field(model, array, row, column).unwrap();
    vec![
        ModelParameter::Mass(body("c")),
        ModelParameter::LogCholesky(body("b"), 4),
        Parameter::Gravity(2).into(),
        Parameter::JointDamping(model.joint("i").unwrap().id()).into(),
        Parameter::JointStiffness(model.joint("j").unwrap().id()).into(),
        field("dof_armature", 0, 0),
        field("tendon_stiffness", 0, 0),
        field("actuator_gainprm", 1, 2),
        field("actuator_biasprm", 0, 1),
        field("actuator_dynprm", 2, 0),
        field("actuator_gear", 2, 0),
        field("body_pos", 3, 0),
    ]
}

#[test]
fn gradients_agree_with_differences_of_the_cost() {
    for option in ["", r#"integrator="implicit""#] {
        for has_sensors in [false, true] {
            let mut data = arm(option);
            let parameters = parameters_of_arm(data.model());
            check(&mut data, 17, &parameters, has_sensors, TransitionMethod::Analytic);
        }
    }
    let mut data = arm(r#"integrator="RK4""#);
    let parameters = parameters_of_arm(data.model());
    check(&mut data, 5, &parameters[..4], true, TransitionMethod::Columns);
}

#[test]
fn gradients_of_the_humanoid_agree_with_differences_of_the_cost() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    // The floor has the largest friction of all geoms.
    data.edit_model(|model| model.geom_friction_mut()[0][0] = 2.0).unwrap();
    let model = data.model().clone();
    let parameters = [
        ModelParameter::Mass(model.body("torso").unwrap().id()),
        ModelParameter::field(&model, "geom_friction", 0, 0).unwrap(),
        ModelParameter::field(&model, "geom_solimp", 0, 1).unwrap(),
    ];
    check(&mut data, 9, &parameters, false, TransitionMethod::Analytic);
}

#[test]
fn sensitivities_are_derivatives_of_the_final_state() {
    let mut data = arm("");
    let model = data.model().clone();
    let parameters = parameters_of_arm(&model);
    let mut controls = Matrix::zeros(12, model.nu());
    controls.as_mut_slice().iter_mut().enumerate().for_each(|(at, value)| *value = 0.2 * (at as f64).sin());
    let mut lineariser = Lineariser::new(model.clone(), TransitionOptions::default()).unwrap();
    let (sensitivities, report) = lineariser.sensitivities(&mut data, &controls, &parameters).unwrap();
    assert_eq!((report.method, sensitivities.len()), (TransitionMethod::Analytic, 13));
    // Forwards and backwards give the same derivatives.
    for dof in 0..model.nv() {
        let (gradient, _) = lineariser
            .cost_gradient(&mut data, &controls, &parameters, |step, data, slopes| {
                if step < 12 {
                    return 0.0;
                }
                slopes.state[model.nv() + dof] = 1.0;
                data.qvel()[dof]
            })
            .unwrap();
        for (index, &by_parameter) in gradient.parameters.iter().enumerate() {
            let forwards = sensitivities[12][(model.nv() + dof, index)];
            let error = (forwards - by_parameter).abs();
            assert!(error <= 1e-10 * forwards.abs().max(1.0), "{dof} {index}: {forwards:e} {by_parameter:e}");
        }
    }
}

#[test]
fn errors_and_edges() {
    let mut data = arm("");
    let model = data.model().clone();
    let mut lineariser = Lineariser::new(model.clone(), TransitionOptions::default()).unwrap();
    let no_cost = |_: usize, _: &Data, _: &mut CostSlopes<'_>| 0.0;
    assert!(lineariser.cost_gradient(&mut data, &Matrix::zeros(3, model.nu() + 1), &[], no_cost).is_err());
    let (gradient, _) = lineariser.cost_gradient(&mut data, &Matrix::zeros(0, model.nu()), &[], no_cost).unwrap();
    assert_eq!((gradient.cost, gradient.controls.shape()), (0.0, (0, model.nu())));
    let controls = Matrix::zeros(3, model.nu());
    let error =
        lineariser.cost_gradient(&mut data, &controls, &[], |step, _, _| if step == 1 { f64::NAN } else { 0.0 });
    assert!(error.unwrap_err().to_string().contains("step 1"));
    // The lineariser is usable afterwards, also with an edited model.
    data.edit_model(|model| model.dof_damping_mut()[0] = 0.7).unwrap();
    assert!(lineariser.cost_gradient(&mut data, &controls, &[], no_cost).is_ok());
}
