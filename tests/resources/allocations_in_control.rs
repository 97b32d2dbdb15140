//! Linearisations, controllers, planners and rollouts do not allocate, or only in the first call.
#![forbid(unsafe_code)]
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use mujoco_safe::control::TimeVaryingLqr;
use mujoco_safe::control::ilqr::{CostExpansion, IlqrOptions, QuadraticCost, TrajectoryCost};
use mujoco_safe::control::predictive::{
    IlqrPlanner, Planner, SamplingOptions, SamplingPlanner, ThreadedPredictiveController,
};
use mujoco_safe::control::residual::{
    Controls, Frame, FrameOrientation, FramePose, FramePosition, JointPosition, JointVelocity, Norm, ResidualCost,
    SensorReading, Subtree, Term,
};
use mujoco_safe::derivative::{
    CostSlopes, InverseForce, InverseJacobians, ModelParameter, ParameterOutputs, TransitionMethod, TransitionOptions,
};
use mujoco_safe::ik::{Avoidance, Ik, SearchOptions, Task};
use mujoco_safe::math::{Qp, QpProblem};
use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters, Rollout, RolloutBuffers, Workers};
use mujoco_safe::{
    Controller, Data, Differences, Lineariser, Lqr, LqrWeights, Matrix, Model, PdController, RandomController,
    StateSpace, ZeroController, sample,
};

use crate::allocations::{allocates_nothing, squatting};
use crate::allocator::allocations;
use crate::lock_process;

#[test]
fn linearising_into_outputs_does_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let mut system = StateSpace::zeros(data.model());
    allocates_nothing("transition_fd_into", || {
        data.transition_fd_into(1e-6, Differences::Central, &mut system).unwrap();
    });
    let last = data.model().nu() - 1;
    data.ctrl_mut()[last] = 5.0;
    allocates_nothing("transition_fd_into with a control beyond its range", || {
        data.transition_fd_into(1e-6, Differences::Forward, &mut system).unwrap();
    });
}

#[test]
fn linearising_in_a_workspace_does_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let mut system = StateSpace::zeros(data.model());
    for method in
        [TransitionMethod::Engine, TransitionMethod::Columns, TransitionMethod::Implicit, TransitionMethod::Analytic]
    {
        let options = TransitionOptions::default().with_method(method);
        let mut transition = Lineariser::new(data.model().clone(), options).unwrap();
        allocates_nothing(&format!("a workspace by {method:?}"), || {
            transition.linear_system_into(&mut data, &mut system).unwrap();
        });
        let states = Matrix::from_row_major(1, data.physics_state().len(), data.physics_state());
        let controls = Matrix::zeros(1, data.model().nu());
        let mut systems = transition.along(&data, &states, &controls).unwrap();
        allocates_nothing(&format!("along a trajectory by {method:?}"), || {
            transition.along_into(&data, &states, &controls, &mut systems).unwrap();
        });
    }
}

#[test]
fn derivatives_by_parameters_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    data.forward().unwrap();
    let model = data.model().clone();
    let (torso, knee) = (model.body("torso").unwrap().id(), model.joint("right_knee").unwrap().id());
    let parameters = [
        ModelParameter::Mass(torso),
        ModelParameter::LogCholesky(torso, 3),
        Parameter::JointDamping(knee).into(),
        Parameter::Gravity(2).into(),
        ModelParameter::field(&model, "geom_friction", 0, 0).unwrap(),
        ModelParameter::field(&model, "geom_solimp", 0, 1).unwrap(),
    ];
    let mut lineariser = Lineariser::new(model.clone(), TransitionOptions::default()).unwrap();
    let (mut jacobian, _) = lineariser.parameter_jacobian(&mut data, &parameters).unwrap();
    allocates_nothing("a derivative by parameters", || {
        let outputs = ParameterOutputs { state: Some(&mut jacobian.state), sensors: None };
        let report = lineariser.parameter_jacobian_into(&mut data, &parameters, outputs).unwrap();
        assert!(report.differenced.is_empty());
    });
    let force = InverseForce::Total;
    let (mut forces, _) = lineariser.inverse_parameter_jacobian(&mut data, &parameters, force).unwrap();
    allocates_nothing("a derivative of inverse dynamics by parameters", || {
        lineariser.inverse_parameter_jacobian_into(&mut data, &parameters, force, &mut forces).unwrap();
    });
    let controls = Matrix::zeros(5, model.nu());
    let speed = |_: usize, data: &Data, slopes: &mut CostSlopes<'_>| {
        slopes.state[model.nv()] = 1.0;
        data.qvel()[0]
    };
    let (mut gradient, _) = lineariser.cost_gradient(&mut data, &controls, &parameters, speed).unwrap();
    allocates_nothing("a gradient along a trajectory", || {
        lineariser.cost_gradient_into(&mut data, &controls, &parameters, speed, &mut gradient).unwrap();
    });
    let (mut of_body, mut of_joints) = (data.body_regressor(torso).unwrap(), data.joint_regressor().unwrap());
    allocates_nothing("regressors", || {
        data.body_regressor_into(torso, &mut of_body).unwrap();
        data.joint_regressor_into(&mut of_joints).unwrap();
    });
}

