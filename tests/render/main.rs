//! Rendering and recording.

#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/child.rs"]
mod child;
#[path = "pictures/difference.rs"]
mod difference;

mod batch;
mod content;
mod detail;
mod extreme_scenes;
#[path = "../common/installed.rs"]
mod installed;
mod linked;
mod optics;
// The pictures are those of the models and lights of 2.2.2.
#[cfg(not(engine_since = "2.3.0"))]
mod pictures;
mod pinhole;
mod quiet;
mod rays;
mod record;
mod row;
#[path = "pictures/scenes.rs"]
mod scenes;
mod skins;
mod snapshots;
mod stage;
