//! Trajectories: recording, replaying, and files; NumPy archives.

#[path = "../common/arbitrary.rs"]
mod arbitrary;

#[cfg(validates_binaries)]
#[path = "../common/cases.rs"]
mod cases;
#[cfg(validates_binaries)]
#[path = "../common/child.rs"]
mod child;

#[cfg(validates_binaries)]
mod flight;
#[cfg(feature = "npz")]
#[path = "../common/installed.rs"]
mod installed;
#[cfg(feature = "npz")]
mod npz;
#[cfg(feature = "npz")]
mod numpy;
mod recording;
mod sensordata;
#[cfg(feature = "serde")]
mod serde;
