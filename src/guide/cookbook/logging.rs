//! Saving and logging: CSV, NumPy, MCAP, lines of text.
//!
//! A [`Trajectory`](crate::Trajectory) records times, states and controls, and sensor readings if
//! it is created by [`with_sensordata`](crate::Trajectory::with_sensordata). `save_csv` writes a
//! table with a header, and [`load_csv`](crate::Trajectory::load_csv) reads it again without loss.
//!
//! ```
//! use mujoco_safe::{Data, RandomController, Trajectory, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! let mut controller = RandomController::new(1);
//! let mut trajectory = Trajectory::with_sensordata(data.model());
//! for _ in 0..10 {
//!     trajectory.record(&mut data, &mut controller, 20)?;
//!     eprintln!("{:.1} s: qpos {:.3?}, ctrl {:.3?}", data.time(), data.qpos(), data.ctrl());
//! }
//! let path = std::env::temp_dir().join("mujoco_safe_cartpole.csv");
//! trajectory.save_csv(&path)?;
//! let saved = Trajectory::load_csv(data.model(), &path)?;
//! assert_eq!((saved.len(), saved.states()), (200, trajectory.states()));
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! With the feature `npz`, `save_npz` writes the same for `numpy.load`, and `npz::save` any other
//! arrays, here the height of the centre of mass:
//!
#![cfg_attr(feature = "npz", doc = "```")]
#![cfg_attr(not(feature = "npz"), doc = "```ignore")]
//! use mujoco_safe::npz::{self, Array};
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let mut heights = Vec::new();
//! for _ in 0..50 {
//!     data.step()?;
//!     heights.push(data.body("torso")?.subtree_com()[2]);
//! }
//! let path = std::env::temp_dir().join("mujoco_safe_heights.npz");
//! npz::save(&path, &[Array::new("height", &[heights.len()], &heights)])?;
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! With the feature `mcap`, a log contains what Foxglove and Rerun show, also of a running
//! simulation. The page [`logs`](crate::guide::logs) describes both programs.
//!
#![cfg_attr(feature = "mcap", doc = "```")]
#![cfg_attr(not(feature = "mcap"), doc = "```ignore")]
//! use mujoco_safe::mcap::Log;
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let path = std::env::temp_dir().join("mujoco_safe_humanoid.mcap");
//! let mut log = Log::create(&path, data.model())?;
//! for _ in 0..200 {
//!     log.step(&mut data)?;
//! }
//! log.finish()?;
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! The feature `serde` stores trajectories, states and options in other formats. Warnings of the
//! engine are messages of the crate [`log`](https://docs.rs/log): with `env_logger::init();`
//! (`cargo add env_logger`) and `RUST_LOG=mujoco=warn` they appear on the terminal.
