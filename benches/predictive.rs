//! Parts of an iteration of predictive control by iLQR, for the humanoid that stands on its left
//! leg under pushes, with a horizon of 50 steps: median and 99th percentile of the derivatives, the
//! backward pass and the line search. The first trajectory of a plan is part of the iteration. Then
//! the same run in real time, with the planner in a second thread, and the time of a plan by
//! sampling.
//!
//! The number of operations of an iteration hardly varies in this run. The 99th percentile
//! therefore depends on the other load of the machine. For comparison, the bench first prints the
//! percentiles of arithmetic in the same threads that takes 5 ms without other load.
//!
//! The motion is chaotic: under pushes of some other strengths, the humanoid falls in one build of
//! this crate and stands in another, because the last bits of the plans differ. In the run without
//! threads it stands.
//!
//! ```text
//! cargo bench --bench predictive
//! ```

mod common;

use std::hint::black_box;
use std::thread::{available_parallelism, sleep};
use std::time::{Duration, Instant};

use common::models::Balance;
use mujoco_safe::control::TimeVaryingLqr;
use mujoco_safe::control::ilqr::{IlqrOptions, IlqrTimes};
use mujoco_safe::control::predictive::{
    IlqrPlanner, Planner, PredictiveController, SamplingOptions, SamplingPlanner, ThreadedPredictiveController,
};
use mujoco_safe::control::residual::{
    Controls, FrameOrientation, JointPosition, JointVelocity, ResidualCost, Subtree, Term,
};
use mujoco_safe::{Controller, Data, Lqr, LqrWeights, Result, StateSpec};

/// Number of steps of a plan, which has one knot for each.
const HORIZON: usize = 50;
/// Number of plans.
const PLANS: usize = 400;
/// Number of steps between two plans.
const INTERVAL: usize = 4;
/// Step sizes of the line search.
const STEP_SIZES: [f64; 4] = [1.0, 0.5, 0.2, 0.05];
/// Number of steps between two pushes and during a push, and their force, N.
const PUSH_INTERVAL: usize = 200;
const PUSH_DURATION: usize = 20;
const NEWTONS: f64 = 30.0;
/// Number of plans by sampling, and of candidates of each.
const SAMPLED_PLANS: usize = 100;
const SAMPLES: usize = 32;

/// Returns the cost of standing: posture, height and drift of the centre of mass, upright torso,
/// motion, effort.
fn standing(data: &mut Data) -> Result<ResidualCost> {
    let model = data.model().clone();
    data.forward()?;
    let centre = data.subtree_com()[model.body("torso")?.index()];
    let joints: Vec<f64> = (0..model.nv()).map(|dof| f64::from(u8::from(dof >= 6))).collect();
    ResidualCost::new(
        &model,
        [
            Term::new("com", Subtree::com(&model, "torso")?.with_target(centre))
                .with_weight(100.0)
                .with_terminal_weight(1e4),
            Term::new("drift", Subtree::velocity(&model, "torso")?).with_weight(10.0).with_terminal_weight(1e3),
            Term::new("momentum", Subtree::angular_momentum(&model, "torso")?).with_weight(0.1),
            Term::new("upright", FrameOrientation::body(&model, "torso")?).with_weight(5.0),
            Term::new("posture", JointPosition::all(&model).with_target(data.qpos())?)
                .with_scales(joints)
                .with_weight(1.0),
            Term::new("motion", JointVelocity::all(&model)).with_weight(0.01),
            Term::new("effort", Controls::new(&model).with_target(data.ctrl())?).with_weight(0.1),
        ],
    )
}

/// Prints the median and the 99th percentile of a sample.
fn print(name: &str, milliseconds: impl Iterator<Item = f64>) {
    let mut sorted: Vec<f64> = milliseconds.collect();
    sorted.sort_by(f64::total_cmp);
    let at = |fraction: f64| sorted[((sorted.len() - 1) as f64 * fraction).round() as usize];
    println!("predictive: {name:24} median {:6.2} ms, p99 {:6.2} ms", at(0.5), at(0.99));
}

/// Prints the times of a fixed amount of arithmetic in each thread. Their spread is the effect of
/// the other load of the machine.
fn print_other_load() {
    const SECONDS: f64 = 0.005;
    let work = |count: u32| (0..count).fold(1.0, |value: f64, _| black_box(0.5 * value + 1.0));
    let time = |run: &dyn Fn()| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    // The fastest of several runs is the one without interruption.
    let fastest = (0..20).map(|_| time(&|| _ = work(100_000))).fold(f64::INFINITY, f64::min);
    let count = (SECONDS / fastest * 1e5) as u32;
    print("arithmetic of 5 ms", (0..PLANS).map(|_| 1e3 * time(&|| _ = rayon::broadcast(|_| work(count)))));
}

/// Pushes the torso for 0.1 s every second, to the left and to the right in turn.
fn push(data: &mut Data, torso: usize, step: usize) {
    let is_pushed = step % PUSH_INTERVAL < PUSH_DURATION;
    let sign = if (step / PUSH_INTERVAL).is_multiple_of(2) { 1.0 } else { -1.0 };
    data.xfrc_applied_mut()[torso][0] = if is_pushed { sign * NEWTONS } else { 0.0 };
}

