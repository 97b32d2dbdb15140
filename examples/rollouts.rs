//! What becomes of a balanced pole when it is pushed? Many random pushes at once, on all cores.
//!
//! ```text
//! cargo run --release --example rollouts -- --out out
//! ```
//!
//! `--rollouts N` how many pushes (256), `--newtons F` their standard deviation (6), `--seconds S` how long each is watched (3),
//! `--seed N` for other pushes (1), `--out DIR` where the plot goes (none is written without).

#[path = "common/mod.rs"]
mod common;

use std::error::Error;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use common::chart::{self, INK, Line, PALETTE, Panel};
use common::option;
use indicatif::{ProgressBar, ProgressStyle};
use mujoco_safe::rollout::{Rollout, RolloutResult};
use mujoco_safe::{Controller, Data, Lqr, LqrWeights, Model, sample};
use plotters::style::RGBColor;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};

/// How long a push lasts, s.
const PUSH: f64 = 0.1;
/// A pole that leans more has fallen, rad.
const FALLEN: f64 = 1.0;

struct Arguments {
    rollouts: usize,
    newtons: f64,
    seconds: f64,
    seed: u64,
    out: Option<PathBuf>,
}

const HELP: &str = "rollouts [--rollouts N] [--newtons F] [--seconds S] [--seed N] [--out DIR]";

fn arguments() -> Result<Arguments, String> {
    let arguments = Arguments { rollouts: 256, newtons: 6.0, seconds: 3.0, seed: 1, out: None };
    option::read(HELP, arguments, |arguments, option| {
        match option.name() {
            "--rollouts" => arguments.rollouts = option.number()?,
            "--newtons" => arguments.newtons = option.number()?,
            "--seconds" => arguments.seconds = option.number()?,
            "--seed" => arguments.seed = option.number()?,
            "--out" => arguments.out = Some(option.path()?),
            _ => return option.unknown(),
        }
        Ok(())
    })
}

fn main() -> std::process::ExitCode {
    common::finish(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments = arguments()?;
    let model = Arc::new(sample::cartpole());
    let pole = model.body("pole")?.id();
    let steps = (arguments.seconds / model.timestep()).round() as usize;

    let weights = LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0]);
    let lqr = Lqr::at_present_state(&mut Data::new(model.clone())?, &weights)?;
    let mut random = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(arguments.seed);
    let normal =
        Normal::new(0.0, arguments.newtons).map_err(|error| format!("--newtons {}: {error}", arguments.newtons))?;
    let pushes: Vec<f64> = normal.sample_iter(&mut random).take(arguments.rollouts).collect();

    // Each rollout has a controller of its own: the regulator, and a push while it lasts.
    let bar = ProgressBar::new(arguments.rollouts as u64)
        .with_style(ProgressStyle::with_template("{bar:40} {pos}/{len} rollouts, {elapsed}")?);
    let start = Instant::now();
    let result = Rollout::new(model.clone(), arguments.rollouts, steps)
        .controllers(|index| {
            let (mut lqr, push) = (lqr.clone(), pushes[index]);
            move |data: &mut Data| {
                data.xfrc_applied_mut()[pole.index()][0] = if data.time() < PUSH { push } else { 0.0 };
                lqr.control(data)
            }
        })
        .progress(|_| {
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
    let (standing, fallen): (Vec<usize>, Vec<usize>) = (0..result.len()).partition(|&index| stands(&result, index));
    let largest = |of: &[usize]| of.iter().map(|&index| pushes[index].abs()).fold(0.0, f64::max);
    let simulated = (arguments.rollouts * steps) as f64 * model.timestep();
    println!(
        "{} poles of {} still stand; the hardest push among them was {:.1} N",
        standing.len(),
        result.len(),
        largest(&standing)
    );
    if let Some(least) = fallen.iter().map(|&index| pushes[index].abs()).min_by(f64::total_cmp) {
        println!("the softest push that felled one was {least:.1} N");
    }
    println!("{simulated:.0} s simulated in {elapsed:.3} s: {:.0} times real time", simulated / elapsed);

    if let Some(out) = &arguments.out {
        std::fs::create_dir_all(out)?;
        let path = out.join("rollouts.svg");
        plot(&path, &model, &result, &standing, &fallen)?;
        println!("wrote {}", path.display());
    }
    Ok(())
}

/// Whether the pole stayed up.
fn stands(result: &RolloutResult, index: usize) -> bool {
    result.states_of(index).rows().all(|state| state[1].abs() < FALLEN)
}

/// The angle and the position of every rollout, and the quantiles of those that stand.
fn plot(
    path: &Path,
    model: &Model,
    result: &RolloutResult,
    standing: &[usize],
    fallen: &[usize],
) -> Result<(), Box<dyn Error>> {
    const PALE: RGBColor = RGBColor(176, 208, 230);
    let time = |step: usize| step as f64 * model.timestep();
    let panel = |title, y, coordinate: usize| {
        let rollout = |label: &str, color, index: usize| {
            // A pole that has fallen swings about, which is of no interest here.
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
        let label = |text, place| if place == 0 { text } else { "" };
        let mut lines = Vec::new();
        lines.extend(standing.iter().enumerate().map(|(place, &index)| rollout(label("stands", place), PALE, index)));
        lines
            .extend(fallen.iter().enumerate().map(|(place, &index)| rollout(label("falls", place), PALETTE[1], index)));
        if !standing.is_empty() {
            lines.push(quantile("median", 0.5, INK));
            lines.push(quantile("5 and 95 %", 0.05, PALETTE[0]));
            lines.push(quantile("", 0.95, PALETTE[0]));
        }
        Panel { title, x: "time (s)", y, lines, at_least: None }
    };
    chart::draw(
        path,
        300,
        &[panel("Pole after a random push of 0.1 s", "angle (rad)", 1), panel("Cart under it", "position (m)", 0)],
    )
}

/// The value below which this fraction of them lies.
fn quantile(mut values: Vec<f64>, fraction: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[(fraction * (values.len() - 1) as f64).round() as usize]
}