#[test]
fn derivatives_of_inverse_dynamics_by_a_lineariser_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let mut jacobians = InverseJacobians::zeros(data.model());
    for method in [TransitionMethod::Engine, TransitionMethod::Analytic] {
        let options = TransitionOptions::default().with_method(method);
        let mut lineariser = Lineariser::new(data.model().clone(), options).unwrap();
        for force in [InverseForce::Total, InverseForce::WithoutActuators] {
            allocates_nothing(&format!("derivatives of inverse dynamics by {method:?}, {force:?}"), || {
                lineariser.inverse_jacobians_into(&mut data, force, &mut jacobians).unwrap();
            });
        }
    }
}

#[test]
fn ticks_of_inverse_kinematics_do_not_allocate() {
    let _lock = lock_process();
    let model = std::sync::Arc::new(
        Model::from_xml_str(
            r#"<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/><body name="a"><joint name="a" type="ball" limited="true" range="0 1"/>
                 <geom name="a" type="capsule" size=".1" fromto="0 0 0 0 0 1"/><body name="b" pos="0 0 1"><joint name="b" limited="true" range="-1 1"/>
                 <geom name="b" type="box" size=".1 .1 .3"/><body pos="0 0 .5"><joint name="c"/><geom size=".1"/></body></body></body></worldbody>
               <equality><joint joint1="b" joint2="c"/></equality>
               <tendon><fixed limited="true" range="-.5 .5"><joint joint="b" coef="1"/></fixed></tendon></mujoco>"#,
        )
        .unwrap(),
    );
    let mut data = Data::new(&model).unwrap();
    let mut ik = Ik::new(&model);
    let body = |name: &str| Frame::body(&model, name).unwrap();
    let pose = ik.add_task(Task::new(FramePose::new(body("b")).relative_to(body("a"))));
    ik.add_task(Task::new(Subtree::com(&model, "a").unwrap()).with_priority(1));
    ik.add_task(Task::rate(Subtree::angular_momentum(&model, "a").unwrap()).with_priority(2).with_weight(0.1));
    ik.avoid("b", "floor", Avoidance { detection: 2.0, ..Avoidance::default() }).unwrap();
    ik.set_acceleration_limit("b", 1.0).unwrap();
    allocates_nothing("Ik::step", || {
        for step in 0..20 {
            ik.set_target(pose, &[0.1 * f64::from(step), 0.0, 1.0, 1.0, 0.0, 0.0, 0.0]).unwrap();
            ik.task_mut(pose).unwrap().weight = 1.0 + f64::from(step);
            ik.step(&mut data, 0.01).unwrap();
        }
    });
    allocates_nothing("Ik::search", || {
        ik.search(&mut data, &SearchOptions { starts: 3, ..SearchOptions::default() }).unwrap();
    });
    let (h, g) = (Matrix::identity(5), [-1.0; 5]);
    let (c, limits) = (Matrix::from_row_major(1, 5, vec![1.0; 5]), [2.0]);
    let mut solver = Qp::new(5, 1);
    allocates_nothing("Qp::solve", || {
        let problem = QpProblem::new(&h, &g).with_bounds(&[0.0; 5], &[0.5; 5]).with_constraints(&c, &limits, &limits);
        solver.solve(&mut [0.0; 5], &problem).unwrap();
    });
}

