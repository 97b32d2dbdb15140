//! Contents and precision of a page.

use crate::macros::with_methods;

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
            signals: Vec::new(),
            notes: Vec::new(),
            camera: None,
            geomgroup: groups,
            sitegroup: groups,
        }
    }
}

with_methods!(HtmlOptions {
    with_title(title: impl Into<String>) = title.into(),
    with_frames_per_second(frames_per_second: f64),
    with_position_error(position_error: f64) = Some(position_error),
    with_rotation_error(rotation_error: f64),
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
