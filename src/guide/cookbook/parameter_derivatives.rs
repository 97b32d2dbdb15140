//! Derivatives by parameters of a model, and gradients of costs along trajectories.
//!
//! [`Lineariser::parameter_jacobian`](crate::Lineariser::parameter_jacobian) differentiates a step
//! by any numbers of a model. Closed forms give the derivatives by the inertia of bodies, gravity,
//! armature, damping, dry friction, springs, affine actuators, gears, time constants, and the
//! friction, `solref` and `solimp` of contacts, limits and equality constraints; margins, sizes,
//! poses and others are differenced, and
//! [`differenced_parameters`](crate::Lineariser::differenced_parameters) names them.
//! [`sensitivities`](crate::Lineariser::sensitivities) are the derivatives of a whole
//! trajectory. For a single number, such as a cost,
//! [`cost_gradient`](crate::Lineariser::cost_gradient) computes the derivatives by all controls and
//! any number of parameters at once, backwards in time.
//!
//! This program fits the damping and the mass of a pendulum to a measured motion. The
//! [inertia](crate::derivative::InertialParameters) of a body with an unknown shape has ten
//! log-Cholesky coordinates, [`ModelParameter::LogCholesky`](crate::derivative::ModelParameter),
//! for which every step of an optimiser is a possible body.
//!
//! ```
//! use mujoco_safe::derivative::{CostSlopes, ModelParameter, TransitionOptions};
//! use mujoco_safe::nalgebra::{DMatrix, DVector};
//! use mujoco_safe::rollout::Parameter;
//! use mujoco_safe::{Data, Lineariser, Matrix, Model};
//!
//! let mut data = Data::new(Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <body name="arm">
//!              <joint name="hinge" axis="0 1 0" damping="0.1"/>
//!              <geom type="capsule" fromto="0 0 0 0 0 -.5" size=".02" mass="1"/>
//!            </body>
//!          </worldbody>
//!          <actuator><motor joint="hinge"/></actuator>
//!        </mujoco>"#,
//! )?)?;
//! let model = data.model().clone();
//! let parameters: [ModelParameter; 2] = [
//!     Parameter::JointDamping(model.joint("hinge")?.id()).into(),
//!     ModelParameter::Mass(model.body("arm")?.id()),
//! ];
//! let controls: Vec<f64> = (0..300).map(|k| 0.5 * (0.03 * f64::from(k)).sin()).collect();
//! let steps = controls.len();
//! let controls = Matrix::from_row_major(steps, 1, controls);
//!
//! // Velocities after each step, measured on a pendulum with more damping and a larger mass.
//! let velocities = |data: &Data| {
//!     let mut copy = data.clone();
//!     let step = |controls: &[f64]| {
//!         copy.ctrl_mut().copy_from_slice(controls);
//!         copy.step().map(|()| copy.qvel()[0])
//!     };
//!     controls.rows().map(step).collect::<Result<Vec<f64>, _>>()
//! };
//! let set = |data: &mut Data, values: &[f64]| {
//!     data.edit_model(|model| {
//!         let mut all = parameters.iter().zip(values);
//!         all.try_for_each(|(parameter, &value)| parameter.set(model, value))
//!     })
//! };
//! set(&mut data, &[0.25, 1.6])?;
//! let measured = DVector::from_vec(velocities(&data)?);
//!
//! // Gauss–Newton method from the values of the drawing.
//! let mut lineariser = Lineariser::new(model, TransitionOptions::default())?;
//! let mut values = DVector::from_vec(vec![0.1, 1.0]);
//! for _ in 0..8 {
//!     set(&mut data, values.as_slice())?;
//!     let residual = DVector::from_vec(velocities(&data)?) - &measured;
//!     let (sensitivities, _) = lineariser.sensitivities(&mut data, &controls, &parameters)?;
//!     let entry = |step: usize, at: usize| sensitivities[step + 1][(1, at)];
//!     let jacobian = DMatrix::from_fn(steps, 2, entry);
//!     let normal = jacobian.tr_mul(&jacobian).cholesky().expect("both have an effect");
//!     values -= normal.solve(&jacobian.tr_mul(&residual));
//! }
//! assert!((values[0] - 0.25).abs() < 1e-6 && (values[1] - 1.6).abs() < 1e-6);
//!
//! // The gradient of the error, backwards, for any number of parameters.
//! set(&mut data, values.as_slice())?;
//! let error = |step: usize, data: &Data, slopes: &mut CostSlopes<'_>| {
//!     let error = if step == 0 { 0.0 } else { data.qvel()[0] - measured[step - 1] };
//!     slopes.state[1] = error;
//!     0.5 * error * error
//! };
//! let (gradient, _) = lineariser.cost_gradient(&mut data, &controls, &parameters, error)?;
//! // Zero at the minimum.
//! assert!(gradient.cost < 1e-12);
//! assert!(gradient.parameters.iter().all(|slope| slope.abs() < 1e-6));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
