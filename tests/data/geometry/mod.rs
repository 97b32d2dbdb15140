//! Distances, rays and contacts against what geometry says.
#![forbid(unsafe_code)]

mod contact;
mod distance;
mod ray;
