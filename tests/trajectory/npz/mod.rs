//! NumPy archives of arrays, trajectories and rollouts.
#![forbid(unsafe_code)]

mod arrays;
mod rollouts;
mod trajectories;
