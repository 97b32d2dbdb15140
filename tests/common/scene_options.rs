//! Options of scenes.

use mujoco_safe::scene::SceneOptions;

/// Shows the same groups of every kind of element.
pub fn with_groups(options: SceneOptions, groups: [bool; 6]) -> SceneOptions {
    options
        .with_geomgroup(groups)
        .with_sitegroup(groups)
        .with_jointgroup(groups)
        .with_tendongroup(groups)
        .with_actuatorgroup(groups)
        .with_skingroup(groups)
}
