//! Costs as residuals: Jacobians, norms and expansions against differences, and the search with
//! them.

use std::sync::Arc;

use mujoco_safe::control::ilqr::{CostExpansion, Ilqr, IlqrOptions, QuadraticCost, TrajectoryCost};
use mujoco_safe::control::residual::{
    Controls, FrameOrientation, FramePosition, JointPosition, JointVelocity, Needs, Norm, Residual, ResidualCost,
    ResidualJacobian, SensorReading, Subtree, Term,
};
use mujoco_safe::{Data, Error, LqrWeights, Matrix, Model, Result, sample};
use nalgebra::{DMatrix, DVector};

use super::{Random, assert_close, cartpole};
use crate::cases::cases;

/// Returns a free body with a ball joint and a hinge below it, activations, sensors and a mocap
/// body.
fn tree() -> Data {
    let model = Model::from_xml_str(
        r#"<mujoco><option gravity="0 0 -9.81"/><worldbody>
          <body name="target" mocap="true" pos="1 2 3"><site name="mark" pos="0.1 0 0"/></body>
          <body name="trunk" pos="0 0 2"><freejoint name="root"/><geom type="box" size="0.2 0.1 0.3" pos="0.05 0 0"/>
            <body name="arm" pos="0.2 0.1 0.3"><joint name="ball" type="ball" damping="0.1"/>
              <geom type="capsule" size="0.05" fromto="0 0 0 0.3 0.1 0" contype="0" conaffinity="0"/>
              <body name="hand" pos="0.3 0.1 0"><joint name="hinge" axis="0 1 1"/><joint name="slide" type="slide" axis="1 0 0"/>
                <geom type="box" size="0.05 0.08 0.02" contype="0" conaffinity="0"/>
                <site name="palm" pos="0.05 0.02 0.01" euler="20 30 40"/></body></body></body>
        </worldbody>
        <actuator><motor joint="slide"/><general joint="hinge" dyntype="filter" dynprm="0.1" gainprm="2"/></actuator>
        <sensor><accelerometer name="accelerometer" site="palm"/><framepos name="position" objtype="site" objname="palm"/>
          <jointpos name="angle" joint="hinge"/></sensor></mujoco>"#,
    )
    .unwrap();
    Data::new(model).unwrap()
}

/// Moves a simulation to a random state near the present one, with random controls.
fn scatter(data: &mut Data, random: &mut Random) {
    let model = data.model().clone();
    let direction = random.vector(model.nv());
    model.integrate_pos(data.qpos_mut(), direction.as_slice(), 0.3).unwrap();
    data.qvel_mut().copy_from_slice(random.vector(model.nv()).as_slice());
    data.act_mut().copy_from_slice(random.vector(model.na()).as_slice());
    data.ctrl_mut().copy_from_slice((random.vector(model.nu()) * 0.1).as_slice());
}

fn compute(data: &mut Data) {
    data.forward().unwrap();
    data.subtree_vel().unwrap();
}

/// Returns the residual after an input was changed: a degree of freedom, a velocity, an activation
/// or a control.
fn perturbed(data: &Data, residual: &dyn Residual, input: usize, change: f64) -> DVector<f64> {
    let mut data = data.clone();
    let (nv, na) = (data.model().nv(), data.model().na());
    if input < nv {
        let mut direction = vec![0.0; nv];
        direction[input] = 1.0;
        data.integrate_pos(&direction, change).unwrap();
    } else if input < 2 * nv {
        data.qvel_mut()[input - nv] += change;
    } else if input < 2 * nv + na {
        data.act_mut()[input - 2 * nv] += change;
    } else {
        data.ctrl_mut()[input - 2 * nv - na] += change;
    }
    compute(&mut data);
    let mut values = DVector::zeros(residual.size());
    residual.evaluate(&mut data, values.as_mut_slice()).unwrap();
    values
}

/// Returns a derivative by central differences with Richardson extrapolation, whose error is of the
/// fourth order.
fn extrapolated(value: impl Fn(f64) -> DVector<f64>) -> DVector<f64> {
    const STEP: f64 = 2e-3;
    let central = |step: f64| (value(step) - value(-step)) / (2.0 * step);
    (central(STEP / 2.0) * 4.0 - central(STEP)) / 3.0
}

fn differenced(data: &Data, residual: &dyn Residual) -> DMatrix<f64> {
    let model = data.model();
    let columns = 2 * model.nv() + model.na() + model.nu();
    let columns: Vec<_> =
        (0..columns).map(|input| extrapolated(|change| perturbed(data, residual, input, change))).collect();
    DMatrix::from_columns(&columns)
}

