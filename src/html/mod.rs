//! Trajectories as HTML pages: one file with the model, the motion and a player, which opens from
//! disk, without a network.
//!
#![doc = include_str!("picture.html")]
//!
//! ```
//! use mujoco_safe::html::{HtmlOptions, Signal};
//! use mujoco_safe::{Data, RandomController, Trajectory, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let mut trajectory = Trajectory::new(data.model());
//! trajectory.record(&mut data, &mut RandomController::new(1), 400)?;
//!
//! let path = std::env::temp_dir().join("mujoco_safe_fall.html");
//! let options = HtmlOptions::default().with_signals([Signal::Qpos("left_knee".into())]);
//! trajectory.save_html(data.model(), &path, &options)?;
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! The page plays, loops and seeks, shows the free camera and those of the model, names what is
//! clicked, and plots signals. `?` lists its keys. It needs WebGL 2 and `DecompressionStream`,
//! which Chrome and Edge have since version 80, Safari since 16.4 and Firefox since 113.
//!
//! # Contents
//!
//! The geoms and sites of the selected groups, with materials, textures, lights with shadows, and
//! the sky. Poses have a stated error: [`HtmlOptions::position_error`] and
//! [`HtmlOptions::rotation_error`]. Vertices of meshes and elevations of height fields are rounded
//! to 1/131,070 of the extent along each axis, and signals to 1/131,070 of their range.
//!
//! Meshes without a texture are simplified by [meshoptimizer](https://meshoptimizer.org), to
//! [`HtmlOptions::mesh_error`]. The library estimates the distance between the surfaces as a root
//! mean square. The tests measure the largest distance, which is less than the error for their
//! meshes.
//!
//! Colours are those of the renderer except at specular highlights: a picture of the humanoid
//! differs by less than 2 of 255 levels on average. Reflections, fog, haze and the attenuation of
//! lights are not drawn.
//!
//! Skins, flexes and tendons that the first record shows, with colours and without textures. Their
//! vertices have the error of positions.
//!
//! Rangefinders and other decoration are not drawn. The page names what it does not draw, and
//! [`save`] returns the names.
//!
//! A trajectory has no positions of mocap bodies and no changes of the model: mocap bodies are
//! drawn where the model has them.
//!
//! # Names and texts
//!
//! All names and texts are in the compressed data, and the page inserts them as text. Its content
//! security policy allows only the page's own program and no connection.
//!
//! The player is drawn by [three.js](https://threejs.org) (MIT licence, whose text is in the page's
//! program). Its sources are in the folder `html/` of the repository.

mod assets;
mod deformable;
mod motion;
mod options;
mod page;
mod signal;
mod stream;

use std::io::Write;
use std::path::Path;

#[cfg(feature = "live")]
pub(crate) use self::deformable::Sampler;
pub use self::options::{HtmlOptions, Signal};
use self::page::Page;
use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::file;
use crate::model::IntoModel;
use crate::replay;
use crate::trajectory::Trajectory;

/// Running simulation, which the page shows instead of tracks.
#[cfg(feature = "live")]
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(crate) struct Live<'d> {
    /// Name of the actuator, and ends of the slider, of each control.
    pub(crate) sliders: &'d [(Option<&'d str>, [f64; 2])],
    /// Largest number of ghosts.
    pub(crate) ghosts: usize,
}

