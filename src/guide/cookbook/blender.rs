//! A motion for Blender and other programs: an animated glTF file.
//!
//! One file (`.glb`) holds the model and its motions. Blender imports it (File, Import, glTF 2.0),
//! Windows and macOS show it, and so do web viewers, presentations and game engines. Needs the
//! feature `gltf`, and no display. For a page that plays by itself see
//! [`web_page`](super::web_page).
//!
#![cfg_attr(feature = "gltf", doc = "```")]
#![cfg_attr(not(feature = "gltf"), doc = "```ignore")]
//! use mujoco_safe::gltf::{self, GltfOptions};
//! use mujoco_safe::{Data, RandomController, Trajectory, sample};
//!
//! // Two falls from the same state become two animations.
//! let mut data = Data::new(sample::humanoid())?;
//! let mut falls = Vec::new();
//! for seed in 0..2 {
//!     data.reset()?;
//!     let mut fall = Trajectory::new(data.model());
//!     fall.record(&mut data, &mut RandomController::new(seed), 400)?;
//!     falls.push((format!("seed {seed}"), fall));
//! }
//! let path = std::env::temp_dir().join("mujoco_safe_falls.glb");
//! let options = GltfOptions::default().with_frames_per_second(30.0);
//! let animations = falls.iter().map(|(label, fall)| (label.as_str(), fall));
//! let left_out = gltf::save(&path, data.model(), animations, &options)?;
//! println!("not in the file: {left_out:?}");
//!
//! // The present state, without an animation.
//! let still = std::env::temp_dir().join("mujoco_safe_state.glb");
//! data.save_glb(&still, &GltfOptions::default())?;
//! # std::fs::remove_file(path).ok();
//! # std::fs::remove_file(still).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! The nodes have the names and the tree of the bodies, so a program can attach a camera to a body
//! or replace its shape. Select `Unitless` as the lighting mode when importing into Blender: the
//! lights are then as bright as in the viewer.
