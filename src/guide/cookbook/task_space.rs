//! Task-space (operational-space) control: the tip of an arm follows a circle.
//!
//! The torques give the tip a desired acceleration: with the Jacobian `J` of the tip, the inertia
//! `M` of the joints and the bias forces, the inertia of the task is `(J M⁻¹ Jᵀ)⁻¹` (Khatib 1987).
//! The null space of the task holds the posture.
//!
//! ```
//! use std::f64::consts::PI;
//!
//! use mujoco_safe::nalgebra::{DMatrix, DVector, Vector3};
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <compiler angle="radian"/>
//!          <default>
//!            <joint damping=".1" armature=".01" axis="0 1 0"/>
//!            <geom type="capsule" size=".04" contype="0" conaffinity="0"/>
//!          </default>
//!          <worldbody>
//!            <body pos="0 0 .2">
//!              <joint name="turn" axis="0 0 1"/><geom fromto="0 0 0 0 0 .2"/>
//!              <body pos="0 0 .2">
//!                <joint name="shoulder"/><geom fromto="0 0 0 0 0 .4"/>
//!                <body pos="0 0 .4">
//!                  <joint name="elbow"/><geom fromto="0 0 0 0 0 .35"/>
//!                  <body name="hand" pos="0 0 .35">
//!                    <joint name="wrist"/><geom fromto="0 0 0 0 0 .1"/>
//!                    <site name="tip" pos="0 0 .15"/>
//!                  </body>
//!                </body>
//!              </body>
//!            </body>
//!          </worldbody>
//!          <actuator>
//!            <motor joint="turn"/><motor joint="shoulder"/>
//!            <motor joint="elbow"/><motor joint="wrist"/>
//!          </actuator>
//!          <keyframe><key name="home" qpos="0 .6 1.2 .8"/></keyframe>
//!        </mujoco>"#,
//! )?;
//! let home = DVector::from_column_slice(model.keyframe("home")?.qpos());
//! let mut data = Data::new(model)?;
//! data.reset_to_key("home")?;
//! data.forward()?;
//! let (radius, rate) = (0.1, PI); // m, rad/s
//! let centre = Vector3::from(*data.site("tip")?.xpos()) - Vector3::new(0.0, radius, 0.0);
//! let mut largest = 0.0_f64;
//! while data.time() < 3.0 {
//!     data.step1()?; // kinematics, inertia and bias of the present state
//!     let (sin, cos) = (rate * data.time()).sin_cos();
//!     let target = centre + radius * Vector3::new(0.0, cos, sin);
//!     let velocity = radius * rate * Vector3::new(0.0, -sin, cos);
//!     let acceleration = radius * rate.powi(2) * Vector3::new(0.0, -cos, -sin);
//!
//!     let tip = *data.site("tip")?.xpos();
//!     let j = data.jac_site("tip")?.linear.to_nalgebra(); // (3, nv)
//!     let j_dot = data.jac_dot(tip, "hand")?.linear.to_nalgebra();
//!     let m = data.full_m()?.to_nalgebra();
//!     let [q, v] = [data.qpos(), data.qvel()].map(DVector::from_column_slice);
//!     let forces = [data.qfrc_bias(), data.qfrc_passive()];
//!     let [bias, passive] = forces.map(DVector::from_column_slice);
//!
//!     let error = target - Vector3::from(tip);
//!     if data.time() > 1.0 {
//!         largest = largest.max(error.norm());
//!     }
//!     let factor = m.clone().cholesky().expect("an inertia is positive definite");
//!     let m_inverse_jt = factor.solve(&j.transpose());
//!     let inertia = (&j * &m_inverse_jt).try_inverse().expect("the arm is not stretched");
//!     let wanted = acceleration + 400.0 * error + 40.0 * (velocity - &j * &v) - &j_dot * &v;
//!     let posture = &m * (25.0 * (&home - q) - 10.0 * &v);
//!     let map = j.transpose() * &inertia; // from accelerations of the tip to torques
//!     let null = DMatrix::identity(4, 4) - &map * m_inverse_jt.transpose();
//!     let torque = map * wanted + null * posture + bias - passive;
//!     data.ctrl_mut().copy_from_slice(torque.as_slice());
//!     data.step2()?;
//! }
//! assert!(largest < 1e-3, "the tip is up to {largest} m beside its target");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
