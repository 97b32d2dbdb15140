//! The [MuJoCo](https://mujoco.org) physics engine for Rust: safe, and as fast as the C call.
//!
//! ```
//! use std::sync::Arc;
//! use mujoco_safe::{Controller, Data, Lqr, LqrWeights, Trajectory, sample};
//!
//! // Simulations share the model.
//! let model = Arc::new(sample::cartpole()); // or Model::from_xml_path("cartpole.xml")?
//! let mut data = Data::new(model.clone())?;
//!
//! // An unknown name is an error that lists the valid names.
//! let hinge = model.joint("hinge")?;
//!
//! // Linearise a step about the upright position and compute the regulator.
//! let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
//! let mut lqr = Lqr::at_present_state(&mut data, &weights)?;
//!
//! // Tilt the pole and record its recovery.
//! data.joint_mut(hinge).qpos_mut()[0] = 0.1;
//! let mut trajectory = Trajectory::new(&model);
//! trajectory.record(&mut data, &mut lqr, 1000)?;
//! assert!(data.joint(hinge).qpos()[0].abs() < 1e-3);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Data flow
//!
//! ```text
//! humanoid.xml ──load──▶ Model ──Arc──▶ Data ──qpos, qvel──▶ Controller ──ctrl──▶ Data::step
//!                        sizes, ids,     │  ▲                                          │
//!                        names, options  │  └── reset, reset_to_key, set_state          ▼
//!                                        │                                 Trajectory ─▶ CSV
//!                                        ├── Scene ─▶ Renderer ─▶ PNG, GIF, MP4; Viewer
//!                                        └── transition_fd ─▶ StateSpace ─▶ Lqr ─▶ gains K
//! ```
//!
//! - [`Model`]: description of a mechanism. Loaded from MJCF, URDF or MJB, edited by
//!   [`Model::edit`] before it is shared and by [`Data::edit_model`] afterwards. [`Options`],
//!   [`Visual`](model::Visual) and [`Statistics`](model::Statistics) are typed and checked.
//! - [`spec`]: models in code, built element by element and joined with others.
//! - [`Data`]: a simulation. Every array of the engine is a method with the engine's name:
//!   [`Data::qpos`], [`Data::ctrl_mut`], [`Data::xfrc_applied_mut`], [`Model::body_mass`]. So is
//!   every function: `mj_step` is [`Data::step`], `mj_jacBodyCom` is [`Data::jac_body_com`]. The
//!   search of this documentation finds them by their C names.
//! - [`element`]: named access to single elements (joints, bodies, sensors, …) of all 23 kinds.
//! - [`Matrix`]: row-major matrices as the engine writes them, with nalgebra views of the same
//!   memory. [`math`] wraps the engine's mathematics.
//! - [`callback`]: closures inside a step.
//! - [`controller`]: the [`Controller`] trait and simple controllers.
//! - [`derivative`], [`control`]: linearisation, the Riccati equation, LQR, iLQR.
//! - [`estimation`]: Kalman filter and smoother. [`identification`]: parameters from measurements,
//!   by [`least_squares`].
//! - [`ik`]: inverse kinematics with tasks, priorities and limits.
//! - [`rollout`]: many simulations on all cores. [`environment`]: tasks of reinforcement learning.
//! - [`Trajectory`]: recorded states and controls.
//! - [`scene`]: abstract visualisation of a simulation. [`render`][render] draws it,
//!   [`record`][record] writes animations, [`viewer`][viewer-module] opens a window.
//! - [`sample`]: sample models.
//!
//! The [`guide`] explains the concepts, with pages for users of Python and MuJoCo.jl and a table of
//! common problems. The [`prelude`] imports the names that most programs need. The
//! [`cookbook`](guide::cookbook) has complete programs, [`promises`](guide::promises) lists the
//! guarantees with their tests, and [`coverage`](guide::coverage) lists the counterpart of each
//! function, field and kind of the engine. [`Model::field_docs`] returns the engine's description
//! of a field.
//!
//! # Guarantees
//!
//! No call without `unsafe` can crash the process, access memory out of bounds, end the program,
//! wait on standard input or write a file that the caller did not name (the viewer
//! [remembers](viewer::ViewerOptions::layout) its layout). Where the engine prints a
//! message and exits, a call returns an [`Error`]; also where the engine would silently reset the
//! simulation or return values of another state. The known exception is the compilation of XML: see
//! [`Model::from_xml_str`].
//!
//! Mistakes in the program, such as the use of an id of another model, panic. Functions for control
//! loops do not allocate, except those that return a `Vec` or a [`Matrix`].
//!
//! # Features
//!
//! All features are off by default. `renderer`: rendering and animations, without a window or a
//! display. `viewer`: the window. `mjz`: models and their files in one archive, as MuJoCo's `.mjz`.
//! `npz`: trajectories, rollouts and other arrays as NumPy files. `mcap`: logs for Foxglove and
//! Rerun. `html`: trajectories as web pages. `live`: running simulations in a browser. `gltf`:
//! trajectories as animated glTF files. `ndarray`: matrices as arrays of the crate `ndarray`,
//! without a copy. `serde`: options, states, matrices and trajectories as plain data in the formats
//! of serde. `bindgen`: bindings for an engine without committed ones. `download`: the build
//! installs MuJoCo if it finds no engine (see
//! [`guide::engines`]).
//!
//! # Units and conventions
//!
//! SI units: metres, seconds, radians, kilograms, newtons. Quaternions are `[w, x, y, z]`. Indices
//! count from 0. The number of positions `nq` differs from the number of degrees of freedom `nv` if
//! there are free or ball joints.
//!
#![cfg_attr(feature = "viewer", doc = include_str!("guide/links/with_viewer.md"))]
#![cfg_attr(not(feature = "viewer"), doc = include_str!("guide/links/without_viewer.md"))]

