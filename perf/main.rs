//! Everything that this library claims to do faster than others, side by side with them: see `scripts/compare`, which builds and sets up
//! what this needs.
//!
//! ```text
//! cargo bench --bench compare -- --engine target/perf/engine --python target/perf/venv/bin/python --out out
//! ```
//!
//! The others are programs of their own, which wait for their turn: ours, theirs, ours, theirs. Each pair has a ratio; what is
//! reported is the median of the ratios, and their quartiles.

#[path = "../benches/common/balance.rs"]
mod balance;
mod ours;
mod peer;
mod report;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use balance::Balance;
use ours::{Ours, Riccatis};
use peer::Peer;
use report::{Duel, Report};

/// The sample models of Debian's package `libmujoco-samples`.
const MANY_HUMANOIDS: &str = "/usr/share/mujoco/model/humanoid/22_humanoids.xml";

type Outcome<T> = Result<T, Box<dyn Error>>;

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
        Arguments { engine: "target/perf/engine".into(), python: None, out: "out".into(), pairs: 41, threads: 2 };
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

/// The models, each with the keyframe that it starts from, and the steps of a turn.
fn models() -> Vec<(&'static str, PathBuf, Option<&'static str>, usize)> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    let mut models = vec![
        ("cart-pole", own.join("cartpole.xml"), Some("hanging_down"), 2000),
        ("humanoid, standing", own.join("humanoid.xml"), Some("stand"), 200),
    ];
    if Path::new(MANY_HUMANOIDS).exists() {
        models.push(("22 humanoids", MANY_HUMANOIDS.into(), None, 5));
    }
    models
}

fn main() -> Outcome<()> {
    let arguments = arguments()?;
    let (pairs, threads) = (arguments.pairs, arguments.threads);
    let mut report = Report::default();

    for (name, path, key, steps) in models() {
        let mut ours = Ours::new(&path, key, threads)?;
        let mut engine = Peer::start(&arguments.engine, &path, key, None)?;
        let mut python = match &arguments.python {
            Some(python) => Some(Peer::start(python, &path, key, Some("perf/peer.py"))?),
            None => None,
        };
        let order = format!("step {steps}");
        let c = Duel::fight(pairs, || ours.step(steps), || engine.ask(&order))?;
        report.add(format!("step, {name}"), "C", steps, &c.same());
        if let Some(python) = &mut python {
            let duel = Duel::fight(pairs, || ours.step(steps), || python.ask(&order))?;
            report.add(format!("step, {name}"), "Python bindings", steps, &duel.same());
        }
        if name == "22 humanoids" {
            continue;
        }

        let (count, steps) = (64, steps / 10);
        let calls = count * steps;
        for threads in [1, threads] {
            let order = format!("rollout {count} {steps} {threads}");
            let what = format!("64 rollouts, {name}, threads: {threads}");
            let duel = Duel::fight(pairs, || ours.rollout(count, steps, threads), || engine.ask(&order))?;
            report.add(what.clone(), "C", calls, &duel.same());
            if let Some(python) = &mut python {
                let duel = Duel::fight(pairs, || ours.rollout(count, steps, threads), || python.ask(&order))?;
                report.add(what, "Python bindings", calls, &duel.same());
            }
        }
        if threads > 1 {
            let (two, one) = (ours.rollout(count, steps, threads)?, ours.rollout(count, steps, 1)?);
            assert_eq!(two.1.to_bits(), one.1.to_bits(), "the number of threads changes the result");
            let mut others = Ours::new(&path, key, threads)?;
            let duel = Duel::fight(pairs, || ours.rollout(count, steps, threads), || others.rollout(count, steps, 1))?;
            report.add(format!("64 rollouts, {name}, threads: {threads}"), "itself in one", calls, &duel);
        }

        let calls = if name == "cart-pole" { 100 } else { 2 };
        let order = format!("transition {calls}");
        for threads in [1, threads] {
            let duel = Duel::fight(pairs, || ours.transition(calls, threads), || engine.ask(&order))?;
            report.add(format!("linear system, {name}, threads: {threads}"), "C", calls, &duel);
        }

        if let Some(python) = &mut python {
            let balance = if name == "cart-pole" { Balance::cartpole()? } else { Balance::humanoid()? };
            let mut riccatis = Riccatis::new(balance)?;
            fs::create_dir_all(&arguments.out)?;
            let file = std::path::absolute(arguments.out.join("riccati.txt"))?;
            fs::write(&file, riccatis.text())?;
            let order = format!("riccati {}", file.display());
            let duel = Duel::fight(pairs, || riccatis.solve(), || python.ask(&order))?;
            println!("Riccati, {name}: relative residuals {:.1e} and {:.1e}", duel.ours_made, duel.theirs_made);
            report.add(format!("Riccati equation, {name}"), "SciPy", 1, &duel);
            fs::remove_file(&file)?;

            let calls = 1000;
            let order = format!("controller {calls}");
            let duel = Duel::fight(pairs, || ours.controller(calls), || python.ask(&order))?;
            report.add(format!("LQR's decision, {name}"), "NumPy", calls, &duel.same());
        }
    }
    if arguments.python.is_none() {
        println!("Not compared with Python, SciPy and NumPy: no --python was given.");
    }
    report.write(&arguments.out, pairs)?;
    Ok(())
}
