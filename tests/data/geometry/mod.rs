//! Distances, rays and contacts against analytic geometry.
#![forbid(unsafe_code)]

mod contact;
mod distance;
mod ray;
