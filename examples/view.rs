//! Interactive viewer for any model.
//!
//! ```text
//! cargo run --release --features viewer --example view -- model.xml
//! ```
//!
//! Without a path, the example shows the bundled humanoid. Drop the file of another model onto the window to load it. Press
//! F1 for the keyboard and mouse controls. Options:
//!
//! - `--keyframe NAME`: initial keyframe
//! - `--size WxH`: size of the window in pixels
//! - `--trajectory FILE.csv`: plays a recorded trajectory of this model; can be repeated

#[path = "common/mod.rs"]
mod common;

use std::path::PathBuf;

use common::command_line;
use mujoco_safe::viewer::{Viewer, ViewerOptions};
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
    command_line::read(HELP, Arguments::default(), |arguments, option| {
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
    common::command_line::exit_code(view())
}

fn view() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = arguments()?;
    let mut options = ViewerOptions::default();
    let model = match &arguments.model {
        Some(path) => {
            options = options.with_title(path.display().to_string()).with_file(path);
            if path.extension().is_some_and(|extension| extension == "mjb") {
                Model::from_binary_path(path)?
            } else {
                Model::from_xml_path(path)?
            }
        }
        None => sample::humanoid(),
    };
    if let Some(size) = arguments.size {
        options = options.with_size(size);
    }
    let trajectories: Result<Vec<_>, _> =
        arguments.trajectories.iter().map(|path| Trajectory::load_csv(&model, path)).collect();
    let mut data = Data::new(model)?;
    if let Some(name) = &arguments.keyframe {
        let keyframe = data.model().keyframe(name)?.id();
        data.reset_to_key(keyframe)?;
    }
    Viewer::new().options(options).trajectories(trajectories?).run(data)?;
    Ok(())
}
