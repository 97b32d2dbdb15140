//! Everything that this library claims to do faster than others, side by side with them: see `scripts/compare`, which builds and sets up
//! what this needs.
//!
//! ```text
//! cargo bench --bench compare -- --engine target/perf/engine --python target/perf/venv/bin/python --out out
//! ```
//!
//! The others are programs of their own, which wait for their turn: ours, theirs, theirs, ours. Each pair has a ratio; what is
//! reported is the median of the ratios, and their quartiles. All threads keep to a processor each (see `processor.rs`), and for work in several
//! a pair counts if the machine had a core for each.

#[path = "../benches/common/models.rs"]
mod models;
mod ours;
mod peer;
mod processor;
mod report;


use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use models::Balance;
use ours::{Ours, Riccatis};
use peer::Peer;
use report::{Duel, Report};

/// How many pairs of short turns there are for one of rollouts, which take longer.
const LONGER: usize = 6;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

struct Arguments {
    engine: PathBuf,
    python: Option<PathBuf>,
    out: PathBuf,
    pairs: usize,
    threads: usize,
}

fn arguments() -> Outcome<Arguments> {
    use lexopt::prelude::*;
    let mut arguments =
        Arguments { engine: "target/perf/engine".into(), python: None, out: "out".into(), pairs: 301, threads: 2 };
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("engine") => arguments.engine = parser.value()?.into(),
            Long("python") => arguments.python = Some(parser.value()?.into()),
            Long("out") => arguments.out = parser.value()?.into(),
            Long("pairs") => arguments.pairs = parser.value()?.parse::<usize>()?.max(3),
            Long("threads") => arguments.threads = parser.value()?.parse::<usize>()?.clamp(1, 64),
            Long("bench") => (), // cargo says so
            _ => return Err(argument.unexpected().into()),
        }
    }
    Ok(arguments)
}

/// A model, the keyframe that it starts from, and how much is done in a turn: some milliseconds, as what else the machine does changes from
/// one hundredth of a second to the next. Rollouts take longer, so that threads are worth starting.
struct Task {
    name: &'static str,
    path: PathBuf,
    key: Option<&'static str>,
    steps: usize,
    /// Of each of 64 rollouts.
    rollout_steps: usize,
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
            systems: 200,
        },
        Task {
            name: "humanoid, standing",
            path: humanoid,
            key: Some("stand"),
            steps: 80,
            rollout_steps: 20,
            systems: 2,
        },
    ];
    if let Some(path) = models::many_humanoids().map(Path::to_owned) {
        tasks.push(Task { name: "22 humanoids", path, key: None, steps: 8, rollout_steps: 0, systems: 0 });
    }
    tasks
}

fn main() -> Outcome<()> {
    let arguments = arguments()?;
    let (pairs, threads) = (arguments.pairs, arguments.threads);
    let (one, all) = (processor::pool(1)?, processor::pool(threads)?);
    let pools = if threads == 1 { vec![&one] } else { vec![&one, &all] };
    let mut report = Report::default();

    for Task { name, path, key, steps, rollout_steps, systems } in tasks() {
        let mut ours = Ours::new(&path, key, threads)?;
        let mut engine = Peer::start(&arguments.engine, &path, key, None)?;
        let mut python = match &arguments.python {
            Some(python) => Some(Peer::start(python, &path, key, Some("perf/peer.py"))?),
            None => None,
        };
        let order = format!("step {steps}");
        let c = Duel::fight(&one, pairs, || ours.step(steps), || engine.ask(&order))?;
        report.add(format!("step, {name}"), "C", steps, &c.same());
        if let Some(python) = &mut python {
            let duel = Duel::fight(&one, pairs, || ours.step(steps), || python.ask(&order))?;
            report.add(format!("step, {name}"), "Python bindings", steps, &duel.same());
        }
        if rollout_steps == 0 {
            continue;
        }

        let (count, steps) = (64, rollout_steps);
        let long = pairs.div_ceil(LONGER);
        let calls = count * steps;
        for pool in &pools {
            let threads = pool.current_num_threads();
            let order = format!("rollout {count} {steps} {threads}");
            let what = format!("64 rollouts, {name}, threads: {threads}");
            let duel = Duel::fight(pool, long, || ours.rollout(count, steps), || engine.ask(&order))?;
            report.add(what.clone(), "C", calls, &duel.same());
            if let Some(python) = &mut python {
                let duel = Duel::fight(pool, long, || ours.rollout(count, steps), || python.ask(&order))?;
                report.add(what, "Python bindings", calls, &duel.same());
            }
        }
        if threads > 1 {
            let mut others = Ours::new(&path, key, threads)?;
            let in_one = || one.install(|| others.rollout(count, steps));
            let duel = Duel::fight(&all, long, || ours.rollout(count, steps), in_one)?;
            assert!(duel.is_same_to_the_last_bit(), "the number of threads changes the result");
            report.add(format!("64 rollouts, {name}, threads: {threads}"), "itself in one", calls, &duel);
        }

        let order = format!("transition {systems}");
        for pool in &pools {
            let threads = pool.current_num_threads();
            let duel = Duel::fight(pool, pairs, || ours.transition(systems), || engine.ask(&order))?;
            report.add(format!("linear system, {name}, threads: {threads}"), "C", systems, &duel);
        }

        if let Some(python) = &mut python {
            let balance = if name == "cart-pole" { Balance::cartpole()? } else { Balance::humanoid()? };
            let mut riccatis = Riccatis::new(balance)?;
            fs::create_dir_all(&arguments.out)?;
            let file = std::path::absolute(arguments.out.join("riccati.txt"))?;
            fs::write(&file, riccatis.text())?;
            let order = format!("riccati {}", file.display());
            let duel = Duel::fight(&one, pairs, || riccatis.solve(), || python.ask(&order))?;
            println!("Riccati, {name}: relative residuals {:.1e} and {:.1e}", duel.ours_made, duel.theirs_made);
            report.add(format!("Riccati equation, {name}"), "SciPy", 1, &duel);
            fs::remove_file(&file)?;

            let calls = 2000;
            let order = format!("controller {calls}");
            let duel = Duel::fight(&one, pairs, || ours.controller(calls), || python.ask(&order))?;
            report.add(format!("LQR's decision, {name}"), "NumPy", calls, &duel.same());
        }
    }
    if arguments.python.is_none() {
        println!("Not compared with Python, SciPy and NumPy: no --python was given.");
    }
    report.write(&arguments.out)?;
    Ok(())
}