/// Writes trajectories of a model as one HTML page. Returns descriptions of what the page does not
/// draw.
///
/// The page shows the first trajectory in full, with its signals. The others are transparent, and
/// have the labels of their pairs. In the page, another trajectory can be selected instead, and all
/// can be shown side by side: see [`HtmlOptions::spacing`].
///
/// # Errors
///
/// [`Error::File`] if the file cannot be written; an existing file is then unchanged.
/// [`Error::Shape`] or [`Error::Invalid`] for trajectories of another model, without records or
/// with descending times, and for a signal with another number of values. [`Error::NoSuchName`] for
/// signals and a camera that the model does not have. [`Error::Invalid`] for precisions and rates
/// that are not positive. Errors of [`Data::forward`] in the recorded states.
///
/// ```
/// use mujoco_safe::html::{self, HtmlOptions};
/// use mujoco_safe::{Data, RandomController, Trajectory, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// let mut trajectories = Vec::new();
/// for seed in 0..3 {
///     data.reset()?;
///     let mut trajectory = Trajectory::new(data.model());
///     trajectory.record(&mut data, &mut RandomController::new(seed), 100)?;
///     trajectories.push((format!("seed {seed}"), trajectory));
/// }
/// let path = std::env::temp_dir().join("mujoco_safe_seeds.html");
/// let shown = trajectories.iter().map(|(label, trajectory)| (label.as_str(), trajectory));
/// let left_out = html::save(&path, data.model(), shown, &HtmlOptions::default())?;
/// assert!(left_out.is_empty(), "the page draws everything");
/// # std::fs::remove_file(path).ok();
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
///
/// Recorded states of a [`Rollout`](crate::rollout::Rollout) become trajectories, side by side:
///
/// ```
/// use mujoco_safe::html::{self, HtmlOptions};
/// use mujoco_safe::rollout::Rollout;
/// use mujoco_safe::{Data, RandomController, StateSpec, Trajectory, sample};
///
/// let rollouts = Rollout::new(sample::cartpole(), 4, 100)
///     .with_controllers(|rollout| RandomController::new(rollout as u64))
///     .with_recorded_states(StateSpec::INTEGRATION)
///     .run()?;
/// let mut data = Data::new(sample::cartpole())?;
/// let mut trajectories = vec![Trajectory::new(data.model()); rollouts.len()];
/// for (rollout, trajectory) in trajectories.iter_mut().enumerate() {
///     for state in rollouts.states_of(rollout).rows() {
///         data.set_state(StateSpec::INTEGRATION, state)?;
///         trajectory.push(&data)?;
///     }
/// }
/// let path = std::env::temp_dir().join("mujoco_safe_rollouts.html");
/// let options = HtmlOptions::default().with_spacing(1.0);
/// let shown = trajectories.iter().map(|trajectory| ("", trajectory));
/// html::save(&path, data.model(), shown, &options)?;
/// # std::fs::remove_file(path).ok();
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn save<'t>(
    path: impl AsRef<Path>,
    model: impl IntoModel,
    trajectories: impl IntoIterator<Item = (&'t str, &'t Trajectory)>,
    options: &HtmlOptions,
) -> Result<Vec<String>> {
    let trajectories: Vec<_> = trajectories.into_iter().collect();
    let Some((_, first)) = trajectories.first() else {
        let what = "the trajectories of a page";
        return Err(Error::invalid(InvalidKind::Unsuitable, what, "an empty list", "at least one"));
    };
    let records = |(_, trajectory): &(_, &Trajectory)| replay::records(trajectory.times(), options.frames_per_second);
    let records = trajectories.iter().map(records).collect::<Result<Vec<_>>>()?;
    let mut data = Data::new(model)?;
    first.apply(0, &mut data)?;
    data.forward()?;
    let mut page = Page::new(&mut data, options)?;
    for ((label, trajectory), records) in trajectories.iter().zip(&records) {
        page.add(&mut data, label, trajectory, records)?;
    }
    file::replace(path.as_ref(), |out| out.write_all(page.text()?.as_bytes()))?;
    Ok(page.left_out())
}

/// Returns the text of a page for a running simulation, of which the positions have been computed,
/// descriptions of what the page does not draw, and the reader of its deformable shapes.
#[cfg(feature = "live")]
pub(crate) fn live(
    data: &mut Data,
    live: Live<'_>,
    options: &HtmlOptions,
) -> Result<(String, Vec<String>, Option<Sampler>)> {
    let mut page = Page::new(data, options)?;
    page.live = Some(live);
    let text = page.text().map_err(|error| Error::Unsupported(format!("the description of the page: {error}")))?;
    Ok((text, page.left_out(), page.look.sampler))
}

impl Trajectory {
    /// Writes the records as one HTML page, which plays them in a browser without a network.
    /// Returns descriptions of what the page does not draw. See the [module](crate::html).
    ///
    /// Requires the feature `html`.
    ///
    /// # Errors
    ///
    /// As for [`html::save`](crate::html::save).
    pub fn save_html(
        &self,
        model: impl IntoModel,
        path: impl AsRef<Path>,
        options: &HtmlOptions,
    ) -> Result<Vec<String>> {
        save(path, model, [("", self)], options)
    }
}
