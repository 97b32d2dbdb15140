//! Writes pages of recorded motions, which a browser plays without a network.
//!
//! ```text
//! cargo run --release --features html --example web_replay -- --out out
//! cargo run --release --features html --example web_replay -- --model robot.xml --seconds 5
//! ```

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;
use common::command_line;
use mujoco_safe::html::{self, HtmlOptions, Signal};
use mujoco_safe::{Data, Model, RandomController, Trajectory, sample};

/// Writes a page of a motion under random control.
#[derive(Parser)]
struct Arguments {
    /// A model; without it, the sample humanoid
    #[arg(long)]
    model: Option<PathBuf>,
    /// Simulated time
    #[arg(long, default_value_t = 3.0)]
    seconds: f64,
    /// Number of transparent trajectories with other controls
    #[arg(long, default_value_t = 0)]
    ghosts: u64,
    /// Camera at the start
    #[arg(long)]
    camera: Option<String>,
    /// Folder of the page
    #[arg(long, default_value = "out")]
    out: PathBuf,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let model = match &arguments.model {
        Some(path) => Model::from_xml_path(path)?,
        None => sample::humanoid(),
    };
    let mut data = Data::new(model)?;
    let steps = (arguments.seconds / data.model().options().timestep).round() as usize;
    let mut trajectories = Vec::new();
    for seed in 0..=arguments.ghosts {
        data.reset()?;
        let mut trajectory = Trajectory::with_sensordata(data.model());
        trajectory.record(&mut data, &mut RandomController::new(seed), steps)?;
        trajectories.push((format!("seed {seed}"), trajectory));
    }
    // The first named joint, actuator and sensor.
    let model = data.model();
    let mut signals = Vec::new();
    let hinge = model.joints().find(|joint| joint.name().is_some() && joint.dofs().len() == 1);
    signals.extend(hinge.and_then(|joint| Some(Signal::Qpos(joint.name()?.to_owned()))));
    signals.extend(model.actuators().find_map(|actuator| Some(Signal::Ctrl(actuator.name()?.to_owned()))));
    signals.extend(model.sensors().find_map(|sensor| Some(Signal::Sensor(sensor.name()?.to_owned()))));
    let mut options = HtmlOptions::default().with_title("Random control").with_signals(signals);
    options.camera.clone_from(&arguments.camera);

    std::fs::create_dir_all(&arguments.out)?;
    let path = arguments.out.join("replay.html");
    let shown = trajectories.iter().map(|(label, trajectory)| (label.as_str(), trajectory));
    let left_out = html::save(&path, model, shown, &options)?;
    for element in left_out {
        println!("not drawn: {element}");
    }
    println!("{}: {} kB", path.display(), std::fs::metadata(&path)?.len() / 1000);
    Ok(())
}
