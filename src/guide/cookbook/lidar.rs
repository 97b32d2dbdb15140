//! A lidar: distances along rays.
//!
//! ```
//! use mujoco_safe::data::RayOptions;
//! use mujoco_safe::{Data, Model};
//!
//! let model = Model::from_xml_str(
//!     r#"<mujoco>
//!          <worldbody>
//!            <geom name="wall" type="box" pos="2 0 .5" size=".1 3 .5"/>
//!            <body name="robot" pos="0 0 .2">
//!              <freejoint/><geom size=".1"/><site name="lidar"/>
//!            </body>
//!          </worldbody>
//!        </mujoco>"#,
//! )?;
//! let mut data = Data::new(model)?;
//! data.forward()?;
//! let angles = (-45..=45).map(|degrees| f64::from(degrees).to_radians());
//! let directions: Vec<[f64; 3]> = angles.map(|a| [a.cos(), a.sin(), 0.0]).collect();
//! let options = RayOptions::default().with_bodyexclude(data.model().body("robot")?);
//! let mut hits = vec![None; directions.len()];
//! let origin = *data.site("lidar")?.xpos();
//! data.multi_ray_into(origin, &directions, &options, 10.0, &mut hits)?;
//! let ahead = hits[45].expect("a wall");
//! assert!((ahead.distance - 1.9).abs() < 1e-9);
//! assert_eq!(data.geom(ahead.geom).name(), Some("wall"));
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
