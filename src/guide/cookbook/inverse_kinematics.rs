//! Inverse kinematics with a Jacobian.
//!
//! Damped least squares: `dq = Jᵀ (J Jᵀ + λ² I)⁻¹ e` (Buss, *Introduction to inverse kinematics
//! with Jacobian transpose, pseudoinverse and damped least squares methods*, 2009).
//! [`Matrix::transposed`](crate::Matrix::transposed) is a nalgebra view of the transpose without a
//! copy.
//!
//! ```
//! use mujoco_safe::nalgebra::{DMatrix, Vector3};
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <default><geom type="capsule" fromto="0 0 0 .4 0 0" size=".03"/></default>
//!          <worldbody>
//!            <body>
//!              <joint name="shoulder" axis="0 1 0"/><geom/>
//!              <body pos=".4 0 0">
//!                <joint name="elbow" axis="0 1 0"/><geom/>
//!                <site name="tip" pos=".4 0 0"/>
//!              </body>
//!            </body>
//!          </worldbody>
//!        </mujoco>"#,
//! )?;
//! let tip = model.site("tip")?.id();
//! let mut data = Data::new(model)?;
//! data.qpos_mut().copy_from_slice(&[-0.5, 1.0]);
//! let target = Vector3::new(0.4, 0.0, 0.3);
//! for _ in 0..100 {
//!     data.fwd_position()?;
//!     let error = target - Vector3::from(*data.site(tip).xpos());
//!     let jacobian = data.jac_site(tip)?.linear;
//!     let j = jacobian.transposed(); // (nv, 3): a view
//!     let damped = j.tr_mul(&j) + 1e-4 * DMatrix::<f64>::identity(3, 3);
//!     let dq = &j * damped.lu().solve(&error).expect("a positive definite matrix");
//!     data.integrate_pos(dq.as_slice(), 1.0)?;
//! }
//! data.fwd_position()?;
//! assert!((target - Vector3::from(*data.site(tip).xpos())).norm() < 1e-4);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! An orientation as target: the rows of `data.jac_site(tip)?.angular`, with
//! [`math::sub_quat`](crate::math::sub_quat) for the error. The joints' ranges are not respected:
//! clamp `qpos`, or solve a bounded problem with [`BoxQp`](crate::math::BoxQp).
