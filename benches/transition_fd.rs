//! Linearisation of the humanoid on its left leg, also with elliptic cones and equality
//! constraints, and of the cart-pole, against `mjd_transitionFD`: central differences with
//! [`Data::transition_fd_into`]; [`Data::transition_fd`], which allocates its result and includes
//! the sensors; the same differences in two threads; the method through inverse dynamics, in one
//! thread and in two; and the analytic method. Then the steps of a trajectory of the humanoid by
//! the analytic method, in two threads and in one, and the speedup that this machine allows at that
//! time, measured by two independent threads. First prints the accuracy of each method: the largest
//! error of A and of B, relative to their largest numbers, against extrapolated differences of
//! steps whose solver has converged. Last the derivatives of inverse dynamics, without those of
//! sensors, in closed form, and their errors against extrapolated differences: against
//! `mjd_inverseFD`, or with engines before 2.3.7 that lack it against [`Data::inverse_fd_into`].
//!
//! ```text
//! cargo bench --bench transition_fd
//! ```

mod common;
#[path = "../tests/linearisation/inverse_fd/oracle.rs"]
mod inverse_oracle;
#[path = "../tests/linearisation/transition/oracle.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod oracle;

use std::hint::black_box;
use std::ptr::null_mut;
use std::sync::Barrier;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use common::models::Balance;
use mujoco_safe::derivative::{
    InverseForce, InverseJacobians, InverseOutputs, LinearisationReport, TransitionMethod, TransitionOptions,
    TransitionOutputs,
};
use mujoco_safe::enums::Cone;
use mujoco_safe::{Data, Differences, Lineariser, Lqr, Matrix, Model, Result, StateSpace, sys};

struct Linearisation {
    data: Data,
    a: Matrix,
    b: Matrix,
    analytic: Lineariser,
    inverse: Lineariser,
    inverse_in_two: Lineariser,
    columns_in_two: Lineariser,
}

/// Returns a variant that linearises with one of the workspaces.
fn through(
    calls: u32,
    choose: fn(&mut Linearisation) -> (&mut Lineariser, &mut Data, TransitionOutputs<'_>),
) -> impl Fn(&mut Linearisation) {
    move |state| {
        for _ in 0..calls {
            let (transition, data, outputs) = choose(state);
            let used = transition.linear_system_into(data, outputs).expect("the state is stable");
            assert_eq!(used.fallback, None);
        }
    }
}

/// Returns the largest error of a matrix, relative to its largest number, or absolute for a matrix
/// of zeros.
fn error(ours: &Matrix, theirs: &Matrix) -> f64 {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a: f64, b| a.max(b.abs()));
    let differences = ours.as_slice().iter().zip(theirs.as_slice()).map(|(a, b)| a - b);
    let scale = largest(&mut theirs.as_slice().iter().copied());
    largest(&mut { differences }) / if scale > 0.0 { scale } else { 1.0 }
}

/// Prints the errors of A and B by each method.
fn print_accuracy(name: &str, data: &mut Data) {
    let truth = oracle::linear_system(data);
    for method in
        [TransitionMethod::Engine, TransitionMethod::Columns, TransitionMethod::Implicit, TransitionMethod::Analytic]
    {
        let options = TransitionOptions::default().with_method(method);
        let mut lineariser = Lineariser::new(data.model().clone(), options).expect("there is memory");
        let (system, used) = lineariser.linear_system(data).expect("the state is stable");
        assert_eq!(used.fallback, None);
        println!(
            "{name}: {method:?} errs by {:.1e} in A, {:.1e} in B",
            error(&system.a, &truth.a),
            error(&system.b, &truth.b)
        );
    }
}

