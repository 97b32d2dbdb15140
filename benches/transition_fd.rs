//! Linearisation of the humanoid on its left leg, also with elliptic cones and equality constraints, and of the cart-pole, against `mjd_transitionFD`: central differences with
//! [`Data::transition_fd_into`]; [`Data::transition_fd`], which allocates its result and includes the sensors; the same
//! differences in two threads; the method through inverse dynamics, in one thread and in two; and the analytic method. First prints
//! the accuracy of each method: the largest error of A and of B, relative to their largest numbers, against extrapolated differences
//! of steps whose solver has converged.
//!
//! ```text
//! cargo bench --bench transition_fd
//! ```

mod common;
#[path = "../tests/linearisation/transition/oracle.rs"]
mod oracle;

use std::hint::black_box;
use std::ptr::null_mut;

use common::models::Balance;
use criterion::Criterion;
use mujoco_safe::derivative::{TransitionMethod, TransitionOptions, TransitionOutputs};
use mujoco_safe::enums::Cone;
use mujoco_safe::{Data, Differences, Lineariser, Lqr, Matrix, Model, Result, sys};

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
        let error = |ours: &Matrix, theirs: &Matrix| {
            let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a: f64, b| a.max(b.abs()));
            let differences = ours.as_slice().iter().zip(theirs.as_slice()).map(|(a, b)| a - b);
            largest(&mut { differences }) / largest(&mut theirs.as_slice().iter().copied())
        };
        println!(
            "{name}: {method:?} errs by {:.1e} in A, {:.1e} in B",
            error(&system.a, &truth.a),
            error(&system.b, &truth.b)
        );
    }
}

fn compare(criterion: &mut Criterion, name: &str, mut data: Data, calls: u32) {
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
            // SAFETY: the data and its own model, A and B of the shapes that the engine writes, and NULL for C and D.
            unsafe { sys::mjd_transitionFD(model, data, Lqr::EPS, 1, a, b, null_mut(), null_mut()) }
        }
    };
    common::compare(
        criterion,
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

/// Creates a humanoid on its left leg with elliptic cones, a hand welded to its torso, and two joints that are coupled.
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
    let mut criterion = common::criterion();
    compare(&mut criterion, "transition_fd/humanoid", Balance::humanoid()?.data, 1);
    compare(&mut criterion, "transition_fd/humanoid with equalities, elliptic", constrained_humanoid()?, 1);
    compare(&mut criterion, "transition_fd/cartpole", Balance::cartpole()?.data, 100);
    criterion.final_summary();
    Ok(())
}
