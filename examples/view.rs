//! Interactive viewer for any model.
//!
//! ```text
//! cargo run --release --features viewer --example view -- model.xml
//! ```
//!
//! Without a path, the example shows the bundled humanoid. Drop the file of another model onto the
//! window to load it. Press F1 for the keyboard and mouse controls. `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::path::PathBuf;

use clap::Parser;
use common::command_line;
use mujoco_safe::viewer::{Viewer, ViewerOptions};
use mujoco_safe::{Data, Model, Trajectory, sample};

/// Shows a model in the viewer.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Model file: MJCF, URDF or MJB; without it, the bundled humanoid
    model: Option<PathBuf>,
    /// Initial keyframe
    #[arg(long, value_name = "NAME")]
    keyframe: Option<String>,
    /// Size of the window in pixels
    #[arg(long, value_name = "WxH", value_parser = command_line::size)]
    size: Option<[usize; 2]>,
    /// Play a recorded trajectory of this model; can be repeated
    #[arg(long = "trajectory", value_name = "FILE.csv")]
    trajectories: Vec<PathBuf>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
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
    Viewer::new().with_options(options).with_trajectories(trajectories?).run(data)?;
    Ok(())
}
