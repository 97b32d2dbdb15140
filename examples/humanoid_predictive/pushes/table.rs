//! Table of the falls by direction, and all pushes as CSV.

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use super::Outcome;

/// Directions of the force, each in the middle of an eighth of the circle, as seen by the humanoid.
const DIRECTIONS: [&str; 8] =
    ["forward", "forward left", "left", "backward left", "backward", "backward right", "right", "forward right"];

/// Returns the index of the direction of an angle.
fn direction(angle: f64) -> usize {
    (angle / TAU * DIRECTIONS.len() as f64).round() as usize % DIRECTIONS.len()
}

/// Prints the numbers of pushes and of falls for each direction.
pub fn print(outcomes: &[Outcome]) {
    println!("{:<16} {:>6} {:>10} {:>14}", "direction", "pushes", "LQR falls", "planner falls");
    let row = |name: &str, is_in: &dyn Fn(&Outcome) -> bool| {
        let count = |is_counted: &dyn Fn(&Outcome) -> bool| {
            outcomes.iter().filter(|&outcome| is_in(outcome) && is_counted(outcome)).count()
        };
        let regulated = count(&|outcome| !outcome.regulated.upright());
        let planned = count(&|outcome| !outcome.planned.upright());
        println!("{name:<16} {:>6} {regulated:>10} {planned:>14}", count(&|_| true));
    };
    for (index, name) in DIRECTIONS.iter().enumerate() {
        row(name, &|outcome| direction(outcome.angle) == index);
    }
    row("all", &|_| true);
}

/// Writes a line for each push. The time of a fall is empty if the humanoid stands.
pub fn save(path: &Path, newtons: f64, outcomes: &[Outcome]) -> Result<(), Box<dyn Error>> {
    let mut csv = "seed,force_newtons,angle_degrees,direction,lqr_fell_at_seconds,planner_fell_at_seconds\n".to_owned();
    let time = |fell_at: Option<f64>| fell_at.map_or_else(String::new, |time| format!("{time:.3}"));
    for Outcome { seed, angle, regulated, planned } in outcomes {
        let (degrees, name) = (angle.to_degrees(), DIRECTIONS[direction(*angle)]);
        let (regulated, planned) = (time(regulated.fell_at), time(planned.fell_at));
        writeln!(csv, "{seed},{newtons},{degrees:.2},{name},{regulated},{planned}")?;
    }
    std::fs::write(path, csv).map_err(|error| format!("{}: {error}", path.display()).into())
}
