//! The engine's sample models, where they are installed (`apt-get install libmujoco-samples`).

use std::path::Path;

pub(crate) fn many_humanoids() -> Option<&'static Path> {
    let path = Path::new("/usr/share/mujoco/model/humanoid/22_humanoids.xml");
    path.exists().then_some(path)
}
