//! A mocap body as a gripper.
//!
//! The program sets the pose of a mocap body, which becomes a gripper by activating and
//! deactivating a weld constraint.
//! [`Data::weld_at_present_pose`](crate::Data::weld_at_present_pose) activates one at the present
//! relative pose.
//!
//! ```
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <geom type="plane" size="1 1 .1"/>
//!            <body name="hand" mocap="true" pos="0 0 .3">
//!              <geom size=".02" contype="0" conaffinity="0"/>
//!            </body>
//!            <body name="cube" pos="0 0 .05">
//!              <freejoint/><geom type="box" size=".05 .05 .05" mass=".2"/>
//!            </body>
//!          </worldbody>
//!          <equality>
//!            <weld name="grasp" body1="hand" body2="cube" relpose="0 0 -.07 1 0 0 0"
//!                  active="false"/>
//!          </equality>
//!        </mujoco>"#,
//! )?;
//! let mut data = Data::new(model)?;
//! data.set_equality_active("grasp", true)?;
//! for step in 0..500 {
//!     let mut hand = data.body_mut("hand")?;
//!     hand.mocap_pos_mut().expect("a mocap body")[2] = 0.12 + 0.001 * f64::from(step);
//!     data.step()?;
//! }
//! assert!(data.body("cube")?.xpos()[2] > 0.4);
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