#[test]
fn controllers_do_not_allocate() {
    let _lock = lock_process();
    let mut data = Data::new(sample::cartpole()).unwrap();
    let weights = LqrWeights::new(Matrix::identity(4), Matrix::identity(1));
    let mut lqr = Lqr::at_present_state(&mut data, &weights).unwrap();
    let (mut pd, mut random) = (PdController::new(data.model(), 1.0, 0.1), RandomController::new(1));
    let gains = vec![Matrix::zeros(1, 4); 3];
    let mut table = TimeVaryingLqr::with_gains(&data, Matrix::zeros(4, 4), Matrix::zeros(3, 1), gains).unwrap();
    allocates_nothing("the controllers", || {
        lqr.control(&mut data).unwrap();
        table.control(&mut data).unwrap();
        data.step().unwrap();
        pd.control(&mut data).unwrap();
        random.control(&mut data).unwrap();
        ZeroController.control(&mut data).unwrap();
    });
}

#[test]
fn costs_of_residuals_do_not_allocate() {
    let _lock = lock_process();
    let data = squatting();
    let model = data.model();
    let cost = ResidualCost::new(
        model,
        [
            Term::new("posture", JointPosition::all(model)),
            Term::new("rest", JointVelocity::all(model)).with_norm(Norm::Huber { width: 1.0 }),
            Term::new("hand", FramePosition::body(model, "hand_left").unwrap())
                .with_norm(Norm::SmoothAbs { width: 0.1 }),
            Term::new("upright", FrameOrientation::body(model, "torso").unwrap()),
            Term::new("com", Subtree::com(model, "torso").unwrap()),
            Term::new("velocity", Subtree::velocity(model, "torso").unwrap()),
            Term::new("momentum", Subtree::angular_momentum(model, "torso").unwrap()),
            Term::new("gyro", SensorReading::new(model, "torso_gyro").unwrap()),
            Term::new("effort", Controls::new(model)),
        ],
    )
    .unwrap();
    let (state, controls) = (data.physics_state(), data.ctrl().to_vec());
    let mut expansion = CostExpansion::zeros(model);
    allocates_nothing("value", || assert!(cost.value(3, &state, Some(&controls)).unwrap() > 0.0));
    allocates_nothing("expand", || cost.expand(3, &state, Some(&controls), &mut expansion).unwrap());
    allocates_nothing("begin", || cost.begin(&data).unwrap());
}

/// Returns a quadratic cost with mixed terms, of a model with a quaternion.
fn quadratic(data: &Data) -> QuadraticCost {
    let (nx, nu) = (2 * data.model().nv(), data.model().nu());
    let mut weights = LqrWeights::diagonal(&vec![1.0; nx], &vec![0.1; nu]);
    weights.s = Some(Matrix::from_row_major(nx, nu, vec![1e-4; nx * nu]));
    QuadraticCost::new(data.model(), &data.physics_state(), weights, Matrix::identity(nx)).unwrap()
}

#[test]
fn a_quadratic_cost_does_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let cost = quadratic(&data);
    data.step().unwrap();
    let (state, controls) = (data.physics_state(), vec![0.1; data.model().nu()]);
    let mut expansion = CostExpansion::zeros(data.model());
    for controls in [Some(&controls[..]), None] {
        allocates_nothing("value", || assert!(cost.value(3, &state, controls).unwrap() > 0.0));
        allocates_nothing("expand", || cost.expand(3, &state, controls, &mut expansion).unwrap());
    }
}

#[test]
fn plans_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let cost = quadratic(&data);
    let mut planner = IlqrPlanner::new(data.model(), 3, IlqrOptions::default().with_iterations(2)).unwrap();
    let mut policy = TimeVaryingLqr::hold_controls(&data, 3).unwrap();
    allocates_nothing("IlqrPlanner::plan", || {
        data.qvel_mut()[0] += 0.1;
        let report = planner.plan(&data, &cost, &mut policy).unwrap();
        assert!(report.cost < report.initial_cost);
        data.step().unwrap();
    });
    let mut controller = ThreadedPredictiveController::new(&data, planner, cost).unwrap();
    allocates_nothing("ThreadedPredictiveController::control", || {
        controller.control(&mut data).unwrap();
        data.step().unwrap();
        controller.wait().unwrap();
    });
}

