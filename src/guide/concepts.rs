//! Concepts: model and data, the pipeline, states, results and their age, names and ids, matrices,
//! other engines, errors.
//!
//! # Model and data
//!
//! A [`Model`] is the description of a mechanism: bodies, joints, masses, options. The engine's
//! compiler creates it from MJCF or URDF, and it stays constant during a simulation. A [`Data`] is
//! one simulation: the state, the inputs, and all quantities that the engine computes from them.
//! Each simulation holds its model in an [`Arc`](std::sync::Arc), so any number of simulations in
//! any threads share one model.
//!
//! ```
//! use std::sync::Arc;
//! use mujoco_safe::{Data, sample};
//!
//! let model = Arc::new(sample::cartpole()); // or Model::from_xml_path("cartpole.xml")?
//! let mut first = Data::new(model.clone())?;
//! let second = Data::new(model.clone())?;
//! first.qpos_mut()[1] = 0.1; // the other simulation does not change
//! assert_eq!(second.qpos()[1], 0.0);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! [`Model::edit`] changes a model before it is shared, [`Data::edit_model`] the model of one
//! simulation afterwards. Both lend a [`ModelMut`].
//!
//! # The pipeline
//!
//! The engine computes quantities in stages. Each stage needs the results of the stage before it:
//!
//! 1. [`Stage::Position`]: poses of bodies, geoms and sites, tendons, the inertia matrix, contacts,
//!    the constraint Jacobian.
//! 2. [`Stage::Velocity`]: velocities of bodies, passive forces, the bias force (gravity, Coriolis
//!    and centrifugal forces).
//! 3. [`Stage::Acceleration`]: actuator forces, accelerations without constraints, constraint
//!    forces, accelerations.
//!
//! | call | computes | integrates |
//! |---|---|---|
//! | [`Data::forward`] | all three stages at the present state, including the sensors | no |
//! | [`Data::step`] | the same as [`forward`](Data::forward), then the new state | yes |
//! | [`Data::step1`] | the first two stages, and their sensors | no |
//! | [`Data::step2`] | the third stage, and its sensors, then the new state | yes |
//! | [`Data::inverse`] | the forces that cause the accelerations in [`qacc`](Data::qacc) | no |
//!
//! Between [`step1`](Data::step1) and [`step2`](Data::step2) a program can compute controls from
//! quantities of the present state. The pair takes an Euler step if the integrator is
//! [`Rk4`](crate::enums::Integrator::Rk4). The functions in
//! [`data::pipeline`](crate::data::pipeline) compute single parts of a stage.
//!
//! # The state
//!
//! The physics state is `[qpos; qvel; act]`: positions, velocities and actuator activations.
//! [`StateSpec`] selects the parts of a state vector:
//!
//! | specification | parts |
//! |---|---|
//! | [`PHYSICS`](StateSpec::PHYSICS) | positions, velocities, activations |
//! | [`FULL_PHYSICS`](StateSpec::FULL_PHYSICS) | the same and the time |
//! | [`USER`](StateSpec::USER) | the inputs: controls, applied forces, mocap poses, user data |
//! | [`INTEGRATION`](StateSpec::INTEGRATION) | all of these and the warm start of the solver |
//!
//! A simulation that is set to a saved [`INTEGRATION`](StateSpec::INTEGRATION) state continues bit
//! for bit. Without the warm start, the continuation differs within the tolerance of the constraint
//! solver.
//!
//! ```
//! use mujoco_safe::{Data, StateSpec, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! assert_eq!((data.model().nq(), data.model().nv()), (28, 27)); // a quaternion has four numbers and three degrees of freedom
//! let saved = data.state(StateSpec::INTEGRATION);
//! data.step_n(10)?;
//! data.set_state(StateSpec::INTEGRATION, &saved)?;
//! assert_eq!(data.time(), 0.0);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Age of results
//!
//! After a [`step`](Data::step), `qpos`, `qvel`, `act` and `time` belong to the new state. **All
//! other quantities still belong to the state before the step**, because the engine computes them
//! before it integrates. (With the integrator [`Rk4`](crate::enums::Integrator::Rk4) this is so for
//! sensor readings and energies; the rest belongs to the last state in which the engine evaluates
//! the dynamics, close to the new one.) The same is true after a program writes `qpos`. Call
//! [`forward`](Data::forward) to compute them for the present state:
//!
//! ```
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! data.qvel_mut()[0] = 1.0;
//! data.step()?;
//! assert!(data.qpos()[0] > 0.009);                // the cart has moved
//! assert_eq!(data.body("cart")?.xpos()[0], 0.0);  // its pose is that of the old state
//! data.forward()?;
//! assert_eq!(data.body("cart")?.xpos()[0], data.qpos()[0]);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! Sensor readings and contacts have the same age as poses. For a controller that reads them, the
//! lag is one time step; a loop that calls [`forward`](Data::forward) after each step computes
//! everything twice.
//!
//! # Results that have not been computed
//!
//! A reset and a change of the model discard all results. A call that needs a missing result
//! returns [`Error::NotComputed`], which names the call that computes it. So do named sensors,
//! contact forces, and the accelerations and forces of named bodies. Plain getters such as
//! [`Data::xpos`] check nothing, because they only return the engine's array; [`Data::require`]
//! checks in one line.
//!
//! ```
//! use mujoco_safe::{Data, Error, Stage, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! assert!(matches!(data.jac_site("tip"), Err(Error::NotComputed { .. })));
//! assert!(matches!(data.sensor("tip_position")?.data(), Err(Error::NotComputed { .. })));
//! assert_eq!(data.xpos()[2], [0.0; 3]); // unchecked: zeros before the first computation
//! data.forward()?;
//! data.require(Stage::Acceleration)?;
//! assert_eq!(data.sensor("tip_position")?.data()?, [0.0, 0.0, 0.6]);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Names, ids, indices and views
//!
//! An element is selected by a [`IntoId`](crate::id::IntoId): its name, its index, its
//! [`Id`](crate::id::Id), or a view of it. A name or an index can be unknown, so the lookup returns
//! a [`Result`](crate::Result). An id and a view always refer to an element, so the lookup returns
//! a view without an error.
//!
//! ```
//! use mujoco_safe::{Data, sample};
//!
//! let model = sample::humanoid();
//! let knee = model.joint("left_knee")?.id();  // a name: Result
//! let mut data = Data::new(model)?;
//! data.joint_mut(knee).qpos_mut()[0] = 0.5;   // an id: no Result
//! assert_eq!(data.joint(knee).name(), Some("left_knee"));
//!
//! let view = data.joint(knee).in_model();     // the constant fields of the same joint
//! assert_eq!(data.qpos()[view.qpos_range().start], 0.5);
//! assert_eq!(view.qpos_range().start, view.dofs().start + 1); // after the quaternion of the root
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A view borrows the model or the simulation; an id is a number that borrows nothing. Take ids
//! outside of a loop, and use views inside. Indices count from 0, as in C. An id records its model,
//! and panics with any other model except clones. [`element`](crate::element) lists the 23 kinds of
//! elements.
//!
//! # Arrays and matrices
//!
//! | engine | here | example |
//! |---|---|---|
//! | `n x 1` | `&[f64]` | [`Data::qpos`] |
//! | `n x 3` | `&[[f64; 3]]` | [`Data::xpos`] |
//! | `n x 9`, rotation matrices | `&[[f64; 9]]`, row-major | [`Data::xmat`] |
//! | `n x m`, `m` from the model | [`MatrixView`] | [`Model::key_qpos`] |
//! | results of functions | [`Matrix`] | [`Data::full_m`] |
//!
//! All matrices are row-major, as in the engine. nalgebra is column-major: [`Matrix::transposed`]
//! is a nalgebra view of the transpose without a copy, and [`Matrix::to_nalgebra`] and
//! `Matrix::from` copy. An element of a [`Matrix`] is `matrix[(row, column)]`.
//!
//! # Fields of other engines
//!
//! The accessors of fields follow the engine: with 4.0.1 the inertia matrix is `Data::M`, not
//! `Data::qM`. `cargo doc` with an engine shows its accessors. The rest of the interface, with the
//! enums and [`Options`](crate::Options), is the same with every engine. What an engine lacks is
//! [`Error::Unsupported`]. A setter names the versions that have the variant, flag or option.
//!
//! Use these methods instead of arrays whose layout differs:
//!
//! | array | method |
//! |---|---|
//! | `actuator_moment` | [`Data::full_moment`](crate::Data::full_moment), [`ActuatorData::moment`](crate::element::ActuatorData) |
//! | `ten_J` | [`TendonData::J`](crate::element::TendonData) |
//! | `qM`, `M` | [`Data::full_m`](crate::Data::full_m), [`Data::mul_m_into`](crate::Data::mul_m_into) |
//! | `eq_active`, `eq_active0` | [`EqualityData::active`](crate::element::EqualityData), [`Data::set_equality_active`](crate::Data::set_equality_active) |
//! | `tex_rgb`, `tex_data` | [`Texture::rgb`](crate::element::Texture) |
//! | `light_directional`, `light_type` | [`Light::directional`](crate::element::Light) |
//! | `solver`, `solver_iter` | [`Data::solver`](crate::Data::solver) |
//! | `mesh_normal`, `mesh_texcoord` | [`Mesh::normal`](crate::element::Mesh) by [`Mesh::facenormal`](crate::element::Mesh), likewise `texcoord` |
//! | `contact.geom1`, `contact.geom` | [`Contact::geoms`](crate::data::Contact::geoms), [`Contact::sides`](crate::data::Contact::sides) |
//!
//! Functions that 2.2.2 lacks are implemented [in Rust](crate::guide::coverage::functions) and used
//! with every engine, so that they have the same results. `tests/smoke` compares each with the
//! function of the engine from 3.5.0. Three differ: `mj_multiRay` may return hits beyond its
//! cutoff, `mju_cholFactorBand` of 4.0 returns the square root of the smallest pivot, and
//! `mj_geomDistance` of 3.5.0 is less precise. A few others call the function of the engine, and
//! return [`Error::Unsupported`] where it has none, such as
//! [`Data::inside_site`](crate::Data::inside_site).
//!
//! # Units
//!
//! SI units: metres, seconds, radians, kilograms, newtons. Angles in MJCF are degrees unless the
//! file says otherwise; the compiler converts them. Quaternions are `[w, x, y, z]`. The linear
//! velocity of a free joint is in the world frame, its angular velocity in the frame of the body.
//! [`Data::xfrc_applied`] is `[force, torque]`; the engine's spatial vectors, such as
//! [`Data::cvel`], are `[angular, linear]`. [`Model::field_docs`] and [`Data::field_docs`] return
//! the engine's description of a field.
//!
//! # Errors and panics
//!
//! Failures of the environment are [`Error`]s: files, texts, names, a diverged simulation, a
//! failure of the engine. Mistakes of the program panic: an index beyond a slice, an id of another
//! model. After a failure in the middle of a computation, the simulation is *poisoned*: each
//! further computation returns [`Error::Poisoned`] until [`Data::reset`]. The page
//! [`errors`](super::errors) has the details.

#[cfg(doc)]
use crate::{Data, Error, Matrix, MatrixView, Model, ModelMut, Stage, StateSpec};
