//! MCAP files: logs and trajectories, read by this crate and by the official reader for Python, and
//! damaged files.

mod damaged;
mod deformables;
mod joint_states;
mod logs;
mod official_reader;
