//! Errors and safety: kinds of errors and their remedies, poisoning, panics, limits of the
//! guarantees.
//!
//! # Errors or panics
//!
//! A failure that can occur in a correct program is an [`Error`]: a file, a text, a name, a
//! diverged simulation, a failure of the engine. A mistake in the program panics: an index beyond a
//! slice, an id of another model, a record that a trajectory does not have. Numerical outcomes are
//! a status: [`IlqrStatus`](crate::control::ilqr::IlqrStatus),
//! [`BoxQpStatus`](crate::math::BoxQpStatus), [`QpStatus`](crate::math::QpStatus),
//! [`IkStatus`](crate::ik::IkStatus).
//!
//! [`Error`] is non-exhaustive, and its text states the problem, the place and the allowed values:
//!
//! ```
//! use mujoco_safe::{Data, Error, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! match data.joint_mut("left_kne") {
//!     Ok(mut knee) => knee.qpos_mut()[0] = 0.5,
//!     Err(Error::NoSuchName { name, known, .. }) => {
//!         assert_eq!(name, "left_kne");
//!         assert!(known.contains(&"left_knee".to_owned()));
//!     }
//!     Err(error) => return Err(error),
//! }
//! let text = data.full_m().unwrap_err().to_string();
//! assert!(text.ends_with("call forward or step first"), "{text}");
//! # Ok::<(), Error>(())
//! ```
//!
//! # Kinds of errors
//!
//! | error | cause | remedy |
//! |---|---|---|
//! | [`Load`](Error::Load) | the XML is not a valid model for the engine | the message has the line; see [troubleshooting](super::troubleshooting#models) |
//! | [`InvalidBinary`](Error::InvalidBinary) | a damaged binary model, or one of another version | compile the XML again |
//! | [`File`](Error::File) | a file cannot be read or written | check path and permissions |
//! | [`Serve`](Error::Serve) | the address of a live page is in use, or not one of this machine | another port or address |
//! | [`XmlLosesEdits`](Error::XmlLosesEdits), [`XmlReplaced`](Error::XmlReplaced) | XML cannot represent the model, or another model was loaded since | [`Model::save_binary`](crate::Model::save_binary) |
//! | [`Save`](Error::Save) | the engine cannot write a model, or a recording failed | the message; install `ffmpeg`, or another format |
//! | [`NoSuchName`](Error::NoSuchName), [`NoSuchIndex`](Error::NoSuchIndex), [`NoSuchField`](Error::NoSuchField) | an unknown name or index | the error lists the known names |
//! | [`NotComputed`](Error::NotComputed) | a result has not been computed | the call that the message names, usually [`Data::forward`] |
//! | [`Shape`](Error::Shape) | a vector or matrix of the wrong shape | the message has both shapes |
//! | [`Invalid`](Error::Invalid) | a value that is not allowed; its [`InvalidKind`](crate::InvalidKind) tells a program why | the message has the allowed values |
//! | [`OtherModel`](Error::OtherModel) | a scene, lineariser or simulation of another model | create both from one model or its clones |
//! | [`Unstable`](Error::Unstable) | NaN, or a value beyond ±10¹⁰ | a smaller time step, softer contacts, more damping; limits on controls |
//! | [`Callback`](Error::Callback) | a closure panicked in a step | correct the closure, reset |
//! | [`Panicked`](Error::Panicked) | the planner or the cost of predictive control panicked in its thread | correct it |
//! | [`Engine`](Error::Engine) | the engine raised an error, for example a stack overflow | the message; a larger `nstack` in the model's `size` |
//! | [`Poisoned`](Error::Poisoned) | an earlier call failed | [`Data::reset`] |
//! | [`Solver`](Error::Solver) | no regulator exists | [`Error::solver`] returns the [`RiccatiError`](crate::control::riccati::RiccatiError) |
//! | [`SceneFull`](Error::SceneFull) | more geoms than the scene has room for | a larger [`Scene`](crate::Scene) |
//! | [`Unsupported`](Error::Unsupported) | the operation is not possible with this model or this engine | the message |
//! | [`OutOfMemory`](Error::OutOfMemory), [`LoaderLocked`](Error::LoaderLocked) | memory is exhausted; the compiler was interrupted by such a failure | restart the process |
//! | [`EngineVersion`](Error::EngineVersion) | the library at run time has another version than the headers | see [`engines`](super::engines) |
//!
//! Rendering returns `RenderError`, the viewer `ViewerError`; both contain an [`Error`] as
//! `Other`. A rollout has one [`RolloutError`](crate::rollout::RolloutError) per failed simulation.
//!
//! # Poisoning
//!
//! A call with `&mut Data` that fails in the middle of a computation leaves the simulation half
//! computed. The simulation is then poisoned: each computation returns [`Error::Poisoned`] with the
//! first cause, until [`reset`](Data::reset), [`reset_to_key`](Data::reset_to_key) or
//! [`copy_from`](Data::copy_from). Reading and writing arrays still works. A position, velocity or
//! control that is out of range is found before the engine computes, so it does not poison:
//!
//! ```
//! use mujoco_safe::{Data, Error, StateSpec, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let start = data.state(StateSpec::INTEGRATION);
//!
//! // Found before the step: the simulation is unchanged.
//! data.ctrl_mut()[0] = f64::NAN;
//! assert!(matches!(data.step(), Err(Error::Unstable(_))));
//! data.ctrl_mut()[0] = 0.0;
//! data.step()?;
//!
//! // Found during the step: poisoned.
//! data.qfrc_applied_mut()[0] = f64::INFINITY;
//! assert!(matches!(data.step(), Err(Error::Unstable(_))));
//! assert!(matches!(data.step(), Err(Error::Poisoned { .. })));
//! data.reset()?;
//! data.set_state(StateSpec::INTEGRATION, &start)?;
//! data.step()?;
//! # Ok::<(), Error>(())
//! ```
//!
//! To retry with another control, save a [`StateSpec::INTEGRATION`](crate::StateSpec::INTEGRATION)
//! state before the step, reset, and restore it.
//!
//! # Diverged simulations
//!
//! [`Error::Unstable`] has the quantity, the index, the name of the joint or actuator, and the
//! time. An environment for learning ends its episode:
//!
//! ```
//! use mujoco_safe::{Data, Error, sample};
//!
//! fn episode(data: &mut Data, steps: usize) -> Result<usize, Error> {
//!     data.reset()?;
//!     for step in 0..steps {
//!         match data.step() {
//!             Ok(()) => {}
//!             Err(Error::Unstable(instability)) => {
//!                 eprintln!("the episode ends after {step} steps: {instability}");
//!                 return Ok(step);
//!             }
//!             Err(error) => return Err(error),
//!         }
//!     }
//!     Ok(steps)
//! }
//! assert_eq!(episode(&mut Data::new(sample::cartpole())?, 100)?, 100);
//! # Ok::<(), Error>(())
//! ```
//!
//! # Warnings
//!
//! The engine's warnings (too many contacts, a nearly singular inertia matrix) are not errors.
//! [`Data::warning`] counts them, and the first of each type is logged under the target `mujoco` of
//! the [`log`](https://docs.rs/log) crate: install a logger to see it.
//! [`Model::compile_warnings`](crate::Model::compile_warnings) returns the compiler's warnings.
//!
//! # Panics
//!
//! | mistake | instead |
//! |---|---|
//! | an id, or a view, of another model | look the element up in this model |
//! | `data.qpos_mut().copy_from_slice(&q)` with another length | [`Data::set_state`], which returns [`Error::Shape`] |
//! | a row, a record or a simulation beyond the end | check `len()` |
//! | [`Clone`] of a [`Data`] or [`Model`](crate::Model) without memory | [`Data::try_clone`], [`Model::try_clone`](crate::Model::try_clone) |
//! | a closure of a rollout or a batch panics | the call panics after all threads have stopped |
//!
//! # Limits of the guarantees
//!
//! - **Model XML.** The engine's own compiler reads it, and no check before compilation is
//!   complete. Compile untrusted texts in a separate process with limits on time and memory. Binary
//!   models are validated completely.
//! - **Plain getters** such as [`Data::xpos`] return the contents of the array, valid or not.
//!   [`Data::require`] checks for missing results. No check tracks values that the program itself
//!   writes.
//! - **Meaning.** A negative damping or an inconsistent inertia is accepted: it is wrong physics,
//!   not wrong memory access.
//! - **Raw pointers.** The use of [`sys`](crate::sys) and of [`Data::as_mut_ptr`] is `unsafe`, and
//!   the guarantees end there.
//! - **Time.** A step of an extreme model may take long, and the compilation of a large text may
//!   take minutes.
//!
//! [`promises`](crate::guide::promises) lists all guarantees with the test of each.

#[cfg(doc)]
use crate::{Data, Error};
