//! Many simulations: threads, rollouts, batches, determinism.
//!
//! | task | use |
//! |---|---|
//! | independent simulations with their own logic | [`std::thread::scope`], one [`Data`] per thread |
//! | many simulations from initial states, with controls or controllers | [`Rollout`] |
//! | one policy for many simulations that step together | [`Batch`] |
//! | the same with rewards, ends of episodes and resets (reinforcement learning) | [`VectorEnvironment`] |
//! | rollouts in every control step | [`Rollout::on`] with [`Workers`] |
//! | linearisation in several threads | [`Lineariser`](crate::Lineariser) with [`TransitionOptions::with_threads`](crate::derivative::TransitionOptions::with_threads) |
//! | many machines | a process per machine: the example `mpi` distributes a batch over MPI ranks, with the same random numbers for any number of ranks ([`Batch::with_first_index`]) |
//! | a learner in Python | the example `python`: a module whose NumPy arrays borrow the rows of a batch (`scripts/python-module`) |
//!
//! # Shared and owned
//!
//! A [`Model`] is constant while it is shared, so all threads read one `Arc<Model>`. A [`Data`]
//! belongs to one thread at a time. Any number of threads may read a [`Data`] that no thread
//! changes; the compiler enforces both rules. The cookbook has a program with
//! [threads](crate::guide::cookbook::threads).
//!
//! # Rollouts
//!
//! A [`Rollout`] resets each simulation, sets its initial state, and takes a fixed number of steps.
//! Controls come from an array or from a controller for each rollout. Each rollout can edit its own
//! copy of the model:
//!
//! ```
//! use std::sync::Arc;
//! use mujoco_safe::rollout::Rollout;
//! use mujoco_safe::{Data, Lqr, LqrWeights, StateSpec, sample};
//!
//! // Does the regulator of the nominal pole balance poles of other masses?
//! let model = Arc::new(sample::cartpole());
//! let pole = model.body("pole")?.id();
//! let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
//! let lqr = Lqr::at_present_state(&mut Data::new(model.clone())?, &weights)?;
//! let result = Rollout::new(model, 8, 300)
//!     .with_initial_state(StateSpec::PHYSICS, &[0.0, 0.1, 0.0, 0.0])
//!     .with_controllers(|_| lqr.clone())
//!     .with_model_edits(|index, edit| {
//!         edit.body_mut(pole).scale_mass(0.8 + 0.1 * index as f64)?;
//!         edit.update_constants()
//!     })
//!     .with_outputs(1, |data, row| row[0] = data.actuator_force()[0])
//!     .run()?;
//! for (index, outcome) in result.outcomes().iter().enumerate() {
//!     match outcome {
//!         Ok(()) => assert!(result.state(index, 300)[1].abs() < 0.05),
//!         Err(error) => println!("rollout {index} failed: {error}"),
//!     }
//! }
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A failure ends one rollout and leaves NaN in its remaining rows; the others continue.
//! [`Rollout::run_into`] writes to existing buffers. [`Rollout::with_progress`] reports completed
//! rollouts and can cancel the rest.
//!
//! ## Rows and times
//!
//! | array | shape | row `k` |
//! |---|---|---|
//! | [`states`](crate::rollout::RolloutResult::states) | `(nroll, nstep + 1, nstate)` | the state after `k` steps |
//! | [`sensordata`](crate::rollout::RolloutResult::sensordata) | `(nroll, nstep, nsensordata)` | the readings in the state of row `k` |
//! | [`outputs`](crate::rollout::RolloutResult::outputs) | `(nroll, nstep, noutput)` | the closure after step `k` |
//!
//! The closure of [`with_outputs`](Rollout::with_outputs) runs after a step. The state that it
//! reads belongs to row `k + 1`; poses, contacts and forces belong to row `k`, because [a step does
//! not update them](super::concepts#age-of-results).
//! [`with_forward_after_step`](Rollout::with_forward_after_step) updates them before the closure
//! runs, at the cost of one more evaluation of forward dynamics per step.
//!
//! ## Files
//!
//! `result.save_npz(path)?` (feature `npz`) writes these arrays for `numpy.load`, and which
//! rollouts completed. `npz::save` writes any other arrays.
//!
//! # Batches
//!
//! A [`Batch`] calls one policy per step with all observations as a matrix `(n, nobs)` and all
//! controls as a matrix `(n, nu)`. Stepping, observing and resetting run in parallel.
//!
//! ```
//! use mujoco_safe::rollout::Batch;
//! use mujoco_safe::{Matrix, sample};
//!
//! let gains = Matrix::from_rows(&[[0.3, 3.0, 0.4, 0.6]]); // (nu, nobs)
//! let mut batch = Batch::new(sample::cartpole(), 32)?.with_substeps(2); // observations: [qpos; qvel; act]
//! batch.reset_where(|_| true, |index, _, data| data.qpos_mut()[1] = 0.01 * index as f64 - 0.16)?;
//! for _ in 0..100 {
//!     batch.step(|observations, controls| {
//!         for (row, x) in observations.rows().enumerate() {
//!             let control: f64 = gains.row(0).iter().zip(x).map(|(gain, x)| gain * x).sum();
//!             controls.as_mut_slice()[row] = control.clamp(-1.0, 1.0);
//!         }
//!     })?;
//!     // Reset the simulations whose episode has ended: by a fall, or by a failure of the simulation (its observations are NaN).
//!     let ended: Vec<bool> = batch.observations().rows().map(|x| x[1].is_nan() || x[1].abs() > 0.5).collect();
//!     batch.reset_where(|index| ended[index], |_, episode, data| data.qpos_mut()[1] = 1e-3 * episode as f64)?;
//! }
//! assert!(batch.observations().rows().all(|x| x[1].abs() < 0.1));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! The observations of a failed simulation are NaN, and [`failure`](Batch::failure) returns its
//! error. The closure of [`with_observations`](Batch::with_observations) reads the simulation after
//! a step, so the remark on the age of poses applies to it too; [`Batch::with_forward_after_step`]
//! updates them. [`Batch::data`] returns a copy of one simulation, for example to draw it,
//! [`Batch::states`] the states of all as a matrix, and [`Batch::edit_where`] changes simulations
//! between two steps.
//!
//! ## Parameters for each simulation
//!
//! For domain randomisation, [`Batch::with_parameters`] gives each simulation other values of
//! chosen [`Parameter`]s of the model: masses with inertia, centres of mass, friction, sizes,
//! damping, stiffness, armature, gains, gears, gravity, and by [`Parameter::field`] any other
//! number in the model's arrays. The values come from distributions and are determined by a seed,
//! the index of the simulation and the number of its episode:
//!
//! ```
//! use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters};
//! use mujoco_safe::sample;
//!
//! let model = sample::humanoid();
//! let (torso, floor) = (model.body("torso")?.id(), model.geom("floor")?.id());
//! let parameters = Parameters::new()
//!     .with(&model, Parameter::MassFactor(torso), Distribution::LogUniform { low: 0.8, high: 1.25 })?
//!     .with(&model, Parameter::GeomFriction(floor, 0), Distribution::Uniform { low: 0.4, high: 1.0 })?;
//! let mut batch = Batch::new(model, 16)?.with_parameters(parameters)?;
//! batch.sample_parameters(|_| true, 42)?;
//! batch.step(|_, _| ())?;
//! # assert!(batch.failures().next().is_none());
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A step equals a step of a model with these values, bit for bit. Values that other constants of
//! the model depend on, such as masses, cost a call of
//! [`update_constants`](crate::ModelMut::update_constants) for each draw, not for each step. For
//! quantities that are no [`Parameter`], call [`Data::edit_model`] in
//! [`reset_where`](Batch::reset_where) or [`edit_where`](Batch::edit_where): the batch keeps only
//! the differences from its model. Steps of such a simulation take about twice as long, because the
//! worker must be cleared: an edit may change which quantities a step computes.
//!
//! # Environments
//!
//! A [`VectorEnvironment`] adds to a batch what algorithms of reinforcement learning expect:
//! rewards, ends of episodes by the task (terminated) or by the time limit (truncated), and new
//! episodes where one has ended. A [`Task`] defines them; the module
//! [`environment`](crate::environment) has ready tasks and examples of custom tasks.
//!
//! ```
//! use mujoco_safe::environment::{InvertedPendulum, VectorEnvironment};
//!
//! // Measure the mean length of 100 episodes under a linear policy.
//! let mut carts = VectorEnvironment::new(InvertedPendulum::model(), InvertedPendulum, 100, 42)?;
//! let (mut steps, mut ends) = (0, 0);
//! for _ in 0..50 {
//!     let actions: Vec<f64> = carts.observations().rows().map(|x| 0.1 * x[0] + 0.5 * x[1]).collect();
//!     carts.step(&actions)?;
//!     steps += carts.len();
//!     ends += carts.terminated().iter().filter(|&&terminated| terminated).count();
//! }
//! println!("{} steps", steps / ends.max(1));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A task sees the simulation after each action. So rewards, ends and observations can depend on
//! all that the engine computes:
//!
//! | Gymnasium's task | reads | method of [`Task`] |
//! |---|---|---|
//! | `Reacher` | poses of two bodies: `data.body(fingertip).xpos()` | none: `start` draws the target |
//! | `Ant`, `Humanoid` | forces of contacts on bodies: `data.cfrc_ext()` | [`body_forces`](Task::body_forces) |
//! | `Ant`, `Humanoid` | a pose or a centre of mass before the action | [`remember`](Task::remember) |
//! | `Humanoid` | `cinert`, `cvel`, `qfrc_actuator` | none |
//!
//! As in Gymnasium, these quantities belong to the state before the last engine step, unless
//! [`forward_after_step`](Task::forward_after_step) returns `true`. After the start of an episode
//! they belong to the initial state; Gymnasium leaves the forces on bodies at zero until the first
//! step. Otherwise, the three tasks have the observations, rewards and ends of Gymnasium's classes
//! from the same initial states: the tests in `tests/rollout/gymnasium` compare episodes with a
//! bound of 1e-9. In them, `start` calls [`Data::forward`] as Gymnasium's reset does, because this
//! changes the initial guess of the constraint solver.
//!
//! Noise on actions and observations, and delays of the actions that differ between episodes,
//! prepare a policy for a robot:
//!
//! ```
//! use mujoco_safe::environment::{HalfCheetah, VectorEnvironment};
//!
//! let cheetahs = VectorEnvironment::new(HalfCheetah::model(), HalfCheetah, 16, 42)?
//!     .with_action_delay(0..=2)? // steps of the environment
//!     .with_action_noise(&[0.05; 6])?
//!     .with_observation_noise(&[0.01; 17])?;
//! assert_eq!(cheetahs.observations().shape(), (16, 17));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A [`BatchCamera`](crate::render::BatchCamera) draws all simulations of a batch or an
//! environment: observations for policies that see, with colours, lights and cameras that differ
//! between the images if the caller wants.
//!
//! The example `learn_gait` learns to run in a vector environment, by augmented random search: each
//! simulation tries other weights of a linear policy. It plots the learning curves of three
//! searches, records a film of the best policy, and saves it.
//!
//! ## Layout of the arrays, and neural networks
//!
//! States, observations, controls and parameters are contiguous row-major arrays of `f64`:
//!
//! | array | shape | strides in elements |
//! |---|---|---|
//! | [`Batch::states`] | `(n, nstate)`, [`StateSpec::INTEGRATION`](crate::StateSpec::INTEGRATION) | `(nstate, 1)` |
//! | [`Batch::observations`], [`VectorEnvironment::observations`], [`final_observations`](VectorEnvironment::final_observations) | `(n, nobs)` | `(nobs, 1)` |
//! | [`BatchCamera::rgb`](crate::render::BatchCamera::rgb) (`u8`) | `(n, height, width, 3)` | `(3 · width · height, 3 · width, 3, 1)` |
//! | [`depth`](crate::render::BatchCamera::depth) (`f32`), [`segmentation`](crate::render::BatchCamera::segmentation) (`u32`) | `(n, height, width)` | `(width · height, width, 1)` |
//! | controls, and the actions of [`VectorEnvironment::step`] | `(n, nu)` | `(nu, 1)` |
//! | [`Batch::parameters`] | `(n, nparameter)` | `(nparameter, 1)` |
//! | [`rewards`](VectorEnvironment::rewards) (`f64`), [`terminated`](VectorEnvironment::terminated) and [`truncated`](VectorEnvironment::truncated) (`bool`) | `(n)` | `(1)` |
//!
//! [`MatrixView::as_slice`] returns the memory, which is valid until the next call that changes the
//! simulations. [`MatrixView::to_f32_into`] rounds it to single precision. With `x` such a slice of
//! shape `(n, m)`:
//!
//! | library | array or tensor | copies |
//! |---|---|---|
//! | ndarray | `observations.as_ndarray()` (feature `ndarray`) | no |
//! | nalgebra | [`MatrixView::transposed`]: a column for each simulation | no |
//! | candle | `Tensor::from_slice(x, (n, m), &device)?` | yes |
//! | burn | `Tensor::<B, 2>::from_data(TensorData::new(x.to_vec(), [n, m]), &device)` | yes |
//! | tch | `Tensor::from_slice(x).view([n as i64, m as i64])` | yes |
//!
//! # Threads and memory
//!
//! Rollouts and batches use the current [rayon] pool, by default one thread per logical processor.
//! To use fewer threads, or pinned ones, run them in a pool:
//!
//! ```
//! use mujoco_safe::rayon::ThreadPoolBuilder;
//! use mujoco_safe::rollout::Rollout;
//! use mujoco_safe::sample;
//!
//! let pool = ThreadPoolBuilder::new().num_threads(2).build()?;
//! let result = pool.install(|| Rollout::new(sample::cartpole(), 100, 50).run())?;
//! assert_eq!(result.len(), 100);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Rollouts and batches need one [`Data`] per thread. A batch keeps of each simulation its
//! [state](Batch::states), its controls and its observations as rows of matrices, so 4,096
//! humanoids take about 20 MB (`cargo bench --bench batch`). A simulation whose model was edited
//! also keeps the values that differ.
//!
//! # Determinism
//!
//! - A rollout or a batch equals a loop over [`Data::step`] bit for bit, for any number of threads
//!   and any chunk size.
//! - A simulation that is set to a [`StateSpec::INTEGRATION`](crate::StateSpec::INTEGRATION) state
//!   continues bit for bit.
//! - The results of two builds of the engine, or of two kinds of processors, differ in the last
//!   bits. Contacts amplify these differences.
//! - Random numbers: derive the seed from the index of the rollout
//!   (`RandomController::new(index as u64)`), not from a generator that threads share. In a batch,
//!   [`Random`] derives it from the index and the number of the episode, which
//!   [`reset_where`](Batch::reset_where) passes to its closure.
//!
//! [Promises](crate::guide::promises) 8 and 12 state this with their tests.

#[cfg(doc)]
use crate::{
    Data, MatrixView, Model,
    environment::{Task, VectorEnvironment},
    rollout::{Batch, Parameter, Random, Rollout, Workers},
};
