//! Saving and restoring a state, bit for bit.
//!
//! ```
//! use mujoco_safe::{Data, StateSpec, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let mut saved = data.state(StateSpec::INTEGRATION); // all inputs of the next step
//! data.step_n(10)?;
//! let first = data.qpos().to_vec();
//! data.set_state(StateSpec::INTEGRATION, &saved)?;
//! data.step_n(10)?;
//! assert_eq!(data.qpos(), first);
//! data.state_into(StateSpec::INTEGRATION, &mut saved)?; // reuses the vector
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! `saved` is a `Vec<f64>`, which any format stores. It fits the same model and the same version of
//! the engine.
