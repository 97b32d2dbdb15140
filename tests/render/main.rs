//! Rendering and recording.

#[path = "../common/child.rs"]
mod child;

mod content;
mod extreme_scenes;
mod optics;
mod pictures;
mod pinhole;
mod quiet;
mod rays;
mod record;
mod snapshots;
mod stage;
