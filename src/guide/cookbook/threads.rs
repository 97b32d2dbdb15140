//! Parallel simulations in threads.
//!
//! Threads share a model, and each thread has its own simulation.
//! [`parallel`](crate::guide::parallel) lists the ready ways: rollouts, batches, environments.
//!
//! ```
//! use std::sync::Arc;
//! use std::thread;
//!
//! use mujoco_safe::{Data, Result, sample};
//!
//! let model = Arc::new(sample::cartpole());
//! let angles: Vec<f64> = thread::scope(|scope| {
//!     let simulate = |control: f64| -> Result<f64> {
//!         let mut data = Data::new(&model)?;
//!         data.ctrl_mut()[0] = control;
//!         data.step_n(20)?;
//!         Ok(data.qpos()[1])
//!     };
//!     let threads: Vec<_> =
//!         (0..4).map(|i| scope.spawn(move || simulate(0.1 * f64::from(i)))).collect();
//!     let join = |thread: thread::ScopedJoinHandle<'_, _>| thread.join().expect("no panic");
//!     threads.into_iter().map(join).collect::<Result<_>>()
//! })?;
//! assert!(angles.is_sorted_by(|a, b| a.abs() < b.abs())); // more control, a larger angle
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
