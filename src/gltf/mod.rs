//! Trajectories as animated glTF 2.0 files (`.glb`), for Blender, the viewers of Windows and macOS,
//! web viewers, game engines and other programs.
//!
//! ```
//! use mujoco_safe::gltf::GltfOptions;
//! use mujoco_safe::{Data, RandomController, Trajectory, sample};
//!
//! let mut data = Data::new(sample::humanoid())?;
//! let mut trajectory = Trajectory::new(data.model());
//! trajectory.record(&mut data, &mut RandomController::new(1), 400)?;
//!
//! let path = std::env::temp_dir().join("mujoco_safe_fall.glb");
//! trajectory.save_glb(data.model(), &path, &GltfOptions::default())?;
//! # std::fs::remove_file(path).ok();
//! # Ok::<(), mujoco_safe::Error>(())
//! ```
//!
//! # Contents
//!
//! - A node for each body, with its name, in the tree of the model. The root node turns the z-axis
//!   of the model into the y-axis of glTF.
//! - A node for each geom and site of the selected groups, with its triangles. Round shapes have up
//!   to 24 slices and 12 stacks (`visual/quality` in MJCF). Infinite planes end where no body has
//!   been. Geoms of the same shape share their vertices.
//! - Materials: the colour, the emission, the opacity, and `metallic` and `roughness` where the
//!   model has them; otherwise the roughness follows from the shininess. 2D textures as PNG. A cube
//!   texture becomes its mean colour.
//! - A mesh with bones for each skin of the groups 0 to 2, and for each flex in two or three
//!   dimensions. Its joints are the nodes of the bodies, so it has no animation of its own. A
//!   vertex has the weights of the model, in sets of four with the largest first: programs that
//!   read only one set, such as three.js, draw a vertex of more than four bones with the four
//!   largest weights. Normals are those at rest, and turn with the bodies: the shading of a flex
//!   whose bodies only slide does not change. The offset `inflate` of a skin is along the normals
//!   at rest. A flex has the positions of its vertices, without its radius.
//! - The cameras, the free camera, and the active lights. The headlight, which moves with the
//!   viewer in MuJoCo, shines from the free camera. A white surface that faces a light of colour 1
//!   is white in programs that take a surface of luminance 1 as white, such as three.js: select
//!   `Unitless` as the lighting mode when importing into Blender.
//! - An animation for each trajectory, with the name of its label. It starts at 0 s. Translations
//!   are in single precision; [`GltfOptions::rotation_error`] is that of rotations. Coordinates
//!   that change by less than 1 µm (or a millionth of the model's extent, if that is less) do not
//!   move.
//!
//! Tendons, the sky and the patterns of cube textures are left out; [`save`] returns their names.
//! So are skins and flexes without the motion of bones, with the reason: ropes, flexes whose
//! vertices are interpolated (`dof` in MJCF), and skins whose weights do not sum to 1, or with
//! numbers that are not finite, as only an edited model has them. A vertex without its negative
//! weights, or with only the 16 largest, is named with the sum of the others. Reflection, fog,
//! haze, shadows, ambient light and the attenuation of lights are left out too. So are animations
//! of colours, since a trajectory has none, and the positions of mocap bodies, which a trajectory
//! does not have: only [`Data::save_glb`] has them.

mod contents;
mod document;
mod geometry;
mod material;
mod motion;
mod node;
mod skin;

use std::path::Path;

use self::motion::Clip;
use crate::data::Data;
use crate::error::{Error, InvalidKind, Result};
use crate::macros::with_methods;
use crate::model::IntoModel;
use crate::replay;
use crate::trajectory::Trajectory;

/// Contents and precision of a glTF file.
///
/// ```
/// use mujoco_safe::gltf::GltfOptions;
///
/// let options = GltfOptions::default().with_frames_per_second(30.0).with_sitegroup([false; 6]);
/// assert_eq!(options.rotation_error, 1e-4);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GltfOptions {
    /// Number of recorded states per second of simulated time that the file contains, at most. By
    /// default 60. Programs interpolate between them. `f64::INFINITY` takes every record.
    pub frames_per_second: f64,
    /// Largest angle by which a recorded orientation of a body in its parent is rounded, rad: at
    /// least 1e-6, by default 1e-4. From 6.2e-5 on, the file has 16 bits per component of a
    /// quaternion, below 32.
    pub rotation_error: f64,
    /// Contained groups of geoms: by default 0 to 2, those that the viewer shows.
    pub geomgroup: [bool; 6],
    /// Contained groups of sites: by default 0 to 2.
    pub sitegroup: [bool; 6],
}

