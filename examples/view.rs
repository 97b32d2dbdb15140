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

use common::option::text;
use mujoco_safe::viewer::Viewer;
use mujoco_safe::{Data, Model, Trajectory, sample};

#[derive(Default)]
struct Arguments {
    model: Option<PathBuf>,
    keyframe: Option<String>,
    size: Option<[u32; 2]>,
    trajectories: Vec<PathBuf>,
}

fn arguments() -> Result<Arguments, String> {
    use lexopt::Arg::{Long, Short, Value};
    let mut arguments = Arguments::default();
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next().map_err(|error| error.to_string())? {
        match argument {
            Value(path) if arguments.model.is_none() => arguments.model = Some(path.into()),
            Long("keyframe") => arguments.keyframe = Some(text(&mut parser, "--keyframe")?),
            Long("size") => arguments.size = Some(size(&text(&mut parser, "--size")?)?),
            Long("trajectory") => arguments.trajectories.push(text(&mut parser, "--trajectory")?.into()),
            Short('h') | Long("help") => {
                println!("view [MODEL] [--keyframe NAME] [--size WxH] [--trajectory FILE.csv]...");
                std::process::exit(0);
            }
            Short(_) | Long(_) | Value(_) => {
                return Err(format!("{}; --help lists the options", argument.unexpected()));
            }
        }
    }
    Ok(arguments)
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    numbers.filter(|size| !size.contains(&0)).ok_or_else(|| format!("--size {text}: give it as in 1280x720"))
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
