//! The window, in programs that are built with one.

use std::error::Error;

use mujoco_safe::{Controller, Data, Trajectory};

#[cfg(not(feature = "viewer"))]
const NO_WINDOW: &str = "this program was built without its window; --view needs cargo run --features viewer";

/// Shows a simulation under control, and recorded ones, until the window is closed.
#[cfg(feature = "viewer")]
pub fn show(
    title: &str,
    data: Data,
    controller: impl Controller + Send + 'static,
    trajectories: Vec<Trajectory>,
) -> Result<(), Box<dyn Error>> {
    mujoco_safe::viewer::Viewer::new().title(title).controller(controller).trajectories(trajectories).run(data)?;
    Ok(())
}

/// Shows recorded simulations until the window is closed.
#[cfg(feature = "viewer")]
pub fn replay(title: &str, data: Data, trajectories: Vec<Trajectory>) -> Result<(), Box<dyn Error>> {
    mujoco_safe::viewer::Viewer::new().title(title).trajectories(trajectories).run(data)?;
    Ok(())
}

/// Says how to get the window.
#[cfg(not(feature = "viewer"))]
pub fn replay(_: &str, _: Data, _: Vec<Trajectory>) -> Result<(), Box<dyn Error>> {
    Err(NO_WINDOW.into())
}

/// Says how to get the window.
#[cfg(not(feature = "viewer"))]
pub fn show(_: &str, _: Data, _: impl Controller + Send + 'static, _: Vec<Trajectory>) -> Result<(), Box<dyn Error>> {
    Err(NO_WINDOW.into())
}
