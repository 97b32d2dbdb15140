//! Learning to run: augmented random search finds a gait of the half cheetah.
//!
//! ```text
//! cargo run --release --features renderer --example learn_gait -- --out out    # without the feature, no film
//! ```
//!
//! The policy is linear in the observations, with 6 × 17 weights that start at zero. An iteration
//! of the search ([`search`]) runs 18 episodes of 50 s at the same time, in a
//! [`VectorEnvironment`](mujoco_safe::environment::VectorEnvironment) on all cores. The program
//! repeats the search with other random numbers, prints the return of each policy in episodes that
//! the search has not seen, plots the learning curves, records a film of the best policy, and saves
//! it. `--policy` measures and records a saved policy. `--help` lists the options.
//!
//! With MuJoCo 2.2.2 of Debian 12, 3 of 3 searches reach a return of 2500; their policies run
//! faster than 3.2 m/s. The mean includes the episodes in which a policy falls on its back, at most
//! a fifth of them. The results are the same for any number of threads. Other builds of the engine
//! differ in the last bits, and so find other gaits.

#[path = "../common/mod.rs"]
mod common;
#[cfg(feature = "renderer")]
mod film;
mod plots;
mod policy;
mod search;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use common::command_line;
use mujoco_safe::Model;
use mujoco_safe::environment::{HalfCheetah, Task, VectorEnvironment};
use policy::Policy;
use search::{EPISODES, Search, returns};

/// Return of a policy that runs: the mean velocity is more than 2.5 m/s.
const GOAL: f64 = 2500.0;
/// Number of iterations after which each search has found such a policy.
const ITERATIONS: usize = 250;
/// Number of episodes that measure a learnt policy.
const TESTS: usize = 32;
/// Seed of the episodes that measure the best policy of a search.
const TEST_SEED: u64 = u64::MAX;
/// Seed of the episodes that select this policy.
const SELECTION_SEED: u64 = TEST_SEED - 1;
/// Number of policies of a search among which these episodes select.
const CANDIDATES: usize = 8;
/// Duration of the film, s.
#[cfg(feature = "renderer")]
const FILM: f64 = 6.0;

/// Learns to run by augmented random search.
#[derive(Parser)]
#[command(args_override_self = true)]
struct Arguments {
    /// Number of searches, each with other random numbers
    #[arg(long, value_name = "N", default_value_t = 3)]
    seeds: u64,
    /// Number of iterations of each search
    #[arg(long, value_name = "N", default_value_t = ITERATIONS)]
    iterations: usize,
    /// Measures this policy instead of learning one
    #[arg(long, value_name = "FILE")]
    policy: Option<PathBuf>,
    /// Folder for the plot, the film and the policy; without it, no files are written
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> std::process::ExitCode {
    command_line::exit_code(run(&Arguments::parse()))
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let model = Arc::new(HalfCheetah::model());
    if let Some(path) = &arguments.policy {
        let policy = Policy::load(path, model.nu(), HalfCheetah.observation_size(&model))?;
        println!("return {:.1}", measure(&model, &policy, TEST_SEED)?);
        return arguments.out.as_deref().map_or(Ok(()), |out| write_film(out, &model, &policy));
    }
    let (mut curves, mut best, mut successes) = (Vec::new(), None::<(f64, Policy)>, 0);
    for seed in 1..=arguments.seeds {
        let start = Instant::now();
        let (curve, policy) = learn(&model, seed, arguments.iterations)?;
        let value = measure(&model, &policy, TEST_SEED)?;
        println!("seed {seed}: return {value:.1} after {:.0} s", start.elapsed().as_secs_f64());
        successes += usize::from(value >= GOAL);
        curves.push(curve);
        if best.as_ref().is_none_or(|(most, _)| value > *most) {
            best = Some((value, policy));
        }
    }
    println!("{successes} of {} seeds reach a return of {GOAL}", curves.len());
    if let (Some(out), Some((_, policy))) = (&arguments.out, best) {
        std::fs::create_dir_all(out)?;
        let [plot, file] = ["learn_gait.svg", "learn_gait.json"].map(|name| out.join(name));
        plots::draw(&plot, &curves)?;
        policy.save(&file)?;
        println!("wrote {} and {}", plot.display(), file.display());
        write_film(out, &model, &policy)?;
    }
    if successes < curves.len() && arguments.iterations >= ITERATIONS {
        return Err(format!("not every search reached a return of {GOAL}").into());
    }
    Ok(())
}

/// Searches for a policy. Returns the curve, which is the return of the policy before each
/// iteration, and the best policy.
///
/// Many policies run in most episodes and fall on their back in some, which the two episodes of an
/// iteration may not show. The best policy is therefore selected in more episodes, among those of
/// the highest points of the curve.
fn learn(model: &Arc<Model>, seed: u64, iterations: usize) -> mujoco_safe::Result<(Vec<f64>, Policy)> {
    let mut search = Search::new(model, seed)?;
    let mut curve = Vec::with_capacity(iterations);
    let mut candidates = vec![(f64::NEG_INFINITY, search.policy().clone())];
    for iteration in 1..=iterations {
        let policy = search.policy().clone();
        let value = search.iterate()?;
        curve.push(value);
        candidates.push((value, policy));
        candidates.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        candidates.truncate(CANDIDATES);
        if iteration % 25 == 0 {
            let most = candidates[0].0;
            println!("seed {seed}, {} episodes: return {value:.0}, highest so far {most:.0}", iteration * EPISODES);
        }
    }
    for (value, policy) in &mut candidates {
        *value = measure(model, policy, SELECTION_SEED)?;
    }
    let (_, best) = candidates.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b)).expect("there are candidates");
    Ok((curve, best))
}

/// Returns the mean return of a policy in episodes of this seed.
fn measure(model: &Arc<Model>, policy: &Policy, seed: u64) -> mujoco_safe::Result<f64> {
    let mut environment = VectorEnvironment::new(model, HalfCheetah, TESTS, seed)?;
    let returns = returns(&mut environment, |observations, controls| policy.act(observations, controls))?;
    Ok(returns.iter().sum::<f64>() / TESTS as f64)
}

/// Records a film of a policy, if the example is built with the feature `renderer`.
#[cfg_attr(not(feature = "renderer"), allow(clippy::unnecessary_wraps, reason = "only a film can fail"))]
fn write_film(out: &Path, model: &Arc<Model>, policy: &Policy) -> Result<(), Box<dyn Error>> {
    #[cfg(feature = "renderer")]
    {
        std::fs::create_dir_all(out)?;
        let recorded = film::record(&out.join("learn_gait.gif"), model, policy, FILM)?;
        println!("wrote {}: {} frames, {:.2} s", recorded.path.display(), recorded.frames, recorded.seconds);
    }
    #[cfg(not(feature = "renderer"))]
    let _ = (out, model, policy);
    Ok(())
}
