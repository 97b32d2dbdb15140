//! Sensors by name.
//!
//! ```
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! data.forward()?;
//! for sensor in data.sensors() {
//!     let (kind, dim) = (sensor.in_model().sensor_type(), sensor.in_model().dim());
//!     println!("{:?}: {kind:?}, {dim} values, {:?}", sensor.name(), sensor.data());
//! }
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
