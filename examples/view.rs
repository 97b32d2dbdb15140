//! Any model, in a window.
//!
//! ```text
//! cargo run --release --features viewer --example view -- model.xml
//! ```
//!
//! Without a model it is the bundled humanoid. `--keyframe NAME` starts there, `--size WxH` is the size of the window, and
//! `--trajectory FILE.csv` (any number of times) plays what was recorded of this model. Another model is loaded by dropping its
//! file onto the window. F1 says what keys and mouse do.

#[path = "common/mod.rs"]
mod common;

use std::path::PathBuf;

use common::option;
use mujoco_safe::viewer::Viewer;
use mujoco_safe::{Data, Model, Trajectory, sample};

#[derive(Default)]
struct Arguments {
    model: Option<PathBuf>,
    keyframe: Option<String>,
    size: Option<[u32; 2]>,
    trajectories: Vec<PathBuf>,
}

const HELP: &str = "view [MODEL] [--keyframe NAME] [--size WxH] [--trajectory FILE.csv]...";

fn arguments() -> Result<Arguments, String> {
    option::read(HELP, Arguments::default(), |arguments, option| {
        match option.name() {
            "" if arguments.model.is_none() => arguments.model = Some(option.path()?),
            "--keyframe" => arguments.keyframe = Some(option.text()?),
            "--size" => arguments.size = Some(option.size()?),
            "--trajectory" => arguments.trajectories.push(option.path()?),
            _ => return option.unknown(),
        }
        Ok(())
    })
}

fn main() -> std::process::ExitCode {
    common::finish(view())
}

fn view() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = arguments()?;
    let mut viewer = Viewer::new();
    let model = match &arguments.model {
        Some(path) => {
            viewer = viewer.title(path.display().to_string()).file(path);
            if path.extension().is_some_and(|extension| extension == "mjb") {
                Model::from_binary_path(path)?
            } else {
                Model::from_xml_path(path)?
            }
        }
        None => sample::humanoid(),
    };
    if let Some(size) = arguments.size {
        viewer = viewer.size(size);
    }
    let trajectories: Result<Vec<_>, _> =
        arguments.trajectories.iter().map(|path| Trajectory::load_csv(&model, path)).collect();
    let mut data = Data::new(model)?;
    if let Some(name) = &arguments.keyframe {
        let keyframe = data.model().keyframe(name)?.id();
        data.reset_to_key(keyframe)?;
    }
    viewer.trajectories(trajectories?).run(data)?;
    Ok(())
}
