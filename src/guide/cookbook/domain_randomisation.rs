//! Domain randomisation: many simulations with random parameters of the model.
//!
//! Each rollout edits its own copy of the model. The random numbers depend on the seed and the
//! index of the rollout only, so the results do not depend on the threads.
//! [`with_forward_after_step`](crate::Rollout::with_forward_after_step) updates the poses that the
//! outputs read. With the feature `npz`, `result.save_npz(path)?` writes all arrays for NumPy.
//!
//! ```
//! use mujoco_safe::rollout::Random;
//! use mujoco_safe::{Rollout, sample};
//!
//! let (nroll, nstep) = (16, 50);
//! let model = sample::cartpole();
//! let (pole, hinge) = (model.body("pole")?.id(), model.joint("hinge")?.id());
//! let result = Rollout::new(model, nroll, nstep)
//!     .with_model_edits(|roll, edit| {
//!         let scale = Random::new(42, roll, 0).uniform(0.8, 1.2);
//!         edit.body_mut(pole).scale_mass(scale)?;
//!         edit.joint_mut(hinge).damping_mut()[0] *= scale;
//!         edit.update_constants()
//!     })
//!     .with_shared_controls(&vec![0.1; nstep]) // (nstep, nu)
//!     .with_outputs(1, |data, row| row[0] = data.body(pole).xpos()[0])
//!     .with_forward_after_step()
//!     .run()?;
//! assert!(result.outcomes().iter().all(Result::is_ok));
//! assert_eq!(result.outputs().len(), nroll * nstep);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! Batches and environments draw parameters from distributions, and again in each episode: see
//! [parameters for each simulation](crate::guide::parallel#parameters-for-each-simulation).
