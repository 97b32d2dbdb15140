//! Contents and precision of a page.

use crate::error::{Error, Result};
use crate::macros::with_methods;
use crate::model::Model;

/// Contents and precision of a page.
///
/// ```
/// use mujoco_safe::html::{HtmlOptions, Signal};
///
/// let options = HtmlOptions::default()
///     .with_title("A fall")
///     .with_camera("side")
///     .with_signals([Signal::Qpos("left_knee".into()), Signal::Ctrl("left_knee".into())])
///     .with_notes([(0.5, "lets go".into())]);
/// assert_eq!(options.frames_per_second, 60.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct HtmlOptions {
    /// Title of the page. If it is empty, the title is "Simulation".
    pub title: String,
    /// Number of recorded states per second of simulated time that the page contains, at most. The
    /// page interpolates between them. `f64::INFINITY` takes every record.
    pub frames_per_second: f64,
    /// Largest distance between the position of a body in the page and in the engine, m. By default
    /// 0.1 mm, or a ten-thousandth of the model's extent (`statistic` in MJCF) if that is less.
    pub position_error: Option<f64>,
    /// Largest angle between the orientation of a body in the page and in the engine, rad. By
    /// default 0.0005.
    pub rotation_error: f64,
    /// Largest distance between a mesh in the page and in the model, m, as an estimate: see
    /// [`html`](crate::html#contents). By default 0.25 mm, or 1/4000 of the model's extent if that
    /// is less. Zero keeps all triangles.
    pub mesh_error: Option<f64>,
    /// Distance between several trajectories side by side, m. By default they are in one place, and
    /// all but the first are transparent. The page can change between both.
    pub spacing: Option<f64>,
    /// Plotted signals.
    pub signals: Vec<Signal>,
    /// Notes: the time, s, and the text.
    pub notes: Vec<(f64, String)>,
    /// Name of the camera of the model from which the page shows the start. `None` for the free
    /// camera.
    pub camera: Option<String>,
    /// Contained groups of geoms: by default 0 to 2, those that the viewer shows.
    pub geomgroup: [bool; 6],
    /// Contained groups of sites: by default 0 to 2.
    pub sitegroup: [bool; 6],
}

impl Default for HtmlOptions {
    fn default() -> Self {
        let groups = [true, true, true, false, false, false];
        Self {
            title: String::new(),
            frames_per_second: 60.0,
            position_error: None,
            rotation_error: 5e-4,
            mesh_error: None,
            spacing: None,
            signals: Vec::new(),
            notes: Vec::new(),
            camera: None,
            geomgroup: groups,
            sitegroup: groups,
        }
    }
}

impl HtmlOptions {
    /// Returns the default of errors of positions, m.
    pub(super) fn default_error(extent: f64) -> f64 {
        if extent > 0.0 { extent.min(1.0) * 1e-4 } else { 1e-4 }
    }

    pub(super) fn largest_mesh_error(&self, model: &Model) -> Result<f64> {
        let error = self.mesh_error.unwrap_or_else(|| 2.5 * Self::default_error(model.statistics().extent));
        let is_valid = error >= 0.0 && error.is_finite();
        Error::check_range(is_valid, "HtmlOptions::mesh_error", error, "at least 0 and finite")?;
        Ok(error)
    }
}

pub(super) fn check_positive(what: &str, value: f64, limit: f64) -> Result<f64> {
    Error::check_range(value > 0.0 && value <= limit, what, value, format_args!("above 0 and at most {limit:e}"))?;
    Ok(value)
}

with_methods!(HtmlOptions {
    with_title(title: impl Into<String>) = title.into(),
    with_frames_per_second(frames_per_second: f64),
    with_position_error(position_error: f64) = Some(position_error),
    with_rotation_error(rotation_error: f64),
    with_mesh_error(mesh_error: f64) = Some(mesh_error),
    with_spacing(spacing: f64) = Some(spacing),
    with_signals(signals: impl IntoIterator<Item = Signal>) = signals.into_iter().collect(),
    with_notes(notes: impl IntoIterator<Item = (f64, String)>) = notes.into_iter().collect(),
    with_camera(camera: impl Into<String>) = Some(camera.into()),
    with_geomgroup(geomgroup: [bool; 6]),
    with_sitegroup(sitegroup: [bool; 6]),
});

/// Plotted quantity. An element with several values has a curve for each.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Signal {
    /// Positions of the joint of this name.
    Qpos(String),
    /// Velocities of the joint of this name.
    Qvel(String),
    /// Control of the actuator of this name.
    Ctrl(String),
    /// Readings of the sensor of this name. If the trajectory has no readings, those of
    /// [`Data::forward`](crate::Data::forward) in each state, without forces from outside.
    Sensor(String),
    /// Values of the caller, one for each record of the first trajectory.
    Values {
        /// Title of the plot.
        name: String,
        /// The values.
        values: Vec<f64>,
    },
}
