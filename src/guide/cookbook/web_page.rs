//! A motion as a web page: one file that plays in a browser, offline.
//!
#![doc = include_str!("../../html/picture.html")]
//!
//! The page holds the model, the motion and a player. Send it by mail, attach it to a report or
//! store it with the results of a test: it opens from disk in Chromium, Firefox and Safari, on
//! phones too. Needs the feature `html`, and no display.
//!
#![cfg_attr(feature = "html", doc = "```")]
#![cfg_attr(not(feature = "html"), doc = "```ignore")]
//! use mujoco_safe::html::{self, HtmlOptions, Signal};
//! use mujoco_safe::{Data, RandomController, Trajectory, sample};
//!
//! // Three falls from the same state.
//! let mut data = Data::new(sample::humanoid())?;
//! let mut falls = Vec::new();
//! for seed in 0..3 {
//!     data.reset()?;
//!     let mut fall = Trajectory::new(data.model());
//!     fall.record(&mut data, &mut RandomController::new(seed), 400)?;
//!     falls.push((format!("seed {seed}"), fall));
//! }
//!
//! // The first is drawn in full, the others transparent.
//! let options = HtmlOptions::default()
//!     .with_title("Three falls")
//!     .with_camera("side")
//!     .with_signals([Signal::Qpos("left_knee".into()), Signal::Ctrl("left_knee".into())])
//!     .with_notes([(0.5, "falls".into())]);
//! let path = std::env::temp_dir().join("mujoco_safe_three_falls.html");
//! let shown = falls.iter().map(|(label, fall)| (label.as_str(), fall));
//! let left_out = html::save(&path, data.model(), shown, &options)?;
//! assert!(left_out.is_empty(), "the page draws everything");
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! The space bar plays, the arrows step, `?` lists the other keys. A click names a geom and its
//! body, and a click in a plot seeks. The address of the page can end with a time to start at, s:
//! `fall.html#t=0.5`.
