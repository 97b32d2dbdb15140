//! Identification of parameters from measurements.
//!
//! A log has the motor's torque and the readings of an encoder, of a pendulum whose damping and
//! mass are unknown. The encoder reports 4 ms late, which is unknown too. [`identification`] finds
//! all three, with confidence intervals. The example `find_load` finds and compensates the load of
//! an arm.
//!
//! ```
//! use std::sync::Arc;
//!
//! use mujoco_safe::identification::{Experiment, Identification, Measurement};
//! use mujoco_safe::identification::{Options, Signal, Unknown};
//! use mujoco_safe::rollout::Parameter;
//! use mujoco_safe::{Data, Model};
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
//!          <sensor><jointpos name="encoder" joint="hinge"/></sensor>
//!        </mujoco>"#,
//! )?);
//! let (arm, hinge) = (model.body("arm")?.id(), model.joint("hinge")?.id());
//!
//! // The log, of a simulation with other values: usually Signal::load_csv reads it.
//! let mut real = Data::new(&model)?;
//! real.edit_model(|model| {
//!     model.joint_mut(hinge).damping_mut()[0] = 0.25;
//!     model.body_mut(arm).scale_mass(1.3)?;
//!     model.update_constants()
//! })?;
//! let (mut times, mut torques, mut angles) = (Vec::new(), Vec::new(), Vec::new());
//! for k in 0..800 {
//!     real.ctrl_mut()[0] = 0.5 * (0.03 * f64::from(k)).sin();
//!     times.push(real.time());
//!     torques.push(real.ctrl()[0]);
//!     angles.push(real.qpos()[0]);
//!     real.step()?;
//! }
//! let late: Vec<f64> = times.iter().map(|time| time + 0.004).collect();
//!
//! let start = Data::new(&model)?; // the state in which the log starts
//! let encoder = Measurement::of_sensor(&model, "encoder", Signal::scalar(late, angles)?)?;
//! let log = Experiment::new("log", &start)
//!     .with_controls(Signal::scalar(times, torques)?)
//!     .with_measurement(encoder.with_deviation(1e-3));
//! let unknowns = vec![
//!     Unknown::parameter(&model, Parameter::JointDamping(hinge))?,
//!     Unknown::parameter(&model, Parameter::MassFactor(arm))?.logarithmic(),
//!     Unknown::delay("encoder").between(0.0, 0.02),
//! ];
//! let fit = Identification::new(unknowns)?.with_experiment(log)?.solve(Options::default())?;
//! println!("{fit}"); // a table with confidence intervals
//! for (estimate, truth) in fit.estimates().iter().zip([0.25, 1.3, 0.004]) {
//!     assert!((estimate.value - truth).abs() < 1e-4 * truth, "{fit}");
//! }
//! assert!(fit.undetermined().is_empty()); // the log determines all three
//! let identified = fit.model(&model)?;
//! # assert!((identified.body_mass()[1] - 1.3).abs() < 1e-3);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! With the feature `html`, `fit.save_report("fit.html", &held_out)?` writes a page with the
//! values, what the log does not determine, and plots of the measured and simulated readings, also
//! of the logs that [`validate`](crate::identification::Fit::validate) has simulated.
//!
//! Unknowns can also be gains and biases of sensors, any array of the model
//! ([`Parameter::field`](crate::rollout::Parameter::field)), and numbers that a closure writes
//! ([`Unknown::edit`](crate::identification::Unknown::edit)). For long or unstable motions, divide
//! a log into [segments](crate::identification::Experiment::with_segments).
//!
//! [`identification`]: crate::identification
