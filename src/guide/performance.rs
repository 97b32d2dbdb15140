//! Performance: allocation, shared models, build profiles, builds of the engine, measurements.
//!
//! # Costs of a step
//!
//! The engine takes nearly all of the time of a step. [`Data::step`] adds some tens of nanoseconds
//! to the C call for its checks; the [figures](#measurements) compare both. The largest savings are
//! in the model and in the number of calls:
//!
//! - **Do not compute twice.** [`Data::step`] contains [`Data::forward`]. A loop that calls both
//!   takes twice the time. Read quantities one step late, or split the step into
//!   [`step1`](Data::step1) and [`step2`](Data::step2).
//! - **Contacts.** Collision detection and the constraint solver dominate models with contacts.
//!   Exclude pairs that cannot touch (`contype`, `conaffinity`, `exclude` in MJCF), and replace
//!   meshes by primitive shapes.
//! - **Solver.** [`Options`](crate::Options) sets the solver, its iterations and its tolerance.
//!   [`Data::solver`] returns the statistics of each iteration.
//! - **Time step.** A longer step with an implicit integrator can be stable where Euler is not:
//!   [`Integrator::Implicit`](crate::enums::Integrator::Implicit).
//!
//! # Allocation
//!
//! Steps, forward and inverse dynamics, state vectors with `_into`, named access by id, contacts
//! and their forces, Jacobians with `_into`, rays, scenes, linearisation into outputs, and the
//! regulators allocate nothing. A test counts the allocations of Rust, C and C++. These calls
//! allocate:
//!
//! | allocates | alternative |
//! |---|---|
//! | [`Data::state`], [`Data::physics_state`] | [`state_into`](Data::state_into), [`physics_state_into`](Data::physics_state_into) |
//! | [`Data::jac_site`] and other functions that return a [`Matrix`] | [`jac_site_into`](Data::jac_site_into), … |
//! | [`Data::transition_fd`] | [`transition_fd_into`](Data::transition_fd_into), [`Lineariser::linear_system_into`](crate::Lineariser::linear_system_into) |
//! | [`Riccati::solve`](crate::control::riccati::Riccati::solve) | [`solve_into`](crate::control::riccati::Riccati::solve_into) with a workspace |
//! | [`Data::clone`] | [`copy_from`](Data::copy_from) into an existing simulation |
//! | [`Trajectory::new`](crate::Trajectory::new) while it grows | [`Trajectory::with_capacity`](crate::Trajectory::with_capacity), [`reserve`](crate::Trajectory::reserve) |
//! | [`Rollout::new`](crate::rollout::Rollout::new) for each run | [`Rollout::on`](crate::rollout::Rollout::on) with [`Workers`](crate::rollout::Workers), [`run_into`](crate::rollout::Rollout::run_into) |
//! | the first [`Data::edit_model`] of a shared model | later edits of the same simulation copy nothing |
//!
//! ```
//! use mujoco_safe::{Data, Matrix, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let foot = data.model().site("sole_left")?.id();                // look up once
//! let mut linear = Matrix::zeros(3, data.model().nv());           // allocate once
//! for _ in 0..10 {
//!     data.step()?;
//!     data.jac_site_into(foot, Some(&mut linear), None)?;         // no angular part
//! }
//! assert!(linear.as_slice().iter().any(|&entry| entry != 0.0));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Models
//!
//! Wrap the model in an `Arc` and clone the `Arc`. [`Data::new`] with a [`Model`] moves it into a
//! new `Arc`. Each edit of a shared model by [`Data::edit_model`] copies the model once, with its
//! meshes and textures; a rollout with
//! [`with_model_edits`](crate::rollout::Rollout::with_model_edits) reuses its copies. With 2.2.2
//! and 3.5.0, loading a binary model ([`Model::from_binary_path`]) skips the XML compiler, which
//! can take seconds for large meshes.
//!
//! # Threads
//!
//! Simulations in different threads do not share locks, so throughput grows with the number of
//! cores until the memory bandwidth limits it. See [`parallel`](super::parallel). Linearisations
//! along trajectories, and those by differences, use several threads on request:
//! [`TransitionOptions::with_threads`](crate::derivative::TransitionOptions::with_threads).
//!
//! # Build profiles
//!
//! Measure release builds: `cargo run --release`. The engine is optimised in every profile, but
//! accessors and controllers are not. For a debug build with usable speed, optimise the
//! dependencies:
//!
//! ```toml
//! [profile.dev.package."*"]
//! opt-level = 2
//! ```
//!
//! `lto = "thin"` and `codegen-units = 1` in `[profile.release]` concern only Rust code, the
//! controllers and the Riccati solver, not the engine.
//!
//! # Builds of the engine
//!
//! Debian's library and the official ones, in the release archive and in the wheel for Python, are
//! compiled by other compilers with other options. Their speeds differ, and so do the last bits of
//! their results. Compare them on your machine, each with its own target directory:
//!
//! ```sh
//! cargo bench --bench step                                                          # Debian's library
//! MUJOCO_DIR=/opt/mujoco-2.2.2 CARGO_TARGET_DIR=target/official cargo bench --bench step
//! ```
//!
//! The page [`engines`](super::engines) describes `MUJOCO_DIR`.
//!
//! # Measurements
//!
//! Ratios to the same call in C, medians with confidence intervals, on a virtual machine with two
//! cores of an AMD EPYC:
//!
//! | | time | ratio | command |
//! |---|---|---|---|
//! | [`Data::step`], humanoid | 43 µs | 1.000 [0.998, 1.003] | `cargo bench --bench step` |
//! | [`Data::step`], cart-pole | 1.7 µs | 0.993 [0.992, 0.994] | |
//! | [`Data::step`], 22 humanoids | 0.8 ms | 0.999 [0.994, 1.004] | |
//! | [`Data::transition_fd_into`], humanoid, A and B | 1.7 ms | 1.001 [1.000, 1.002] | `cargo bench --bench transition_fd` |
//! | the same in closed form, by a [`Lineariser`](crate::Lineariser) | 51 µs | 0.030 [0.030, 0.031] | |
//! | the same with elliptic cones and equality constraints | | 0.023 [0.023, 0.023] | |
//! | the same of the cart-pole | | 0.299 [0.299, 0.300] | |
//! | humanoid, by implicit differentiation | | 0.438 [0.437, 0.440] | |
//! | the same in two threads | | 0.28 [0.27, 0.29] | |
//! | [`Data::jac_body_com_into`] | 93 ns | 1.006 [1.005, 1.006] | `cargo bench --bench jacobian` |
//!
//! A step takes no longer than in C because the check of the inputs replaces the engine's own,
//! which makes a function call for each number. The Riccati equation of the humanoid, with 54
//! states and 21 controls, is solved with a relative residual of 2·10⁻¹³
//! (`cargo bench --bench riccati`). The humanoid's regulator computes its controls in 0.4 µs
//! without allocation; as a closure that allocates vectors it takes 1.08 times as long
//! (`cargo bench --bench controller`). A tick of [inverse kinematics](crate::ik) of the humanoid
//! with six tasks takes 0.059 times as long as with mink 1.3 and daqp, 19 µs, with smaller errors
//! of the tasks (`MUJOCO_PYTHON=python3 cargo bench --bench ik`).
//!
//! Derivatives of rigid bodies, relative to those of Pinocchio 4.0.0 and Crocoddyl 3.2.1, which
//! Python calls for each result (`MUJOCO_PYTHON=python3 cargo bench --bench rigid_body`). For the
//! arm, all elements agree to 3·10⁻¹⁵ of the largest one:
//!
//! | | arm, 6 degrees of freedom | humanoid, 27 |
//! |---|---|---|
//! | [`inverse_jacobians_into`](crate::Lineariser::inverse_jacobians_into), `computeRNEADerivatives` | 0.59, 4.4 µs | 0.85, 21 µs |
//! | [`joint_regressor_into`](Data::joint_regressor_into), `computeJointTorqueRegressor` | 0.72, 4.4 µs | 0.87, 21 µs |
//! | [`linear_system_into`](crate::Lineariser::linear_system_into), `IntegratedActionModelEuler.calcDiff` | 0.43, 5.2 µs | 0.51, 31 µs |
//! | the same, `computeABADerivatives` without an integrator | 0.61 | 0.84 |
//!
//! [Identification](crate::identification) of a mass on a spring takes 0.29 times as long as with
//! the engine's `mujoco.sysid`, of five armatures of an arm 0.56 times, of 20 unknowns of the arm
//! and its load 0.074 times, with two cores. The largest errors of the found values are 1·10⁻¹³,
//! 1·10⁻¹⁵ and 5·10⁻¹⁵ here, and 2·10⁻¹³, 6·10⁻⁴ and 9·10⁻³ there
//! (`MUJOCO_DIR=$(scripts/engine 3.17.0) MUJOCO_PYTHON=python3 cargo bench --bench identification`,
//! with `mujoco[sysid]==3.17.0`).
//!
//! Frames per second of processor time relative to the engine's own renderer, with the same
//! settings and software rendering (Mesa's Vulkan and OpenGL), in alternation
//! (`MUJOCO_PYTHON=python3 cargo bench --features renderer --bench render`):
//!
//! | | 640×480 | 1280×720 |
//! |---|---|---|
//! | humanoid, shadows and reflections | 2.83 [2.66, 3.26] | 2.72 [2.60, 2.75] |
//! | 22 humanoids | 2.65 [2.56, 2.81] | 2.26 [2.23, 2.28] |
//! | the engine's `humanoid100` | 1.89 [1.84, 2.09] | 1.81 [1.70, 1.86] |
//!
//! At 640×480, by the features that take most of the time:
//!
//! | | all | 1 sample per pixel | no shadows | neither |
//! |---|---|---|---|---|
//! | 1,000 grains | 2.02 [1.93, 2.05] | 1.85 [1.71, 1.95] | 1.22 [1.17, 1.26] | 1.27 [1.12, 1.39] |
//! | arm of 56 meshes with 3,840 triangles each | 2.06 [2.03, 2.10] | 1.97 [1.83, 2.07] | 1.19 [1.12, 1.26] | 1.26 [1.17, 1.29] |
//! | mirror | 1.73 [1.58, 1.82] | 1.90 [1.82, 2.09] | 1.14 [1.09, 1.19] | 1.20 [1.18, 1.21] |
//! | 7 lights, 5 of which cast shadows | 3.52 [3.38, 3.79] | 3.82 [3.45, 4.47] | 1.03 [0.98, 1.03] | 1.05 [0.94, 1.17] |
//! | cloth with a skin of 37,632 triangles | 1.63 [1.48, 1.69] | 1.64 [1.55, 1.89] | 1.00 [0.95, 1.03] | 1.00 [0.95, 1.04] |
//!
//! Repeated runs of the last two columns vary by 0.05. A fine skin without shadows takes as long as
//! with the engine.
//!
//! At 84×84 the humanoid is drawn 10.4 [10.0, 11.0] times as fast.
//!
//! The first image of the humanoid takes 0.21 s [0.20, 0.21], and 0.64 s [0.63, 0.67] before Mesa
//! has cached its compiled shaders on disk.
//!
//! `scripts/compare` measures this crate, the engine called from C, the official Python bindings,
//! SciPy, NumPy and SLICOT in one run: steps, rollouts, batches (from 3.17 also with
//! `mujoco.batch`), linearisations, Riccati equations and control laws; then it runs the benchmarks
//! beside mink, Pinocchio, Crocoddyl and `mujoco.sysid`. `MUJOCO_PYTHON` is an interpreter with
//! `mujoco==2.2.2`, `numpy<2`, SciPy and PyOpenGL; `scripts/compare` creates one if it finds a
//! Python 3.7 to 3.10.
//!
//! `cargo bench` in this repository compares each call with the raw C call in one process, and
//! prints the ratio with its confidence interval (`cargo bench -- ÷` prints only the ratios). In a
//! program, the engine's timers show the parts of a step:
//!
//! ```
//! use mujoco_safe::data::{Timer, enable_timers};
//! use mujoco_safe::{Data, sample};
//!
//! enable_timers(); // before the first step; without a clock, the timers only count
//! let mut data = Data::new(sample::humanoid())?;
//! data.step_n(100)?;
//! for timer in Timer::ALL {
//!     let total = data.timer(timer);
//!     println!("{timer:?}: {} calls, {:.1} µs each", total.number, 1e6 * total.duration / total.number.max(1) as f64);
//! }
//! assert_eq!(data.timer(Timer::Step).number, 100);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A profiler such as `perf` attributes time to the engine's functions only if the library has
//! symbols. The viewer plots the timers.
//!
//! # Rendering
//!
//! Keep [`Scene`](crate::Scene) and renderer, and write to existing images with `rgb_into`.
//! Rendering with a software driver is proportional to the number of pixels and samples: reduce the
//! size, the samples and the shadow maps (`RendererOptions`), or switch shadows and reflections off
//! ([`RenderFlags`](crate::scene::RenderFlags)). Render only frames that are due;
//! [`pictures`](super::pictures#animations) shows how.
//!
//! The figures above do not hold for graphics cards, whose cost is triangles, shadow maps and the
//! work of the driver for each image. On an NVIDIA H200, which is made for computing and slow at
//! triangles, with Vulkan, 16 processors and MuJoCo 4.0.1, one thread drew these images per second,
//! relative to the engine's renderer with EGL (`scripts/gpu-bench`, one run; medians of 9 pairs;
//! Panda: an earlier run, with MuJoCo 4.0.0):
//!
//! | scene | image | 84×84 | 256×256 | 640×480 |
//! |---|---|---|---|---|
//! | humanoid | colours | 22 | 8.3 | 3.4 |
//! | | depth | 28 | 18 | 9.2 |
//! | | segmentation | 1.7 | 3.1 | 3.8 |
//! | 22 humanoids | colours | 6.2 | 1.7 | 1.1 |
//! | | depth | 11 | 12 | 8.7 |
//! | | segmentation | 1.0 | 1.5 | 2.2 |
//! | arm of 215,000 triangles | colours | 0.92 | 0.86 | 0.88 |
//! | | depth | 10 | 8.1 | 4.8 |
//! | | segmentation | 1.4 | 3.0 | |
//! | Panda of robosuite, 141,000 triangles | colours | 2.1 | 0.95 | 0.81 |
//! | | depth | 1.2 | 1.4 | 1.5 |
//! | | segmentation | 1.2 | 2.3 | 4.1 |
//!
//! The colours of the arm and of the 22 humanoids were measured while their floors, of 4 and 20 m,
//! cast shadows that nothing visible received, and filled the shadow maps. Such floors now cast no
//! shadow, as infinite ones did not before; the colours were not measured again. In software (two
//! cores, MuJoCo 4.0.1) this cuts the time of an image of the arm with 84×84 pixels, from 47 to
//! 26 ms. The run ended before the missing figure.
//!
//! Of the humanoid at 84×84, one thread draws 3,850 images per second by single calls, four threads
//! 9,100, and sixteen about as many as four; with one sample and without shadows one thread draws
//! 5,200, four 15,200 and sixteen 20,000. One call for 1,024 simulations (`rgb_batch_into`), in
//! other poses and from the side of the free camera, draws, in the same run:
//!
//! | scene | images of a submission together | one after another | processor time per image |
//! |---|---|---|---|
//! | humanoid 84×84 | 10,900 | 7,500 | 85 µs, of which states and scenes 24 |
//! | humanoid 84×84, 1 sample, no shadows | 16,400 | 12,000 | 59 µs, 16 |
//! | cart-pole 64×64 | 31,700 | 13,800 | 31 µs, 2 |
//! | cart-pole 64×64, 1 sample, no shadows | 51,000 | 28,500 | 20 µs, 0 |
//!
//! Both columns are of one call; the second is what adapters do that cannot draw images together.
//! On a machine with a faster processor and the same card, the last row was 91,200 and 47,600.
//!
//! After this run, an image no longer computes the whole position stage, only what it shows, and a
//! thread that waits for the card sleeps. In software (two cores) this cuts the calling thread's
//! processor time per image of the humanoid from 54 to 30 µs, and of the cart-pole from 20 to 16.
//! It was not measured again on the card.

#[cfg(doc)]
use crate::{Data, Matrix, Model};
