//! NumPy archives of arrays and of rollouts.
#![forbid(unsafe_code)]

mod arrays;
#[path = "../common/numpy.rs"]
mod numpy;
mod rollouts;
