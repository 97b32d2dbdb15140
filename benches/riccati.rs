//! How long [`Lqr::solve`] takes for the gain: the humanoid on its left leg (54 states, 21 controls) and the cart-pole (4 states,
//! 1 control). There is nothing in C to compare it with; the number of doublings and the residual are printed beside it.
//!
//! ```text
//! cargo bench --bench riccati
//! ```

mod common;

use std::hint::black_box;

use common::balance::Balance;
use criterion::Criterion;
use mujoco_safe::{Lqr, Result};

fn bench(criterion: &mut Criterion, name: &str, mut balance: Balance) -> Result<()> {
    let system = balance.system()?;
    let solution = Lqr::solve(&system, &balance.weights)?;
    println!(
        "{name}: {} doublings, relative residual {:.1e}, spectral radius {:.12}",
        solution.iterations, solution.relative_residual, solution.spectral_radius
    );
    criterion.bench_function(name, |bencher| bencher.iter(|| Lqr::solve(black_box(&system), &balance.weights)));
    Ok(())
}

fn main() -> Result<()> {
    let mut criterion = common::criterion();
    bench(&mut criterion, "riccati/humanoid", Balance::humanoid()?)?;
    bench(&mut criterion, "riccati/cartpole", Balance::cartpole()?)?;
    criterion.final_summary();
    Ok(())
}
