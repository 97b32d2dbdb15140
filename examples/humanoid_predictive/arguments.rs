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
        let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
        let arguments = Self { seeds: 5, newtons: NEWTONS, seconds: 6.0, threads: cores, out: None };
        option::read(HELP, arguments, |arguments, option| {
            match option.name() {
                "--seeds" => arguments.seeds = option.number()?,
                "--newtons" => arguments.newtons = option.number()?,
                "--seconds" => arguments.seconds = option.number()?,
                "--threads" => arguments.threads = option.number()?,
                "--out" => arguments.out = Some(option.path()?),
                _ => return option.unknown(),
            }
            Ok(())
        })
    }
}
