//! Contents and precision of a glTF file.

use crate::macros::with_methods;

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
