//! Distributed batch: each MPI rank steps its share of the simulations on all of its threads, and
//! rank 0 gathers the final states and parameters.
//!
//! ```text
//! scripts/mpi                                               # installs Open MPI, builds, and runs this example with 1, 2 and 4 ranks
//! mpirun -n 2 target/mpi/release/mujoco-safe-mpi --check
//! ```
//!
//! Options:
//!
//! - `--simulations N`: number of simulations (64)
//! - `--steps N`: number of steps (300)
//! - `--seed N`: seed of the initial states, the controls and the parameters (1)
//! - `--check`: repeats all simulations on rank 0 and compares the results
//!
//! Humanoids start in a standing posture with random velocities, move under random controls, and
//! start again after a fall. Each has other masses, damping and friction in each episode. All
//! random numbers depend on the index of the simulation among those of all ranks, and on the number
//! of its episode or step. The final states and parameters are therefore bitwise equal for any
//! number of ranks and threads, if all ranks use the same engine and the same kind of processor.

use std::error::Error;
use std::ops::Range;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use mpi::Threading;
use mpi::collective::SystemOperation;
use mpi::datatype::PartitionMut;
use mpi::topology::Communicator;
use mpi::traits::{CommunicatorCollectives, Root};
use mujoco_safe::rollout::{Batch, Distribution, Parameter, Parameters, Random};
use mujoco_safe::{Data, Model, StateSpec, sample};

/// Height of the torso below which a humanoid has fallen, m.
const FALLEN: f64 = 0.8;
/// Stream of the random numbers for the controls.
const CONTROLS: u64 = 1 << 32;

struct Arguments {
    simulations: usize,
    steps: usize,
    seed: u64,
    check: bool,
}

fn arguments() -> Result<Arguments, Box<dyn Error>> {
    use lexopt::prelude::*;
    let mut arguments = Arguments { simulations: 64, steps: 300, seed: 1, check: false };
    let mut parser = lexopt::Parser::from_env();
    while let Some(argument) = parser.next()? {
        match argument {
            Long("simulations") => arguments.simulations = parser.value()?.parse()?,
            Long("steps") => arguments.steps = parser.value()?.parse()?,
            Long("seed") => arguments.seed = parser.value()?.parse()?,
            Long("check") => arguments.check = true,
            _ => return Err(argument.unexpected().into()),
        }
    }
    Ok(arguments)
}

/// Returns the simulations of a rank.
fn share(all: usize, rank: usize, ranks: usize) -> Range<usize> {
    all * rank / ranks..all * (rank + 1) / ranks
}

/// Returns the parameters of the model that differ between the simulations.
fn parameters(model: &Model) -> mujoco_safe::Result<Parameters> {
    let mass = Distribution::LogUniform { low: 0.8, high: 1.25 };
    let mut parameters = Parameters::new();
    for body in ["torso", "thigh_left", "thigh_right"] {
        parameters = parameters.with(model, Parameter::MassFactor(model.body(body)?.id()), mass)?;
    }
    let (knee, floor) = (model.joint("left_knee")?.id(), model.geom("floor")?.id());
    parameters.with(model, Parameter::JointDamping(knee), Distribution::Uniform { low: 0.5, high: 5.0 })?.with(
        model,
        Parameter::GeomFriction(floor, 0),
        Distribution::Uniform { low: 0.5, high: 1.0 },
    )
}

/// Results of some of the simulations.
struct Final {
    /// State and values of the parameters of each simulation, concatenated.
    rows: Vec<f64>,
    falls: u64,
}

/// Steps some of the simulations.
fn simulate(model: &Arc<Model>, which: Range<usize>, arguments: &Arguments) -> mujoco_safe::Result<Final> {
    let (first, seed) = (which.start, arguments.seed);
    let start = |index: usize, episode: u64, data: &mut Data| {
        data.reset_to_key("stand")?;
        let mut random = Random::new(seed, first + index, episode);
        data.qvel_mut().iter_mut().for_each(|velocity| *velocity = 0.1 * random.normal());
        Ok(())
    };
    let mut batch = Batch::new(model, which.len())?.with_parameters(parameters(model)?)?.with_first_index(first);
    batch.reset_where(|_| true, start)?;
    batch.sample_parameters(|_| true, seed)?;
    for step in 0..arguments.steps as u64 {
        batch.step(|_, controls| {
            for (index, controls) in controls.as_mut_slice().chunks_exact_mut(model.nu()).enumerate() {
                let mut random = Random::stream(seed, first + index, step, CONTROLS);
                controls.iter_mut().for_each(|control| *control = random.uniform(-1.0, 1.0));
            }
        })?;
        let fallen: Vec<bool> = batch.observations().rows().map(|observation| observation[2] < FALLEN).collect();
        batch.reset_where(|index| fallen[index], start)?;
        batch.sample_parameters(|index| fallen[index], seed)?;
    }
    if let Some((index, error)) = batch.failures().next() {
        eprintln!("simulation {} failed: {error}", first + index);
    }
    let falls = (0..batch.len()).map(|index| batch.episode(index) - 1).sum();
    let row = |index: usize| [batch.states().row(index), batch.parameters().row(index)].concat();
    Ok(Final { rows: (0..batch.len()).flat_map(row).collect(), falls })
}

/// Hashes the bits of numbers (FNV-1a).
fn digest(numbers: &[f64]) -> u64 {
    let bytes = numbers.iter().flat_map(|value| value.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments = arguments()?;
    // Only this thread calls MPI; the workers do not.
    let (universe, _) = mpi::initialize_with_threading(Threading::Funneled).ok_or("MPI is already initialised")?;
    let world = universe.world();
    let (rank, ranks) = (usize::try_from(world.rank())?, usize::try_from(world.size())?);
    let model = Arc::new(sample::humanoid());
    let width = model.state_size(StateSpec::INTEGRATION) + parameters(&model)?.len();

    world.barrier();
    let start = Instant::now();
    let mine = simulate(&model, share(arguments.simulations, rank, ranks), &arguments)?;
    let first = world.process_at_rank(0);
    if rank > 0 {
        first.gather_varcount_into(&mine.rows[..]);
        first.reduce_into(&mine.falls, SystemOperation::sum());
        return Ok(());
    }
    let shares = (0..ranks).map(|rank| share(arguments.simulations, rank, ranks));
    let counts = shares.clone().map(|share| i32::try_from(share.len() * width)).collect::<Result<Vec<_>, _>>()?;
    let starts = shares.map(|share| i32::try_from(share.start * width)).collect::<Result<Vec<_>, _>>()?;
    let mut all = vec![0.0; arguments.simulations * width];
    first.gather_varcount_into_root(&mine.rows[..], &mut PartitionMut::new(&mut all[..], counts, starts));
    let mut all_falls = 0_u64;
    first.reduce_into_root(&mine.falls, &mut all_falls, SystemOperation::sum());
    println!(
        "{} simulations of {} steps in {ranks} ranks: {:.3} s, {all_falls} falls, final states and parameters {:016x}",
        arguments.simulations,
        arguments.steps,
        start.elapsed().as_secs_f64(),
        digest(&all)
    );
    if arguments.check {
        let alone = simulate(&model, 0..arguments.simulations, &arguments)?.rows;
        if !alone.iter().zip(&all).all(|(alone, all)| alone.to_bits() == all.to_bits()) || alone.len() != all.len() {
            return Err("a single process computes other states or parameters".into());
        }
        println!("A single process computes bitwise equal states and parameters.");
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
