//! The command line.

use std::path::PathBuf;

use crate::common::option;

pub const HELP: &str = "\
A humanoid on one leg, held by a linear-quadratic regulator.

  --model PATH      a model file; the bundled humanoid without
  --keyframe NAME   the keyframe to balance about (stand_on_left_leg)
  --torso NAME      the body whose subtree's centre of mass is balanced (torso)
  --foot NAME       the body over which it is balanced (foot_left)
  --seconds S       how long to simulate (10)
  --push FX,FY[,S]  push the torso with this force in N, for S seconds (0.1), after 1 s
  --noise SIGMA     add normal noise of this deviation to every control (0)
  --seed N          the seed of the noise (1)
  --out DIR         where the plots and the trajectory go; nothing is written without
  --view            show it in a window (built with --features viewer): under control, and as it was recorded
  --json            print the figures as one JSON object";

/// A push against the torso.
#[derive(Clone, Copy, Debug)]
pub struct Push {
    /// N, world frame.
    pub force: [f64; 2],
    /// s.
    pub duration: f64,
}

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
        use lexopt::Arg::{Long, Short, Value};
        let mut arguments = Self {
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
        let mut parser = lexopt::Parser::from_env();
        while let Some(argument) = parser.next().map_err(|error| error.to_string())? {
            match argument {
                Long("model") => arguments.model = Some(option::text(&mut parser, "--model")?.into()),
                Long("keyframe") => arguments.keyframe = option::text(&mut parser, "--keyframe")?,
                Long("torso") => arguments.torso = option::text(&mut parser, "--torso")?,
                Long("foot") => arguments.foot = option::text(&mut parser, "--foot")?,
                Long("seconds") => arguments.seconds = positive(&mut parser, "--seconds")?,
                Long("push") => arguments.push = Some(push(&mut parser)?),
                Long("noise") => arguments.noise = positive(&mut parser, "--noise")?,
                Long("seed") => arguments.seed = option::number(&mut parser, "--seed")?,
                Long("out") => arguments.out = Some(option::text(&mut parser, "--out")?.into()),
                Long("view") => arguments.view = true,
                Long("json") => arguments.json = true,
                Short('h') | Long("help") => {
                    println!("{HELP}");
                    std::process::exit(0);
                }
                Short(_) | Long(_) | Value(_) => {
                    return Err(format!("{}; --help lists the options", argument.unexpected()));
                }
            }
        }
        Ok(arguments)
    }
}

fn positive(parser: &mut lexopt::Parser, name: &str) -> Result<f64, String> {
    let value: f64 = option::number(parser, name)?;
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(format!("{name} {value}: must be finite and not negative"))
    }
}

fn push(parser: &mut lexopt::Parser) -> Result<Push, String> {
    let list = option::text(parser, "--push")?;
    let numbers: Result<Vec<f64>, String> =
        list.split(',').map(|part| part.trim().parse().map_err(|error| format!("--push {list}: {error}"))).collect();
    match numbers?[..] {
        [x, y] => Ok(Push { force: [x, y], duration: 0.1 }),
        [x, y, duration] => Ok(Push { force: [x, y], duration }),
        _ => Err("--push: give FX,FY or FX,FY,SECONDS, as in --push 20,0".to_owned()),
    }
}
