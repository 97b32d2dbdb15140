//! Saving a video or an animation.
//!
#![doc = include_str!("../../record/picture.html")]
//!
//! A recorder takes the images that are due by simulated time. The extension of the path selects
//! the format: `.mp4`, `.mov` and `.mkv` by the program `ffmpeg` (`apt-get install ffmpeg`), `.gif`
//! and `.png` without it. Needs the feature `renderer`, and no display.
//!
#![cfg_attr(feature = "renderer", doc = "```no_run")]
#![cfg_attr(not(feature = "renderer"), doc = "```ignore")]
//! use mujoco_safe::record::{Recorder, RecorderOptions};
//! use mujoco_safe::render::Renderer;
//! use mujoco_safe::{Data, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let mut renderer = Renderer::new(data.model(), 640, 480)?;
//! let options = RecorderOptions::default().with_frames_per_second(30.0);
//! let mut recorder = Recorder::create("fall.mp4", options)?;
//! while data.time() < 2.0 {
//!     if recorder.is_due(data.time()) {
//!         data.forward()?; // the poses of the present state
//!         let image = renderer.snapshot(&mut data, "side")?.rgb()?;
//!         recorder.push(&image, data.time())?;
//!     }
//!     data.step()?;
//! }
//! recorder.finish()?;
//! # Ok::<(), mujoco_safe::render::RenderError>(())
//! ```
//!
//! In the viewer, F1 lists the keys that record what the window shows.
