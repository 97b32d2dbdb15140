//! Tests of a robot in continuous integration.
//!
//! A test loads the robot's model, runs its controller and checks the result. Equal programs give
//! equal results on the same library and kind of processor, so a test does not fail by chance. In
//! `tests/robot.rs` each of these functions has the attribute `#[test]`:
//!
//! ```
//! use mujoco_safe::{Data, Lqr, LqrWeights, Result, sample};
//!
//! fn the_model_compiles_without_warnings() {
//!     let model = sample::cartpole(); // or Model::from_xml_path("robot.xml")
//!     assert!(model.compile_warnings().is_empty(), "{:?}", model.compile_warnings());
//! }
//!
//! fn the_regulator_recovers_from_a_push() -> Result<()> {
//!     use mujoco_safe::Controller;
//!
//!     let mut data = Data::new(sample::cartpole())?;
//!     let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
//!     let mut lqr = Lqr::at_present_state(&mut data, &weights)?;
//!     data.qvel_mut()[1] = 0.5;
//!     let mut largest = 0.0_f64;
//!     for _ in 0..500 {
//!         lqr.control(&mut data)?;
//!         largest = largest.max(data.ctrl()[0].abs());
//!         data.step()?; // a diverged simulation is an error
//!     }
//!     assert!(data.qpos()[1].abs() < 1e-3, "the pole is at {} rad", data.qpos()[1]);
//!     assert!(largest < 1.0, "the motor saturates");
//!     Ok(())
//! }
//!
//! fn a_run_has_no_warnings_and_is_reproducible() -> Result<()> {
//!     let run = || {
//!         let mut data = Data::new(sample::humanoid())?;
//!         data.reset_to_key("squat")?;
//!         data.step_n(500)?;
//!         assert_eq!(data.warnings().next(), None);
//!         Ok::<_, mujoco_safe::Error>(data.physics_state())
//!     };
//!     assert_eq!(run()?, run()?);
//!     Ok(())
//! }
//! # the_model_compiles_without_warnings();
//! # a_run_has_no_warnings_and_is_reproducible()?;
//! # the_regulator_recovers_from_a_push()?;
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A machine for continuous integration needs the engine, a C++ compiler and no display:
//!
//! ```sh
//! sudo apt-get install libmujoco-dev g++   # Debian 12; elsewhere the feature download
//! cargo test
//! ```
//!
//! The feature `download` needs pip, and keeps the engine in `~/.cache/mujoco-safe`. A workflow of
//! GitHub can cache it:
//!
//! ```yaml
//! jobs:
//!   test:
//!     runs-on: ubuntu-latest
//!     steps:
//!       - uses: actions/checkout@v4
//!       - uses: actions/cache@v4
//!         with:
//!           path: |
//!             ~/.cache/mujoco-safe
//!             ~/.cargo/registry
//!             target
//!           key: ${{ hashFiles('Cargo.lock') }}
//!       - run: cargo test
//! ```
//!
//! Tests that draw also need `libvulkan1 mesa-vulkan-drivers`, and tests of windows `xvfb-run cargo
//! test`.
