//! Workloads of this crate, equivalent to those of the references.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use mujoco_safe::control::riccati::{Riccati, RiccatiSolution, RiccatiWorkspace};
use mujoco_safe::derivative::{TransitionOptions, TransitionOutputs};
use mujoco_safe::rollout::{Rollout, RolloutBuffers, Workers};
use mujoco_safe::{Batch, Controller, Data, Lineariser, Lqr, LqrWeights, Matrix, Model, StateSpace, StateSpec, rayon};

use crate::Outcome;
use crate::models::Balance;

/// Random number generator, equal to that of `engine.c`.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / 9_007_199_254_740_992.0 * 2.0 - 1.0
    }
}

pub(crate) struct Library {
    data: Data,
    start: Vec<f64>,
    controls: Vec<f64>,
    workers: Workers,
    states: Vec<f64>,
    batch: Option<Batch<'static>>,
    transitions: [Lineariser; 2],
    a: Matrix,
    b: Matrix,
    lqr: Lqr,
}

impl Library {
    pub(crate) fn new(path: &Path, key: Option<&str>, threads: usize) -> Outcome<Self> {
        let model = Arc::new(Model::from_xml_path(path)?);
        let mut data = Data::new(model.clone())?;
        if let Some(key) = key {
            data.reset_to_key(key)?;
        }
        let (nx, nu) = (2 * model.nv() + model.na(), model.nu());
        let transition = |threads| Lineariser::new(model.clone(), TransitionOptions::default().with_threads(threads));
        let mut numbers = Numbers(1);
        let mut gain = Matrix::zeros(nu, nx);
        gain.as_mut_slice().iter_mut().for_each(|entry| *entry = numbers.next());
        Ok(Self {
            start: data.state(StateSpec::INTEGRATION),
            controls: Vec::new(),
            workers: Workers::new(model.clone()),
            states: Vec::new(),
            batch: None,
            transitions: [transition(1)?, transition(threads)?],
            a: Matrix::zeros(nx, nx),
            b: Matrix::zeros(nx, nu),
            lqr: Lqr::with_gain(&data, gain)?,
            data,
        })
    }

    /// Generates controls for this many steps, up to a tenth of their ranges.
    fn generate_controls(&mut self, steps: usize) {
        let model = self.data.model();
        let nu = model.nu();
        if self.controls.len() < steps * nu {
            let mut numbers = Numbers(1);
            let (ranges, limited) = (model.actuator_ctrlrange(), model.actuator_ctrllimited());
            let scale = |index: usize| if limited[index % nu] == 0 { 1.0 } else { ranges[index % nu][1] };
            self.controls = (0..steps * nu).map(|index| 0.1 * numbers.next() * scale(index)).collect();
        }
    }

    fn restart(&mut self) -> Outcome<()> {
        Ok(self.data.set_state(StateSpec::INTEGRATION, &self.start)?)
    }

    pub(crate) fn step(&mut self, calls: usize) -> Outcome<(f64, f64)> {
        let warm_up = calls / 8;
        self.generate_controls(warm_up + calls);
        self.restart()?;
        let nu = self.data.model().nu();
        let mut begin = Instant::now();
        for call in 0..warm_up + calls {
            if call == warm_up {
                begin = Instant::now();
            }
            self.data.ctrl_mut().copy_from_slice(&self.controls[call * nu..(call + 1) * nu]);
            self.data.step()?;
        }
        Ok((begin.elapsed().as_secs_f64(), self.data.qpos().iter().sum()))
    }

    /// Runs rollouts on the threads of the current pool.
    pub(crate) fn rollout(&mut self, count: usize, steps: usize) -> Outcome<(f64, f64)> {
        self.generate_controls(count * steps);
        let model = self.data.model();
        let (nq, width) = (model.nq(), model.state_size(StateSpec::PHYSICS));
        self.states.resize(count * (steps + 1) * width, 0.0);
        let begin = Instant::now();
        let rollout = Rollout::on(&self.workers, count, steps)
            .with_initial_state(StateSpec::INTEGRATION, &self.start)
            .with_controls(&self.controls[..count * steps * model.nu()]);
        let buffers = RolloutBuffers { states: Some(&mut self.states), ..Default::default() };
        let outcomes = rollout.run_into(buffers)?;
        let seconds = begin.elapsed().as_secs_f64();
        outcomes.into_iter().collect::<Result<Vec<()>, _>>()?;
        let last = &self.states[self.states.len() - width..];
        Ok((seconds, last[..nq].iter().sum()))
    }

