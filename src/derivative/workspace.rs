//! Linear systems of steps, again and again, in several threads, without allocating.

use std::sync::Arc;

use rayon::prelude::*;

use super::method::{Fallback, TransitionMethod, TransitionOptions, Used};
use super::through_inverse::obstacle;
use super::worker::{Share, Wanted, Worker};
use super::{StateSpace, TransitionOutputs, check_eps, sizes};
use crate::data::{Data, StateSpec};
use crate::enums::Integrator;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;

/// Linearises steps of a simulation, by a choice of [methods](TransitionMethod), and keeps what that needs: a simulation for
/// each thread, and room for the columns.
///
/// ```
/// use mujoco_safe::{Data, StateSpace, Transition, TransitionMethod, TransitionOptions, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// data.reset_to_key("squat")?;
/// let mut transition = Transition::new(data.model().clone(), TransitionOptions::default())?;
/// let mut system = StateSpace::zeros(data.model());
/// let used = transition.linear_system_into(&mut data, &mut system)?;
/// assert_eq!(used.method, TransitionMethod::Inverse);
/// assert_eq!(used.fallback, None);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
///
/// Columns are shared among the threads of the rayon pool that the call is made in, so `ThreadPool::install` chooses another
/// one than the global pool. The result does not depend on their number. With one thread all is done in the caller's.
#[derive(Debug)]
pub struct Transition {
    options: TransitionOptions,
    workers: Vec<Worker>,
    /// The point to linearise about.
    inputs: Vec<f64>,
}

impl Transition {
    /// A workspace for simulations of this model, or of copies of it.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless `eps` is between `1e-12` and 1 and there is at least one thread, [`Error::Engine`] or
    /// [`Error::OutOfMemory`] if the engine cannot allocate the simulations.
    pub fn new(model: impl Into<Arc<Model>>, options: TransitionOptions) -> Result<Self> {
        let model = model.into();
        if let Some(eps) = options.eps {
            check_eps("TransitionOptions", eps)?;
        }
        if options.threads == 0 {
            return Err(Error::invalid("threads of TransitionOptions", "0", "at least 1"));
        }
        let workers = (0..options.threads).map(|_| Worker::new(&model)).collect::<Result<_>>()?;
        Ok(Self { options, workers, inputs: vec![0.0; model.state_size(StateSpec::INTEGRATION)] })
    }

    /// What it was made with.
    pub fn options(&self) -> &TransitionOptions {
        &self.options
    }

    /// The linear system of a step about the present state, controls and other inputs, and by which method it was found.
    ///
    /// # Errors
    ///
    /// As for [`linear_system_into`](Self::linear_system_into).
    pub fn linear_system(&mut self, data: &mut Data) -> Result<(StateSpace, Used)> {
        let mut system = StateSpace::zeros(data.model());
        let used = self.linear_system_into(data, &mut system)?;
        Ok((system, used))
    }