fn jacobian(data: &mut Data, residual: &dyn Residual) -> DMatrix<f64> {
    let mut jacobian = ResidualJacobian::zeros(data.model(), residual.size());
    compute(data);
    residual.differentiate(data, &mut jacobian).unwrap();
    let rows = (0..residual.size()).map(|row| [jacobian.by_state(row), jacobian.by_controls(row)].concat());
    DMatrix::from_row_iterator(
        residual.size(),
        2 * data.model().nv() + data.model().na() + data.model().nu(),
        rows.flatten(),
    )
}

fn residuals(model: &Model) -> Vec<(String, Box<dyn Residual>)> {
    let mut list: Vec<(String, Box<dyn Residual>)> = vec![
        ("positions".into(), Box::new(JointPosition::all(model))),
        ("velocities".into(), Box::new(JointVelocity::all(model))),
        ("controls".into(), Box::new(Controls::new(model))),
    ];
    for joint in 0..model.njnt() {
        list.push((format!("position {joint}"), Box::new(JointPosition::new(model, joint).unwrap())));
        list.push((format!("velocity {joint}"), Box::new(JointVelocity::new(model, joint).unwrap())));
    }
    for body in 0..model.nbody() {
        let target = [0.5, -0.5, 0.7, 0.1];
        list.push((format!("body {body}"), Box::new(FramePosition::body(model, body).unwrap())));
        let orientation = FrameOrientation::body(model, body).unwrap().with_target(target);
        list.push((format!("orientation {body}"), Box::new(orientation)));
        if model.body_subtreemass()[body] > 0.0 {
            list.push((format!("centre of mass {body}"), Box::new(Subtree::com(model, body).unwrap())));
            list.push((format!("velocity of {body}"), Box::new(Subtree::velocity(model, body).unwrap())));
            list.push((format!("momentum of {body}"), Box::new(Subtree::angular_momentum(model, body).unwrap())));
        }
    }
    for site in 0..model.nsite() {
        list.push((format!("site {site}"), Box::new(FramePosition::site(model, site).unwrap())));
        list.push((format!("orientation of {site}"), Box::new(FrameOrientation::site(model, site).unwrap())));
    }
    list
}

#[track_caller]
fn assert_exact(data: &mut Data, name: &str, residual: &dyn Residual) {
    let (found, expected) = (jacobian(data, residual), differenced(data, residual));
    let error = (&found - &expected).amax() / expected.amax().max(1.0);
    assert!(error < 1e-8, "{name}: error {error:e}, {found} instead of {expected}");
}

#[test]
fn the_jacobian_of_each_residual_equals_extrapolated_differences() {
    let mut random = Random::new(3);
    for mut data in [cartpole(), tree()] {
        for _ in 0..cases(1, 3) {
            scatter(&mut data, &mut random);
            for (name, residual) in residuals(&data.model().clone()) {
                assert_exact(&mut data, &name, &*residual);
            }
        }
    }
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    scatter(&mut data, &mut random);
    let model = data.model().clone();
    let torso = Subtree::velocity(&model, "torso").unwrap();
    assert_exact(&mut data, "velocity", &torso);
    assert_exact(&mut data, "momentum", &Subtree::angular_momentum(&model, "torso").unwrap());
    assert_exact(&mut data, "centre of mass", &Subtree::com(&model, "torso").unwrap());
    assert_exact(&mut data, "hand", &FramePosition::body(&model, "hand_left").unwrap());
    assert_exact(&mut data, "orientation", &FrameOrientation::body(&model, "torso").unwrap());
    assert_exact(&mut data, "positions", &JointPosition::all(&model));
}

#[test]
fn the_jacobian_of_a_sensor_equals_extrapolated_differences() {
    let mut data = tree();
    scatter(&mut data, &mut Random::new(5));
    let model = data.model().clone();
    for name in ["accelerometer", "position", "angle"] {
        assert_exact(&mut data, name, &SensorReading::new(&model, name).unwrap());
    }
    // The reading of a position is that of the site.
    let (sensor, site) =
        (SensorReading::new(&model, "position").unwrap(), FramePosition::site(&model, "palm").unwrap());
    assert_close(&jacobian(&mut data, &sensor), &jacobian(&mut data, &site), 1e-12);
}

/// A residual that does not implement the Jacobian.
struct Opaque(Subtree);

impl Residual for Opaque {
    fn size(&self) -> usize {
        self.0.size()
    }

    fn needs(&self) -> Needs {
        self.0.needs()
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        self.0.evaluate(data, residual)
    }
}

