//! Callbacks that a simulation owns: how long they stay, and which calls run them.

#![forbid(unsafe_code)]

use std::panic::{AssertUnwindSafe, RefUnwindSafe, UnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use mujoco_safe::callback::Callbacks;
use mujoco_safe::derivative::{Fallback, TransitionMethod, TransitionOptions};
use mujoco_safe::rollout::{Rollout, Workers};
use mujoco_safe::{Batch, Data, Differences, Error, Lineariser, Matrix, sample};

use crate::callbacks::assert_equals_controller;

/// Counter that closures share with a test.
#[derive(Clone, Default)]
struct Calls(Arc<AtomicUsize>);

impl Calls {
    /// Returns a control callback that counts its calls.
    fn count(&self) -> Callbacks<'static> {
        let calls = self.clone();
        Callbacks::new().with_control(move |_| _ = calls.0.fetch_add(1, Ordering::Relaxed))
    }

    /// Returns the number of calls since the last call of this method.
    fn take(&self) -> usize {
        self.0.swap(0, Ordering::Relaxed)
    }

    /// Returns `true` if a closure that counts exists.
    fn has_closures(&self) -> bool {
        Arc::strong_count(&self.0) > 1
    }
}

fn cartpole() -> Data {
    Data::new(sample::cartpole()).unwrap()
}

/// Returns a simulation that counts its steps.
fn counting() -> (Data, Calls) {
    let (mut data, calls) = (cartpole(), Calls::default());
    data.set_callbacks(calls.count());
    (data, calls)
}

#[test]
fn a_control_callback_equals_a_controller_bit_for_bit() {
    assert_equals_controller(|data, callbacks, steps| {
        data.set_callbacks(callbacks);
        data.step_n(steps).unwrap();
    });
}

#[test]
fn callbacks_stay_through_resets_edits_moves_and_other_threads() {
    let (mut data, calls) = counting();
    data.reset().unwrap();
    data.edit_model(|model| model.set_timestep(0.001)).unwrap();
    data.copy_from(&data.clone()).unwrap();
    let mut stored = Box::new(data);
    std::thread::scope(|scope| scope.spawn(|| stored.step()).join().unwrap()).unwrap();
    stored.step().unwrap();
    assert_eq!(calls.take(), 2);
}

#[test]
fn new_callbacks_replace_the_previous_ones_and_an_empty_set_removes_them() {
    let (mut data, first) = counting();
    let second = Calls::default();
    data.set_callbacks(second.count());
    assert!(!first.has_closures());
    data.step().unwrap();
    assert_eq!(second.take(), 1);
    data.set_callbacks(Callbacks::new());
    assert!(!second.has_closures());
    data.step().unwrap();
    assert_eq!((first.take(), second.take()), (0, 0));
}

#[test]
fn callbacks_are_dropped_with_their_simulation() {
    let (data, calls) = counting();
    assert!(calls.has_closures());
    std::thread::spawn(move || drop(data)).join().unwrap();
    assert!(!calls.has_closures());
}

#[test]
fn copies_have_no_callbacks() {
    let (data, calls) = counting();
    data.clone().step().unwrap();
    let (mut target, of_target) = counting();
    target.copy_from(&data).unwrap_err(); // separately loaded models
    target.clone_from(&data); // allocates
    assert!(!of_target.has_closures());
    target.set_callbacks(of_target.count());
    target.clone_from(&data); // reuses the memory
    target.step().unwrap();
    assert_eq!((calls.take(), of_target.take()), (0, 0));
}

#[test]
fn a_scope_suspends_the_callbacks_of_its_simulation() {
    let (mut data, calls) = counting();
    let scoped = Calls::default();
    data.with_callbacks(scoped.count(), |data| data.step()).unwrap();
    assert_eq!((calls.take(), scoped.take()), (0, 1));
    data.with_callbacks(Callbacks::new(), |data| data.step()).unwrap();
    assert_eq!(calls.take(), 0);
    let panicked = catch_unwind(AssertUnwindSafe(|| {
        data.with_callbacks(scoped.count(), |_| resume_unwind(Box::new("out of the scope")));
    }));
    assert!(panicked.is_err());
    data.step().unwrap();
    assert_eq!((calls.take(), scoped.take()), (1, 0));
}

#[test]
fn callbacks_that_are_set_in_a_scope_take_effect_after_it() {
    let (mut data, calls) = (cartpole(), Calls::default());
    let scoped = Calls::default();
    data.with_callbacks(scoped.count(), |data| {
        data.set_callbacks(calls.count());
        data.step().unwrap();
    });
    assert_eq!((calls.take(), scoped.take()), (0, 1));
    data.step().unwrap();
    assert_eq!((calls.take(), scoped.take()), (1, 0));
}

