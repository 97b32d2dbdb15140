//! Repeating a failure bit for bit: the flight recorder.
//!
//! A simulation diverges after an hour, on another machine. A
//! [`FlightRecorder`](crate::flight::FlightRecorder) keeps the last steps in bounded memory and
//! writes them to a file after an error or a panic. [`Recording`](crate::flight::Recording) repeats
//! them, verifies each step, and gives the simulation before any of them:
//!
//! ```
//! use mujoco_safe::flight::{FlightRecorder, Recording};
//! use mujoco_safe::{Data, sample};
//!
//! # use mujoco_safe::{Error, Model};
//! # if matches!(Model::from_binary(b""), Err(Error::Unsupported(_))) {
//! #     return Ok::<(), Error>(()); // an engine whose binary models are not loaded
//! # }
//! let path = std::env::temp_dir().join("mujoco_safe_recipe.flight");
//! let mut data = Data::new(sample::humanoid())?;
//! let mut recorder = FlightRecorder::new(&data)?.with_file(&path);
//! let failure = loop {
//!     data.qfrc_applied_mut()[5] += 1e9; // the mistake
//!     if let Err(error) = recorder.step(&mut data) {
//!         break error;
//!     }
//! };
//!
//! let recording = Recording::read(&path)?;
//! assert_eq!(recording.reason(), failure.to_string());
//! assert_eq!(recording.repeat()?.difference, None);
//! let fast = recording.first(|data| data.qvel().iter().any(|speed| speed.abs() > 1e3))?;
//! println!("a velocity exceeds 1000 after {fast:?} of {:?}", recording.calls());
//! // By bisection, since this condition continues to hold.
//! let late = recording.first_by_bisection(|data| data.time() > 0.1)?;
//! println!("0.1 s have passed after {late:?}");
//! let mut before = recording.data_before(recording.calls().end - 1)?;
//! assert_eq!(before.step().unwrap_err().to_string(), failure.to_string());
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! `cargo run --example replay -- repeat FILE` does the same without a program. The [module
//! `flight`](crate::flight) lists what cannot be repeated, and how that is detected.
