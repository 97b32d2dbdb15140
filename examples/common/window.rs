//! Viewer window, if the example is built with the feature `viewer`.

use std::error::Error;

#[cfg(feature = "viewer")]
use mujoco_safe::viewer::{Viewer, ViewerOptions};
use mujoco_safe::{Controller, Data, Trajectory};

use super::live_plan::LivePlan;

#[cfg(not(feature = "viewer"))]
const NO_WINDOW: &str = "--view requires the viewer: run with `cargo run --features viewer`";

/// Shows a controlled simulation and recorded trajectories until the window is closed.
#[cfg(feature = "viewer")]
pub fn show(
    title: &str,
    data: Data,
    controller: impl Controller + Send + 'static,
    trajectories: Vec<Trajectory>,
) -> Result<(), Box<dyn Error>> {
    viewer(title).with_controller(controller).with_trajectories(trajectories).run(data)?;
    Ok(())
}

/// Shows a simulation under a predictive controller with its plan, and recorded trajectories, until
/// the window is closed.
#[cfg(feature = "viewer")]
pub fn show_plan(title: &str, data: Data, plan: LivePlan, trajectories: Vec<Trajectory>) -> Result<(), Box<dyn Error>> {
    viewer(title)
        .with_instrumented_controller(plan, |plan, _, instruments| plan.declare(instruments))
        .with_trajectories(trajectories)
        .run(data)?;
    Ok(())
}

/// Plays recorded trajectories until the window is closed.
#[cfg(feature = "viewer")]
pub fn replay(title: &str, data: Data, trajectories: Vec<Trajectory>) -> Result<(), Box<dyn Error>> {
    viewer(title).with_trajectories(trajectories).run(data)?;
    Ok(())
}

#[cfg(feature = "viewer")]
fn viewer(title: &str) -> Viewer {
    Viewer::new().with_options(ViewerOptions::default().with_title(title))
}

/// Returns an error: the viewer is not built.
#[cfg(not(feature = "viewer"))]
pub fn replay(_: &str, _: Data, _: Vec<Trajectory>) -> Result<(), Box<dyn Error>> {
    Err(NO_WINDOW.into())
}

/// Returns an error: the viewer is not built.
#[cfg(not(feature = "viewer"))]
pub fn show(_: &str, _: Data, _: impl Controller + Send + 'static, _: Vec<Trajectory>) -> Result<(), Box<dyn Error>> {
    Err(NO_WINDOW.into())
}

/// Returns an error: the viewer is not built.
#[cfg(not(feature = "viewer"))]
pub fn show_plan(_: &str, _: Data, _: LivePlan, _: Vec<Trajectory>) -> Result<(), Box<dyn Error>> {
    Err(NO_WINDOW.into())
}
