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
//! let foot = model.body("foot_left")?.index();
//! model.edit().body_mass_mut()[foot] *= 1.01;
//! let comparison = Comparison::new(&trace[..], Some(&model))?;
//! let of_model = &comparison.divergences[0];
//! assert_eq!(of_model.field, "body_mass");
//! assert_eq!(of_model.element, "body 'foot_left'");
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
//!
//! # From 2.2.2 to 4.0.1
//!
//! The script has compared 33 models of packages in 20 steps with random controls each: those of
//! this repository and of MuJoCo, Gymnasium, dm_control, robosuite, Brax, Gymnasium-Robotics and
//! Meta-World.
//!
//! | models | first difference beyond rounding | likely cause, and remedy |
//! |---|---|---|
//! | 14, such as `humanoid`, `half_cheetah`, `walker2d_v5`, `cartpole`, `manipulator`, `humanoid_CMU` | none | |
//! | `acrobot`, `fish` | `body_iquat`; no stage of a step differs | bodies with equal moments of inertia have no unique principal axes: nothing to do |
//! | `quadruped` | `body_iquat`, `geom_size` of a height field; no stage differs | the box around the height field: nothing to do |
//! | `reacher`, `ball_in_cup` | `body_invweight0` is 1.5 times as large; no stage differs yet | the mean over the directions in which the body can move, formerly over three: contacts of the body become softer, see `solref` |
//! | `pusher_v5` | `make_constraint`: `efc_margin` is doubled; then `efc_R` | since 3.5 margins of two geoms are added: halve `margin`. `body_invweight0` of a nearly massless body: give it a mass |
//! | `ant`, `humanoid` of Gymnasium | `integration`: next `qpos` by 10⁻¹¹ and 10⁻⁹ | RK4 starts the solver of its four evaluations equally since 3.3.6: nothing to do |
//! | `rodent` | `compute_crb`: the inertia by 10⁻⁷ of its value | constants of the compiler by 10⁻¹⁰: nothing to do |
//! | `dog`, `ur5e`, `kinova3`, `iiwa`, `convex_convex`, `manipulate_block` | `kinematics`: `xipos`, `geom_xpos` by 10⁻⁹ to 10⁻² of the value | frames and inertia of meshes: set `inertia` of the mesh; a measured `<inertial>` does not depend on it |
//! | `panda`, `gr1`, `pick_and_place` | as before, then `collision` | as before; convex collisions are native since 3.3: `nativeccd="disable"` restores the earlier algorithm |
//! | `sawyer_door_pull`, `pick_and_place` | also `body_weldid` of a mocap body | since 3.12 it is the root of its own weld group: children of mocap bodies collide as children do |
//!
//! Models that one of the two does not load were left out: newer attributes such as `inertia` of a
//! mesh, elements that were removed such as composite particles, and a muscle of which 2.2.2 does
//! not find the range of lengths.