    /// Steps a batch on the threads of the current pool. As for steps, the first call is not timed:
    /// see `engine.c`.
    pub(crate) fn batch(&mut self, count: usize, calls: usize) -> Outcome<(f64, f64)> {
        let width = count * self.data.model().nu();
        self.generate_controls((calls + 1) * count);
        let Self { data, start, controls, batch, .. } = self;
        let batch = match batch {
            Some(batch) if batch.len() == count => batch,
            _ => batch.insert(Batch::new(data.model(), count)?),
        };
        batch.reset_where(|_| true, |_, _, data| data.set_state(StateSpec::INTEGRATION, start))?;
        let mut begin = Instant::now();
        for (call, controls) in (0..=calls).zip(controls.chunks_exact(width)) {
            if call == 1 {
                begin = Instant::now();
            }
            batch.step(|_, to| to.as_mut_slice().copy_from_slice(controls))?;
        }
        let seconds = begin.elapsed().as_secs_f64();
        if let Some((_, error)) = batch.failures().next() {
            return Err(error.to_string().into());
        }
        let qpos = batch.model().state_range(StateSpec::INTEGRATION, StateSpec::QPOS);
        Ok((seconds, batch.states().row(count - 1)[qpos].iter().sum()))
    }

    /// Linearises on the threads of the current pool. As for steps, the first call is not timed:
    /// see `engine.c`.
    pub(crate) fn transition(&mut self, calls: usize) -> Outcome<(f64, f64)> {
        self.restart()?;
        let Self { data, transitions, a, b, .. } = self;
        let transition = &mut transitions[usize::from(rayon::current_num_threads() > 1)];
        let mut linearise = || -> Outcome<()> {
            let outputs = TransitionOutputs { a: Some(&mut *a), b: Some(&mut *b), ..Default::default() };
            let used = transition.linear_system_into(data, outputs)?;
            assert_eq!(used.fallback, None);
            Ok(())
        };
        linearise()?;
        let begin = Instant::now();
        (0..calls).try_for_each(|_| linearise())?;
        Ok((begin.elapsed().as_secs_f64(), self.a.as_slice().iter().sum()))
    }

    pub(crate) fn controller(&mut self, calls: usize) -> Outcome<(f64, f64)> {
        self.restart()?;
        self.data.qvel_mut().fill(0.01);
        let begin = Instant::now();
        for _ in 0..calls {
            self.lqr.control(&mut self.data)?;
        }
        Ok((begin.elapsed().as_secs_f64(), self.data.ctrl().iter().sum()))
    }
}

/// Riccati equation to solve repeatedly.
pub(crate) struct RiccatiProblem {
    system: StateSpace,
    weights: LqrWeights,
    workspace: RiccatiWorkspace,
    solution: RiccatiSolution,
}

impl RiccatiProblem {
    pub(crate) fn new(mut balance: Balance) -> Outcome<Self> {
        let system = balance.system()?;
        let (workspace, solution) = (RiccatiWorkspace::new(), RiccatiSolution::default());
        Ok(Self { system, weights: balance.weights, workspace, solution })
    }

    pub(crate) fn solve(&mut self) -> Outcome<(f64, f64)> {
        let Self { system, weights, workspace, solution } = self;
        let begin = Instant::now();
        Riccati::new(&system.a, &system.b, &weights.q, &weights.r).solve_into(workspace, solution)?;
        Ok((begin.elapsed().as_secs_f64(), self.solution.relative_residual))
    }

    /// Serialises the problem: one line with the shapes, then one line each for A, B, Q and R.
    pub(crate) fn text(&self) -> String {
        let matrices = [&self.system.a, &self.system.b, &self.weights.q, &self.weights.r];
        let mut text = String::new();
        for matrix in matrices {
            let _ = write!(text, "{} {} ", matrix.nrows(), matrix.ncols());
        }
        for matrix in matrices {
            text.push('\n');
            for entry in matrix.as_slice() {
                let _ = write!(text, "{entry:e} ");
            }
        }
        text
    }
}
