//! Simulation and control: controllers, set-points, linearisation, LQR, iLQR, predictive control,
//! recorded trajectories.
//!
//! # Controllers
//!
//! A [`Controller`] sets the controls of a simulation once before each step. Recordings, rollouts
//! and the viewer accept any controller. Closures that take `&mut Data` are controllers; name the
//! type of the argument (`|data: &mut Data|`), because the compiler cannot infer it.
//!
//! | controller | law |
//! |---|---|
//! | [`ZeroController`](crate::ZeroController) | zero controls: passive dynamics |
//! | [`RandomController`](crate::RandomController) | uniform random controls within their ranges, reproducible by a seed |
//! | [`PdController`](crate::PdController) | PD control of the actuator lengths |
//! | [`Lqr`] | linear-quadratic regulator about a set-point |
//! | [`TimeVaryingLqr`] | linear-quadratic regulator along a trajectory |
//!
//! A controller with a state is a type:
//!
//! ```
//! use mujoco_safe::{Controller, Data, Result, Trajectory, sample};
//!
//! /// PID control of a hinge.
//! struct Pid {
//!     gains: [f64; 3],
//!     integral: f64,
//! }
//!
//! impl Controller for Pid {
//!     fn control(&mut self, data: &mut Data) -> Result<()> {
//!         let (angle, rate) = (data.qpos()[1], data.qvel()[1]);
//!         self.integral += angle * data.model().timestep();
//!         let [kp, ki, kd] = self.gains;
//!         data.ctrl_mut()[0] = (kp * angle + ki * self.integral + kd * rate).clamp(-1.0, 1.0);
//!         Ok(())
//!     }
//! }
//!
//! let mut data = Data::new(sample::cartpole())?;
//! data.qpos_mut()[1] = 0.1;
//! let mut pid: Box<dyn Controller> = Box::new(Pid { gains: [3.0, 0.5, 0.5], integral: 0.0 });
//! let mut trajectory = Trajectory::new(data.model());
//! trajectory.record(&mut data, &mut pid, 200)?;
//! assert!(trajectory.qpos(199)[1].abs() < 0.02);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A control law that needs quantities of the *present* state, such as the bias force, sets the
//! controls between [`step1`](Data::step1) and [`step2`](Data::step2), or in a [`control`
//! callback](crate::callback::Callbacks::with_control), which the Runge–Kutta integrator calls in
//! each substep. [`Data::set_callbacks`] installs the callback until it is replaced, for example in
//! a simulation that a struct stores; [`Data::with_callbacks`] installs it for a scope, in which it
//! can borrow local variables. The cookbook compensates
//! [gravity](crate::guide::cookbook::gravity_compensation) in this way.
//!
//! # Set-points
//!
//! [`Data::inverse`] returns the forces that hold a pose: set [`qacc`](Data::qacc_mut) to zero,
//! call it, and read [`qfrc_inverse`](Data::qfrc_inverse). The [page for
//! MuJoCo.jl](super::julia#set-point-of-the-humanoid) converts them to controls.
//!
//! # Linearisation
//!
//! A step is `x⁺ = A x + B u` near the present state, and its sensors are `y = C x + D u`. The
//! state of the linear system is `[dq; dv; da]` of length `nx = 2 nv + na`: the difference of
//! positions is in the tangent space, in which a quaternion has three components, not four.
//! [`Model::differentiate_pos_into`] computes that difference.
//!
//! | call | method |
//! |---|---|
//! | [`Data::transition_fd`] | differences of steps, by the engine |
//! | [`Lineariser::linear_system_into`] | by default derivatives in closed form, which are faster and more accurate; without allocation |
//! | [`Lineariser::along`] | the systems of all steps of a trajectory |
//! | [`Lineariser::inverse_jacobians_into`] | derivatives of inverse dynamics, by default in closed form |
//!
//! The first three return or fill a [`StateSpace`](crate::StateSpace). The
//! [report](crate::derivative::LinearisationReport) of a [`Lineariser`] states the method that was
//! used: models with features that have no formula, such as contacts of meshes or tendons around
//! geoms, fall back to implicit differentiation or to differences of steps.
//!
//! At a kink of a step the derivative has two sides, and the report names the
//! [kinks](crate::derivative::Kinks) of the state. One rule selects the side: an input moves into
//! its range, and where both directions are possible, a muscle contracts, as it does in a step with
//! a larger control. So in a steady state, where the control of a muscle equals its activation, B
//! has the time constant of activation. [`Data::transition_fd`] is the engine's function, which
//! takes the mean of both sides there. Contacts and limits that begin to act have a kink, or a jump
//! if the bodies move, and the differences of contacts of meshes need not converge. Then some
//! entries are not derivatives, and the report says so by
//! [`Kinks::DIFFERENCES`](crate::derivative::Kinks::DIFFERENCES) or
//! [`Kinks::CONSTRAINTS`](crate::derivative::Kinks::CONSTRAINTS). A regulator for such a state
//! needs a state nearby without the kink, for example one with settled contacts.
//!
//! # LQR
//!
//! [`Lqr::at_present_state`] linearises about the present state and controls, solves the Riccati
//! equation and returns a controller. To inspect the solution, or to use another linear system,
//! call the two parts:
//!
//! ```
//! use mujoco_safe::control::riccati::RiccatiError;
//! use mujoco_safe::{Controller, Data, Differences, Lqr, LqrWeights, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! let system = data.transition_fd(Lqr::EPS, Differences::Central)?;
//! let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
//! let solution = Lqr::solve(&system, &weights)?;
//! assert!(solution.spectral_radius < 1.0);       // the closed loop is stable
//! assert!(solution.relative_residual < 1e-9);
//! let mut lqr = Lqr::with_gain(&data, solution.k)?;
//! data.qpos_mut()[1] = 0.1;
//! for _ in 0..1000 {
//!     lqr.control(&mut data)?;
//!     data.step()?;
//! }
//! assert!(data.qpos()[1].abs() < 1e-3);
//!
//! // Without a cost of its position, the cart may drift: no controller is optimal and stabilising.
//! let unobservable = LqrWeights::diagonal(&[0.0, 10.0, 1.0, 5.0], &[1.0]);
//! assert!(matches!(Lqr::solve(&system, &unobservable), Err(RiccatiError::UnobservableMode { .. })));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! A [`RiccatiError`](crate::control::riccati::RiccatiError) names the reason: an uncontrollable
//! mode, an unobservable mode, a control cost that is not positive.
//! [`Riccati`](crate::control::riccati::Riccati) solves the equation for any matrices, also without
//! a simulation.
//!
//! # Trajectory optimisation, and regulators along a trajectory
//!
//! [`Ilqr`](crate::control::ilqr::Ilqr) finds a trajectory of minimal cost within the control
//! ranges. Its solution has a gain for each step, and
//! [`controller`](crate::control::ilqr::IlqrSolution::controller) returns the [`TimeVaryingLqr`]
//! that follows the trajectory:
//!
//! ```
//! use mujoco_safe::control::ilqr::{Ilqr, IlqrOptions, QuadraticCost};
//! use mujoco_safe::{Controller, Data, LqrWeights, Matrix, sample};
//!
//! // Move the cart to 0.5 m in a second.
//! let mut data = Data::new(sample::cartpole())?;
//! let model = data.model().clone();
//! let weights = LqrWeights::diagonal(&[0.1, 0.1, 0.0, 0.0], &[0.01]);
//! let cost = QuadraticCost::new(model.clone(), &[0.5, 0.0, 0.0, 0.0], weights, Matrix::from_diagonal(&[100.0; 4]))?;
//! let plan = Ilqr::new(model, IlqrOptions::default())?.solve(&data, &Matrix::zeros(100, 1), &cost)?;
//!
//! // Follow the plan from a disturbed state.
//! data.qpos_mut()[1] = 0.02;
//! let mut follow = plan.controller(&data)?;
//! for _ in 0..100 {
//!     follow.control(&mut data)?;
//!     data.step()?;
//! }
//! assert!((data.qpos()[0] - 0.5).abs() < 0.02);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! [`TimeVaryingLqr::along`] computes the gains along a given trajectory. The example
//! `cartpole_swing_up` swings a pole up from any angle.
//!
//! # Costs
//!
//! | cost | penalises |
//! |---|---|
//! | [`QuadraticCost`](crate::control::ilqr::QuadraticCost) | the deviation from one state, with weight matrices |
//! | [`ResidualCost`](crate::control::residual::ResidualCost) | norms of joint positions, poses, momenta, sensors and controls, relative to targets |
//! | your type that implements [`TrajectoryCost`](crate::control::ilqr::TrajectoryCost) | any function of the state and the controls, with its derivatives |
//!
//! A [`ResidualCost`](crate::control::residual::ResidualCost) has named terms, whose weights and
//! targets can change between two searches:
//!
//! ```
//! use mujoco_safe::control::ilqr::TrajectoryCost;
//! use mujoco_safe::control::residual::{FrameOrientation, JointPosition, Norm, ResidualCost, Subtree, Term};
//! use mujoco_safe::sample;
//!
//! let model = std::sync::Arc::new(sample::humanoid());
//! let mut cost = ResidualCost::new(
//!     &model,
//!     [
//!         Term::new("posture", JointPosition::all(&model)).with_weight(0.1),
//!         Term::new("upright", FrameOrientation::body(&model, "torso")?).with_norm(Norm::SmoothAbs { width: 0.1 }),
//!         Term::new("momentum", Subtree::angular_momentum(&model, "torso")?).with_weight(0.01),
//!     ],
//! )?;
//! cost.term_mut("upright")?.weight = 5.0;
//! let state = [model.qpos0(), &vec![0.0; model.nv()]].concat();
//! assert!(cost.value(0, &state, None)? < 1e-6);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Predictive control
//!
//! A [`PredictiveController`](crate::control::predictive::PredictiveController) optimises a plan
//! from the present state every few steps, starting from the previous plan, and follows it with its
//! gains in between. [`IlqrPlanner`](crate::control::predictive::IlqrPlanner) makes a few
//! iterations of iLQR for each plan:
//!
//! ```
//! use mujoco_safe::control::ilqr::IlqrOptions;
//! use mujoco_safe::control::predictive::{IlqrPlanner, PredictiveController};
//! use mujoco_safe::control::residual::{Controls, JointPosition, JointVelocity, ResidualCost, Term};
//! use mujoco_safe::{Controller, Data, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! let model = data.model().clone();
//! let cost = ResidualCost::new(
//!     &model,
//!     [
//!         Term::new("position", JointPosition::all(&model)).with_terminal_weight(100.0),
//!         Term::new("velocity", JointVelocity::all(&model)).with_weight(0.01).with_terminal_weight(10.0),
//!         Term::new("effort", Controls::new(&model)).with_weight(1e-2),
//!     ],
//! )?;
//! let planner = IlqrPlanner::new(&model, 60, IlqrOptions::default().with_iterations(1))?;
//! let mut controller = PredictiveController::new(&data, planner, cost, 2)?;
//! data.qpos_mut()[1] = 0.3;
//! for step in 0..300 {
//!     if step == 100 {
//!         // Move the target.
//!         controller.cost_mut().term_mut("position")?.set_target(&[0.3, 0.0])?;
//!     }
//!     controller.control(&mut data)?;
//!     data.step()?;
//! }
//! assert!((data.qpos()[0] - 0.3).abs() < 0.05);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! This controller plans in the thread of the simulation, and its runs are reproducible.
//! [`ThreadedPredictiveController`](crate::control::predictive::ThreadedPredictiveController) plans
//! in a second thread, for robots, the viewer and other simulations that run in real time: a step
//! does not wait for the planner. Its
//! [`edit`](crate::control::predictive::ThreadedPredictiveController::edit) changes weights and
//! targets. A plan must be finished within a fraction of the horizon:
//! `cargo bench --bench predictive` prints its time for a humanoid. Fewer [step
//! sizes](crate::control::ilqr::IlqrOptions::step_sizes) and a [sufficient
//! decrease](crate::control::ilqr::IlqrOptions::sufficient_decrease) shorten it.
//!
//! In `cargo run --release --example humanoid_predictive -- --pushes 100`, the humanoid stands on
//! one leg and is pushed for 0.1 s by 85 N in random directions. The LQR of its stance falls in 56
//! of 100 pushes, and iLQR over a horizon of 100 steps in none.
//!
//! # Predictive control in the viewer
//!
//! The viewer runs any controller. With [`Viewer::with_instrumented_controller`][instrumented], a
//! closure also declares its [`Instruments`][instruments]: values that are plotted over time,
//! parameters that the user changes with sliders, and paths in the scene. Here they are the cost of
//! each term in the first step of the plan, the weights, and the planned path of the pole's tip. A
//! changed weight acts from the next plan:
//!
#![cfg_attr(feature = "viewer", doc = "```no_run")]
#![cfg_attr(not(feature = "viewer"), doc = "```ignore")]
//! use mujoco_safe::control::ilqr::IlqrOptions;
//! use mujoco_safe::control::predictive::{IlqrPlanner, PredictiveController};
//! use mujoco_safe::control::residual::{Controls, JointPosition, JointVelocity, ResidualCost, Term};
//! use mujoco_safe::viewer::{Viewer, ViewerError};
//! use mujoco_safe::{Data, Result, sample};
//!
//! let data = Data::new(sample::cartpole())?;
//! let model = data.model().clone();
//! let position = Term::new("position", JointPosition::all(&model).with_target(&[0.5, 0.0])?).with_weight(10.0);
//! let velocity = Term::new("velocity", JointVelocity::all(&model)).with_weight(0.1);
//! let effort = Term::new("effort", Controls::new(&model)).with_weight(0.01);
//! let cost = ResidualCost::new(&model, [position, velocity, effort])?;
//! let planner = IlqrPlanner::new(&model, 60, IlqrOptions::default().with_iterations(1))?;
//! let controller = PredictiveController::new(&data, planner, cost, 2)?;
//!
//! // A second simulation takes the states of the plan.
//! let mut planned = Data::new(model.clone())?;
//! let (tip, mut costs) = (model.site("tip")?.id(), vec![0.0; 3]);
//! Viewer::new()
//!     .with_instrumented_controller(controller, move |controller, _, instruments| -> Result<()> {
//!         for term in controller.cost_mut().terms_mut() {
//!             let mut weight = term.weight;
//!             if instruments.parameter(term.name(), &mut weight, 1e-3..=1e3) {
//!                 (term.weight, term.terminal_weight) = (weight, weight);
//!             }
//!         }
//!         let (plan, cost) = (controller.policy(), controller.cost());
//!         cost.values_into(0, plan.states().row(0), Some(plan.controls().row(0)), &mut costs)?;
//!         for (term, value) in cost.terms().iter().zip(&costs) {
//!             instruments.value("cost of a step", term.name(), *value);
//!         }
//!         let mut path = Vec::new();
//!         for state in plan.states().rows() {
//!             planned.qpos_mut().copy_from_slice(&state[..model.nq()]);
//!             planned.kinematics()?;
//!             path.push(*planned.site(tip).xpos());
//!         }
//!         instruments.path(path, 0.005, [0.9, 0.5, 0.1, 1.0]);
//!         Ok(())
//!     })
//!     .run(data)?;
//! # Ok::<(), ViewerError>(())
//! ```
//!
//! A program that steps its simulation itself declares them with
//! [`ViewerHandle::instruments`][handle_instruments]. The examples `humanoid_predictive` and
//! `arm_tracking` show their plans with `--view`.
//!
//! # Predictive control by sampling
//!
//! A [`SamplingPlanner`](crate::control::predictive::SamplingPlanner) takes the place of the
//! `IlqrPlanner` if the cost has no derivatives: predictive sampling, or MPPI.
//! [`with_regulator`](crate::control::predictive::SamplingPlanner::with_regulator) adds its samples
//! to an LQR:
//!
//! ```
//! use mujoco_safe::control::predictive::{PredictiveController, SamplingOptions, SamplingPlanner};
//! use mujoco_safe::control::residual::{JointPosition, JointVelocity, ResidualCost, Term};
//! use mujoco_safe::{Controller, Data, Lqr, LqrWeights, sample};
//!
//! let mut data = Data::new(sample::cartpole())?;
//! let lqr = Lqr::at_present_state(&mut data, &LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]))?;
//! let model = data.model().clone();
//! let position = Term::new("position", JointPosition::all(&model));
//! let velocity = Term::new("velocity", JointVelocity::all(&model)).with_weight(0.1);
//! let cost = ResidualCost::new(&model, [position, velocity])?;
//! let options = SamplingOptions::default().with_samples(16).with_knots(3);
//! let planner = SamplingPlanner::new(data.model(), 80, options)?.with_regulator(lqr)?;
//! let mut controller = PredictiveController::new(&data, planner, cost, 4)?;
//! data.qpos_mut()[1] = 0.15;
//! for _ in 0..200 {
//!     controller.control(&mut data)?;
//!     data.step()?;
//! }
//! assert!(data.qpos()[1].abs() < 0.1, "the pole is upright");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! Programs can also simulate candidates themselves from the present state and apply the best.
//! [`Workers`](crate::rollout::Workers) keeps the simulations of the
//! [rollouts](crate::rollout::Rollout) between decisions. Here the linear-quadratic regulator gives
//! the cost to go after the horizon:
//!
//! ```
//! use mujoco_safe::nalgebra::{DMatrix, DVectorView};
//! use mujoco_safe::rollout::{Rollout, Workers};
//! use mujoco_safe::{Controller, Data, Differences, Lqr, LqrWeights, Result, StateSpec, sample};
//!
//! const HORIZON: usize = 10;
//!
//! struct Predictive {
//!     workers: Workers,
//!     candidates: Vec<f64>, // constant controls, (nroll, HORIZON, nu)
//!     cost_to_go: DMatrix<f64>,
//! }
//!
//! impl Controller for Predictive {
//!     fn control(&mut self, data: &mut Data) -> Result<()> {
//!         let (state, count) = (data.state(StateSpec::FULL_PHYSICS), self.candidates.len() / HORIZON);
//!         let result = Rollout::on(&self.workers, count, HORIZON)
//!             .with_initial_state(StateSpec::FULL_PHYSICS, &state)
//!             .with_controls(&self.candidates)
//!             .run()?;
//!         let cost = |roll: usize| {
//!             let x = DVectorView::from_slice(result.state(roll, HORIZON), 4);
//!             x.dot(&(&self.cost_to_go * x))
//!         };
//!         let best = (0..count).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).expect("candidates");
//!         data.ctrl_mut()[0] = self.candidates[best * HORIZON];
//!         Ok(())
//!     }
//! }
//!
//! let mut data = Data::new(sample::cartpole())?;
//! let system = data.transition_fd(Lqr::EPS, Differences::Central)?;
//! let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
//! let cost_to_go = Lqr::solve(&system, &weights)?.p.to_nalgebra();
//! let candidates = (-8..=8).flat_map(|force| [0.1 * f64::from(force); HORIZON]).collect();
//! let mut predictive = Predictive { workers: Workers::new(data.model().clone()), candidates, cost_to_go };
//! data.qpos_mut()[1] = 0.3;
//! for _ in 0..200 {
//!     predictive.control(&mut data)?;
//!     data.step()?;
//! }
//! assert!(data.qpos()[1].abs() < 0.1);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! The example `humanoid_predictive` samples perturbations of an LQR in this way.
//!
//! # Recorded trajectories
//!
//! A [`Trajectory`](crate::Trajectory) holds times, states and controls, and sensor readings if it
//! was created by [`with_sensordata`](crate::Trajectory::with_sensordata).
//! [`record`](crate::Trajectory::record) steps under a controller,
//! [`push`](crate::Trajectory::push) appends the present state, and
//! [`apply`](crate::Trajectory::apply) sets a simulation to a record. Files:
//! [`save_csv`](crate::Trajectory::save_csv) writes lossless text, `save_npz` (feature `npz`) NumPy
//! arrays. The viewer plays trajectories. [`Rollout`](crate::rollout::Rollout) always records
//! sensor readings.
//!
#![cfg_attr(feature = "viewer", doc = include_str!("links/with_viewer.md"))]
#![cfg_attr(not(feature = "viewer"), doc = include_str!("links/without_viewer.md"))]

#[cfg(doc)]
use crate::{Controller, Data, Lineariser, Lqr, Model, control::TimeVaryingLqr};