/// Planning in the thread of the simulation, which waits for it.
fn synchronous(data: &mut Data, planner: IlqrPlanner, cost: ResidualCost) -> Result<()> {
    let torso = data.model().body("torso")?.index();
    let height = data.subtree_com()[torso][2];
    let mut controller = PredictiveController::new(data, planner, cost, INTERVAL)?;
    let mut times = Vec::new();
    let (mut least, mut costs) = (f64::INFINITY, 0.0);
    let start = Instant::now();
    for step in 0..PLANS * INTERVAL {
        push(data, torso, step);
        controller.control(data)?;
        if step.is_multiple_of(INTERVAL) {
            times.push(controller.planner().times());
            costs += controller.report().map_or(0.0, |report| report.cost);
        }
        data.step()?;
        least = least.min(data.subtree_com()[torso][2] / height);
    }
    let seconds = start.elapsed().as_secs_f64();
    // The first plan creates the simulations.
    let part = |part: fn(&IlqrTimes) -> Duration| times[1..].iter().map(move |times| part(times).as_secs_f64() * 1e3);
    print("initial trajectory", part(|times| times.initial));
    print("derivatives", part(|times| times.derivatives));
    print("backward pass", part(|times| times.backward_pass));
    print("line search", part(|times| times.line_search));
    print("iteration", part(IlqrTimes::total));
    println!("predictive: mean cost of a plan {:.3}", costs / PLANS as f64);
    println!("predictive: lowest centre of mass {:.0} % of the initial height", least * 100.0);
    println!("predictive: real-time factor {:.2}", data.time() / seconds);
    Ok(())
}

/// The same run in real time, with the planner in a second thread.
fn threaded(data: &mut Data, planner: IlqrPlanner, cost: ResidualCost) -> Result<()> {
    let torso = data.model().body("torso")?.index();
    let height = data.subtree_com()[torso][2];
    let timestep = data.model().timestep();
    let mut controller = ThreadedPredictiveController::new(data, planner, cost)?;
    let (mut least, mut late, mut ages) = (f64::INFINITY, Vec::new(), Vec::new());
    let start = Instant::now();
    for step in 0..PLANS * INTERVAL {
        push(data, torso, step);
        controller.control(data)?;
        ages.push((data.time() - controller.policy().start()) * 1e3);
        data.step()?;
        least = least.min(data.subtree_com()[torso][2] / height);
        let target = Duration::from_secs_f64((step + 1) as f64 * timestep);
        sleep(target.saturating_sub(start.elapsed()));
        late.push((start.elapsed().as_secs_f64() - target.as_secs_f64()) * 1e3);
    }
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "predictive: planner in a second thread: {} plans in {:.1} s of the simulation",
        controller.plans(),
        data.time()
    );
    print("age of the plan", ages.into_iter());
    print("delay of a step", late.into_iter());
    println!("predictive: lowest centre of mass {:.0} % of the initial height", least * 100.0);
    println!("predictive: real-time factor {:.2}", data.time() / seconds);
    Ok(())
}

/// Plans by sampling about the regulator from the states of its motion, one every `INTERVAL` steps.
fn sampled(data: &mut Data, weights: &LqrWeights, threads: usize) -> Result<()> {
    let cost = standing(data)?;
    let mut lqr = Lqr::at_present_state(data, weights)?;
    let options = SamplingOptions::default().with_samples(SAMPLES).with_threads(threads);
    let mut planner = SamplingPlanner::new(data.model(), HORIZON, options)?.with_regulator(lqr.clone())?;
    let mut policy = TimeVaryingLqr::hold_controls(data, HORIZON)?;
    let torso = data.model().body("torso")?.index();
    let mut times = Vec::new();
    for step in 0..=SAMPLED_PLANS * INTERVAL {
        push(data, torso, step);
        if step.is_multiple_of(INTERVAL) {
            let start = Instant::now();
            planner.plan(data, &cost, &mut policy)?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        lqr.control(data)?;
        data.step()?;
    }
    // The first plan creates the simulations.
    print(&format!("plan of {SAMPLES} samples"), times[1..].iter().copied());
    Ok(())
}

fn main() -> Result<()> {
    let Balance { mut data, weights } = Balance::humanoid()?;
    let threads = available_parallelism().map_or(1, usize::from);
    println!(
        "predictive: {PLANS} plans of {HORIZON} steps on {threads} threads, one every {INTERVAL} steps; pushes of {NEWTONS} N"
    );
    print_other_load();
    let start = data.state(StateSpec::INTEGRATION);
    for run in [synchronous, threaded] {
        data.set_state(StateSpec::INTEGRATION, &start)?;
        let cost = standing(&mut data)?;
        let options = IlqrOptions::default()
            .with_iterations(1)
            .with_threads(threads)
            .with_step_sizes(STEP_SIZES)
            .with_sufficient_decrease(0.3);
        let planner = IlqrPlanner::new(data.model(), HORIZON, options)?;
        run(&mut data, planner, cost)?;
    }
    data.set_state(StateSpec::INTEGRATION, &start)?;
    sampled(&mut data, &weights, threads)
}