#[test]
fn a_residual_without_a_jacobian_is_differenced() {
    let mut data = tree();
    scatter(&mut data, &mut Random::new(7));
    let exact = Subtree::angular_momentum(data.model(), "trunk").unwrap();
    let before = data.physics_state();
    let found = jacobian(&mut data, &Opaque(exact.clone()));
    assert_eq!(data.physics_state(), before);
    assert_close(&found, &jacobian(&mut data, &exact), 1e-8);
}

const NORMS: [Norm; 3] = [Norm::Quadratic, Norm::SmoothAbs { width: 0.3 }, Norm::Huber { width: 0.5 }];

#[test]
fn slope_and_curvature_of_each_norm_equal_differences() {
    let derivative = |function: &dyn Fn(f64) -> f64, at: f64| {
        extrapolated(|change| DVector::from_element(1, function(at + change)))[0]
    };
    for norm in NORMS {
        assert_eq!((norm.value(0.0), norm.slope(0.0)), (0.0, 0.0));
        for residual in [-2.0, -0.4, -0.01, 0.2, 0.45, 3.0] {
            assert_eq!(norm.value(residual), norm.value(-residual));
            assert!((norm.slope(residual) - derivative(&|at| norm.value(at), residual)).abs() < 1e-8);
            assert!((norm.curvature(residual) - derivative(&|at| norm.slope(at), residual)).abs() < 1e-8);
        }
    }
}

/// Returns the cost with an input of the state or a control changed.
fn cost_near(data: &Data, cost: &ResidualCost, input: usize, change: f64) -> f64 {
    let (mut data, nv, nx) = (data.clone(), data.model().nv(), 2 * data.model().nv() + data.model().na());
    if input < nv {
        let mut direction = vec![0.0; nv];
        direction[input] = 1.0;
        data.integrate_pos(&direction, change).unwrap();
    } else if input < nx {
        let mut state = data.physics_state();
        state[data.model().nq() + input - nv] += change;
        data.set_physics_state(&state).unwrap();
    } else {
        data.ctrl_mut()[input - nx] += change;
    }
    cost.value(0, &data.physics_state(), Some(data.ctrl())).unwrap()
}

fn expand(data: &Data, cost: &ResidualCost) -> CostExpansion {
    let mut expansion = CostExpansion::zeros(data.model());
    cost.expand(0, &data.physics_state(), Some(data.ctrl()), &mut expansion).unwrap();
    expansion
}

#[test]
fn the_gradient_of_a_cost_equals_extrapolated_differences() {
    let mut data = tree();
    scatter(&mut data, &mut Random::new(11));
    let model = data.model().clone();
    for norm in NORMS {
        let cost = ResidualCost::new(
            &model,
            [
                Term::new("palm", FramePosition::site(&model, "palm").unwrap()).with_norm(norm).with_weight(2.0),
                Term::new("momentum", Subtree::angular_momentum(&model, "trunk").unwrap())
                    .with_norm(norm)
                    .with_scales([0.0, 2.0, 1.0]),
                Term::new("acceleration", SensorReading::new(&model, "accelerometer").unwrap()).with_norm(norm),
                Term::new("controls", Controls::new(&model)).with_norm(norm).with_scales([1.0, 3.0]),
            ],
        )
        .unwrap();
        let expansion = expand(&data, &cost);
        let found: Vec<f64> = expansion.x.iter().chain(&expansion.u).copied().collect();
        let scale = found.iter().fold(1.0_f64, |largest, value| largest.max(value.abs()));
        for (input, found) in found.iter().enumerate() {
            let near = |change| DVector::from_element(1, cost_near(&data, &cost, input, change));
            let expected = extrapolated(near)[0];
            assert!((found - expected).abs() < 1e-7 * scale, "{norm:?}, input {input}: {found}, not {expected}");
        }
    }
}

