//! Sample models: four bundled with the crate, and the models of the engine's package.

use std::path::{Path, PathBuf};

use crate::model::Model;

/// MJCF source of [`cartpole`].
pub const CARTPOLE_XML: &str = include_str!("../models/cartpole.xml");
/// MJCF source of [`humanoid`].
pub const HUMANOID_XML: &str = include_str!("../models/humanoid.xml");
/// MJCF source of [`hopper`].
pub const HOPPER_XML: &str = include_str!("../models/hopper.xml");
/// MJCF source of [`half_cheetah`].
pub const HALF_CHEETAH_XML: &str = include_str!("../models/half_cheetah.xml");

/// Directory in which Debian's package `libmujoco-samples` installs the engine's sample models.
#[doc(alias = "example_model_files_directory")]
pub const SYSTEM_MODELS: &str = "/usr/share/mujoco/model";

/// Loads a pole on a cart: 2 joints, 1 motor, and a keyframe `hanging_down`, in which the pole is
/// horizontal and about to fall.
///
/// # Panics
///
/// If the engine cannot load models at all: see
/// [`Error::EngineVersion`](crate::Error::EngineVersion) and
/// [`Error::LoaderLocked`](crate::Error::LoaderLocked).
pub fn cartpole() -> Model {
    bundled(CARTPOLE_XML)
}

/// Loads a humanoid of 40 kg: 27 degrees of freedom, 21 motors, and the keyframes `squat`,
/// `stand_on_left_leg` and `stand`.
///
/// # Panics
///
/// As for [`cartpole`].
///
/// ```
/// let model = mujoco_safe::sample::humanoid();
/// assert_eq!((model.nq(), model.nv(), model.nu()), (28, 27, 21));
/// assert!(model.compile_warnings().is_empty());
/// ```
#[doc(alias = "sample_model_and_data")]
pub fn humanoid() -> Model {
    bundled(HUMANOID_XML)
}

/// Loads a torso on one leg that moves in a plane: 6 degrees of freedom, 3 motors. The model of the
/// task [`Hopper`](crate::environment::Hopper).
///
/// # Panics
///
/// As for [`cartpole`].
pub fn hopper() -> Model {
    bundled(HOPPER_XML)
}

/// Loads a torso on two legs that moves in a plane: 9 degrees of freedom, 6 motors. The model of
/// the task [`HalfCheetah`](crate::environment::HalfCheetah).
///
/// # Panics
///
/// As for [`cartpole`].
pub fn half_cheetah() -> Model {
    bundled(HALF_CHEETAH_XML)
}

fn bundled(xml: &str) -> Model {
    Model::from_xml_str(xml).unwrap_or_else(|error| panic!("cannot load a bundled model: {error}"))
}

/// Returns the model files (`.xml`) in [`SYSTEM_MODELS`], sorted by path. The list is empty if the
/// package is not installed. Some of the files are parts that others include.
#[doc(alias = "example_model_files")]
pub fn system_models() -> Vec<PathBuf> {
    let mut found = Vec::new();
    collect(Path::new(SYSTEM_MODELS), &mut found);
    found.sort();
    found
}

fn collect(dir: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(dir) else { return };
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "xml") {
            found.push(path);
        }
    }
}
