//! Identification of parameters from measurements.
//!
//! The Gauss–Newton method fits the damping and the relative mass of a pendulum to readings of its
//! sensor. One rollout has the nominal parameters, and one more per parameter gives the
//! differences. Row k of `sensordata` is the reading in the state before step k + 1, which
//! `d.sensordata` holds after that step.
//!
//! ```
//! use std::sync::Arc;
//!
//! use mujoco_safe::nalgebra::{DMatrix, DVector};
//! use mujoco_safe::{Model, Result, Rollout};
//!
//! let model = Arc::new(Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <body name="arm">
//!              <joint name="hinge" axis="0 1 0" damping="0.1"/>
//!              <geom type="capsule" fromto="0 0 0 0 0 -.5" size=".02" mass="1"/>
//!            </body>
//!          </worldbody>
//!          <actuator><motor joint="hinge"/></actuator>
//!          <sensor><jointpos joint="hinge"/></sensor>
//!        </mujoco>"#,
//! )?);
//! let (arm, hinge) = (model.body("arm")?.id(), model.joint("hinge")?.id());
//! let controls: Vec<f64> = (0..400).map(|k| 0.5 * (0.03 * f64::from(k)).sin()).collect();
//! let nstep = controls.len();
//! // One column of readings for each column [damping, relative mass].
//! let simulate = |parameters: &DMatrix<f64>| -> Result<DMatrix<f64>> {
//!     let nroll = parameters.ncols();
//!     let result = Rollout::new(&model, nroll, nstep)
//!         .with_model_edits(|roll, edit| {
//!             edit.joint_mut(hinge).damping_mut()[0] = parameters[(0, roll)];
//!             edit.body_mut(arm).scale_mass(parameters[(1, roll)])?;
//!             edit.update_constants()
//!         })
//!         .with_shared_controls(&controls)
//!         .run()?;
//!     Ok(DMatrix::from_column_slice(nstep, nroll, result.sensordata()))
//! };
//! let truth = DMatrix::from_column_slice(2, 1, &[0.25, 1.3]);
//! let measured: DVector<f64> = simulate(&truth)?.column(0).into();
//!
//! let mut estimate = DVector::from_column_slice(&[0.1, 1.0]);
//! for _ in 0..10 {
//!     let eps = 1e-6;
//!     let mut parameters = DMatrix::from_fn(2, 3, |i, _| estimate[i]);
//!     (0..2).for_each(|i| parameters[(i, i + 1)] += eps);
//!     let readings = simulate(&parameters)?;
//!     let nominal: DVector<f64> = readings.column(0).into();
//!     let difference = |row, i| (readings[(row, i + 1)] - nominal[row]) / eps;
//!     let jacobian = DMatrix::from_fn(nstep, 2, difference);
//!     let normal = jacobian.tr_mul(&jacobian).cholesky().expect("identifiable parameters");
//!     estimate += normal.solve(&jacobian.tr_mul(&(&measured - nominal)));
//! }
//! assert!((&estimate - truth.column(0)).norm() < 1e-6, "{estimate}");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