fn compare(name: &str, mut data: Data, calls: u32) {
    print_accuracy(name, &mut data);
    let (nx, nu) = (2 * data.model().nv() + data.model().na(), data.model().nu());
    let transition = |method, threads| {
        let options = TransitionOptions::default().with_method(method).with_threads(threads);
        Lineariser::new(data.model().clone(), options).expect("there is memory")
    };
    let mut state = Linearisation {
        a: Matrix::zeros(nx, nx),
        b: Matrix::zeros(nx, nu),
        analytic: transition(TransitionMethod::Analytic, 1),
        inverse: transition(TransitionMethod::Implicit, 1),
        inverse_in_two: transition(TransitionMethod::Implicit, 2),
        columns_in_two: transition(TransitionMethod::Columns, 2),
        data,
    };

    let analytic = through(calls, |state| {
        let outputs = TransitionOutputs { a: Some(&mut state.a), b: Some(&mut state.b), ..Default::default() };
        (&mut state.analytic, &mut state.data, outputs)
    });
    let inverse = through(calls, |state| {
        let outputs = TransitionOutputs { a: Some(&mut state.a), b: Some(&mut state.b), ..Default::default() };
        (&mut state.inverse, &mut state.data, outputs)
    });
    let inverse_in_two = through(calls, |state| {
        let outputs = TransitionOutputs { a: Some(&mut state.a), b: Some(&mut state.b), ..Default::default() };
        (&mut state.inverse_in_two, &mut state.data, outputs)
    });
    let columns_in_two = through(calls, |state| {
        let outputs = TransitionOutputs { a: Some(&mut state.a), b: Some(&mut state.b), ..Default::default() };
        (&mut state.columns_in_two, &mut state.data, outputs)
    });
    let into = |state: &mut Linearisation| {
        for _ in 0..calls {
            let outputs = TransitionOutputs { a: Some(&mut state.a), b: Some(&mut state.b), ..Default::default() };
            state.data.transition_fd_into(Lqr::EPS, Differences::Central, outputs).expect("the state is stable");
        }
    };
    let allocating = |state: &mut Linearisation| {
        for _ in 0..calls {
            black_box(state.data.transition_fd(Lqr::EPS, Differences::Central).expect("the state is stable"));
        }
    };
    let raw = |state: &mut Linearisation| {
        let (a, b) = (state.a.as_mut_slice().as_mut_ptr(), state.b.as_mut_slice().as_mut_ptr());
        let (model, data) = (state.data.model().as_ptr(), state.data.as_mut_ptr());
        for _ in 0..calls {
            // SAFETY: the data and its own model, A and B of the shapes that the engine writes, and
            // NULL for C and D.
            unsafe { sys::mjd_transitionFD(model, data, Lqr::EPS, 1, a, b, null_mut(), null_mut()) }
        }
    };
    common::compare(
        name,
        &mut state,
        calls,
        &[
            ("analytic", &analytic),
            ("inverse", &inverse),
            ("inverse in two threads", &inverse_in_two),
            ("columns in two threads", &columns_in_two),
            ("transition_fd_into", &into),
            ("transition_fd", &allocating),
            ("mjd_transitionFD", &raw),
        ],
    );
}

/// Number of steps of the trajectory.
const KNOTS: u32 = 50;

/// Linearisers of a trajectory, with its states and controls.
struct Trajectory {
    data: Data,
    states: Matrix,
    controls: Matrix,
    systems: Vec<(StateSpace, LinearisationReport)>,
    in_two: Lineariser,
    in_one: Lineariser,
}