#[test]
fn the_second_derivatives_are_exact_for_linear_residuals_and_include_mixed_ones() {
    /// `r = q₁ + 2 v₀ + 3 u`
    struct Linear;
    impl Residual for Linear {
        fn size(&self) -> usize {
            1
        }

        fn needs(&self) -> Needs {
            Needs::State
        }

        fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
            residual[0] = data.qpos()[1] + 2.0 * data.qvel()[0] + 3.0 * data.ctrl()[0];
            Ok(())
        }
    }

    let mut data = cartpole();
    data.set_physics_state(&[0.1, 0.2, 0.3, 0.4]).unwrap();
    data.ctrl_mut()[0] = -0.15;
    let residual = 0.2 + 0.6 - 0.45;
    for norm in NORMS {
        let cost = ResidualCost::new(data.model(), [Term::new("linear", Linear).with_norm(norm).with_weight(5.0)]);
        let expansion = expand(&data, &cost.unwrap());
        // ρ″ at r, by hand.
        let curvature = 5.0
            * match norm {
                Norm::SmoothAbs { width } => width * width / (residual * residual + width * width).powf(1.5),
                _ => 1.0,
            };
        let j = DVector::from_vec(vec![0.0, 1.0, 2.0, 0.0]);
        assert_close(&expansion.xx, &(&j * j.transpose() * curvature), 1e-8);
        assert_close(&expansion.xu, &DMatrix::from_column_slice(4, 1, (&j * (3.0 * curvature)).as_slice()), 1e-8);
        assert_close(&expansion.uu, &DMatrix::from_element(1, 1, 9.0 * curvature), 1e-8);
    }
}

/// Returns the cart-pole with a distant target, as a residual cost and as a quadratic cost.
fn both() -> (Data, ResidualCost, QuadraticCost) {
    let data = cartpole();
    let model = data.model().clone();
    let (weights, control, end): ([f64; 4], f64, f64) = ([1.0, 0.1, 0.01, 0.02], 1e-3, 10.0);
    // The quadratic norm has a factor ½, and the quadratic cost has none.
    let scales = weights.map(|weight| (2.0 * weight).sqrt());
    let position = || JointPosition::all(&model).with_target(&[0.6, 0.0]).unwrap();
    let velocity = || JointVelocity::all(&model);
    let terms = [
        Term::new("position", position()).with_scales(&scales[..2]).with_terminal_weight(0.0),
        Term::new("velocity", velocity()).with_scales(&scales[2..]).with_terminal_weight(0.0),
        Term::new("control", Controls::new(&model)).with_weight(2.0 * control),
        Term::new("end", position()).with_weight(0.0).with_terminal_weight(2.0 * end),
        Term::new("rest", velocity()).with_weight(0.0).with_terminal_weight(2.0 * end),
    ];
    let residual = ResidualCost::new(&model, terms).unwrap();
    let weights = LqrWeights::diagonal(&weights, &[control]);
    let quadratic = QuadraticCost::new(&model, &[0.6, 0.0, 0.0, 0.0], weights, DMatrix::identity(4, 4) * end).unwrap();
    (data, residual, quadratic)
}

#[test]
fn the_search_equals_that_with_the_same_quadratic_cost() {
    let (data, residual, quadratic) = both();
    for threads in [1, 3] {
        let options = IlqrOptions::default().with_iterations(20).with_threads(threads);
        let solve = |cost: &dyn TrajectoryCost| {
            Ilqr::new(data.model(), options.clone()).unwrap().solve(&data, &Matrix::zeros(60, 1), cost).unwrap()
        };
        let (found, expected) = (solve(&residual), solve(&quadratic));
        assert!((found.cost() - expected.cost()).abs() < 1e-9 * expected.cost());
        assert_close(&found.controls.to_nalgebra(), &expected.controls.to_nalgebra(), 1e-6);
        let total = residual.total(found.states.view(), found.controls.view()).unwrap();
        assert!((total - found.cost()).abs() < 1e-12 * total);
    }
}

#[test]
fn weights_and_targets_can_change_between_evaluations() {
    let (data, mut cost, _) = both();
    let mut values = [0.0; 5];
    let mut evaluate = |cost: &ResidualCost| {
        cost.values_into(0, &data.physics_state(), Some(&[0.5]), &mut values).unwrap();
        let sum = cost.value(0, &data.physics_state(), Some(&[0.5])).unwrap();
        assert!((values.iter().sum::<f64>() - sum).abs() < 1e-15);
        values
    };
    assert_eq!(evaluate(&cost), [0.36, 0.0, 0.5 * 2e-3 * 0.25, 0.0, 0.0]);
    cost.term_mut("position").unwrap().set_target(&[0.0, 0.0]).unwrap();
    cost.term_mut("control").unwrap().weight = 2.0;
    cost.terms_mut()[3].weight = 1.0;
    assert_eq!(evaluate(&cost), [0.0, 0.0, 0.25, 0.5 * 0.36, 0.0]);
}

/// The time of the simulation.
struct Time;

impl Residual for Time {
    fn size(&self) -> usize {
        1
    }

    fn needs(&self) -> Needs {
        Needs::State
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        residual[0] = data.time();
        Ok(())
    }
}

