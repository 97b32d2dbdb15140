//! Methods of a simulation that install callbacks, for a scope or until they are replaced.

use super::{Callbacks, trampoline};
use crate::data::Data;

/// # Callbacks
impl Data {
    /// Runs `run` with these closures active. Within `run`, every call that computes results of
    /// this simulation, in any thread, calls the closures at the points that
    /// [`callback`](crate::callback) lists. Clones of the simulation do not call them. A nested
    /// scope uses only its own closures. The closures of [`set_callbacks`](Self::set_callbacks) are
    /// not called within `run`.
    ///
    /// ```
    /// use mujoco_safe::callback::Callbacks;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qpos_mut()[1] = 0.1;
    /// let mut pushes = Vec::new();
    /// let balance = Callbacks::new().with_control(|context| {
    ///     let push = 30.0 * context.qpos()[1] + 5.0 * context.qvel()[1];
    ///     context.ctrl_mut()[0] = push;
    ///     pushes.push(push);
    /// });
    /// data.with_callbacks(balance, |data| data.step_n(200))?;
    /// assert_eq!(pushes.len(), 200);
    /// assert!(data.qpos()[1].abs() < 0.1);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// A closure cannot keep its argument:
    ///
    /// ```compile_fail,E0521
    /// # use mujoco_safe::callback::Callbacks;
    /// # use mujoco_safe::{Data, sample};
    /// let mut data = Data::new(sample::cartpole()).unwrap();
    /// let mut kept = None;
    /// let callbacks = Callbacks::new().with_control(|context| kept = Some(context.ctrl_mut())); // borrowed data escapes
    /// data.with_callbacks(callbacks, |data| data.step()).unwrap();
    /// ```
    #[doc(alias = "mjcb_control")]
    #[doc(alias = "mjcb_passive")]
    pub fn with_callbacks<R>(&mut self, callbacks: Callbacks<'_>, run: impl FnOnce(&mut Self) -> R) -> R {
        trampoline::install(&callbacks);
        self.scope_callbacks(Box::new(callbacks), run)
    }

    /// Sets the closures that every later call on this simulation runs, in any thread, until they
    /// are replaced. They replace the closures of an earlier call; an empty set,
    /// `Callbacks::new()`, removes them. Within [`with_callbacks`](Self::with_callbacks), they take
    /// effect after the scope.
    ///
    /// The closures stay with the simulation when it is moved, reset, or given an edited model.
    /// After an error of a closure, a [`reset`](Self::reset) makes the simulation usable, with the
    /// same closures.
    ///
    /// Copies of the simulation do not have the closures, so rollouts and iLQR, which simulate
    /// copies, do not call them. The `start` closure of
    /// [`Batch::reset_where`](crate::Batch::reset_where) can set callbacks for each simulation of a
    /// batch. A [`Lineariser`](crate::Lineariser) linearises a simulation with callbacks by the
    /// method [`Engine`](crate::derivative::TransitionMethod::Engine).
    ///
    /// ```
    /// use std::sync::{Arc, Mutex};
    ///
    /// use mujoco_safe::callback::Callbacks;
    /// use mujoco_safe::{Data, Result, sample};
    ///
    /// /// A cart-pole that balances at a target position.
    /// struct Balancer {
    ///     data: Data,
    ///     target: Arc<Mutex<f64>>, // shared with the closure
    /// }
    ///
    /// impl Balancer {
    ///     fn new() -> Result<Self> {
    ///         let mut data = Data::new(sample::cartpole())?;
    ///         let target = Arc::new(Mutex::new(0.0));
    ///         let shared = target.clone();
    ///         data.set_callbacks(Callbacks::new().with_control(move |context| {
    ///             let error = context.qpos()[0] - *shared.lock().unwrap();
    ///             let (angle, qvel) = (context.qpos()[1], context.qvel());
    ///             let push = 0.8 * error + 1.2 * qvel[0] + 10.0 * angle + 2.5 * qvel[1];
    ///             context.ctrl_mut()[0] = push;
    ///         }));
    ///         Ok(Self { data, target })
    ///     }
    /// }
    ///
    /// let mut balancer = Balancer::new()?;
    /// *balancer.target.lock().unwrap() = 0.3;
    /// balancer.data.step_n(1000)?;
    /// assert!((balancer.data.qpos()[0] - 0.3).abs() < 0.01);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// The simulation drops the closures when they are replaced or when it is dropped. A closure
    /// that owns its own simulation, for example through an `Arc<Mutex<Data>>`, is therefore never
    /// dropped, and it deadlocks if it locks that mutex during a step.
    ///
    /// The closures cannot borrow local variables:
    ///
    /// ```compile_fail,E0597
    /// # use mujoco_safe::callback::Callbacks;
    /// # use mujoco_safe::{Data, sample};
    /// let mut data = Data::new(sample::cartpole()).unwrap();
    /// let mut calls = 0;
    /// data.set_callbacks(Callbacks::new().with_control(|_| calls += 1)); // `calls` does not live long enough
    /// ```
    ///
    /// A closure cannot replace the callbacks of its own simulation:
    ///
    /// ```compile_fail,E0596
    /// # use mujoco_safe::callback::Callbacks;
    /// let callbacks = Callbacks::new().with_control(|context| {
    ///     context.set_callbacks(Callbacks::new()); // cannot borrow data as mutable
    /// });
    /// ```
    #[doc(alias = "mjcb_control")]
    #[doc(alias = "mjcb_passive")]
    #[doc(alias = "mj_resetCallbacks")]
    #[doc(alias = "set_mjcb_control")]
    #[doc(alias = "clear_callbacks")]
    pub fn set_callbacks(&mut self, callbacks: Callbacks<'static>) {
        trampoline::install(&callbacks);
        let is_empty = callbacks.present().next().is_none();
        self.replace_own_callbacks((!is_empty).then(|| Box::new(callbacks) as Box<_>));
    }
}
