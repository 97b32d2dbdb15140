//! Linear systems of steps, again and again, in several threads, without allocating.

use std::sync::{Arc, Mutex, PoisonError};

use super::method::{Fallback, Step, TransitionMethod, TransitionOptions, Used};
use super::team::{Queue, together};
use super::through_inverse::obstacle;
use super::worker::{Input, Wanted, Worker, inputs, write};
use super::{StateSpace, TransitionOutputs, check_eps, sizes};
use crate::data::{Data, StateSpec};
use crate::enums::Integrator;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;

/// Fewest columns that are worth waking another thread for.
const FEWEST_TO_SHARE: usize = 16;

/// More would be a mistake, and would take memory for as many simulations.
const MOST_THREADS: usize = 1024;

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
/// one than the global pool. The caller's thread is one of them, and the result does not depend on their number. With one thread, or a
/// model of a few degrees of freedom only, all is done in the caller's.
#[derive(Debug)]
pub struct Transition {
    options: TransitionOptions,
    workers: Vec<Worker>,
    /// The point to linearise about.
    base: Vec<f64>,
    /// The columns, in the order in which they are computed, and each as a row: `(nx + nu, nx + nsensordata)`. Several threads
    /// share them.
    order: Vec<Input>,
    rows: Matrix,
    /// `(nv, nsensordata)`, if some sensors are of accelerations: their derivatives by these, which all columns need.
    sensors_by_acceleration: Matrix,
}

impl Transition {
    /// A workspace for simulations of this model, or of copies of it.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless `eps` is between `1e-12` and 1 and there are from 1 to 1024 threads, [`Error::Engine`] or
    /// [`Error::OutOfMemory`] if the engine cannot allocate the simulations.
    pub fn new(model: impl Into<Arc<Model>>, options: TransitionOptions) -> Result<Self> {
        let model = model.into();
        if let Some(eps) = options.eps {
            check_eps("TransitionOptions", eps)?;
        }
        if !(1..=MOST_THREADS).contains(&options.threads) {
            let expected = format!("from 1 to {MOST_THREADS}, as each has a simulation of its own");
            return Err(Error::invalid("threads of TransitionOptions", options.threads, expected));
        }
        let workers = (0..options.threads).map(|_| Worker::new(&model)).collect::<Result<_>>()?;
        let (nx, nu, ny) = sizes(&model);
        Ok(Self {
            options,
            workers,
            base: vec![0.0; model.state_size(StateSpec::INTEGRATION)],
            order: Vec::with_capacity(nx + nu),
            rows: Matrix::zeros(nx + nu, nx + ny),
            sensors_by_acceleration: Matrix::zeros(model.nv(), ny),
        })
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
        data.state_into(StateSpec::INTEGRATION, &mut self.base)?;
        let (method, fallback) = self.method(data);
        if fallback == Some(Fallback::Callbacks) {
            let step = self.options.step(method);
            let result = data.transition_fd_into(step.eps, step.differences, outputs);
            // What a closure sets is not put back by the engine.
            data.set_state(StateSpec::INTEGRATION, &self.base)?;
            return result.map(|()| Used { method, fallback });
        }
        let wanted = Wanted::by(&outputs);
        let alone = self.workers.len() == 1 || inputs(data.model(), wanted).count() < FEWEST_TO_SHARE;
        if alone || method == TransitionMethod::Engine {
            let worker = &mut self.workers[0];
            return worker.linear_system(&self.base, method, fallback, &self.options, wanted, outputs);
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
        write(data.model(), &self.rows, wanted, &mut outputs);
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
        data.state_into(StateSpec::INTEGRATION, &mut self.base)?;
        let (method, fallback) = self.method(data);
        if fallback == Some(Fallback::Callbacks) {
            return Err(Error::Unsupported("along linearises simulations without callbacks only".to_owned()));
        }
        let (base, options) = (&self.base, &self.options);
        let queue = Queue::new(systems.iter_mut().enumerate());
        let first_error = Mutex::new(None);
        together(&mut self.workers, |worker, _| {
            while let Some((knot, (system, used))) = queue.take() {
                let outputs = TransitionOutputs::from(system);
                let outcome = worker
                    .set_knot(base, states.row(knot), controls.row(knot))
                    .and_then(|()| worker.go(method, fallback, options, Wanted::by(&outputs), outputs));
                match outcome {
                    Ok(method) => *used = method,
                    // All before it were taken before it, so the first of all is among those that the threads have found.
                    Err(error) => {
                        let mut first = first_error.lock().unwrap_or_else(PoisonError::into_inner);
                        if first.as_ref().is_none_or(|&(earlier, _)| knot < earlier) {
                            *first = Some((knot, error));
                        }
                        return;
                    }
                }
            }
        });
        match first_error.into_inner().unwrap_or_else(PoisonError::into_inner) {
            None => Ok(()),
            Some((_, error)) => Err(error),
        }
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
        let step = self.options.step(TransitionMethod::Columns);
        let base = &self.base;
        let model = self.workers[0].data.model().clone();
        let queue = pieces(&model, &mut self.order, &mut self.rows, wanted);
        share(&mut self.workers, |worker, first| {
            if first || queue.is_worth_joining() {
                worker.start(base)?;
                worker.step_from_base(wanted)?;
                while let Some((&input, row)) = queue.take() {
                    worker.column(&model, input, wanted, step, row)?;
                }
            }
            Ok(())
        })
    }

    /// All columns by differences of inverse dynamics, or false where the solver has not converged.
    fn inverse(&mut self, wanted: Wanted) -> Result<bool> {
        let step = self.options.step(TransitionMethod::Inverse);
        let Self { workers, base, order, rows, sensors_by_acceleration, .. } = self;
        let (base, model) = (&base[..], workers[0].data.model().clone());
        for worker in &mut *workers {
            worker.prepared = None;
        }
        let accelerate = wanted.sensors && workers[0].has_accelerometers();
        if accelerate {
            let width = sensors_by_acceleration.ncols().max(1);
            let queue = Queue::new((0..model.nv()).zip(sensors_by_acceleration.as_mut_slice().chunks_exact_mut(width)));
            share(workers, |worker, first| {
                if (first || queue.is_worth_joining()) && worker.is_prepared(base, wanted, step)? {
                    while let Some((dof, row)) = queue.take() {
                        worker.accelerate(dof, step, row)?;
                    }
                }
                Ok(())
            })?;
        }
        let queue = pieces(&model, order, rows, wanted);
        share(workers, |worker, first| {
            if (first || queue.is_worth_joining()) && worker.is_prepared(base, wanted, step)? {
                if accelerate {
                    let from = sensors_by_acceleration.as_slice();
                    worker.base.sensors_by_acceleration.as_mut_slice().copy_from_slice(from);
                }
                while let Some((&input, row)) = queue.take() {
                    worker.inverse_column(&model, input, wanted, step, row)?;
                }
            }
            Ok(())
        })?;
        Ok(workers[0].prepared == Some(true))
    }
}

/// The columns of a system, each with the row that it is written to, for several threads to take.
fn pieces<'a>(
    model: &Model,
    order: &'a mut Vec<Input>,
    rows: &'a mut Matrix,
    wanted: Wanted,
) -> Queue<impl ExactSizeIterator<Item = (&'a Input, &'a mut [f64])>> {
    order.clear();
    order.extend(inputs(model, wanted));
    let width = rows.ncols().max(1);
    Queue::new(order.iter().zip(rows.as_mut_slice().chunks_exact_mut(width)))
}

