//! A window to look at a simulation, and to work on it while it runs.
//!
//! | | who steps | where the window is |
//! |---|---|---|
//! | [`Viewer::run`] | the viewer: a controller, recorded trajectories, the dynamics alone | in this thread, which waits |
//! | [`run`] | the program, in another thread | in this thread, which waits |
//! | [`launch`] | the program, in this thread | in a thread of its own |
//!
//! ```no_run
//! use mujoco_safe::viewer::Viewer;
//! use mujoco_safe::{Data, sample};
//!
//! Viewer::new().run(Data::new(sample::humanoid())?)?;
//! # Ok::<(), mujoco_safe::viewer::ViewerError>(())
//! ```
//!
//! It begins paused: Space starts it. **F1 lists all keys and what the mouse does**, on the screen and on the terminal. A body is
//! selected with a double-click and pulled with Ctrl and the right button. Ctrl+1 and Ctrl+2 open the panels: simulation,
//! trajectories, keyframes, what is shown, physics, numbers to watch; controls, joints and the selected body. F3 and F4 plot. A
//! model's file that is dropped onto the window is loaded.
//!
//! # Platforms
//!
//! Tested on Linux with X11, with a driver in software and without a screen. On Wayland it runs through XWayland. Windows and
//! macOS are provided for in the code (there [`launch`] is missing, since windows belong to the main thread, and Cmd takes the
//! place of Ctrl), but have not been tried.
//!
//! A window needs the libraries that every desktop has; on a bare Debian they are the packages `libx11-6 libx11-xcb1 libxcursor1
//! libxi6 libxkbcommon0 libxkbcommon-x11-0 libvulkan1 mesa-vulkan-drivers`.
//!
//! # How it works
//!
//! Physics and window are two threads that share nothing but a link: requests go one way, snapshots and events the other.
//! No simulation is ever copied. Physics keeps to real time and gives up what it cannot reach; a window is drawn when there is
//! something new to be seen, and sleeps otherwise. The first window gives the engine a clock, as
//! [`enable_timers`](crate::enable_timers) does, for the plot of computing times.
//!
//! | file | what is in it |
//! |---|---|
//! | `launch.rs`, `error.rs` | [`Viewer`], [`run`], [`launch`], and why there is no window |
//! | `window/` | the window: events, frames, files |
//! | `panel/` | what lies over the picture |
//! | `input/` | keys and mouse: one table of what each does |
//! | `request.rs`, `event.rs`, `snapshot.rs` | what the two threads tell each other |
//! | `expected.rs` | the state that requests without an answer lead to |
//! | `link.rs` | how: a queue, and a slot for the newest snapshot |
//! | `view.rs` | the window's side: camera, what is shown |
//! | `bridge/` | the physics' side: requests done, snapshots made |
//! | `simulation/` | what the physics thread owns: modes, pause, steps, history |
//! | `mode/` | controller, trajectories, passive dynamics |
//! | `clock.rs` | real time |
//! | `history.rs` | states to go back to |
//! | `worker.rs` | the physics thread |
//! | `handle.rs` | for programs that have a loop of their own: [`Handle`] |
//! | `capture.rs` | states as keyframes in XML |
//! | `watch.rs`, `plot.rs` | numbers over time |

#![forbid(unsafe_code)]

mod bridge;
mod capture;
mod clock;
mod error;
mod event;
mod expected;
mod handle;
mod history;
mod input;
mod launch;
mod link;
mod mode;
mod panel;
mod plot;
#[doc(hidden)]
pub mod probe;
mod request;
mod simulation;
mod snapshot;
mod view;
mod watch;
mod window;
mod worker;

pub use self::error::ViewerError;
pub use self::handle::Handle;
pub use self::input::{Key, KeyPress, Modifiers};
#[cfg(not(target_os = "macos"))]
pub use self::launch::launch;
pub use self::launch::{Viewer, ViewerOptions, run};

#[cfg(test)]
mod tests;
