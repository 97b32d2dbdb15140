//! Command-line arguments.

use std::path::PathBuf;

use clap::Parser;

use crate::common::command_line::not_negative;
use crate::simulate::{PUSH_AT, Push};

/// A humanoid balances on one leg under a linear-quadratic regulator.
#[derive(Parser)]
#[command(allow_negative_numbers = true, args_override_self = true)]
pub struct Arguments {
    /// Model file; without it, the bundled humanoid
    #[arg(long, value_name = "PATH")]
    pub model: Option<PathBuf>,
    /// Keyframe near which to balance
    #[arg(long, value_name = "NAME", default_value = "stand_on_left_leg")]
    pub keyframe: String,
    /// Root of the subtree whose centre of mass is balanced
    #[arg(long, value_name = "NAME", default_value = "torso")]
    pub torso: String,
    /// Body over which it is balanced
    #[arg(long, value_name = "NAME", default_value = "foot_left")]
    pub foot: String,
    /// Simulated time, s
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = not_negative)]
    pub seconds: f64,
    /// Push the torso with this force in N, for S seconds (0.1), starting at 1 s
    #[arg(long, value_name = "FX,FY[,S]", value_parser = push, allow_hyphen_values = true)]
    pub push: Option<Push>,
    /// Standard deviation of normal noise on every control
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0, value_parser = not_negative)]
    pub noise: f64,
    /// Seed of the noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Folder for the plots and the trajectory; without it, no files are written
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Show the simulation and its recordings in a window (requires `--features viewer`)
    #[arg(long)]
    pub view: bool,
    /// Print the results as one JSON object
    #[arg(long)]
    pub json: bool,
}

fn push(text: &str) -> Result<Push, String> {
    let numbers = text.split(',').map(|part| part.trim().parse().map_err(|error| format!("{part}: {error}")));
    match numbers.collect::<Result<Vec<f64>, _>>()?[..] {
        [x, y] => Ok(Push { force: [x, y], start: PUSH_AT, duration: 0.1 }),
        [x, y, duration] => Ok(Push { force: [x, y], start: PUSH_AT, duration }),
        _ => Err("expected FX,FY or FX,FY,SECONDS, such as 20,0".to_owned()),
    }
}