/// Times the linear systems along a trajectory that starts at the present state.
fn compare_along(name: &str, mut data: Data) -> Result<()> {
    let model = data.model().clone();
    let lineariser = |threads| Lineariser::new(model.clone(), TransitionOptions::default().with_threads(threads));
    let mut states = Matrix::zeros(KNOTS as usize, data.physics_state().len());
    let mut controls = Matrix::zeros(KNOTS as usize, model.nu());
    for knot in 0..KNOTS as usize {
        states.row_mut(knot).copy_from_slice(&data.physics_state());
        controls.row_mut(knot).copy_from_slice(data.ctrl());
        data.step()?;
    }
    let (in_two, mut in_one) = (lineariser(2)?, lineariser(1)?);
    let systems = in_one.along(&data, &states, &controls)?;
    let mut trajectory = Trajectory { data, states, controls, systems, in_two, in_one };
    let along = |state: &mut Trajectory, in_two: bool| {
        let Trajectory { data, states, controls, systems, .. } = state;
        let lineariser = if in_two { &mut state.in_two } else { &mut state.in_one };
        lineariser.along_into(data, states, controls, systems).expect("the states are stable");
        assert!(systems.iter().all(|(_, report)| report.fallback.is_none()));
    };
    common::compare(
        name,
        &mut trajectory,
        KNOTS,
        &[
            ("analytic in two threads", &|state| along(state, true)),
            ("analytic in one thread", &|state| along(state, false)),
        ],
    );
    print_speedup(name, &mut trajectory)
}

/// Number of measurements of a speedup. Their median is printed.
const SPEEDUP_RUNS: usize = 60;

/// Prints the speedup by the second thread. Also prints the speedup of two independent threads,
/// each of which linearises the complete trajectory without sharing anything with the other: the
/// most that this machine, with its other load, allows.
fn print_speedup(name: &str, trajectory: &mut Trajectory) -> Result<()> {
    let Trajectory { data, states, controls, systems, in_two, in_one } = trajectory;
    let (data, states, controls) = (&*data, &*states, &*controls);
    let along = |lineariser: &mut Lineariser, systems: &mut Vec<(StateSpace, LinearisationReport)>| {
        lineariser.along_into(data, states, controls, systems).expect("the states are stable");
    };
    let mut second = (Lineariser::new(data.model().clone(), TransitionOptions::default())?, systems.clone());
    let (barrier, is_timed) = (Barrier::new(2), AtomicBool::new(false));
    let (mut shared, mut independent) = (Vec::new(), Vec::new());
    thread::scope(|scope| {
        let handle = scope.spawn(|| {
            for _ in 0..SPEEDUP_RUNS {
                barrier.wait();
                while !is_timed.swap(false, Ordering::Relaxed) {
                    along(&mut second.0, &mut second.1);
                }
            }
        });
        for _ in 0..SPEEDUP_RUNS {
            let one = common::time(&mut || along(in_one, systems)).as_secs_f64();
            shared.push(one / common::time(&mut || along(in_two, systems)).as_secs_f64());
            barrier.wait();
            // The second thread wakes up during the first of these runs.
            along(in_one, systems);
            let beside_another = common::time(&mut || along(in_one, systems)).as_secs_f64();
            is_timed.store(true, Ordering::Relaxed);
            independent.push(2.0 * one / beside_another);
        }
        handle.join().expect("the states are stable");
    });
    println!(
        "{name}: two threads are {:.2} times as fast as one; two independent threads, {:.2} times",
        common::median(shared),
        common::median(independent)
    );
    Ok(())
}

/// Derivatives of inverse dynamics of one simulation.
struct Inverse {
    data: Data,
    jacobians: InverseJacobians,
    lineariser: Lineariser,
}

/// Returns the outputs except for those of sensors.
fn without_sensors(jacobians: &mut InverseJacobians) -> InverseOutputs<'_> {
    let InverseJacobians { df_dq, df_dv, df_da, dm_dq, .. } = jacobians;
    InverseOutputs {
        df_dq: Some(df_dq),
        df_dv: Some(df_dv),
        df_da: Some(df_da),
        dm_dq: Some(dm_dq),
        ..Default::default()
    }
}

/// Calls `mjd_inverseFD` without the outputs of sensors.
#[cfg(engine_since = "2.3.7")]
fn difference_inverse(state: &mut Inverse) {
    let InverseJacobians { df_dq, df_dv, df_da, dm_dq, .. } = &mut state.jacobians;
    let [df_dq, df_dv, df_da, dm_dq] = [df_dq, df_dv, df_da, dm_dq].map(|matrix| matrix.as_mut_slice().as_mut_ptr());
    let (model, data) = (state.data.model().as_ptr(), state.data.as_mut_ptr());
    // SAFETY: the data and its own model, matrices of the shapes that the engine writes, and NULL
    // for those of the sensors.
    unsafe {
        sys::mjd_inverseFD(model, data, INVERSE_EPS, 0, df_dq, df_dv, df_da, null_mut(), null_mut(), null_mut(), dm_dq)
    }
}

