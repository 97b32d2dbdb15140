//! A window to look at a simulation, and to work on it while it runs.
//!
//! Physics and window are two threads that share nothing but a link: requests go one way, snapshots and events the other.
//! No simulation is ever copied. What is here needs no window:
//!
//! | file | what is in it |
//! |---|---|
//! | `input/` | keys and mouse: one table of what each does |
//! | `request.rs`, `event.rs`, `snapshot.rs` | what the two threads tell each other |
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