#[test]
fn plans_by_sampling_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let cost = quadratic(&data);
    let mut policy = TimeVaryingLqr::hold_controls(&data, 3).unwrap();
    for temperature in [0.0, 1.0] {
        let options = SamplingOptions::default().with_samples(5).with_iterations(2).with_temperature(temperature);
        let mut planner = SamplingPlanner::new(data.model(), 3, options).unwrap();
        allocates_nothing("SamplingPlanner::plan", || {
            planner.plan(&data, &cost, &mut policy).unwrap();
            data.step().unwrap();
        });
    }
}

#[test]
fn derivatives_of_inverse_dynamics_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let mut jacobians = InverseJacobians::zeros(data.model());
    allocates_nothing("inverse_fd_into", || {
        data.inverse_fd_into(1e-6, InverseForce::WithoutActuators, &mut jacobians).unwrap();
    });
}

/// Returns the number of allocations of this thread in ten rollouts, with an existing simulation.
fn allocations_of_rollouts(workers: &Workers, steps: usize) -> usize {
    let controls = vec![0.1; steps * workers.model().nu()];
    let (mut states, mut outputs) = (vec![0.0; 10 * (steps + 1) * 55], vec![0.0; 10 * steps]);
    let rollouts = [
        Rollout::on(workers, 10, steps).with_shared_controls(&controls),
        Rollout::on(workers, 10, steps).with_controllers(|index| RandomController::new(index as u64)),
        Rollout::on(workers, 10, steps).with_model_edits(|_, model| model.set_total_mass(50.0)),
        Rollout::on(workers, 10, steps).with_forward_after_step(),
    ];
    rollouts
        .into_iter()
        .map(|rollout| {
            let rollout = rollout.with_chunk(10).with_outputs(1, |data, row| row[0] = data.time());
            let buffers = RolloutBuffers { states: Some(&mut states), sensordata: None, outputs: Some(&mut outputs) };
            let (number, outcomes) = allocations(|| rollout.run_into(buffers));
            assert!(outcomes.unwrap().iter().all(Result::is_ok));
            number
        })
        .sum()
}

#[test]
fn steps_of_rollouts_do_not_allocate() {
    let _lock = lock_process();
    let workers = Workers::new(sample::humanoid());
    allocations_of_rollouts(&workers, 1);
    let (few, many) = (allocations_of_rollouts(&workers, 1), allocations_of_rollouts(&workers, 100));
    assert_eq!(few, many, "allocations depend on the number of steps");
}

#[test]
fn steps_of_a_batch_do_not_allocate() {
    let _lock = lock_process();
    let batch = || Batch::new(sample::humanoid(), 3).unwrap().with_chunk(3);
    let edited = || {
        let mut batch = batch();
        let edit = |data: &mut Data| data.edit_model(|model| model.set_total_mass(50.0));
        batch.reset_where(|index| index > 0, |_, _, data| edit(data)).unwrap();
        batch
    };
    let varied = || {
        let batch = batch();
        let torso = Parameter::MassFactor(batch.model().body("torso").unwrap().id());
        let factors = Distribution::Uniform { low: 0.5, high: 2.0 };
        let parameters = Parameters::new().with(batch.model(), torso, factors).unwrap();
        let mut batch = batch.with_parameters(parameters).unwrap();
        batch.sample_parameters(|_| true, 1).unwrap();
        batch
    };
    for mut batch in [batch(), batch().with_forward_after_step(), edited(), varied()] {
        allocates_nothing("Batch::step", || {
            batch.step(|observations, controls| controls.as_mut_slice().fill(0.1 * observations[(0, 2)])).unwrap();
        });
        allocates_nothing("Batch::reset_where", || batch.reset_where(|index| index > 0, |_, _, _| ()).unwrap());
        allocates_nothing("Batch::edit_where", || {
            batch.edit_where(|index| index > 0, |_, data| data.set_time(1.0)).unwrap();
        });
        let mut data = Data::new(batch.model()).unwrap();
        allocates_nothing("Batch::load", || batch.load(1, &mut data).unwrap());
    }
}
