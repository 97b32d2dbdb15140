//! The command line.

use std::path::PathBuf;

use crate::common::option;
use crate::robot::NEWTONS;

pub const HELP: &str = "\
A humanoid is pushed so hard that its linear-quadratic regulator falls; a planner keeps it up.

  --seeds N         how many pushes, each in another direction (5)
  --newtons F       how hard, for 0.1 s (180)
  --seconds S       how long each simulation is; the push comes after 1 s (6)
  --threads N       how many threads plan (all cores)
  --out DIR         where the plots and the trajectory of the first go; nothing is written without";

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
    pub seeds: u64,
    pub newtons: f64,
    pub seconds: f64,
    pub threads: usize,
    pub out: Option<PathBuf>,
}

impl Arguments {
    pub fn parse() -> Result<Self, String> {
        use lexopt::Arg::{Long, Short, Value};
        let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
        let mut arguments = Self { seeds: 5, newtons: NEWTONS, seconds: 6.0, threads: cores, out: None };
        let mut parser = lexopt::Parser::from_env();
        while let Some(argument) = parser.next().map_err(|error| error.to_string())? {
            match argument {
                Long("seeds") => arguments.seeds = option::number(&mut parser, "--seeds")?,
                Long("newtons") => arguments.newtons = option::number(&mut parser, "--newtons")?,
                Long("seconds") => arguments.seconds = option::number(&mut parser, "--seconds")?,
                Long("threads") => arguments.threads = option::number(&mut parser, "--threads")?,
                Long("out") => arguments.out = Some(option::text(&mut parser, "--out")?.into()),
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
