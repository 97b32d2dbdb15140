//! Interactive window for a simulation.
//!
#![doc = include_str!("picture.html")]
//!
//! | | steps the simulation | shows the window |
//! |---|---|---|
//! | [`Viewer::run`] | the viewer, with a controller, recorded trajectories or passive dynamics | the calling thread, which blocks |
//! | [`run`] | the program, on another thread | the calling thread, which blocks |
//! | [`launch`] | the program, on the calling thread | a background thread |
//!
//! ```no_run
//! use mujoco_safe::viewer::Viewer;
//! use mujoco_safe::{Data, sample};
//!
//! Viewer::new().run(Data::new(sample::humanoid())?)?;
//! # Ok::<(), mujoco_safe::viewer::ViewerError>(())
//! ```
//!
//! [`Viewer::run`] starts paused; Space resumes. **F1 lists all keys and mouse gestures**, on the
//! screen and on the terminal. A double-click selects a body; Ctrl and the right button pull it.
//! Tab and Shift+Tab open and close the side panels, which are open from the start in a window with
//! place for them ([`ViewerOptions::panels`]): simulation, trajectories, keyframes, visualisation,
//! appearance, physics options and watched values on the left; search, controls, joints and the
//! selected body on the right. The next window has the layout that the user has given to this one
//! ([`ViewerOptions::layout`]). The panel of the simulation also adds noise to the controls, and
//! saves the model and the engine's listings. F3 and F4 open plots there. The timeline at the
//! bottom shows the states since the start, or the records of a trajectory; a click or a drag goes
//! to one. Ctrl+O opens a model file, and Ctrl+L loads the present one again. A controller can add
//! plots, sliders for its parameters and drawings: see [`Instruments`]. A model file that is
//! dropped onto the window is loaded, and a change of [`ViewerOptions::file`] is shown at once,
//! while the simulation continues ([`ViewerOptions::watch`]).
//!
//! Keys have the meaning of the engine's `simulate`: digits toggle the geom group of the same
//! number, `-` and `=` change the speed, `[` and `]` the camera, and Esc selects the free camera.
//! Only Ctrl+Q, the window's close button and the signals of Ctrl+C in the terminal, of `kill` and
//! of a closed terminal (SIGINT, SIGTERM, SIGHUP) end the session. A running recording is finished
//! then. There is only this key map, so that F1, the documentation and `simulate` agree in every
//! window.
//!
//! # Platforms
//!
//! Tested on Linux with X11, with a software driver on a virtual display. On Wayland the window
//! runs through XWayland. The code supports Windows and macOS, but has not been tested there. On
//! macOS [`launch`] is missing, because windows belong to the main thread, and Cmd replaces Ctrl.
//!
//! A window needs the libraries of a desktop. On a minimal Debian they are the packages `libx11-6
//! libx11-xcb1 libxcursor1 libxi6 libxkbcommon0 libxkbcommon-x11-0 libvulkan1 mesa-vulkan-drivers`.
//!
//! # Threads
//!
//! Physics and window run on two threads that share only a link: requests flow to the physics,
//! snapshots and events flow to the window. The simulation data is never copied completely. The
//! physics follows real time and drops time that it cannot catch up. The window is drawn when
//! something has changed, and sleeps otherwise. The panels show a running simulation ten times per
//! second. A frame renders the scene only if it has changed, and repaints only the parts of the
//! window that have changed. The first window installs the engine's clock, as
//! [`enable_timers`](crate::data::enable_timers) does, for the plot of computing times.

#![forbid(unsafe_code)]

mod endpoint;
mod error;
mod handle;
mod input;
mod instruments;
mod launch;
mod link;
mod options;
mod panel;
mod remembered;
mod signal;
mod simulation;
#[cfg(feature = "_test-hooks")]
#[doc(hidden)]
pub mod test_hooks;
mod view;
mod window;

pub use self::error::ViewerError;
pub use self::handle::ViewerHandle;
pub use self::input::{Key, KeyPress, Modifiers};
pub use self::instruments::Instruments;
#[cfg(not(target_os = "macos"))]
pub use self::launch::launch;
pub use self::launch::{Viewer, run};
pub use self::options::{Theme, ViewerOptions};

#[cfg(test)]
mod tests;