impl Default for GltfOptions {
    fn default() -> Self {
        let groups = [true, true, true, false, false, false];
        Self { frames_per_second: 60.0, rotation_error: 1e-4, geomgroup: groups, sitegroup: groups }
    }
}

with_methods!(GltfOptions {
    with_frames_per_second(frames_per_second: f64),
    with_rotation_error(rotation_error: f64),
    with_geomgroup(geomgroup: [bool; 6]),
    with_sitegroup(sitegroup: [bool; 6]),
});

/// Writes trajectories of a model as one glTF file (`.glb`), each as an animation with its label as
/// the name. At rest, the nodes have the poses of the first record. Returns descriptions of what
/// the file does not contain.
///
/// # Errors
///
/// [`Error::File`] if the file cannot be written; an existing file is then unchanged.
/// [`Error::Shape`] or [`Error::Invalid`] for trajectories of another model, without records or
/// with descending times. [`Error::Invalid`] for a rate that is not positive, and positions that
/// are not finite in single precision. Errors of [`Data::forward`] in the recorded states.
///
/// ```
/// use mujoco_safe::gltf::{self, GltfOptions};
/// use mujoco_safe::{Data, RandomController, Trajectory, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// let mut swings = Vec::new();
/// for seed in 0..2 {
///     data.reset()?;
///     let mut swing = Trajectory::new(data.model());
///     swing.record(&mut data, &mut RandomController::new(seed), 100)?;
///     swings.push((format!("seed {seed}"), swing));
/// }
/// let path = std::env::temp_dir().join("mujoco_safe_swings.glb");
/// let animations = swings.iter().map(|(label, swing)| (label.as_str(), swing));
/// let left_out = gltf::save(&path, data.model(), animations, &GltfOptions::default())?;
/// for element in left_out {
///     println!("not in the file: {element}");
/// }
/// # std::fs::remove_file(path).ok();
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn save<'t>(
    path: impl AsRef<Path>,
    model: impl IntoModel,
    trajectories: impl IntoIterator<Item = (&'t str, &'t Trajectory)>,
    options: &GltfOptions,
) -> Result<Vec<String>> {
    let trajectories: Vec<_> = trajectories.into_iter().collect();
    let Some((_, first)) = trajectories.first() else {
        let what = "the trajectories of a glTF file";
        return Err(Error::invalid(InvalidKind::Unsuitable, what, "an empty list", "at least one"));
    };
    let mut data = Data::new(model)?;
    let mut clips = Vec::with_capacity(trajectories.len());
    for &(name, trajectory) in &trajectories {
        let mut records = replay::records(trajectory.times(), options.frames_per_second)?;
        let times = motion::ascending(trajectory.times(), &mut records)?;
        let poses = replay::poses(&mut data, trajectory, &records, |_, _| Ok(()))?;
        clips.push(Clip { name, times, poses });
    }
    first.apply(0, &mut data)?;
    data.forward()?;
    contents::write(path.as_ref(), &mut data, options, &clips)
}

impl Trajectory {
    /// Writes the records as an animated glTF file (`.glb`), for Blender and other programs.
    /// Returns descriptions of what the file does not contain. See the [module](crate::gltf).
    ///
    /// Requires the feature `gltf`.
    ///
    /// # Errors
    ///
    /// As for [`gltf::save`](crate::gltf::save).
    #[doc(alias("export", "Blender", "gltf", "glb"))]
    pub fn save_glb(
        &self,
        model: impl IntoModel,
        path: impl AsRef<Path>,
        options: &GltfOptions,
    ) -> Result<Vec<String>> {
        save(path, model, [("", self)], options)
    }
}

impl Data {
    /// Writes the present state as a glTF file (`.glb`) without animation. Returns descriptions of
    /// what the file does not contain. See the [module](crate::gltf).
    ///
    /// Requires the feature `gltf`.
    ///
    /// # Errors
    ///
    /// As for [`gltf::save`](crate::gltf::save).
    ///
    /// ```
    /// use mujoco_safe::gltf::GltfOptions;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let data = Data::new(sample::humanoid())?;
    /// let path = std::env::temp_dir().join("mujoco_safe_humanoid.glb");
    /// data.save_glb(&path, &GltfOptions::default())?;
    /// # std::fs::remove_file(path).ok();
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias("export", "Blender", "gltf", "glb"))]
    pub fn save_glb(&self, path: impl AsRef<Path>, options: &GltfOptions) -> Result<Vec<String>> {
        let mut data = self.clone();
        data.forward()?;
        let poses = replay::all(data.model()).into_iter().map(|frame| vec![replay::pose(&data, frame)]).collect();
        let clip = Clip { name: "", times: vec![[0.0]], poses };
        contents::write(path.as_ref(), &mut data, options, &[clip])
    }
}
