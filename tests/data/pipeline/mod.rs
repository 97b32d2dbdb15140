//! Stages of the pipeline: out of order they are rejected, in order they equal forward dynamics.
#![forbid(unsafe_code)]

mod features;
mod order;
mod readings;
