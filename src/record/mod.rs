//! Moving pictures: numbered PNG files, animated PNG and GIF, and video through the program `ffmpeg`.
//!
//! A [`Recorder`] goes by the time of the simulation, however long drawing takes. Ask it [whether a picture is
//! due](Recorder::is_due) before drawing one:
//!
//! ```
//! use mujoco_safe::record::{Recorder, RecorderOptions};
//! use mujoco_safe::render::Picture;
//! use mujoco_safe::{Data, sample};
//!
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("cartpole.gif");
//! let mut data = Data::new(sample::cartpole())?;
//! data.qvel_mut()[1] = 2.0;
//! // The path says what is written: here `cartpole.gif`.
//! let mut recorder = Recorder::create(&path, RecorderOptions { frames_per_second: 20.0, ..Default::default() })?;
//! while data.time() < 0.5 {
//!     if recorder.is_due(data.time()) {
//!         // A renderer draws better ones.
//!         let mut picture = Picture::new(256, 256);
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
//!
//! | file | what is in it |
//! |---|---|
//! | `format.rs` | [`Format`]: which file a path asks for |
//! | `recorder.rs` | [`Recorder`], [`RecorderOptions`] |
//! | `clock.rs` | which picture belongs to which frame |
//! | `encoder.rs` | what writes pictures |
//! | `png.rs` | numbered files, and animated PNG |
//! | `gif.rs`, `palette.rs` | animated GIF, and its colours |
//! | `ffmpeg.rs` | video |

#![forbid(unsafe_code)]

mod clock;
mod encoder;
mod ffmpeg;
mod format;
mod gif;
mod palette;
mod png;
mod recorder;

pub use self::format::Format;
pub use self::recorder::{Recorder, RecorderOptions, Summary};
