//! Gravity compensation: actuators that carry a robot's weight.
//!
//! The bias force (gravity, Coriolis and centrifugal forces) is the force that keeps the
//! acceleration at zero. Applied through the actuators, it holds a robot in place.
//!
//! ```
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <body>
//!              <joint name="hinge" axis="0 1 0"/>
//!              <geom type="capsule" fromto="0 0 0 .5 0 0" size=".03"/>
//!            </body>
//!          </worldbody>
//!          <actuator><motor joint="hinge"/></actuator>
//!        </mujoco>"#,
//! )?;
//! let mut data = Data::new(model)?;
//! for _ in 0..1000 {
//!     data.step1()?; // position- and velocity-dependent quantities
//!     let force = data.qfrc_bias()[0];
//!     data.ctrl_mut()[0] = force;
//!     data.step2()?;
//! }
//! assert!(data.qpos()[0].abs() < 1e-9);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! Without actuators, write the same forces to [`qfrc_applied_mut`](crate::Data::qfrc_applied_mut).
//! Newer engines, such as 2.3.7 and 4.0.1, compensate the gravity of a body themselves: the
//! attribute `gravcomp="1"` of the body.
