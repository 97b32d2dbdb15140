//! Trajectories: recording, replaying, and files; NumPy archives; MCAP files.

#[path = "../common/arbitrary.rs"]
mod arbitrary;

#[cfg(validates_binaries)]
#[path = "../common/cases.rs"]
mod cases;
#[cfg(validates_binaries)]
#[path = "../common/child.rs"]
mod child;

#[cfg(feature = "mcap")]
#[path = "../common/chunk_crc.rs"]
mod chunk_crc;
mod comparison;
#[cfg(validates_binaries)]
mod flight;
#[cfg(any(feature = "mcap", feature = "npz"))]
#[path = "../common/installed.rs"]
mod installed;
#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "npz")]
mod npz;
#[cfg(feature = "npz")]
mod numpy;
#[cfg(any(feature = "mcap", feature = "npz"))]
mod python;
mod recording;
mod sensordata;
#[cfg(feature = "serde")]
mod serde;
