//! Flight recorder: a bounded record of everything that enters a simulation, which repeats its last
//! steps bit for bit; and a comparison of two engines, which finds the first difference.
//!
//! A [`FlightRecorder`] makes the calls of the simulation, and stores for each what has changed
//! since the previous one. After an error or a panic it writes a file, from which
//! [`Recording::repeat`] makes the same calls again, in this or another process.
//!
//! ```
//! use mujoco_safe::flight::{FlightRecorder, Recording};
//! use mujoco_safe::{Controller, Data, RandomController, sample};
//!
//! # use mujoco_safe::{Error, Model};
//! # if matches!(Model::from_binary(b""), Err(Error::Unsupported(_))) {
//! #     return Ok::<(), Error>(()); // an engine whose binary models are not loaded
//! # }
//! let path = std::env::temp_dir().join("mujoco_safe_failure.flight");
//! let mut data = Data::new(sample::humanoid())?;
//! let mut recorder = FlightRecorder::new(&data)?.with_file(&path).with_note("seed 1");
//! let mut controller = RandomController::new(1);
//! for _ in 0..100 {
//!     controller.control(&mut data)?;
//!     recorder.step(&mut data)?;
//! }
//! data.ctrl_mut()[3] = f64::NAN;
//! recorder.step(&mut data).unwrap_err(); // writes the file
//!
//! let recording = Recording::read(&path)?;
//! let repeat = recording.repeat()?;
//! assert_eq!((repeat.calls, &repeat.difference), (101, &None));
//! let fast = recording.first(|data| data.qvel().iter().any(|velocity| velocity.abs() > 1.0))?.unwrap();
//! println!("{}: fast since call {fast}, {:?}", recording.reason(), recording.data_after(fast)?);
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Recorded values
//!
//! The result of [`Data::step`](crate::Data::step) depends on the model and on
//! [`StateSpec::INTEGRATION`](crate::StateSpec::INTEGRATION): positions, velocities, activations,
//! time, the start of the solver, controls, applied forces, mocap poses, user data, states of
//! plugins and delays. Since engine 3.0 it also depends on which equality constraints are active.
//! Before 3.0, a step with disabled actuation advances activations with the
//! [`act_dot`](crate::Data::act_dot) of an earlier call; since 3.5, a step with disabled sensors
//! puts earlier readings into the buffers of delays. Before each call the recorder compares these
//! values with those that the previous call left, and stores the words that differ. So it records
//! writes by the program, resets, keyframes, jumps to other states and calls that it did not make,
//! without a hook in each method. It stores the model again if it was edited, and a checksum of the
//! results of each call: of the values that only the engine changes, or of all values if closures
//! act in the simulation.
//!
//! The calls and their inputs are in [memory](FlightRecorder::with_memory) that is allocated at the
//! start. It has segments, of which each begins with all values, so the oldest can be dropped. A
//! segment also begins after an error, because the repetition must [reset](crate::Data::reset) the
//! simulation, and after an edit. Models are stored in MuJoCo's binary form (MJB); an edited model
//! as the words that differ from the first one. A step that changes neither the model nor more than
//! the controls allocates nothing, except for the segments that follow those of errors and edits.
//!
//! # Limits of the repetition
//!
//! A repetition makes the recorded calls and compares the checksum and the text of the error after
//! each, so it is never wrong without notice: [`Repeat::difference`] has the first call that
//! differs, with possible causes. It can differ in these cases:
//!
//! - The processor, the engine's build or this crate's version are others ([`Origin`]).
//! - [Closures](crate::callback) act in a step. A repetition does not have them. It sets the
//!   controls, applied forces, mocap poses and user data that they left before the call, which
//!   repeats a control closure exactly, unless the integrator calls it several times (`Rk4`). For
//!   other closures pass them to [`Recording::repeat_with`].
//! - The program wrote to an array of results that the next call reads before it computes them: a
//!   half step does, and some checks of a step.
//! - A plugin has memory that is not a part of its state, or `unsafe` code writes to the model.
//! - [`step2`](FlightRecorder::step2) continues a first half that the recorder did not make.
//!
//! With engines whose binary models this crate does not [validate](crate::Model::from_binary), a
//! recording needs the model's [text](FlightRecorder::with_xml), and can be repeated only if the
//! text compiles to the same bytes: not after edits.
//!
//! Models with the option `sleep` are an error, because no state contains which bodies sleep.
//!
//! Calls other than the four of the recorder compute results that no later step reads. They are not
//! repeated; the state that they leave is.
//!
//! # Comparison of engines
//!
//! A process has one engine, so two engines, or two builds of one, are compared by a trace: a
//! [`Tracer`] or [`Recording::trace`] writes the inputs of each call and about sixty quantities of
//! its stages. A [`Comparison`] in a program with the other engine reads it, call by call. It
//!
//! - compares the sizes, options and arrays of the two compiled models;
//! - sets the inputs of each call to those of the trace, so that a difference is one of this call,
//!   and is not inherited from earlier ones;
//! - reports for each quantity the first call in which it differs by more than rounding, with the
//!   element that differs most, in the order of the stages. The first stage makes the difference.
//!
//! The effect of rounding on a value is measured: the call is repeated three times with inputs that
//! are changed by 4 ε of their values or of one, or by the largest difference of two constants of
//! the models that counts as rounding (below 10⁻¹⁰ of their row). A difference up to 100 times the
//! largest change, plus ε times the largest value of the row, is rounding. An iterative solver that
//! stops early adds an error of its own. It is measured in both engines, by ten times as many
//! iterations with the tolerance zero: up to ten times the larger error, a difference counts as one
//! of [convergence](Comparison::convergence). Contacts and constraint rows that the engines list in
//! different orders are matched. Matrices are compared by their product with a constant vector.
//!
//! The trace has the model's fields, and loads with another build of the same engine. Another
//! engine needs the [text](FlightRecorder::with_xml) or the [model](Comparison::new); without both,
//! the comparison is an error. The [recipe](crate::guide::cookbook::upgrades) has an example.
//!
//! # File
//!
//! A file begins with `MJFLIGHT`, or `MJ_TRACE` for a trace, and the version of the format (`u32`).
//! Parts follow: one for a recording; for a trace its origin, models, calls and the number of
//! calls. A part is a value in the encoding of the crate [`postcard`], with its length before it
//! and a checksum after it (`u64`).
//!
//! A call of a recording consists of words: its kind, the changes before it, those that closures
//! made, and the checksum of its results. Changes are runs of words; the word before a run has its
//! start and its length (`u32`).
//!
//! [`postcard`]: https://docs.rs/postcard
//!
//! A file from a stranger is safe to read: memory is allocated for the bytes that the file has,
//! models are validated as by [`Model::from_binary`](crate::Model::from_binary), and states are set
//! by safe methods.

mod change;
mod compare;
mod divergence;
mod inputs;
mod matched;
mod model_difference;
mod model_image;
mod origin;
mod parts;
mod quantities;
mod recorder;
mod recording;
mod repeat;
mod report;
#[cfg(test)]
mod tests;
mod trace;

pub use self::compare::Comparison;
pub use self::divergence::Divergence;
pub use self::origin::Origin;
pub use self::recorder::FlightRecorder;
pub use self::recording::Recording;
pub use self::repeat::{Difference, Repeat};
pub use self::trace::Tracer;