    /// As [`linear_system`](Self::linear_system), into the caller's matrices, of which any may be left out. Allocates nothing,
    /// except what rayon needs, now and then, to wake its threads.
    ///
    /// The simulation is as before afterwards, to the last bit and also after an error. Only the
    /// [callbacks](crate::callback) of a simulation have to be called with that simulation; what is computed of it then counts
    /// as not computed, and after an error it has to be reset.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape, [`Error::OtherModel`] for a simulation of a model that was loaded separately, and
    /// the errors of [`Data::step`]. With [`TransitionMethod::Engine`] also those of [`Data::transition_fd_into`].
    pub fn linear_system_into<'a>(
        &mut self,
        data: &mut Data,
        outputs: impl Into<TransitionOutputs<'a>>,
    ) -> Result<Used> {
        let mut outputs = outputs.into();
        outputs.check(data.model())?;
        self.follow(data)?;
        data.state_into(StateSpec::INTEGRATION, &mut self.inputs)?;
        let (method, fallback) = self.method(data);
        if fallback == Some(Fallback::Callbacks) {
            let step = self.options.step(method);
            let result = data.transition_fd_into(step.eps, step.differences, outputs);
            // What a closure sets is not put back by the engine.
            data.set_state(StateSpec::INTEGRATION, &self.inputs)?;
            return result.map(|()| Used { method, fallback });
        }
        let wanted = Wanted::by(&outputs);
        if self.workers.len() == 1 || method == TransitionMethod::Engine {
            let worker = &mut self.workers[0];
            return worker.linear_system(&self.inputs, method, fallback, &self.options, wanted, outputs);
        }
        let used = match method {
            TransitionMethod::Inverse if self.inverse(wanted)? => Used { method, fallback },
            TransitionMethod::Inverse => {
                self.columns(wanted)?;
                Used { method: TransitionMethod::Columns, fallback: Some(Fallback::NotConverged) }
            }
            _ => {
                self.columns(wanted)?;
                Used { method, fallback }
            }
        };
        let count = self.workers.len();
        for (index, worker) in self.workers.iter().enumerate() {
            worker.write(Share { index, count }, wanted, &mut outputs);
        }
        Ok(used)
    }

    /// The linear systems of steps along a trajectory, for a regulator whose gain changes with time: row `k` of `states`,
    /// `[qpos; qvel; act]`, and row `k` of `controls` are linearised into system `k`. Time, applied forces, mocap poses and user
    /// data are those of `data`. Each thread linearises a share of the rows; the results are those of one row after another.
    ///
    /// ```
    /// use mujoco_safe::{Data, Matrix, Transition, TransitionOptions, sample};
    ///
    /// let data = Data::new(sample::cartpole())?;
    /// let mut transition = Transition::new(data.model().clone(), TransitionOptions { threads: 2, ..Default::default() })?;
    /// let states = Matrix::from_rows(&[[0.0, 0.1, 0.0, 0.0], [0.0, 0.2, 0.0, 1.0], [0.1, 0.3, 0.0, 2.0]]);
    /// let systems = transition.along(&data, &states, &Matrix::zeros(3, 1))?;
    /// // The further it leans, the less it takes to fall on.
    /// assert!(systems[0].0.a[(3, 1)] > systems[1].0.a[(3, 1)]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`linear_system_into`](Self::linear_system_into), [`Error::Shape`] unless `states` is `(N, nq + nv + na)` and
    /// `controls` is `(N, nu)`, and [`Error::Unsupported`] for a simulation with callbacks. The error is that of the first row
    /// that has one.
    pub fn along(&mut self, data: &Data, states: &Matrix, controls: &Matrix) -> Result<Vec<(StateSpace, Used)>> {
        let nothing = Used { method: self.options.method, fallback: None };
        let mut systems = vec![(StateSpace::zeros(data.model()), nothing); states.nrows()];
        self.along_into(data, states, controls, &mut systems)?;
        Ok(systems)
    }

    /// As [`along`](Self::along), into systems that the caller has. Allocates nothing, except what rayon needs.
    ///
    /// # Errors
    ///
    /// As for [`along`](Self::along), and [`Error::Shape`] unless there is one system of the right shapes for each row.
    pub fn along_into(
        &mut self,
        data: &Data,
        states: &Matrix,
        controls: &Matrix,
        systems: &mut [(StateSpace, Used)],
    ) -> Result<()> {
        let model = data.model();
        let knots = states.nrows();
        Error::check_shape("states of along", states.shape(), (knots, model.state_size(StateSpec::PHYSICS)))?;
        Error::check_shape("controls of along", controls.shape(), (knots, model.nu()))?;
        Error::check_length("the systems of along", systems.len(), knots)?;
        for (system, _) in &mut *systems {
            TransitionOutputs::from(system).check(model)?;
        }
        self.follow(data)?;
        data.state_into(StateSpec::INTEGRATION, &mut self.inputs)?;
        let (method, fallback) = self.method(data);
        if fallback == Some(Fallback::Callbacks) {
            return Err(Error::Unsupported("along linearises simulations without callbacks only".to_owned()));
        }
        let (inputs, options) = (&self.inputs, &self.options);
        let share = |worker: &mut Worker, first: usize, systems: &mut [(StateSpace, Used)]| {
            for (knot, (system, used)) in (first..).zip(systems) {
                let outputs = TransitionOutputs::from(system);
                worker.set_knot(inputs, states.row(knot), controls.row(knot))?;
                *used = worker.go(method, fallback, options, Wanted::by(&outputs), outputs)?;
            }
            Ok(())
        };
        let chunk = knots.div_ceil(self.workers.len()).max(1);
        if self.workers.len() == 1 {
            return share(&mut self.workers[0], 0, systems);
        }
        let shares = self.workers.par_iter_mut().with_max_len(1).zip(systems.par_chunks_mut(chunk));
        shares.enumerate().for_each(|(index, (worker, systems))| {
            worker.outcome = share(worker, index * chunk, systems);
        });
        outcome(&mut self.workers)
    }

    /// Takes over the model of a simulation, which may have been changed since.
    fn follow(&mut self, data: &Data) -> Result<()> {
        data.check_usable()?;
        data.check_inputs()?;
        if !self.workers[0].data.model().is_same_structure(data.model()) {
            return Err(Error::OtherModel { what: "the data to linearise" });
        }
        self.workers.iter_mut().for_each(|worker| worker.follow(data));
        Ok(())
    }

    /// By which method, as far as that is known beforehand.
    fn method(&self, data: &Data) -> (TransitionMethod, Option<Fallback>) {
        let asked = self.options.method;
        if data.callbacks.is_some() {
            return (TransitionMethod::Engine, (asked != TransitionMethod::Engine).then_some(Fallback::Callbacks));
        }
        let obstacle = match asked {
            TransitionMethod::Inverse => obstacle(data.model()),
            TransitionMethod::Engine if data.model().options().integrator == Integrator::Rk4 => {
                Some(Fallback::RungeKutta)
            }
            _ => None,
        };
        (if obstacle.is_some() { TransitionMethod::Columns } else { asked }, obstacle)
    }

    /// All columns by differences of a step.
    fn columns(&mut self, wanted: Wanted) -> Result<()> {
        let (inputs, step) = (&self.inputs, self.options.step(TransitionMethod::Columns));
        each(&mut self.workers, |worker, share| {
            worker.start(inputs)?;
            worker.columns(share, wanted, step)
        });
        outcome(&mut self.workers)
    }

    /// All columns by differences of inverse dynamics, or false where the solver has not converged.
    fn inverse(&mut self, wanted: Wanted) -> Result<bool> {
        let (inputs, step) = (&self.inputs, self.options.step(TransitionMethod::Inverse));
        let (first, others) = self.workers.split_first_mut().expect("Bug: no worker");
        first.start(inputs)?;
        if !first.prepare(wanted, step)? {
            return Ok(false);
        }
        let count = others.len() + 1;
        let accelerate = wanted.sensors && first.has_accelerometers();
        let begin = |first: &Worker, worker: &mut Worker| {
            worker.start(inputs)?;
            worker.base.adopt(&first.base);
            worker.begin(wanted)
        };
        if accelerate {
            let first = &*first;
            others.par_iter_mut().with_max_len(1).for_each(|worker| worker.outcome = begin(first, worker));
            outcome(&mut self.workers)?;
            each(&mut self.workers, |worker, share| worker.accelerate(share, step));
            outcome(&mut self.workers)?;
            for index in 0..count {
                for other in (0..count).filter(|&other| other != index) {
                    let [from, to] = self.workers.get_disjoint_mut([index, other]).expect("Bug: two equal indices");
                    from.share_accelerations(Share { index, count }, to);
                }
            }
            each(&mut self.workers, |worker, share| worker.inverse_columns(share, wanted, step));
        } else {
            for worker in others {
                worker.base.adopt(&first.base);
            }
            each(&mut self.workers, |worker, share| {
                if share.index > 0 {
                    worker.start(inputs)?;
                    worker.begin(wanted)?;
                }
                worker.inverse_columns(share, wanted, step)
            });
        }
        outcome(&mut self.workers).map(|()| true)
    }
}

