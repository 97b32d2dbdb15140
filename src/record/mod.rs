//! Recording of video and animations: numbered PNG files, animated PNG and GIF, and video through
//! the program `ffmpeg`.
//!
#![doc = include_str!("picture.html")]
//!
//! *A humanoid under a linear-quadratic regulator is pushed, in slow motion: example `record`.*
//!
//! A [`Recorder`] samples images by simulation time, independently of the time that rendering
//! takes. Check [`is_due`](Recorder::is_due) before rendering an image:
//!
//! ```
//! use mujoco_safe::record::{Recorder, RecorderOptions};
//! use mujoco_safe::render::RgbImage;
//! use mujoco_safe::{Data, sample};
//!
//! let folder = tempfile::tempdir()?; // cargo add tempfile
//! let path = folder.path().join("cartpole.gif");
//! let mut data = Data::new(sample::cartpole())?;
//! data.qvel_mut()[1] = 2.0;
//! // The extension selects the format, here GIF.
//! let mut recorder = Recorder::create(&path, RecorderOptions::default().with_frames_per_second(20.0))?;
//! while data.time() < 0.5 {
//!     if recorder.is_due(data.time()) {
//!         // For brevity this draws one pixel; use `render::Renderer` for images of the scene.
//!         let mut picture = RgbImage::new(256, 256);
//!         let (sine, cosine) = data.qpos()[1].sin_cos();
//!         picture.set_pixel((128.0 + 100.0 * sine) as usize, (128.0 - 100.0 * cosine) as usize, [255; 3]);
//!         recorder.push(&picture, data.time())?;
//!     }
//!     data.step()?;
//! }
//! let summary = recorder.finish()?;
//! assert_eq!((summary.frames, summary.seconds), (10, 0.5));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

mod clock;
mod encoder;
mod ffmpeg;
mod format;
mod gif;
mod options;
mod palette;
mod png;
mod recorder;

pub use self::format::Format;
pub use self::options::RecorderOptions;
pub use self::recorder::{Recorder, Summary};
