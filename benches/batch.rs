//! Memory and speed of a [`Batch`] of 4,096 humanoids. Prints the resident memory beyond that of
//! the program before the batch, and the steps per second on two threads as a multiple of a loop of
//! `mj_step` over the same states, with one `mjData` per thread. Then gives each humanoid other
//! parameters of the model, and prints the memory and the duration of a step as a multiple of that
//! without parameters.
//!
//! ```text
//! cargo bench --bench batch
//! ```

use std::ops::Range;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use mujoco_safe::rayon::prelude::*;
use mujoco_safe::rayon::{ThreadPool, ThreadPoolBuilder, current_thread_index};
use mujoco_safe::rollout::{Distribution, Parameter, Parameters};
use mujoco_safe::{Batch, Data, Model, Result, StateSpec, sample, sys};

const COUNT: usize = 4096;
const THREADS: usize = 2;
/// Number of simulations that a thread takes at a time in the loop of `mj_step`, about that of a
/// batch.
const CHUNK: usize = 256;
const STEPS: usize = 30;

/// Returns the resident memory of this process, MB.
fn resident() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux reports the memory of processes");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("the report has this line");
    let kilobytes: f64 = line.trim().trim_end_matches(" kB").parse().expect("a number");
    kilobytes / 1e3
}

/// Returns the control of an actuator, a wave in time.
fn control(step: usize, index: usize, actuator: usize) -> f64 {
    (0.1 * step as f64 + index as f64 + 2.0 * actuator as f64).sin() * 0.2
}

/// Sets the initial state of a simulation.
fn start(index: usize, data: &mut Data) -> Result<()> {
    data.reset_to_key("stand")?;
    data.qpos_mut()[2] += 1e-4 * index as f64;
    Ok(())
}

/// States that the engine steps without a batch.
struct Raw {
    model: Arc<Model>,
    /// Simulation of each thread.
    data: Vec<Mutex<Data>>,
    states: Vec<f64>,
    /// Place of each component of a state vector.
    parts: [Range<usize>; 9],
}

impl Raw {
    fn new(model: &Arc<Model>, states: &[f64]) -> Result<Self> {
        let range = |part| model.state_range(StateSpec::INTEGRATION, part);
        let parts = [
            StateSpec::QPOS,
            StateSpec::QVEL,
            StateSpec::ACT,
            StateSpec::WARMSTART,
            StateSpec::CTRL,
            StateSpec::QFRC_APPLIED,
            StateSpec::XFRC_APPLIED,
            StateSpec::MOCAP_POS,
            StateSpec::MOCAP_QUAT,
        ]
        .map(range);
        let data = (0..THREADS).map(|_| Data::new(model).map(Mutex::new)).collect::<Result<_>>()?;
        Ok(Self { model: model.clone(), data, states: states.to_vec(), parts })
    }

    fn step(&mut self, pool: &ThreadPool, controls: &[f64]) {
        let Self { model, data, states, parts } = self;
        let (width, nu) = (states.len() / COUNT, model.nu());
        pool.install(|| {
            states.par_chunks_mut(CHUNK * width).zip(controls.par_chunks(CHUNK * nu)).for_each(|(states, controls)| {
                let thread = current_thread_index().expect("a thread of the pool");
                let mut data = data[thread].lock().expect("no thread panics");
                for (state, controls) in states.chunks_mut(width).zip(controls.chunks(nu)) {
                    state[parts[4].clone()].copy_from_slice(controls);
                    step_row(model, &mut data, state, parts);
                }
            });
        });
    }
}

/// Steps one state by the engine alone.
fn step_row(model: &Model, data: &mut Data, state: &mut [f64], parts: &[Range<usize>; 9]) {
    let raw = data.as_mut_ptr();
    // SAFETY: the pointers are those of a simulation that is borrowed exclusively, and each array
    // has the length of its range in a state vector. The batch makes the same steps without an
    // engine error.
    unsafe {
        let arrays = [
            (*raw).qpos,
            (*raw).qvel,
            (*raw).act,
            (*raw).qacc_warmstart,
            (*raw).ctrl,
            (*raw).qfrc_applied,
            (*raw).xfrc_applied,
            (*raw).mocap_pos,
            (*raw).mocap_quat,
        ];
        (*raw).time = state[0];
        for (array, part) in arrays.into_iter().zip(parts).filter(|(_, part)| !part.is_empty()) {
            array.copy_from_nonoverlapping(state[part.clone()].as_ptr(), part.len());
        }
        sys::mj_step(model.as_ptr(), raw);
        state[0] = (*raw).time;
        for (array, part) in arrays.into_iter().zip(parts).filter(|(_, part)| !part.is_empty()) {
            array.copy_to_nonoverlapping(state[part.clone()].as_mut_ptr(), part.len());
        }
    }
}

