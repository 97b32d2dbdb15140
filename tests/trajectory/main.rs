//! Trajectories: recording, replaying, and files.

#[path = "../common/arbitrary.rs"]
mod arbitrary;
#[cfg(feature = "npz")]
#[path = "../common/numpy.rs"]
mod numpy;

#[cfg(feature = "npz")]
mod npz;
mod recording;
mod sensordata;
#[cfg(feature = "serde")]
mod serde;
