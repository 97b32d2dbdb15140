//! Speed comparison with other implementations: the engine in C, its Python bindings, SciPy and
//! NumPy. `scripts/compare` builds and installs everything that it requires.
//!
//! ```text
//! cargo bench --bench compare -- --engine target/perf/engine --python target/perf/venv/bin/python --out out
//! ```
//!
//! Each reference runs in its own process. The measurements alternate in the order ours, theirs,
//! theirs, ours. Each pair gives a ratio; the report contains the median and the quartiles of the
//! ratios. Every thread is pinned to a processor (see `processor.rs`). A multi-threaded pair counts
//! only if the machine provided a core for each thread.

#[allow(dead_code, reason = "the line charts of the examples use more of it")]
#[path = "../examples/common/axis.rs"]
mod axis;
#[allow(dead_code, reason = "the line charts are for the examples")]
#[path = "../examples/common/chart.rs"]
mod chart;
mod library;
#[path = "../benches/common/models.rs"]
mod models;
mod peer;
#[path = "../benches/common/process.rs"]
mod process;
mod processor;
mod report;
mod slicot;
mod speed_chart;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use library::{Library, RiccatiProblem};
use models::Balance;
use mujoco_safe::Version;
use peer::Peer;
use report::{Comparison, Report};

/// Ratio of the number of pairs of short runs to that of rollouts and batches, which take longer.
const SHORT_PAIRS_PER_LONG_PAIR: usize = 6;

/// Number of simulations of a batch. Each has its own `MjData` in one of the references.
const BATCH_SIZE: usize = 256;

/// First engine whose Python bindings have `mujoco.batch`.
const BATCH_IN_PYTHON: Version = Version { major: 3, minor: 17, patch: 0 };

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Compares the speed with other implementations.
#[derive(Parser)]
struct Arguments {
    /// Program that measures the engine in C
    #[arg(long, value_name = "PROGRAM", default_value = "target/perf/engine")]
    engine: PathBuf,
    /// Python interpreter with the engine's bindings, SciPy and NumPy; without it, only C is
    /// compared
    #[arg(long, value_name = "PROGRAM")]
    python: Option<PathBuf>,
    /// Python interpreter with slycot; without it, the Riccati solver is not compared with SLICOT
    #[arg(long, value_name = "PROGRAM")]
    slycot: Option<PathBuf>,
    /// Folder for the report
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Number of pairs of runs, at least 3
    #[arg(long, value_name = "N", default_value_t = 301)]
    pairs: usize,
    /// Number of threads of the parallel tasks, from 1 to 64
    #[arg(long, value_name = "N", default_value_t = 2)]
    threads: usize,
    /// Passed by cargo
    #[arg(long, hide = true)]
    bench: bool,
}

/// Model, initial keyframe, and amount of work per run. A run takes a few milliseconds, because the
/// load of the machine varies from one hundredth of a second to the next. Rollouts take longer, to
/// amortise the start of the threads.
struct Task {
    name: &'static str,
    path: PathBuf,
    key: Option<&'static str>,
    steps: usize,
    /// Steps of each of the 64 rollouts.
    rollout_steps: usize,
    /// Calls that step the batch.
    batch_calls: usize,
    systems: usize,
}

fn tasks() -> Vec<Task> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    let (cartpole, humanoid) = (own.join("cartpole.xml"), own.join("humanoid.xml"));
    let mut tasks = vec![
        Task {
            name: "cart-pole",
            path: cartpole,
            key: Some("hanging_down"),
            steps: 2000,
            rollout_steps: 500,
            batch_calls: 40,
            systems: 200,
        },
        Task {
            name: "humanoid, standing",
            path: humanoid,
            key: Some("stand"),
            steps: 80,
            rollout_steps: 20,
            batch_calls: 8,
            systems: 2,
        },
    ];
    if let Some(path) = models::many_humanoids().map(Path::to_owned) {
        tasks.push(Task {
            name: "22 humanoids",
            path,
            key: None,
            steps: 8,
            rollout_steps: 0,
            batch_calls: 0,
            systems: 0,
        });
    }
    tasks
}

