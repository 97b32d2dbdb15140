//! State estimation of a floating base.
//!
//! An extended Kalman filter estimates the complete state of a monopod that stands on one foot,
//! with a trunk on two driven joints, from a gyroscope, an accelerometer and the encoders of the
//! joints. It runs beside the robot, which here is a simulation with disturbances that the filter
//! does not know. The bounds of its errors are printed as ±2σ.
//!
//! The theory and the meaning of each noise are in [`estimation`](crate::estimation). For a robot
//! that walks, add noise of the [forces of
//! contacts](crate::estimation::ProcessNoise::with_contact_forces), as the example
//! `state_estimation` does. The noise of this program needs the command `cargo add rand rand_distr
//! rand_xoshiro`.
//!
//! ```
//! use mujoco_safe::estimation::{ExtendedKalmanFilter, FixedLagSmoother};
//! use mujoco_safe::estimation::{Measurement, ProcessNoise};
//! use mujoco_safe::{Data, Matrix, Model};
//! use rand::SeedableRng;
//! use rand_distr::{Distribution, StandardNormal};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <option timestep=".005"/>
//!          <default><joint damping=".5"/></default>
//!          <worldbody>
//!            <geom type="plane" size="1 1 .1"/>
//!            <body name="foot" pos="0 0 .049">
//!              <freejoint/>
//!              <geom type="box" size=".2 .15 .05" mass="2"/>
//!              <body pos="0 0 .1">
//!                <joint name="pitch" axis="0 1 0"/>
//!                <geom type="capsule" fromto="0 0 0 0 0 .2" size=".03" mass=".5"/>
//!                <body pos="0 0 .2">
//!                  <joint name="roll" axis="1 0 0"/>
//!                  <geom type="box" size=".05 .1 .05" mass="1"/>
//!                  <site name="imu"/>
//!                </body>
//!              </body>
//!            </body>
//!          </worldbody>
//!          <actuator>
//!            <position name="pitch" joint="pitch" kp="50"/>
//!            <position name="roll" joint="roll" kp="50"/>
//!          </actuator>
//!          <sensor>
//!            <gyro site="imu" noise=".01"/>
//!            <accelerometer site="imu" noise=".1"/>
//!            <jointpos joint="pitch" noise=".002"/>
//!            <jointpos joint="roll" noise=".002"/>
//!          </sensor>
//!        </mujoco>"#,
//! )?;
//! let mut robot = Data::new(model)?;
//! robot.step_n(200)?; // settles on the floor
//! let model = robot.model().clone();
//!
//! // Disturbances: 2 N on the trunk, 1 mrad of the servos, and small errors of the model,
//! // which also allow for the kinks of contacts.
//! let nx = 2 * model.nv();
//! let noise = ProcessNoise::new(&model)
//!     .with_body_forces(3, 2.0, 0.0)?
//!     .with_controls(&[0.001; 2])?
//!     .with_covariance(&Matrix::from_diagonal(&vec![3e-9; nx]))?;
//! // All sensors with noise, here the whole of `sensordata`.
//! let sensors = Measurement::new(&model).with_noisy_sensors()?;
//! let deviations: Vec<f64> = sensors.deviations().collect();
//! let start = Matrix::from_diagonal(&vec![1e-6; nx]);
//! let filter = ExtendedKalmanFilter::new(robot.clone(), &start, noise, sensors)?;
//! let mut smoother = FixedLagSmoother::new(filter.with_gate(0.9999)?, 50)?;
//!
//! let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(1);
//! let mut normal = |deviation: f64| -> f64 {
//!     let number: f64 = StandardNormal.sample(&mut random);
//!     deviation * number
//! };
//! let (mut nees, mut states) = (0.0, Vec::new());
//! for step in 0..400 {
//!     let target = 0.1 * (0.02 * f64::from(step)).sin();
//!     // The robot: its servos are not exact, and something pushes the trunk.
//!     let controls = [target, 0.5 * target];
//!     for (target, ctrl) in controls.iter().zip(robot.ctrl_mut()) {
//!         *ctrl = target + normal(0.001);
//!     }
//!     robot.xfrc_applied_mut()[3] = [normal(2.0), normal(2.0), normal(2.0), 0.0, 0.0, 0.0];
//!     let state = robot.physics_state();
//!     robot.step()?;
//!
//!     // The filter: the readings after a step are those of the state before it.
//!     let readings = robot.sensordata().iter().zip(&deviations);
//!     let readings: Vec<f64> = readings.map(|(reading, d)| reading + normal(*d)).collect();
//!     smoother.update(&controls, &readings)?;
//!     let mut truth = robot.clone();
//!     truth.set_physics_state(&state)?;
//!     // Roll and pitch of the foot.
//!     nees += smoother.filter().nees(&truth, 3..5)?.unwrap_or(f64::INFINITY);
//!     states.push(state);
//!     smoother.predict(&controls)?;
//! }
//! let present = smoother.filter().covariance()[(3, 3)].sqrt().to_degrees();
//! println!("NEES of roll and pitch {:.1}, roll ±{:.2}°", nees / 400.0, 2.0 * present);
//! // The mean of a consistent filter is 2, and that of a cautious one is smaller. With 1e-10
//! // in place of 3e-9, it is 6: the filter trusts itself too much.
//! assert!(nees / 400.0 < 2.0);
//!
//! // With a lag of a quarter of a second, the estimates are better.
//! smoother.smooth()?;
//! let past = smoother.covariance(0)[(3, 3)].sqrt().to_degrees();
//! println!("a quarter of a second ago, roll ±{:.2}°", 2.0 * past);
//! assert!(past < present);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
