//! Variations of a model.
//!
//! The ids of a model are valid for its clones. `scale_mass` scales mass and inertia together, like
//! a change of density, and [`update_constants`](crate::ModelMut::update_constants) updates the
//! derived quantities.
//!
//! ```
//! use mujoco_safe::{Data, sample};
//!
//! let model = sample::cartpole();
//! let pole = model.body("pole")?.id();
//! let hinge = model.joint("hinge")?.id();
//! let mut angles = Vec::new();
//! for scale in [0.8, 1.0, 1.2] {
//!     let mut variation = model.clone();
//!     let mut edit = variation.edit();
//!     edit.body_mut(pole).scale_mass(scale)?;
//!     edit.joint_mut(hinge).damping_mut()[0] *= scale;
//!     edit.update_constants()?;
//!     let mut data = Data::new(variation)?;
//!     data.joint_mut(hinge).qpos_mut()[0] = 0.1;
//!     data.step_n(20)?;
//!     angles.push(data.joint(hinge).qpos()[0]);
//! }
//! assert!(angles.iter().all(|angle| *angle > 0.1));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