/// Returns the Riccati equation of the LQR of a model.
fn riccati_problem(name: &str) -> Outcome<RiccatiProblem> {
    RiccatiProblem::new(if name == "cart-pole" { Balance::cartpole()? } else { Balance::humanoid()? })
}

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    let (pairs, threads) = (arguments.pairs.max(3), arguments.threads.clamp(1, 64));
    let (one, all) = (processor::pool(1)?, processor::pool(threads)?);
    let pools = if threads == 1 { vec![&one] } else { vec![&one, &all] };
    let mut report = Report::default();

    for Task { name, path, key, steps, rollout_steps, batch_calls, systems } in tasks() {
        let mut ours = Library::new(&path, key, threads)?;
        let mut engine = Peer::start(&arguments.engine, &path, key, None)?;
        let mut python = match &arguments.python {
            Some(python) => Some(Peer::start(python, &path, key, Some("perf/peer.py"))?),
            None => None,
        };
        let command = format!("step {steps}");
        let comparison = Comparison::measure(&one, pairs, || ours.step(steps), || engine.run(&command))?;
        report.add(format!("step, {name}"), "C", steps, &comparison.warn_if_different());
        if let Some(python) = &mut python {
            let comparison = Comparison::measure(&one, pairs, || ours.step(steps), || python.run(&command))?;
            report.add(format!("step, {name}"), "Python bindings", steps, &comparison.warn_if_different());
        }
        if rollout_steps == 0 {
            continue;
        }

        let (count, steps) = (64, rollout_steps);
        let long = pairs.div_ceil(SHORT_PAIRS_PER_LONG_PAIR);
        let calls = count * steps;
        for pool in &pools {
            let threads = pool.current_num_threads();
            let command = format!("rollout {count} {steps} {threads}");
            let task = format!("64 rollouts, {name}, threads: {threads}");
            let comparison = Comparison::measure(pool, long, || ours.rollout(count, steps), || engine.run(&command))?;
            report.add(task.clone(), "C", calls, &comparison.warn_if_different());
            if let Some(python) = &mut python {
                let comparison =
                    Comparison::measure(pool, long, || ours.rollout(count, steps), || python.run(&command))?;
                report.add(task, "Python bindings", calls, &comparison.warn_if_different());
            }
        }
        if threads > 1 {
            let mut others = Library::new(&path, key, threads)?;
            let in_one = || one.install(|| others.rollout(count, steps));
            let comparison = Comparison::measure(&all, long, || ours.rollout(count, steps), in_one)?;
            assert!(comparison.is_bitwise_equal(), "the number of threads changes the result");
            report.add(format!("64 rollouts, {name}, threads: {threads}"), "one thread", calls, &comparison);
        }

        for pool in &pools {
            let threads = pool.current_num_threads();
            let mut compare = |reference, peer: &mut Peer, command: &str| -> Outcome<()> {
                let command = format!("{command} {BATCH_SIZE} {batch_calls} {threads}");
                let comparison =
                    Comparison::measure(pool, long, || ours.batch(BATCH_SIZE, batch_calls), || peer.run(&command))?;
                let task = format!("batch of {BATCH_SIZE}, {name}, threads: {threads}");
                report.add(task, reference, BATCH_SIZE * batch_calls, &comparison.warn_if_different());
                Ok(())
            };
            compare("C", &mut engine, "batch")?;
            if let Some(python) = &mut python {
                compare("Python, MjData each", python, "environments")?;
                if mujoco_safe::engine_version() >= BATCH_IN_PYTHON {
                    compare("mujoco.batch", python, "batch")?;
                }
            }
        }

        let command = format!("transition {systems}");
        for pool in &pools {
            let threads = pool.current_num_threads();
            let comparison = Comparison::measure(pool, pairs, || ours.transition(systems), || engine.run(&command))?;
            report.add(format!("linear system, {name}, threads: {threads}"), "C", systems, &comparison);
        }

        if let Some(slycot) = &arguments.slycot {
            let problem = riccati_problem(name)?;
            slicot::compare(&mut report, (slycot, &arguments.out), (&one, pairs), (name, &path), problem)?;
        }

        if let Some(python) = &mut python {
            let mut riccati = riccati_problem(name)?;
            fs::create_dir_all(&arguments.out)?;
            let file = std::path::absolute(arguments.out.join("riccati.txt"))?;
            fs::write(&file, riccati.text())?;
            let command = format!("riccati {}", file.display());
            let comparison = Comparison::measure(&one, pairs, || riccati.solve(), || python.run(&command))?;
            println!(
                "Riccati, {name}: relative residuals {:.1e} and {:.1e}",
                comparison.our_checksum, comparison.their_checksum
            );
            report.add(format!("Riccati equation, {name}"), "SciPy", 1, &comparison);
            fs::remove_file(&file)?;

            let calls = 2000;
            let command = format!("controller {calls}");
            let comparison = Comparison::measure(&one, pairs, || ours.controller(calls), || python.run(&command))?;
            report.add(format!("LQR control law, {name}"), "NumPy", calls, &comparison.warn_if_different());
        }
    }
    if arguments.python.is_none() {
        println!("No comparison with Python, SciPy and NumPy: no --python was given.");
    }
    if arguments.slycot.is_none() {
        println!("No comparison with SLICOT: no --slycot was given.");
    }
    report.write(&arguments.out)?;
    Ok(())
}
