//! The parts of the pipeline: out of order they are refused, in order they are forward dynamics.
#![forbid(unsafe_code)]

mod order;
mod readings;
