//! Upgrading the engine: the first quantity that two versions compute differently.
//!
//! A new version of the engine, or another build of it, moves a robot slightly differently. Two
//! engines do not fit into one process, so the program with the old engine writes a
//! [trace](crate::flight::Tracer), and the program with the new one
//! [compares](crate::flight::Comparison) it with its own results:
//!
//! ```
//! use mujoco_safe::flight::{Comparison, Tracer};
//! use mujoco_safe::{Controller, Data, RandomController, sample};
//!
//! // With the old engine.
//! let mut data = Data::new(sample::humanoid())?;
//! let mut controller = RandomController::new(1);
//! let mut tracer = Tracer::new(Vec::new(), None)?; // or a file
//! for _ in 0..20 {
//!     controller.control(&mut data)?;
//!     tracer.step(&mut data)?;
//! }
//! let trace = tracer.finish()?;
//!
//! // With the new engine. Here, a mass stands for its differences.
//! let mut model = sample::humanoid();
//! let foot = model.body("left_foot")?.index();
//! model.edit().body_mass_mut()[foot] *= 1.01;
//! let comparison = Comparison::new(&trace[..], Some(&model))?;
//! let of_model = &comparison.divergences[0];
//! assert_eq!(of_model.field, "body_mass");
//! assert_eq!(of_model.element, "body 'left_foot'");
//! println!("{comparison}");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! The example `replay` does the same for a model or a recording, without a program. It needs a
//! build with each engine, for instance:
//!
//! ```text
//! MUJOCO_DIR=old cargo build --release --example replay --target-dir target/old
//! MUJOCO_DIR=new cargo build --release --example replay --target-dir target/new
//! replay=release/examples/replay
//! target/new/$replay compare robot.xml --other target/old/$replay
//! ```
//!
//! The script `scripts/compare-engines` of the repository does this for a list of models, and
//! prints a table.
//!
//! # Reading the report
//!
//! Differences with the stage `model` come first. They are of the compiler, or of defaults, and
//! usually cause the others. Then the first stage that differs makes a difference, because all
//! calls start from the state in the trace and the earlier stages agree. Each line has both
//! values, the difference, and the effect of rounding on the value. [`flight`](crate::flight) has
//! the criterion.