// The page of a type in the documentation has the methods in the order of the modules that declare
// them: loading a model comes first, the generated accessors come last.
//
// Modules import each other without cycles, except `data` and `model`: a simulation belongs to a
// model, and loading a model simulates its muscles to find their ranges of lengths.
pub mod model;

pub mod data;

pub mod element;

pub mod callback;
#[doc(alias = "optimal control")]
#[doc(alias = "linear quadratic regulator")]
pub mod control;
pub mod controller;
#[doc(alias = "linearise")]
#[doc(alias = "linearize")]
#[doc(alias = "linearisation")]
#[doc(alias = "linearization")]
pub mod derivative;
mod engine;
pub mod enums;
#[doc(alias = "gym")]
#[doc(alias = "gymnasium")]
#[doc(alias = "reinforcement learning")]
pub mod environment;
mod error;
#[doc(alias("kalman", "ekf", "state estimation", "filter", "smoother"))]
pub mod estimation;
mod ffi;
mod field_docs;
mod file;
#[doc(alias = "black box")]
#[doc(alias = "replay")]
#[doc(alias = "reproduce")]
#[doc(alias("regression", "upgrade", "determinism", "compare engines"))]
pub mod flight;
#[cfg(feature = "gltf")]
#[doc(alias("glb", "export", "blender", "usd", "obj"))]
pub mod gltf;
pub mod guide;
#[cfg(feature = "html")]
#[doc(alias = "browser")]
#[doc(alias = "web")]
#[doc(alias = "replay")]
pub mod html;
pub mod id;
#[doc(alias("system identification", "sysid", "parameter estimation", "calibration"))]
pub mod identification;
#[doc(alias = "inverse kinematics")]
#[doc(alias = "differential ik")]
#[doc(alias = "mink")]
pub mod ik;
pub mod kind;
mod layout;
#[doc(alias("levenberg-marquardt", "gauss-newton", "curve fit", "minimize"))]
pub mod least_squares;
#[cfg(feature = "live")]
#[doc(alias("browser", "web viewer", "websocket", "remote", "ssh"))]
pub mod live;
mod macros;
pub mod math;
pub mod matrix;
#[cfg(feature = "mcap")]
#[doc(alias = "foxglove")]
#[doc(alias = "rerun")]
pub mod mcap;
mod memory;
mod messages;
#[cfg(feature = "npz")]
#[doc(alias = "numpy")]
pub mod npz;
mod numerics;
mod parallel;
pub mod prelude;
#[cfg(feature = "renderer")]
#[doc(alias = "ffmpeg")]
pub mod record;
#[cfg(feature = "renderer")]
pub mod render;
#[cfg(any(feature = "html", feature = "gltf"))]
#[cfg_attr(not(all(feature = "html", feature = "gltf")), allow(dead_code, unused_imports))] // each uses a part
mod replay;
pub mod rollout;
pub mod sample;
pub mod scene;
#[cfg(feature = "serde")]
mod serialise;
#[cfg(any(feature = "renderer", feature = "html", feature = "gltf"))]
#[cfg_attr(not(feature = "renderer"), allow(dead_code, unused_imports))] // files use a part
mod shape;
pub mod spec;
mod stage;
mod trajectory;
mod version;
#[cfg(feature = "viewer")]
#[doc(alias = "gui")]
#[doc(alias = "visualise")]
#[doc(alias = "visualise!")]
#[doc(alias = "visualize")]
#[doc(alias = "visualiser")]
#[doc(alias = "visualizer")]
#[doc(alias = "init_visualiser")]
#[doc(alias = "install_visualiser")]
#[doc(alias = "launch_passive")]
#[doc(alias = "launch_from_path")]
pub mod viewer;
#[cfg(all(feature = "viewer", target_os = "linux"))]
mod x11;
#[cfg(any(feature = "mjz", feature = "npz"))]
mod zip_file;

mod generated;

/// The linear algebra crate of the views of matrices, in the version that this crate uses.
pub use nalgebra;

/// The crate of the arrays that matrices lend (feature `ndarray`), in the version that this crate
/// uses.
#[cfg(feature = "ndarray")]
pub use ndarray;

/// The crate of the thread pools that run rollouts, in the version that this crate uses.
pub use rayon;

/// The raw bindings, for calls that this crate does not wrap.
#[doc(alias = "LibMuJoCo")]
pub use mujoco_sys as sys;

pub use crate::control::{Lqr, LqrWeights};
pub use crate::controller::{Controller, PdController, RandomController, ZeroController};
pub use crate::data::{Data, Stage, StateSpec};
pub use crate::derivative::{Differences, Lineariser, StateSpace};
pub use crate::error::{Error, InvalidKind, Result};
use crate::macros::with_aliases;
pub use crate::matrix::{Matrix, MatrixView, MatrixViewMut};
pub use crate::model::{LoadOptions, Model, ModelMut, Options};
pub use crate::rollout::{Batch, Rollout};
pub use crate::scene::Scene;
pub use crate::trajectory::Trajectory;
pub use crate::version::Version;

with_aliases! {
    pub use crate::engine::{
        engine_version = "mj_version" "mj_versionString",
        load_plugins = "mj_loadPluginLibrary" "mj_loadAllPluginLibraries",
    };
    pub use crate::version::{built_against = "mjVERSION_HEADER"};
}

/// Compiles the README's examples as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
