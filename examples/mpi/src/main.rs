//! Distributed rollouts: each MPI rank simulates its share on all of its threads, and rank 0 gathers the final states.
//!
//! ```text
//! scripts/mpi                                         # installs Open MPI, builds, and runs this example with two ranks
//! mpirun -n 2 target/release/mujoco-safe-mpi --check
//! ```
//!
//! Options:
//!
//! - `--rollouts N`: number of rollouts (64)
//! - `--steps N`: steps of each rollout (100)
//! - `--seed N`: seed of the controls (1)
//! - `--check`: repeats all rollouts on rank 0 and compares the states
//!
//! The inputs of a rollout depend only on its index. The final states are therefore bitwise equal for any number of ranks and
//! threads, if all ranks use the same engine and the same kind of processor.

use std::error::Error;
use std::ops::Range;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use mpi::Threading;
use mpi::datatype::PartitionMut;
use mpi::topology::Communicator;
use mpi::traits::{CommunicatorCollectives, Root};
use mujoco_safe::rollout::{Rollout, RolloutBuffers, Workers};
use mujoco_safe::{Controller, Data, Model, RandomController, StateSpec, sample};

struct Arguments {
    rollouts: usize,
    steps: usize,
    seed: u64,
    check: bool,
}

fn arguments() -> Result<Arguments, Box<dyn Error>> {
    use lexopt::prelude::*;
    let mut arguments = Arguments { rollouts: 64, steps: 100, seed: 1, check: false };
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("rollouts") => arguments.rollouts = parser.value()?.parse()?,
            Long("steps") => arguments.steps = parser.value()?.parse()?,
            Long("seed") => arguments.seed = parser.value()?.parse()?,
            Long("check") => arguments.check = true,
            _ => return Err(argument.unexpected().into()),
        }
    }
    Ok(arguments)
}

/// Returns the rollouts of a rank.
fn share(all: usize, rank: usize, ranks: usize) -> Range<usize> {
    all * rank / ranks..all * (rank + 1) / ranks
}

/// Simulates some of the rollouts and returns their final states, concatenated.
fn final_states(model: &Arc<Model>, which: Range<usize>, arguments: &Arguments) -> Result<Vec<f64>, Box<dyn Error>> {
    let mut data = Data::new(model.clone())?;
    data.reset_to_key("stand")?;
    let start = data.state(StateSpec::INTEGRATION);
    let mut controls = Vec::with_capacity(which.len() * arguments.steps * model.nu());
    for rollout in which.clone() {
        let mut random = RandomController::new(arguments.seed.wrapping_mul(1_000_003).wrapping_add(rollout as u64));
        for _ in 0..arguments.steps {
            random.control(&mut data)?;
            controls.extend_from_slice(data.ctrl());
        }
    }
    let width = model.state_size(StateSpec::PHYSICS);
    let mut states = vec![0.0; which.len() * (arguments.steps + 1) * width];
    let workers = Workers::new(model.clone());
    let outcomes = Rollout::on(&workers, which.len(), arguments.steps)
        .initial_state(StateSpec::INTEGRATION, &start)
        .controls(&controls)
        .run_into(RolloutBuffers { states: Some(&mut states), ..Default::default() })?;
    outcomes.into_iter().collect::<Result<Vec<()>, _>>()?;
    let last = states.chunks_exact((arguments.steps + 1) * width).map(|rollout| &rollout[arguments.steps * width..]);
    Ok(last.flatten().copied().collect())
}

/// Hashes the bits of the states (FNV-1a).
fn digest(states: &[f64]) -> u64 {
    let bytes = states.iter().flat_map(|value| value.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments = arguments()?;
    // Only this thread calls MPI; the workers do not.
    let (universe, _) = mpi::initialize_with_threading(Threading::Funneled).ok_or("MPI is already initialised")?;
    let world = universe.world();
    let (rank, ranks) = (usize::try_from(world.rank())?, usize::try_from(world.size())?);
    let model = Arc::new(sample::humanoid());
    let width = model.state_size(StateSpec::PHYSICS);

    world.barrier();
    let start = Instant::now();
    let mine = final_states(&model, share(arguments.rollouts, rank, ranks), &arguments)?;
    let first = world.process_at_rank(0);
    if rank > 0 {
        first.gather_varcount_into(&mine[..]);
        return Ok(());
    }
    let shares = (0..ranks).map(|rank| share(arguments.rollouts, rank, ranks));
    let counts = shares.clone().map(|share| i32::try_from(share.len() * width)).collect::<Result<Vec<_>, _>>()?;
    let starts = shares.map(|share| i32::try_from(share.start * width)).collect::<Result<Vec<_>, _>>()?;
    let mut all = vec![0.0; arguments.rollouts * width];
    first.gather_varcount_into_root(&mine[..], &mut PartitionMut::new(&mut all[..], counts, starts));
    println!(
        "{} rollouts of {} steps in {ranks} ranks: {:.3} s, final states {:016x}",
        arguments.rollouts,
        arguments.steps,
        start.elapsed().as_secs_f64(),
        digest(&all)
    );
    if arguments.check {
        let alone = final_states(&model, 0..arguments.rollouts, &arguments)?;
        if !alone.iter().zip(&all).all(|(alone, all)| alone.to_bits() == all.to_bits()) || alone.len() != all.len() {
            return Err("a single process computes different states".into());
        }
        println!("A single process computes bitwise equal states.");
    }
    Ok(())
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("mujoco-safe-mpi: {error}");
            ExitCode::FAILURE
        }
    }
}