/// The first error of a worker, if there is one.
fn outcome(workers: &mut [Worker]) -> Result<()> {
    let mut first = Ok(());
    for worker in workers {
        let outcome = std::mem::replace(&mut worker.outcome, Ok(()));
        first = first.and(outcome);
    }
    first
}

/// Has each worker do its share, all at the same time.
fn each(workers: &mut [Worker], work: impl Fn(&mut Worker, Share) -> Result<()> + Sync) {
    let count = workers.len();
    workers.par_iter_mut().with_max_len(1).enumerate().for_each(|(index, worker)| {
        worker.outcome = work(worker, Share { index, count });
    });
}

impl Worker {
    /// The whole linear system, in this thread.
    fn linear_system(
        &mut self,
        inputs: &[f64],
        method: TransitionMethod,
        fallback: Option<Fallback>,
        options: &TransitionOptions,
        wanted: Wanted,
        outputs: TransitionOutputs<'_>,
    ) -> Result<Used> {
        self.start(inputs)?;
        self.go(method, fallback, options, wanted, outputs)
    }

    /// As [`start`](Self::start), with the state and the controls of a knot.
    fn set_knot(&mut self, inputs: &[f64], state: &[f64], controls: &[f64]) -> Result<()> {
        self.start(inputs)?;
        self.data.set_physics_state(state)?;
        self.data.ctrl_mut().copy_from_slice(controls);
        self.data.check_inputs()?;
        self.keep()
    }

    /// The whole linear system about the base point.
    fn go(
        &mut self,
        method: TransitionMethod,
        fallback: Option<Fallback>,
        options: &TransitionOptions,
        wanted: Wanted,
        mut outputs: TransitionOutputs<'_>,
    ) -> Result<Used> {
        let mut used = Used { method, fallback };
        let step = options.step(method);
        match method {
            TransitionMethod::Engine => {
                self.data.transition_fd_into(step.eps, step.differences, outputs)?;
                return Ok(used);
            }
            TransitionMethod::Columns => self.columns(Share::WHOLE, wanted, step)?,
            TransitionMethod::Inverse => {
                if self.prepare(wanted, step)? {
                    if wanted.sensors && self.has_accelerometers() {
                        self.accelerate(Share::WHOLE, step)?;
                    }
                    self.inverse_columns(Share::WHOLE, wanted, step)?;
                } else {
                    used = Used { method: TransitionMethod::Columns, fallback: Some(Fallback::NotConverged) };
                    self.restore()?;
                    self.columns(Share::WHOLE, wanted, options.step(TransitionMethod::Columns))?;
                }
            }
        }
        self.write(Share::WHOLE, wanted, &mut outputs);
        Ok(used)
    }
}

impl TransitionOutputs<'_> {
    fn check(&self, model: &Model) -> Result<()> {
        let (nx, nu, ny) = sizes(model);
        for (what, output, shape) in [
            ("A of a linear system", &self.a, (nx, nx)),
            ("B of a linear system", &self.b, (nx, nu)),
            ("C of a linear system", &self.c, (ny, nx)),
            ("D of a linear system", &self.d, (ny, nu)),
        ] {
            if let Some(output) = output {
                Error::check_shape(what, output.shape(), shape)?;
            }
        }
        Ok(())
    }
}
