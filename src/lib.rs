//! The [MuJoCo](https://mujoco.org) physics engine for Rust: safe, and as fast as the C call.
//!
//! ```
//! use std::sync::Arc;
//! use mujoco_safe::{Controller, Data, Lqr, LqrWeights, Trajectory, sample};
//!
//! // A model is loaded once and shared; a simulation holds on to it.
//! let model = Arc::new(sample::cartpole()); // or Model::from_xml_path("cartpole.xml")?
//! let mut data = Data::new(model.clone())?;
//!
//! // Elements by name: an unknown one is an error that lists the names there are.
//! let hinge = model.joint("hinge")?;
//!
//! // Linearise a step about the upright position and solve for the regulator.
//! let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
//! let mut lqr = Lqr::at_present_state(&mut data, &weights)?;
//!
//! // Let the pole lean, and record how it comes back.
//! data.joint_mut(hinge).qpos_mut()[0] = 0.1;
//! let mut trajectory = Trajectory::new(&model);
//! trajectory.record(&mut data, &mut lqr, 1000)?;
//! assert!(data.joint(hinge).qpos()[0].abs() < 1e-3);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # The way through
//!
//! ```text
//!  humanoid.xml ──load──▶ Model ──Arc──▶ Data ──qpos, qvel──▶ Controller ──ctrl──▶ Data::step ──▶ Trajectory ──▶ CSV
//!                         sizes, ids,     │  ▲
//!                         names, options  │  └── reset, reset_to_key, set_state
//!                                         ├── Scene ─▶ Renderer ─▶ PNG, GIF, MP4; Viewer
//!                                         └── transition_fd ─▶ StateSpace (A, B, C, D) ─▶ Lqr (Riccati) ─▶ K
//! ```
//!
//! - [`Model`]: what is simulated. Loaded from MJCF, URDF or MJB, constant once it is shared, changed through
//!   [`Model::edit`] before and [`Data::edit_model`] after. [`Options`], [`Visual`] and [`Statistics`] are typed and checked.
//! - [`Data`]: a simulation. Every array of the engine is a method of the engine's name: [`Data::qpos`],
//!   [`Data::ctrl_mut`], [`Data::xfrc_applied_mut`], [`Model::body_mass`]. So is every function: `mj_step` is
//!   [`Data::step`], `mj_jacBodyCom` is [`Data::jac_body_com`]; the search of this documentation finds them by their C names.
//! - [`element`]: one joint, body, sensor, … by its name: all 21 kinds.
//! - [`Matrix`]: row-major, as the engine writes, and nalgebra's view of it without a copy. [`math`] is the engine's own.
//! - [`callback`]: closures in the middle of a step.
//! - [`derivative`], [`control`]: linearisation, the Riccati equation, LQR.
//! - [`rollout`]: many simulations at once, on all cores.
//! - [`Trajectory`]: what was recorded.
//! - [`scene`]: the abstract picture of a simulation. `render` draws it, `record` makes films, `viewer` opens a window.
//! - [`sample`]: models to begin with.
//!
//! And to read: [`cookbook`] has whole programs, [`promises`] says what can be relied on and how it is tested, [`coverage`] where
//! each function, field and kind of the engine is. [`Model::field_docs`] says what a field means.
//!
//! # Promises
//!
//! No call without `unsafe` can crash the process, read or write outside of the engine's memory, end the program, wait on
//! standard input or write a file that was not asked for. What the engine answers with a message and an `exit` is an
//! [`Error`] here; so is what it would answer with a silent reset or with numbers of another state. Compiling XML is the
//! exception to be known: see [`Model::from_xml_str`].
//!
//! What only a mistake in the program can get wrong, such as the id of another model, panics. Nothing that is called in a
//! control loop allocates, unless its name says so by returning a `Vec` or a [`Matrix`].
//!
//! # Features
//!
//! None is on by default. `renderer`: pictures and films, without a window or a display. `viewer`: the window. `npz`: trajectories to
//! and from NumPy's files. `serde`: options, states, matrices and trajectories as
//! plain data, in any of serde's formats.
//!
//! # Units and conventions
//!
//! SI throughout: metres, seconds, radians, kilograms, newtons. Quaternions are `[w, x, y, z]`. Indices count from 0. The
//! number of positions `nq` and the number of degrees of freedom `nv` differ where there are free or ball joints.

pub mod callback;
pub mod control;
pub mod controller;
pub mod cookbook;
pub mod coverage;
pub mod data;
pub mod derivative;
pub mod element;
mod engine;
mod enums;
mod error;
mod ffi;
mod field_docs;
mod file;
mod generated;
mod id;
pub mod math;
pub mod matrix;
pub mod model;
pub mod promises;
#[cfg(feature = "renderer")]
pub mod record;
#[cfg(feature = "renderer")]
pub mod render;
pub mod rollout;
pub mod sample;
pub mod scene;
#[cfg(feature = "serde")]
mod serialise;
mod stage;
mod trajectory;
#[cfg(feature = "viewer")]
pub mod viewer;

/// The linear algebra that matrices are handed to, in the version that this crate uses.
pub use nalgebra;

/// The thread pools that rollouts run on, in the version that this crate uses.
pub use rayon;

/// The raw bindings, for calls past this crate.
pub use mujoco_sys as sys;

pub use crate::callback::Callbacks;
pub use crate::control::{Lqr, LqrWeights, TimeVaryingLqr};
pub use crate::controller::{Controller, PdController, RandomController, ZeroController};
pub use crate::data::{
    Axes, Contact, ContactForce, Data, FrameId, GeomDistance, Instability, Jacobian, MissingResults, NewContact,
    RayHit, RayOptions, SolverIteration, SpatialVector, Stage, StateSpec, Timer, TimerCount, UnstableField, Warning,
    WarningCount,
};
pub use crate::derivative::{
    Differences, Fallback, InverseJacobians, InverseOutputs, LinearisationReport, Lineariser, StateSpace,
    TransitionMethod, TransitionOptions, TransitionOutputs,
};
pub use crate::engine::{Version, built_against, enable_timers, engine_version};
pub use crate::enums::{
    ActuatorBias, ActuatorDynamics, ActuatorGain, CameraMode, Collision, Cone, EqualityType, GeomType, Integrator,
    JacobianStorage, JointType, SensorDataType, SensorType, Solver, TextureType,
};
pub use crate::error::{Error, Result};
pub use crate::field_docs::Field;
pub use crate::id::{
    ActuatorId, BodyId, CameraId, ElementKind, EqualityId, ExcludeId, GeomId, HeightFieldId, Id, Ids, JointId,
    KeyframeId, Kind, LightId, MaterialId, MeshId, NumericId, PairId, SensorId, SiteId, SkinId, TendonId, TextId,
    TextureId, TupleId, kind,
};
pub use crate::matrix::{Matrix, MatrixView, MatrixViewMut};
pub use crate::model::{
    DisableFlags, EnableFlags, LengthRangeMode, LengthRangeOptions, LoadOptions, LostEdit, Model, ModelMut, Options,
    SaveXmlOptions, Statistics, Visual, VisualGlobal, VisualHeadlight, VisualMap, VisualQuality, VisualRgba,
    VisualScale, XmlCheck, schema, schema_html,
};
pub use crate::rollout::{Batch, Rollout, RolloutBuffers, RolloutError, RolloutResult};
pub use crate::scene::Scene;
pub use crate::trajectory::Trajectory;

/// The README's example, as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