/// Returns parameters of every kind of randomisation: all masses, the friction of the floor, and
/// the damping of all joints.
fn parameters(model: &Model) -> Result<Parameters> {
    let factor = Distribution::LogUniform { low: 0.8, high: 1.25 };
    let mut parameters = Parameters::new();
    for body in 1..model.nbody() {
        parameters = parameters.with(model, Parameter::MassFactor(model.body(body)?.id()), factor)?;
    }
    for joint in 1..model.njnt() {
        let damping = Distribution::Uniform { low: 0.5, high: 5.0 };
        parameters = parameters.with(model, Parameter::JointDamping(model.joint(joint)?.id()), damping)?;
    }
    let floor = model.geom("floor")?.id();
    parameters.with(model, Parameter::GeomFriction(floor, 0), Distribution::Uniform { low: 0.5, high: 1.0 })
}

/// Measures batches with and without parameters.
fn compare_parameters(model: &Arc<Model>, pool: &ThreadPool) -> Result<()> {
    let start = |_: usize, _: u64, data: &mut Data| data.reset_to_key("stand");
    let mut plain = Batch::new(model, COUNT)?;
    let mut varied = Batch::new(model, COUNT)?.with_parameters(parameters(model)?)?;
    let before = resident();
    let drawing = Instant::now();
    pool.install(|| varied.sample_parameters(|_| true, 1))?;
    let drawing = drawing.elapsed().as_secs_f64() * 1e6 * THREADS as f64 / COUNT as f64;
    println!(
        "{} parameters: {:.1} MB more, {drawing:.0} µs per draw",
        varied.parameters().ncols(),
        resident() - before
    );
    for batch in [&mut plain, &mut varied] {
        pool.install(|| batch.reset_where(|_| true, start))?;
        pool.install(|| batch.step(|_, _| ()))?;
    }
    let mut ratios = Vec::new();
    for _ in 0..STEPS {
        let [plain, varied] = [&mut plain, &mut varied].map(|batch| {
            let start = Instant::now();
            pool.install(|| batch.step(|_, _| ())).map(|()| start.elapsed().as_secs_f64())
        });
        ratios.push(varied? / plain?);
    }
    ratios.sort_by(f64::total_cmp);
    println!("{:.3} × the duration of a step without parameters", ratios[STEPS / 2]);
    Ok(())
}

fn main() -> Result<()> {
    let before = resident();
    let model = Arc::new(sample::humanoid());
    let pool = ThreadPoolBuilder::new().num_threads(THREADS).build().expect("threads can be created");
    let mut batch = Batch::new(&model, COUNT)?;
    pool.install(|| batch.reset_where(|_| true, |index, _, data| start(index, data)))?;
    pool.install(|| batch.step(|_, _| ()))?;
    println!("{COUNT} humanoids: {:.1} MB", resident() - before);

    let mut raw = Raw::new(&model, batch.states().as_slice())?;
    let nu = model.nu();
    let mut ratios = Vec::new();
    for step in 0..STEPS {
        let controls: Vec<f64> = (0..COUNT * nu).map(|at| control(step, at / nu, at % nu)).collect();
        let mut time_batch = || -> Result<f64> {
            let start = Instant::now();
            pool.install(|| batch.step(|_, to| to.as_mut_slice().copy_from_slice(&controls)))?;
            Ok(start.elapsed().as_secs_f64())
        };
        let mut time_raw = || {
            let start = Instant::now();
            raw.step(&pool, &controls);
            start.elapsed().as_secs_f64()
        };
        // Alternate the order, so that a drift of the machine has the same effect on both.
        let (batch, raw) = if step % 2 == 0 {
            let batch = time_batch()?;
            (batch, time_raw())
        } else {
            let raw = time_raw();
            (time_batch()?, raw)
        };
        ratios.push((raw / batch, COUNT as f64 / batch));
    }
    assert!(batch.failures().next().is_none(), "the simulations are stable");
    assert!(batch.states().as_slice() == raw.states, "the batch and the loop compute different states");
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (ratio, speed) = ratios[STEPS / 2];
    println!("{ratio:.3} × the steps per second of a loop of mj_step ({speed:.0} per second on {THREADS} threads)");
    drop((batch, raw));
    compare_parameters(&model, &pool)
}