#[test]
fn callbacks_move_with_a_simulation_that_is_swapped_in_a_scope() {
    let ((mut one, of_one), (mut other, of_other)) = (counting(), counting());
    let scoped = Calls::default();
    one.with_callbacks(scoped.count(), |one| {
        std::mem::swap(one, &mut other);
        // `one` now holds the other simulation, which is in no scope.
        one.step().unwrap();
        assert_eq!((of_one.take(), of_other.take(), scoped.take()), (0, 1, 0));
        other.step().unwrap();
        assert_eq!((of_one.take(), of_other.take(), scoped.take()), (0, 0, 1));
    });
    one.step().unwrap();
    assert_eq!((of_one.take(), of_other.take()), (0, 1));
    other.step().unwrap();
    assert_eq!((of_one.take(), of_other.take()), (1, 0));
    assert_eq!(scoped.take(), 0);
}

#[test]
fn callbacks_stay_after_a_panic_in_one_of_them() {
    let mut data = cartpole();
    let mut calls = 0;
    data.set_callbacks(Callbacks::new().with_control(move |context| {
        calls += 1;
        context.ctrl_mut()[0] = f64::from(calls);
        if calls == 1 {
            resume_unwind(Box::new("first call"));
        }
    }));
    assert!(matches!(data.step(), Err(Error::Callback { callback: "control", .. })));
    assert!(matches!(data.step(), Err(Error::Poisoned { .. })));
    data.reset().unwrap();
    data.step().unwrap();
    assert_eq!(data.ctrl(), [2.0]);
}

#[test]
fn a_callback_can_step_another_simulation_with_callbacks() {
    let (mut inner, of_inner) = counting();
    let of_outer = Calls::default();
    let counter = of_outer.clone();
    let mut outer = cartpole();
    outer.set_callbacks(Callbacks::new().with_passive(move |_| inner.step().unwrap()).with_control(move |_| {
        counter.0.fetch_add(1, Ordering::Relaxed);
    }));
    outer.step().unwrap();
    assert_eq!((of_inner.take(), of_outer.take()), (1, 1));
}

#[test]
fn a_lineariser_uses_the_callbacks_of_the_simulation_or_rejects_them() {
    let mut data = cartpole();
    let push = |data: &Data| 30.0 * data.qpos()[1];
    let mut in_scope = data.clone();
    let feedback = Callbacks::new().with_control(move |context| context.ctrl_mut()[0] = push(context));
    let expected = in_scope.with_callbacks(feedback, |data| data.transition_fd(1e-6, Differences::Central)).unwrap();
    data.set_callbacks(Callbacks::new().with_control(move |context| context.ctrl_mut()[0] = push(context)));
    let options = TransitionOptions::default().with_eps(1e-6);
    let mut lineariser = Lineariser::new(data.model(), options).unwrap();
    let (system, report) = lineariser.linear_system(&mut data).unwrap();
    assert_eq!((report.method, report.fallback), (TransitionMethod::Engine, Some(Fallback::Callbacks)));
    assert_eq!(system.a, expected.a);
    assert_eq!(data.ctrl(), [0.0], "the controls are restored");
    let error = lineariser.along(&data, &Matrix::zeros(1, 4), &Matrix::zeros(1, 1)).unwrap_err();
    assert!(matches!(error, Error::Unsupported(_)), "{error}");
}

#[test]
fn callbacks_that_a_controller_sets_end_with_its_rollout() {
    let workers = Workers::new(sample::cartpole());
    let calls = Calls::default();
    let set = calls.clone();
    let run = |sets: bool| {
        let set = set.clone();
        let controllers = move |_| {
            let set = set.clone();
            move |data: &mut Data| {
                if sets {
                    data.set_callbacks(set.count());
                }
                Ok(())
            }
        };
        Rollout::on(&workers, 8, 3).with_controllers(controllers).run().unwrap();
    };
    run(true);
    assert_eq!(calls.take(), 8 * 3);
    run(false);
    assert_eq!(calls.take(), 0);
}

#[test]
fn a_batch_keeps_the_callbacks_of_each_simulation() {
    let calls = Calls::default();
    let mut batch = Batch::new(sample::cartpole(), 3).unwrap();
    batch.reset_where(|index| index != 1, |_, _, data| data.set_callbacks(calls.count())).unwrap();
    batch.step(|_, _| ()).unwrap();
    batch.reset(0).unwrap();
    batch.step(|_, _| ()).unwrap();
    assert_eq!(calls.take(), 2 * 2);
}

#[test]
fn simulations_with_callbacks_keep_their_auto_traits() {
    fn assert<T: Send + Sync + UnwindSafe + RefUnwindSafe + Unpin>() {}
    assert::<Data>();
}
