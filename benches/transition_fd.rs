//! Linearisation: by central differences with [`Data::transition_fd_into`], and [`Data::transition_fd`], which allocates its
//! result and computes the sensors' part too; by the same differences in two threads; and through inverse dynamics in one thread
//! and in two. All against `mjd_transitionFD`. The humanoid on its left leg, and the cart-pole.
//!
//! ```text
//! cargo bench --bench transition_fd
//! ```

mod common;

use std::hint::black_box;
use std::ptr::null_mut;

use common::balance::Balance;
use criterion::Criterion;
use mujoco_safe::{
    Data, Differences, Lineariser, Lqr, Matrix, Result, TransitionMethod, TransitionOptions, TransitionOutputs, sys,
};

struct Linearisation {
    data: Data,
    a: Matrix,
    b: Matrix,
    inverse: Lineariser,
    inverse_in_two: Lineariser,
    columns_in_two: Lineariser,
}

/// A way through a workspace.
fn through(
    calls: u32,
    choose: fn(&mut Linearisation) -> (&mut Lineariser, &mut Data, TransitionOutputs<'_>),
) -> impl Fn(&mut Linearisation) {
    move |state| {
        for _ in 0..calls {
            let (transition, data, outputs) = choose(state);
            let used = transition.linear_system_into(data, outputs).expect("a stable state");
            assert_eq!(used.fallback, None);
        }
    }
}

fn compare(criterion: &mut Criterion, name: &str, data: Data, calls: u32) {
    let (nx, nu) = (2 * data.model().nv() + data.model().na(), data.model().nu());
    let transition = |method, threads| {
        let options = TransitionOptions { method, threads, ..Default::default() };
        Lineariser::new(data.model().clone(), options).expect("there is memory")
    };
    let mut state = Linearisation {
        a: Matrix::zeros(nx, nx),
        b: Matrix::zeros(nx, nu),
        inverse: transition(TransitionMethod::Inverse, 1),
        inverse_in_two: transition(TransitionMethod::Inverse, 2),
        columns_in_two: transition(TransitionMethod::Columns, 2),
        data,
    };

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
            state.data.transition_fd_into(Lqr::EPS, Differences::Central, outputs).expect("a stable state");
        }
    };
    let allocating = |state: &mut Linearisation| {
        for _ in 0..calls {
            black_box(state.data.transition_fd(Lqr::EPS, Differences::Central).expect("a stable state"));
        }
    };
    let raw = |state: &mut Linearisation| {
        let (a, b) = (state.a.as_mut_slice().as_mut_ptr(), state.b.as_mut_slice().as_mut_ptr());
        let (model, data) = (state.data.model().as_ptr(), state.data.as_mut_ptr());
        for _ in 0..calls {
            // SAFETY: a data and its own model, A and B of the shapes that the engine writes, and neither C nor D.
            unsafe { sys::mjd_transitionFD(model, data, Lqr::EPS, 1, a, b, null_mut(), null_mut()) }
        }
    };
    common::compare(
        criterion,
        name,
        &mut state,
        calls,
        &[
            ("inverse", &inverse),
            ("inverse in two threads", &inverse_in_two),
            ("columns in two threads", &columns_in_two),
            ("transition_fd_into", &into),
            ("transition_fd", &allocating),
            ("mjd_transitionFD", &raw),
        ],
    );
}

fn main() -> Result<()> {
    let mut criterion = common::criterion();
    compare(&mut criterion, "transition_fd/humanoid", Balance::humanoid()?.data, 1);
    compare(&mut criterion, "transition_fd/cartpole", Balance::cartpole()?.data, 100);
    criterion.final_summary();
    Ok(())
}
