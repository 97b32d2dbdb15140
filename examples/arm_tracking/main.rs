//! Predictive control of an arm with six joints: its hand follows a moving target.
//!
//! ```text
//! cargo run --release --example arm_tracking -- --out out
//! ```
//!
//! Fifty times a second, iLQR plans the torques of the next 0.1 s. A residual of this program
//! measures the distance of the hand from the target at the time of each step ([`tracking`]). The
//! planner knows the exact model and the path of the target, so the distance is below 0.1 mm after
//! the approach. The program prints it. `--help` lists the options.

#[path = "../common/mod.rs"]
mod common;
mod tracking;

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use common::chart::{self, Event, Line, PALETTE, Panel};
use common::command_line;
use common::live_plan::{LivePlan, Point};
use mujoco_safe::{Data, Model};
use tracking::{Run, model, target, track};

/// An arm follows a moving target with predictive control.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Simulated time, s
    #[arg(long, value_name = "S", default_value_t = 8.0, value_parser = command_line::not_negative)]
    seconds: f64,
    #[command(flatten)]
    planning: command_line::Planning,
}

/// Time in which the hand reaches the target, s.
const APPROACH: f64 = 1.0;

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let model = Arc::new(model()?);
    let start = Instant::now();
    let run = track(&model, arguments.seconds, command_line::cores())?;
    let factor = arguments.seconds / start.elapsed().as_secs_f64();
    let times: Vec<f64> = run.trajectory.times().iter().map(|time| time + model.timestep()).collect();
    let later =
        || times.iter().zip(&run.distances).filter(|&(&time, _)| time > APPROACH).map(|(_, &distance)| distance);
    if later().next().is_some() {
        let mean = later().sum::<f64>() / later().count() as f64;
        let most = later().fold(0.0, f64::max);
        println!(
            "distance of the hand from the target after {APPROACH} s: mean {:.3} mm, at most {:.3} mm; real-time factor {factor:.2}",
            1e3 * mean,
            1e3 * most
        );
    }
    if let Some(out) = &arguments.planning.out {
        chart::save(out, "arm_tracking.svg", 280, &panels(&times, &run))?;
        let csv = out.join("arm_tracking.csv");
        run.trajectory.save_csv(&csv)?;
        println!("wrote {}", csv.display());
    }
    if arguments.planning.view {
        view(&model, run)?;
    }
    Ok(())
}

/// Shows the arm under the controller: the path of the hand in the plan, the cost of each term, and
/// sliders for the weights. The trajectory mode replays the run.
fn view(model: &Arc<Model>, run: Run) -> Result<(), Box<dyn Error>> {
    let mut data = Data::new(model.clone())?;
    data.reset_to_key(model.keyframe("ready")?.id())?;
    let hand = model.site("hand")?.index();
    let points = vec![Point { position: Box::new(move |data| data.site_xpos()[hand]), rgba: [0.9, 0.55, 0.1, 1.0] }];
    let controller = tracking::controller(&data, command_line::cores())?;
    let plan = LivePlan::new(&data, controller, points, tracking::show_target)?;
    common::window::show_plan("Arm that follows a target", data, plan, vec![run.trajectory])
}

fn panels(times: &[f64], run: &Run) -> [Panel<'static>; 2] {
    let axes = [(1, "y"), (2, "z")];
    let hand = axes.iter().zip(PALETTE).map(|(&(axis, name), color)| {
        Line::new(&format!("hand {name}"), color, times.iter().zip(&run.hand).map(|(&time, at)| (time, at[axis])))
    });
    let targets = axes.iter().zip(PALETTE).map(|(&(axis, name), color)| {
        Line::dashed(&format!("target {name}"), color, times.iter().map(|&time| (time, target(time)[axis])))
    });
    let distance = times.iter().zip(&run.distances).map(|(&time, &distance)| (time, distance.max(1e-6)));
    let approach = Event::new("approach", 0.0, APPROACH);
    [
        Panel::new(
            "Position of the hand and of its target",
            ["time (s)", "position (m)"],
            hand.chain(targets).collect(),
        )
        .events([approach.clone()]),
        Panel::new(
            "Distance of the hand from the target",
            ["time (s)", "distance (m)"],
            vec![Line::new("", PALETTE[0], distance)],
        )
        .logarithmic([false, true])
        .events([approach]),
    ]
}
