//! Parallel rollouts: a balanced pole under many random pushes, simulated on all cores.
//!
//! ```text
//! cargo run --release --example rollouts -- --out out
//! ```
//!
//! The program prints the number of poles that remain upright, the strongest push among them, and
//! the speed of the simulation. `--help` lists the options.

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use common::chart::{self, Event, INK, Line, PALETTE, Panel};
use common::command_line;
use indicatif::{ProgressBar, ProgressStyle};
use mujoco_safe::rollout::{Rollout, RolloutResult};
use mujoco_safe::{Controller, Data, Lqr, LqrWeights, Model, sample};
use plotters::style::RGBColor;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};

/// Simulated time of each rollout, s.
const SECONDS: f64 = 3.0;
/// Standard deviation of the pushes, N.
const NEWTONS: f64 = 6.0;
/// Duration of a push, s.
const PUSH_DURATION: f64 = 0.1;
/// Angle beyond which the pole counts as fallen, rad.
const FALLEN: f64 = 1.0;

/// Simulates many random pushes of a balanced pole on all cores.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Number of pushes
    #[arg(long, value_name = "N", default_value_t = 256)]
    rollouts: usize,
    /// Folder for the plot; without it, no plot is written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let model = Arc::new(sample::cartpole());
    let pole = model.body("pole")?.id();
    let steps = (SECONDS / model.timestep()).round() as usize;

    let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
    let lqr = Lqr::at_present_state(&mut Data::new(model.clone())?, &weights)?;
    let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(1);
    let pushes: Vec<f64> = Normal::new(0.0, NEWTONS)
        .expect("a positive deviation")
        .sample_iter(&mut random)
        .take(arguments.rollouts)
        .collect();

    // Each rollout has its own controller, which applies the push and then the regulator.
    let bar = ProgressBar::new(arguments.rollouts as u64)
        .with_style(ProgressStyle::with_template("{bar:40} {pos}/{len} rollouts, {elapsed}")?);
    let start = Instant::now();
    let result = Rollout::new(model.clone(), arguments.rollouts, steps)
        .with_controllers(|index| {
            let (mut lqr, push) = (lqr.clone(), pushes[index]);
            move |data: &mut Data| {
                data.xfrc_applied_mut()[pole.index()][0] = if data.time() < PUSH_DURATION { push } else { 0.0 };
                lqr.control(data)
            }
        })
        .with_progress(|_| {
            bar.inc(1);
            ControlFlow::Continue(())
        })
        .run()?;
    let elapsed = start.elapsed().as_secs_f64();
    bar.finish();

    for (index, outcome) in result.outcomes().iter().enumerate() {
        if let Err(error) = outcome {
            println!("rollout {index}: {error}");
        }
    }
    let (standing, fallen): (Vec<usize>, Vec<usize>) = (0..result.len()).partition(|&index| is_upright(&result, index));
    let largest = |of: &[usize]| of.iter().map(|&index| pushes[index].abs()).fold(0.0, f64::max);
    let simulated = (arguments.rollouts * steps) as f64 * model.timestep();
    println!(
        "{} of {} poles are still upright; the strongest push among them was {:.1} N",
        standing.len(),
        result.len(),
        largest(&standing)
    );
    if let Some(least) = fallen.iter().map(|&index| pushes[index].abs()).min_by(f64::total_cmp) {
        println!("the weakest push that toppled a pole was {least:.1} N");
    }
    println!("simulated {simulated:.0} s in {elapsed:.3} s, {:.0} times real time", simulated / elapsed);

    if let Some(out) = &arguments.out {
        plot(out, &model, &result, &standing, &fallen)?;
    }
    Ok(())
}

/// Returns `true` if the pole never fell.
fn is_upright(result: &RolloutResult, index: usize) -> bool {
    result.states_of(index).rows().all(|state| state[1].abs() < FALLEN)
}

/// Plots the angle and the position of every rollout, and quantiles over the rollouts that remain
/// upright.
fn plot(
    out: &Path,
    model: &Model,
    result: &RolloutResult,
    standing: &[usize],
    fallen: &[usize],
) -> Result<(), Box<dyn Error>> {
    const PALE: RGBColor = RGBColor(176, 208, 230);
    let time = |step: usize| step as f64 * model.timestep();
    let panel = |title, y, coordinate: usize| {
        let rollout = |label: &str, color, index: usize| {
            // Omit the motion after a fall.
            let states = result.states_of(index);
            let points = states.rows().take_while(|state| state[1].abs() < FALLEN).enumerate();
            Line::new(label, color, points.map(|(step, state)| (time(step), state[coordinate])))
        };
        let quantile = |label: &str, fraction: f64, color| {
            let points = (0..=result.steps()).map(|step| {
                let values = standing.iter().map(|&index| result.state(index, step)[coordinate]);
                (time(step), self::quantile(values.collect(), fraction))
            });
            Line::new(label, color, points)
        };
        let label = |text, index| if index == 0 { text } else { "" };
        let mut lines = Vec::new();
        lines.extend(standing.iter().enumerate().map(|(line, &index)| rollout(label("upright", line), PALE, index)));
        lines.extend(fallen.iter().enumerate().map(|(line, &index)| rollout(label("fallen", line), PALETTE[1], index)));
        if !standing.is_empty() {
            lines.push(quantile("median", 0.5, INK));
            lines.push(quantile("5 % and 95 %", 0.05, PALETTE[0]));
            lines.push(quantile("", 0.95, PALETTE[0]));
        }
        Panel::new(title, ["time (s)", y], lines).events([Event::new("push", 0.0, PUSH_DURATION)])
    };
    chart::save(
        out,
        "rollouts.svg",
        300,
        &[
            panel("Angle of the pole during and after a random push", "angle (rad)", 1),
            panel("Position of the cart", "position (m)", 0),
        ],
    )
}

/// Returns the quantile of some values at a fraction.
fn quantile(mut values: Vec<f64>, fraction: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[(fraction * (values.len() - 1) as f64).round() as usize]
}