/// Has the workers share some work; the first error of one, if there is one.
fn share(workers: &mut [Worker], work: impl Fn(&mut Worker, bool) -> Result<()> + Sync) -> Result<()> {
    together(workers, |worker, first| worker.outcome = work(worker, first));
    let outcomes = workers.iter_mut().map(|worker| std::mem::replace(&mut worker.outcome, Ok(())));
    outcomes.fold(Ok(()), Result::and)
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
        if method == TransitionMethod::Engine {
            let step = options.step(method);
            self.data.transition_fd_into(step.eps, step.differences, outputs)?;
            return Ok(Used { method, fallback });
        }
        let model = self.data.model().clone();
        let mut rows = std::mem::replace(&mut self.rows, Matrix::zeros(0, 0));
        let used = self.all_columns(&model, method, fallback, options, wanted, &mut rows);
        if used.is_ok() {
            write(&model, &rows, wanted, &mut outputs);
        }
        self.rows = rows;
        used
    }

    /// Computes all columns about the base point, one after the other.
    fn all_columns(
        &mut self,
        model: &Model,
        method: TransitionMethod,
        fallback: Option<Fallback>,
        options: &TransitionOptions,
        wanted: Wanted,
        rows: &mut Matrix,
    ) -> Result<Used> {
        let mut used = Used { method, fallback };
        if method == TransitionMethod::Inverse {
            let step = options.step(method);
            if self.prepare(wanted, step)? {
                if wanted.sensors && self.has_accelerometers() {
                    let mut found = std::mem::replace(&mut self.base.sensors_by_acceleration, Matrix::zeros(0, 0));
                    let outcome = (0..model.nv()).try_for_each(|dof| self.accelerate(dof, step, found.row_mut(dof)));
                    self.base.sensors_by_acceleration = found;
                    outcome?;
                }
                for (row, input) in inputs(model, wanted).enumerate() {
                    self.inverse_column(model, input, wanted, step, rows.row_mut(row))?;
                }
                return Ok(used);
            }
            used = Used { method: TransitionMethod::Columns, fallback: Some(Fallback::NotConverged) };
            self.restore()?;
        }
        let step = options.step(TransitionMethod::Columns);
        self.step_from_base(wanted)?;
        for (row, input) in inputs(model, wanted).enumerate() {
            self.column(model, input, wanted, step, rows.row_mut(row))?;
        }
        Ok(used)
    }

    /// Prepares for the columns if nobody has yet. False if the solver has not converged.
    fn is_prepared(&mut self, base: &[f64], wanted: Wanted, step: Step) -> Result<bool> {
        if let Some(prepared) = self.prepared {
            return Ok(prepared);
        }
        self.start(base)?;
        let prepared = self.prepare(wanted, step)?;
        self.prepared = Some(prepared);
        Ok(prepared)
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
