//! Coming from MuJoCo.jl: indices, matrices, a table of calls, and the LQR examples.
//!
//! # Indices and names
//!
//! Indices count from 0, as in C: `data.qpos[3]` is [`data.qpos()[2]`](Data::qpos), and
//! `resetkey!(model, data, 1)` is [`data.reset_to_key(0)`](Data::reset_to_key). MuJoCo.jl's
//! `joint.id + 1` is the index of a joint among the joints. It is the index in `qvel` only for
//! models without free and ball joints. Here a joint states its indices:
//! [`dofs()`](crate::element::Joint::dofs) in `qvel`, and
//! [`qpos_range()`](crate::element::Joint::qpos_range) in `qpos`.
//!
//! Names are the engine's. The short names of MuJoCo.jl's views are spelled out here: `jnt` is
//! `joint`, `cam` is `camera`, `com` of a body is `subtree_com`. The [table of element
//! kinds](crate::guide::coverage::kinds) lists every field of MuJoCo.jl's named access with its
//! name here.
//!
//! # Row-major matrices
//!
//! The engine and [`Matrix`] are row-major, so there is no counterpart of `mj_zeros` and
//! `mj_array`: every [`Matrix`] fits the engine. nalgebra is column-major, like Julia.
//! [`Matrix::to_nalgebra`] copies, and [`Matrix::transposed`] is a view of the transpose without a
//! copy. Many formulas need the transpose: `data.full_moment()?.transposed()` is `momentᵀ`.
//!
//! # Table of calls
//!
//! | MuJoCo.jl | here |
//! |---|---|
//! | `load_model(path)` | [`Model::from_xml_path(path)?`](Model::from_xml_path) |
//! | `init_data(model)` | [`Data::new(model)?`](Data::new) |
//! | `sample_model_and_data()` | [`sample::humanoid()`](crate::sample::humanoid), and [`Data::new`] |
//! | `example_model_files()` | [`sample::system_models()`](crate::sample::system_models) |
//! | `step!(model, data)` | [`data.step()?`](Data::step) |
//! | `forward!(model, data)` | [`data.forward()?`](Data::forward) |
//! | `reset!(model, data)` | [`data.reset()?`](Data::reset) |
//! | `resetkey!(model, data, 2)` | [`data.reset_to_key(1)?`](Data::reset_to_key), or by name |
//! | `timestep(model)` | [`model.timestep()`](Model::timestep) |
//! | `get_physics_state(model, data)` | [`data.physics_state()`](Data::physics_state), [`physics_state_into`](Data::physics_state_into) |
//! | `set_physics_state!(model, data, x)` | [`data.set_physics_state(&x)?`](Data::set_physics_state) |
//! | `data.ctrl .= u` | [`data.ctrl_mut().copy_from_slice(&u)`](Data::ctrl_mut) |
//! | `data.qpos[3] = 2` | [`data.qpos_mut()[2] = 2.0`](Data::qpos_mut) |
//! | `body(data, "torso").com` | [`data.body("torso")?.subtree_com()`](Data::body) |
//! | `key(model, 0).qpos` | [`model.keyframe(0)?.qpos()`](Model::keyframe) |
//! | `[j.name for j in joints(model)]` | [`model.joints()`](Model::joints) |
//! | `show_docs(model, :nv)` | [`Model::field_docs("nv")?`](Model::field_docs) |
//! | `mj_inverse(model, data)` | [`data.inverse()?`](Data::inverse) |
//! | `mj_jacBodyCom(model, data, jacp, jacr, body.id)` | [`data.jac_body_com("torso")?`](Data::jac_body_com) |
//! | `mj_jacSubtreeCom(model, data, jac, body.id)` | [`data.jac_subtree_com("torso")?`](Data::jac_subtree_com) |
//! | `mj_differentiatePos(model, dq, 1, qpos0, data.qpos)` | [`model.differentiate_pos_into(1.0, &qpos0, data.qpos(), &mut dq)?`](Model::differentiate_pos_into) |
//! | `mjd_transitionFD(model, data, ϵ, true, A, B, nothing, nothing)` | [`data.transition_fd(eps, Differences::Central)?`](Data::transition_fd) |
//! | `ared(A, B, R, Q, S)` of MatrixEquations.jl | [`Riccati::new(&a, &b, &q, &r)`](crate::control::riccati::Riccati)`.with_cross_term(&s).solve()?`: Q before R |
//! | `visualise!(model, data)` | `Viewer::new().run(data)?`, feature `viewer`: see [`pictures`](super::pictures) |
//! | `visualise!(model, data, controller=ctrl!)` | `Viewer::new().with_controller(controller).run(data)?` |
//! | `visualise!(model, data, trajectories=states)` | `Viewer::new().with_trajectories([trajectory]).run(data)?`, with a [`Trajectory`](crate::Trajectory) |
//! | `LibMuJoCo.mju_add` | [`sys`](crate::sys): the raw bindings |
//!
//! `install_visualiser` and `init_visualiser` have no counterpart: the Cargo feature `viewer`
//! compiles the viewer.
//!
//! # LQR of the cart-pole
//!
//! ```
//! use mujoco_safe::control::riccati::Riccati;
//! use mujoco_safe::{Data, Differences, Matrix, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! let system = data.transition_fd(1e-6, Differences::Central)?;
//! let q = Matrix::from_diagonal(&[1.0, 10.0, 1.0, 5.0]);
//! let k = Riccati::new(&system.a, &system.b, &q, &Matrix::identity(1)).solve()?.k.to_nalgebra();
//!
//! data.qpos_mut()[1] = 0.1;
//! for _ in 0..1000 {
//!     let state = mujoco_safe::nalgebra::DVector::from_vec(data.physics_state());
//!     data.ctrl_mut().copy_from_slice((-&k * state).as_slice());
//!     data.step()?;
//! }
//! assert!(data.qpos()[1].abs() < 1e-3);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! [`Lqr::at_present_state`](crate::Lqr::at_present_state) does all of this in one call, without
//! allocation in the loop, and treats quaternions as rotations. For a controller with preallocated
//! memory (a functor in MuJoCo.jl), write a type that implements [`Controller`](crate::Controller):
//! see [`control`](super::control).
//!
//! # Set-point of the humanoid
//!
//! Inverse dynamics yields the forces that hold a pose, and a pseudoinverse of the actuator moments
//! yields the controls. The root has no motor, so the height must be such that the floor carries
//! the weight.
//!
//! ```
//! use mujoco_safe::nalgebra::DVector;
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! data.reset_to_key("stand_on_left_leg")?;
//! data.forward()?;
//! data.qacc_mut().fill(0.0);
//! data.inverse()?;
//! let forces = DVector::from_column_slice(data.qfrc_inverse());
//!
//! // ctrl0 = pinv(M_act)' * qfrc0
//! let moment_transposed = data.full_moment()?.transposed().into_owned(); // (nv, nu)
//! let ctrl = moment_transposed.svd(true, true).solve(&forces, 1e-12).expect("an SVD with both factors");
//! data.ctrl_mut().copy_from_slice(ctrl.as_slice());
//! data.forward()?;
//! let joints = 6..data.model().nv(); // without the free joint
//! assert!(joints.into_iter().all(|dof| (data.qfrc_actuator()[dof] - forces[dof]).abs() < 1e-9));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! The example `humanoid_lqr` continues from here: it finds the height, defines the weights of the
//! tutorial, and balances (`cargo run --release --example humanoid_lqr -- --help`).
//!
//! # Differences
//!
//! - Functions that fail return a [`Result`](crate::Result). An engine error does not end the
//!   process.
//! - The model is not an argument: each [`Data`] holds its model.
//! - A view such as `data.body("torso")?` borrows the simulation. Take its
//!   [`id`](crate::element::View::id) to keep it over a step.
//! - Esc selects the free camera of the viewer, as in the engine's `simulate`. Ctrl+Q closes the
//!   window.
//! - [Plots](super::cookbook::plots) need a crate, as they need Makie in Julia.
//! - A state matrix of trajectories is a [`Trajectory`](crate::Trajectory) with one record per row.
//!   It also holds times and controls.

#[cfg(doc)]
use crate::{Data, Matrix, Model};
