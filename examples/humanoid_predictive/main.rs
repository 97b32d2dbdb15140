//! A humanoid is pushed so hard that its linear-quadratic regulator falls; a planner keeps it up.
//!
//! ```text
//! cargo run --release --example humanoid_predictive -- --out out
//! ```
//!
//! The planner simulates 32 futures of half a second, 50 times a second, each under the regulator with something random added, and
//! does what the best of them does ([`planner`]). What is good is that the robot is up and not about to fall over
//! ([`cost`]); that it takes steps for that is its own idea. The simulation waits for the planner, and the real-time factor says
//! for how long. `--help` lists the options.

mod arguments;
mod attempt;
#[path = "../common/mod.rs"]
mod common;
mod cost;
#[path = "../humanoid_lqr/film.rs"]
mod film;
mod planner;
mod plots;
mod robot;
#[allow(dead_code, reason = "the example it belongs to tells more about the run")]
#[path = "../humanoid_lqr/simulate.rs"]
mod simulate;

use std::error::Error;

use arguments::Arguments;
use attempt::{Attempt, attempt};
use common::balance::{set_point, weights};
use mujoco_safe::Data;
use mujoco_safe::rayon::ThreadPoolBuilder;
use planner::{HORIZON, SAMPLES, STEPS};
use robot::{PUSH, Robot, push};

fn main() -> std::process::ExitCode {
    common::finish(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse()?;
    let pool = ThreadPoolBuilder::new().num_threads(arguments.threads).build()?;
    let robot = Robot::new()?;
    println!(
        "{SAMPLES} futures of {HORIZON} s every {} ms, on {} threads; pushes of {} N for {PUSH} s after 1 s",
        STEPS as f64 * robot.model.timestep() * 1e3,
        pool.current_num_threads(),
        arguments.newtons
    );
    let mut attempts = Vec::new();
    for seed in 1..=arguments.seeds {
        let attempt = pool.install(|| attempt(&robot, arguments.newtons, seed, arguments.seconds))?;
        let [x, y] = push(arguments.newtons, seed).force;
        let fate = |fell_at: Option<f64>| match fell_at {
            Some(time) => format!("falls after {time:.2} s"),
            None => "stands".to_owned(),
        };
        println!(
            "push {seed}, towards {:4.0}°: LQR {}, planned {}; real-time factor {:.2}",
            y.atan2(x).to_degrees(),
            fate(attempt.regulated.fell_at),
            fate(attempt.planned.fell_at),
            attempt.real_time_factor()
        );
        attempts.push(attempt);
    }
    if let (Some(out), Some(first)) = (&arguments.out, attempts.first()) {
        std::fs::create_dir_all(out)?;
        let names = [
            "humanoid_predictive.svg",
            "humanoid_predictive_film.svg",
            "humanoid_pushed_film.svg",
            "humanoid_predictive.csv",
        ];
        let [chart, planned, regulated, csv] = names.map(|name| out.join(name));
        plots::draw(&chart, &attempts)?;
        let mut data = Data::new(robot.model.clone())?;
        for (path, run) in [(&planned, &first.planned), (&regulated, &first.regulated)] {
            // One that falls is out of the picture at the end.
            let last = run.trajectory.len() - if run.upright() { 1 } else { 30 };
            let moments = [1.0, 1.2, 1.4, 1.7, 2.0, arguments.seconds];
            let records = moments.map(|time| ((time / robot.model.timestep()) as usize).min(last));
            film::draw(path, &mut data, run, &records)?;
        }
        first.planned.trajectory.save_csv(&csv)?;
        for path in [&chart, &planned, &regulated, &csv] {
            println!("wrote {}", path.display());
        }
    }
    let good = attempts.iter().filter(|attempt| attempt.succeeded()).count();
    println!("{good} of {} pushes felled the regulator and not the planner", attempts.len());
    if attempts.iter().all(Attempt::succeeded) { Ok(()) } else { Err("not all".into()) }
}
