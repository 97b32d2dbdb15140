//! Riccati equations of the humanoid on its left leg (54 states, 21 controls) and of the cart-pole
//! (4 states, 1 control): with a reused workspace ([`Riccati::solve_into`]) and with a new one
//! ([`Lqr::solve`]). The number of doublings and the residual are printed as well.
//!
//! No C implementation is available for comparison. If the environment variable `MUJOCO_PYTHON`
//! names a Python with SciPy, both solve the same equation alternately, and the ratio of their
//! times and SciPy's residual are printed.
//!
//! ```text
//! cargo bench --bench riccati
//! MUJOCO_PYTHON=python3 cargo bench --bench riccati
//! ```

mod common;

use std::env;
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};
use std::time::Instant;

use common::models::Balance;
use mujoco_safe::control::riccati::{Riccati, RiccatiSolution, RiccatiWorkspace};
use mujoco_safe::{Lqr, LqrWeights, Result, StateSpace};

/// Number of solutions by each program.
const PAIRS: usize = 60;

/// Python program that reads the equation and solves it once per input line. Single-threaded, as
/// this crate.
const SCIPY: &str = r#"
import os, sys, time
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
import numpy as np
from scipy.linalg import solve_discrete_are

def matrix():
    rows, columns, *entries = sys.stdin.readline().split()
    return np.array([float(entry) for entry in entries]).reshape(int(rows), int(columns))

a, b, q, r = (matrix() for _ in range(4))
print("ready", flush=True)
for _ in sys.stdin:
    start = time.perf_counter()
    p = solve_discrete_are(a, b, q, r)
    seconds = time.perf_counter() - start
    k = np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a)
    f = a - b @ k
    residual = np.linalg.norm(f.T @ p @ f + k.T @ r @ k + q - p) / np.linalg.norm(p)
    print(repr(seconds), repr(float(residual)), flush=True)
"#;

/// Solves the equation alternately with SciPy.
fn beside_scipy(python: &str, name: &str, system: &StateSpace, weights: &LqrWeights) -> std::io::Result<()> {
    let mut child = Command::new(python).args(["-c", SCIPY]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let mut input = child.stdin.take().expect("the stream is piped");
    let mut output = BufReader::new(child.stdout.take().expect("the stream is piped")).lines();
    for matrix in [&system.a, &system.b, &weights.q, &weights.r] {
        let entries: Vec<String> = matrix.as_slice().iter().map(|entry| format!("{entry:e}")).collect();
        writeln!(input, "{} {} {}", matrix.nrows(), matrix.ncols(), entries.join(" "))?;
    }
    let mut line = || output.next().unwrap_or_else(|| Err(std::io::ErrorKind::UnexpectedEof.into()));
    line()?;

    let (mut workspace, mut solution) = (RiccatiWorkspace::new(), RiccatiSolution::default());
    let (mut ours, mut theirs, mut residual) = (Vec::new(), Vec::new(), 0.0);
    for _ in 0..PAIRS {
        let start = Instant::now();
        let outcome =
            Riccati::new(&system.a, &system.b, &weights.q, &weights.r).solve_into(&mut workspace, &mut solution);
        ours.push(start.elapsed().as_secs_f64());
        outcome.expect("the equation was solved before");
        writeln!(input)?;
        let answer = line()?;
        let (seconds, of_scipy) = answer.split_once(' ').unwrap_or((&answer, "nan"));
        theirs.push(seconds.parse().unwrap_or(f64::NAN));
        residual = of_scipy.parse().unwrap_or(f64::NAN);
    }
    drop(input);
    child.wait()?;
    let mut ratios: Vec<f64> = ours.iter().zip(&theirs).map(|(ours, theirs)| theirs / ours).collect();
    for values in [&mut ours, &mut theirs, &mut ratios] {
        values.sort_unstable_by(f64::total_cmp);
    }
    let [ours, theirs] = [ours, theirs].map(|times| 1e6 * times[PAIRS / 2]);
    println!(
        "{name}: {:.1} times as fast as SciPy (quartiles {:.1} and {:.1}), {ours:.0} µs and {theirs:.0} µs; SciPy's relative \
         residual is {residual:.1e}",
        ratios[PAIRS / 2],
        ratios[PAIRS / 4],
        ratios[3 * PAIRS / 4]
    );
    Ok(())
}

fn bench(name: &str, mut balance: Balance) -> Result<()> {
    let system = balance.system()?;
    let weights = &balance.weights;
    let solution = Lqr::solve(&system, weights)?;
    println!(
        "{name}: {} doublings, relative residual {:.1e}, spectral radius {:.12}",
        solution.iterations, solution.relative_residual, solution.spectral_radius
    );
    if let Ok(python) = env::var("MUJOCO_PYTHON")
        && let Err(error) = beside_scipy(&python, name, &system, weights)
    {
        println!("{name}: no comparison with SciPy, because {python} failed: {error}");
    }
    let (mut workspace, mut solution) = (RiccatiWorkspace::new(), RiccatiSolution::default());
    let (a, b) = (system.a.to_nalgebra(), system.b.to_nalgebra());
    common::bench(&format!("{name}/again"), 1, &mut || {
        let riccati = Riccati::new(&a, &b, &weights.q, &weights.r);
        black_box(riccati.solve_into(&mut workspace, black_box(&mut solution)).is_ok());
    });
    common::bench(&format!("{name}/once"), 1, &mut || _ = black_box(Lqr::solve(black_box(&system), weights)));
    Ok(())
}

fn main() -> Result<()> {
    bench("riccati/humanoid", Balance::humanoid()?)?;
    bench("riccati/cartpole", Balance::cartpole()?)?;
    Ok(())
}