#[test]
fn time_and_mocap_poses_are_those_at_the_beginning_of_the_search() {
    let mut data = tree();
    let model = data.model().clone();
    let mark = FramePosition::site(&model, "mark").unwrap();
    let cost = ResidualCost::new(&model, [Term::new("time", Time), Term::new("mark", mark)]).unwrap();
    let evaluate = |step: usize, data: &Data| {
        let mut values = [0.0; 2];
        cost.values_into(step, &data.physics_state(), None, &mut values).unwrap();
        values
    };
    let near = |found: [f64; 2], expected: [f64; 2]| (0..2).all(|term| (found[term] - expected[term]).abs() < 1e-12);
    let h = model.timestep();
    assert!(near(evaluate(10, &data), [0.5 * (10.0 * h).powi(2), 0.5 * (1.1 * 1.1 + 4.0 + 9.0)]));
    data.set_time(2.0);
    data.mocap_pos_mut()[0] = [0.0, 0.0, 1.0];
    cost.begin(&data).unwrap();
    assert!(near(evaluate(10, &data), [0.5 * (2.0 + 10.0 * h).powi(2), 0.5 * (0.01 + 1.0)]));
    // The search calls `begin`.
    data.mocap_pos_mut()[0] = [0.0, 0.0, 0.0];
    let mut solver = Ilqr::new(&model, IlqrOptions::default().with_iterations(0)).unwrap();
    let solution = solver.solve(&data, &Matrix::zeros(1, 2), &cost).unwrap();
    let times = 0.5 * (4.0 + (2.0 + h).powi(2));
    assert!((solution.cost() - times - 2.0 * 0.5 * 0.01).abs() < 1e-12);
}

/// A residual that cannot be evaluated.
struct Failing;

impl Residual for Failing {
    fn size(&self) -> usize {
        1
    }

    fn needs(&self) -> Needs {
        Needs::State
    }

    fn evaluate(&self, _: &mut Data, _: &mut [f64]) -> Result<()> {
        Err(Error::Unsupported("no value".into()))
    }
}

#[test]
fn errors_of_a_residual_reach_the_caller_and_a_weight_of_zero_disables_it() {
    let data = cartpole();
    let mut cost = ResidualCost::new(data.model(), [Term::new("failing", Failing)]).unwrap();
    let mut solver = Ilqr::new(data.model(), IlqrOptions::default()).unwrap();
    let error = solver.solve(&data, &Matrix::zeros(5, 1), &cost).unwrap_err();
    assert_eq!(error.to_string(), "no value");
    let term = cost.term_mut("failing").unwrap();
    (term.weight, term.terminal_weight) = (0.0, 0.0);
    assert_eq!(cost.value(0, &data.physics_state(), None).unwrap(), 0.0);
}

#[test]
fn invalid_terms_are_errors_that_name_the_term() {
    let model = Arc::new(sample::cartpole());
    let angle = || JointPosition::new(&model, "hinge").unwrap();
    let error = |terms: Vec<Term>| ResidualCost::new(&model, terms).unwrap_err();
    let text = error(vec![Term::new("twice", angle()), Term::new("twice", angle())]).to_string();
    assert!(text.contains("twice"), "{text}");
    for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let text = error(vec![Term::new("angle", angle()).with_norm(Norm::Huber { width })]).to_string();
        assert!(text.contains("'angle'"), "{text}");
    }
    assert!(matches!(error(vec![Term::new("a", angle()).with_scales([1.0, 2.0])]), Error::Shape { .. }));
    assert!(matches!(angle().with_target(&[1.0, 2.0]), Err(Error::Shape { .. })));

    let mut cost = ResidualCost::new(&model, [Term::new("angle", angle()), Term::new("time", Time)]).unwrap();
    let text = cost.term_mut("angel").unwrap_err().to_string();
    assert!(text.contains("angle, time"), "{text}");
    assert!(matches!(cost.term_mut("time").unwrap().set_target(&[1.0]), Err(Error::Unsupported(_))));
    assert!(matches!(cost.term_mut("angle").unwrap().set_target(&[1.0; 2]), Err(Error::Shape { .. })));
    assert!(matches!(cost.value(0, &[0.0; 3], None), Err(Error::Shape { .. })));
    assert!(matches!(cost.value(0, &[0.0; 4], Some(&[0.0; 2])), Err(Error::Shape { .. })));
    assert!(matches!(cost.begin(&cartpole()), Err(Error::OtherModel { .. })));
    let other = ResidualCost::new(sample::cartpole(), [Term::new("angle", angle())]).unwrap();
    assert!(matches!(other.value(0, &[0.0; 4], None), Err(Error::OtherModel { .. })));
}