#[cfg(not(engine_since = "2.3.7"))]
fn difference_inverse(state: &mut Inverse) {
    let outputs = without_sensors(&mut state.jacobians);
    state.data.inverse_fd_into(INVERSE_EPS, InverseForce::Total, outputs).expect("the state is stable");
}

/// Step of the differences of inverse dynamics.
const INVERSE_EPS: f64 = 1e-6;

/// Times the derivatives of inverse dynamics at the accelerations of the present state.
fn compare_inverse(name: &str, data: Data, calls: u32) -> Result<()> {
    let lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default())?;
    let mut state = Inverse { jacobians: InverseJacobians::zeros(data.model()), data, lineariser };
    state.data.forward()?;
    let truth = inverse_oracle::Oracle::new(&state.data, InverseForce::Total).jacobians(2e-5, 2e-3);
    for method in [TransitionMethod::Engine, TransitionMethod::Analytic] {
        let options = TransitionOptions::default().with_method(method);
        let mut lineariser = Lineariser::new(state.data.model().clone(), options)?;
        let (found, report) = lineariser.inverse_jacobians(&mut state.data, InverseForce::Total)?;
        assert_eq!(report.fallback, None);
        println!(
            "{name}: {method:?} errs by {:.1e} in DfDq, {:.1e} in DfDv, {:.1e} in DfDa, {:.1e} in DmDq",
            error(&found.df_dq, &truth.df_dq),
            error(&found.df_dv, &truth.df_dv),
            error(&found.df_da, &truth.df_da),
            error(&found.dm_dq, &truth.dm_dq)
        );
    }
    let analytic = |state: &mut Inverse| {
        for _ in 0..calls {
            let Inverse { data, jacobians, lineariser } = state;
            let outputs = without_sensors(jacobians);
            let report = lineariser.inverse_jacobians_into(data, InverseForce::Total, outputs);
            assert_eq!(report.expect("the state is stable").fallback, None);
        }
    };
    let reference = |state: &mut Inverse| (0..calls).for_each(|_| difference_inverse(state));
    let reference_name = if cfg!(engine_since = "2.3.7") { "mjd_inverseFD" } else { "inverse_fd_into" };
    common::compare(name, &mut state, calls, &[("analytic", &analytic), (reference_name, &reference)]);
    Ok(())
}

/// Creates a humanoid on its left leg with elliptic cones, a hand welded to its torso, and two
/// joints that are coupled.
fn constrained_humanoid() -> Result<Data> {
    let equality = r#"<equality>
        <weld body1="hand_left" body2="torso"/><joint joint1="right_knee" joint2="right_hip_y"/>
    </equality><actuator>"#;
    let xml = include_str!("../models/humanoid.xml").replace("<actuator>", equality);
    let mut data = Data::new(Model::from_xml_str(&xml)?)?;
    data.edit_model(|model| model.edit_options(|options| options.cone = Cone::Elliptic))?;
    data.reset_to_key("stand_on_left_leg")?;
    data.step_n(5)?;
    Ok(data)
}

fn main() -> Result<()> {
    compare("transition_fd/humanoid", Balance::humanoid()?.data, 1);
    compare("transition_fd/humanoid with equalities, elliptic", constrained_humanoid()?, 1);
    compare_along("transition_fd/humanoid along a trajectory", Balance::humanoid()?.data)?;
    compare("transition_fd/cartpole", Balance::cartpole()?.data, 100);
    compare_inverse("inverse_jacobians/humanoid", Balance::humanoid()?.data, 1)?;
    compare_inverse("inverse_jacobians/cartpole", Balance::cartpole()?.data, 100)?;
    Ok(())
}
