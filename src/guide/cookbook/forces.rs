//! An applied force, and the forces of contacts.
//!
//! ```
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <geom name="floor" type="plane" size="5 5 .1"/>
//!            <body name="box" pos="0 0 .1">
//!              <freejoint/><geom name="box" type="box" size=".1 .1 .1" mass="2"/>
//!            </body>
//!          </worldbody>
//!        </mujoco>"#,
//! )?;
//! let mut data = Data::new(model)?;
//! data.body_mut("box")?.xfrc_applied_mut()[0] = 5.0; // N, along x; persists until changed
//! for _ in 0..500 {
//!     data.step()?;
//! }
//! let geom = data.model().geom("box")?.id();
//! let mut total = [0.0; 3];
//! for contact in data.contacts() {
//!     let force = contact.force_on(geom)?;
//!     (0..3).for_each(|axis| total[axis] += force[axis]);
//! }
//! assert!((total[0] + 5.0).abs() < 0.1, "friction: {total:?}");
//! assert!((total[2] - 2.0 * 9.81).abs() < 0.1, "the floor: {total:?}");
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
