//! Command-line arguments.

use std::path::PathBuf;

use crate::common::command_line::{self, Argument};
use crate::simulate::Push;

pub const HELP: &str = "\
A humanoid balances on one leg under a linear-quadratic regulator.

  --model PATH      model file (default: the bundled humanoid)
  --keyframe NAME   keyframe near which to balance (stand_on_left_leg)
  --torso NAME      root of the subtree whose centre of mass is balanced (torso)
  --foot NAME       body over which it is balanced (foot_left)
  --seconds S       simulated time (10)
  --push FX,FY[,S]  push the torso with this force in N, for S seconds (0.1), starting at 1 s
  --noise SIGMA     standard deviation of normal noise on every control (0)
  --seed N          seed of the noise (1)
  --out DIR         folder for the plots and the trajectory; without it, no files are written
  --view            show the simulation and its recordings in a window (requires --features viewer)
  --json            print the results as one JSON object";

#[derive(Clone, Debug)]
pub struct Arguments {
    pub model: Option<PathBuf>,
    pub keyframe: String,
    pub torso: String,
    pub foot: String,
    pub seconds: f64,
    pub push: Option<Push>,
    pub noise: f64,
    pub seed: u64,
    pub out: Option<PathBuf>,
    pub view: bool,
    pub json: bool,
}

impl Arguments {
    pub fn parse() -> Result<Self, String> {
        let arguments = Self {
            model: None,
            keyframe: "stand_on_left_leg".to_owned(),
            torso: "torso".to_owned(),
            foot: "foot_left".to_owned(),
            seconds: 10.0,
            push: None,
            noise: 0.0,
            seed: 1,
            out: None,
            view: false,
            json: false,
        };
        command_line::read(HELP, arguments, |arguments, option| {
            match option.name() {
                "--model" => arguments.model = Some(option.path()?),
                "--keyframe" => arguments.keyframe = option.text()?,
                "--torso" => arguments.torso = option.text()?,
                "--foot" => arguments.foot = option.text()?,
                "--seconds" => arguments.seconds = positive(option)?,
                "--push" => arguments.push = Some(push(option)?),
                "--noise" => arguments.noise = positive(option)?,
                "--seed" => arguments.seed = option.number()?,
                "--out" => arguments.out = Some(option.path()?),
                "--view" => arguments.view = true,
                "--json" => arguments.json = true,
                _ => return option.unknown(),
            }
            Ok(())
        })
    }
}

fn positive(option: &mut Argument<'_>) -> Result<f64, String> {
    let value: f64 = option.number()?;
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(format!("{} {value}: must be finite and not negative", option.name()))
    }
}

fn push(option: &mut Argument<'_>) -> Result<Push, String> {
    let list = option.text()?;
    let numbers: Result<Vec<f64>, String> =
        list.split(',').map(|part| part.trim().parse().map_err(|error| format!("--push {list}: {error}"))).collect();
    match numbers?[..] {
        [x, y] => Ok(Push { force: [x, y], duration: 0.1 }),
        [x, y, duration] => Ok(Push { force: [x, y], duration }),
        _ => Err("--push: expected FX,FY or FX,FY,SECONDS, as in --push 20,0".to_owned()),
    }
}
