//! Linearisation of a step by one or several workers that share the columns.

use std::sync::Arc;

use super::analytic::Analytic;
use super::columns::StepDifferences;
use super::implicit::Linearisation;
use super::kinks;
use super::method::{DifferencedTerms, Fallback, Kinks, LinearisationReport, TransitionMethod, TransitionOptions};
use super::perturbation::{BasePoint, Input, PerturbedData, Settings, Wanted, inputs};
use super::support::Obstacles;
use super::{TransitionOutputs, sizes};
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;
use crate::parallel::{WorkQueue, for_each_worker};

/// A simulation for one thread, with the buffers of all methods.
#[derive(Debug)]
pub(super) struct Worker {
    pub(super) point: PerturbedData,
    differences: StepDifferences,
    implicit: Linearisation,
    pub(super) analytic: Analytic,
    /// Result of the preparation of `implicit` at the base point: false if the solver has not
    /// converged, `None` before it.
    prepared: Option<bool>,
    /// Result of this worker's share of the columns: their kinks.
    outcome: Result<Kinks>,
    /// Buffer for the flags of the rows of C and D in closed form.
    keep: Vec<bool>,
    /// Columns of the systems for which this worker is the first.
    columns: Columns,
}

/// Columns of a linear system, shared by the workers that compute it.
#[derive(Debug, Default)]
struct Columns {
    order: Vec<Input>,
    /// `(nx + nu, nx + nsensordata)`: the columns, each as a row, in the order of [`inputs`].
    rows: Matrix,
    /// `(nv, nsensordata)`: derivatives of the acceleration sensors with respect to the
    /// accelerations.
    acceleration_sensors: Matrix,
}

impl Columns {
    fn new(model: &Model) -> Self {
        let (nx, nu, ny) = sizes(model);
        Self {
            order: Vec::with_capacity(nx + nu),
            rows: Matrix::zeros(nx + nu, nx + ny),
            acceleration_sensors: Matrix::zeros(model.nv(), ny),
        }
    }

    /// Copies the columns to the outputs, transposed, except for the rows of C and D that `keep`
    /// marks.
    fn write_to(&self, model: &Model, wanted: Wanted, keep: &[bool], outputs: &mut TransitionOutputs<'_>) {
        let (nx, _, _) = sizes(model);
        for (row, input) in inputs(model, wanted).enumerate() {
            let (state, sensors) = self.rows.row(row).split_at(nx);
            let column = input.column(model);
            let (of_state, of_sensors) = match input {
                Input::Control(_) => (&mut outputs.b, &mut outputs.d),
                _ => (&mut outputs.a, &mut outputs.c),
            };
            for (values, output, keep) in [(state, of_state, &[][..]), (sensors, of_sensors, keep)] {
                if let Some(output) = output {
                    let rows = values.iter().enumerate().filter(|&(row, _)| !keep.get(row).is_some_and(|&keep| keep));
                    rows.for_each(|(row, value)| output[(row, column)] = *value);
                }
            }
        }
    }
}

impl Worker {
    pub(super) fn new(model: &Arc<Model>) -> Result<Self> {
        Ok(Self {
            point: PerturbedData::new(model)?,
            differences: StepDifferences::new(model),
            implicit: Linearisation::new(model),
            analytic: Analytic::new(model),
            prepared: None,
            outcome: Ok(Kinks::empty()),
            keep: Vec::with_capacity(model.nsensordata()),
            columns: Columns::new(model),
        })
    }

    /// Moves to the base point and prepares for implicit differentiation, unless this was done
    /// already. Returns `false` if the solver has not converged.
    fn prepare_implicit(&mut self, base: BasePoint<'_>, settings: Settings<'_>) -> Result<bool> {
        if let Some(prepared) = self.prepared {
            return Ok(prepared);
        }
        self.point.set_base(base)?;
        let prepared = self.implicit.prepare(&mut self.point, settings)?;
        self.prepared = Some(prepared);
        Ok(prepared)
    }
}

/// Computes a linear system with the given workers, which share the columns. The result does not
/// depend on their number. `for_parameters` is true if derivatives by parameters follow.
pub(super) fn linearise(
    workers: &mut [Worker],
    base: BasePoint<'_>,
    options: &TransitionOptions,
    obstacles: Obstacles,
    mut outputs: TransitionOutputs<'_>,
    for_parameters: bool,
) -> Result<LinearisationReport> {
    if Wanted::by(&outputs).sensors && workers[0].point.data.model().has_noise() {
        return Err(Error::Unsupported("C and D of sensors with noise: clear EnableFlags::SENSORNOISE".to_owned()));
    }
    let (method, fallback) = obstacles.method(options.method);
    if method == TransitionMethod::Engine {
        let (point, step) = (&mut workers[0].point, options.step(method));
        point.set_base(base)?;
        point.data.transition_fd_into(step.eps, step.differences, outputs)?;
        let kinks = kinks::of_inputs(&point.data, None);
        return Ok(LinearisationReport { kinks, ..LinearisationReport::new(method, fallback) });
    }
    if method != TransitionMethod::Analytic {
        return difference(workers, base, options, (method, fallback), &[], outputs);
    }
    let worker = &mut workers[0];
    worker.point.move_to(base)?;
    match worker.analytic.linearise(&mut worker.point.data, &mut outputs, for_parameters)? {
        Ok(differenced) => difference_sensors(workers, base, options, outputs, differenced),
        Err(reason) => {
            let method = match reason {
                Fallback::NotConverged => TransitionMethod::Columns,
                _ => obstacles.differences(),
            };
            difference(workers, base, options, (method, Some(reason)), &[], outputs)
        }
    }
}

/// Computes a linear system by differences of inverse dynamics or of steps, except for the rows of
/// C and D that `keep` marks.
fn difference(
    workers: &mut [Worker],
    base: BasePoint<'_>,
    options: &TransitionOptions,
    (method, fallback): (TransitionMethod, Option<Fallback>),
    keep: &[bool],
    mut outputs: TransitionOutputs<'_>,
) -> Result<LinearisationReport> {
    let report = LinearisationReport::new(method, fallback);
    let model = workers[0].point.data.model().clone();
    let wanted = Wanted::by(&outputs);
    let settings = Settings { model: &model, wanted, step: options.step(method), keep };
    // The workers are borrowed while they write to the columns.
    let mut columns = std::mem::take(&mut workers[0].columns);
    let result = match method {
        TransitionMethod::Implicit => match differentiate_implicitly(workers, &mut columns, base, settings) {
            Ok(Some(kinks)) => Ok(LinearisationReport { kinks, ..report }),
            Ok(None) => {
                let method = TransitionMethod::Columns;
                let settings = Settings { step: options.step(method), ..settings };
                let report = LinearisationReport::new(method, Some(Fallback::NotConverged));
                difference_steps(workers, &mut columns, base, settings)
                    .map(|kinks| LinearisationReport { kinks, ..report })
            }
            Err(error) => Err(error),
        },
        _ => {
            difference_steps(workers, &mut columns, base, settings).map(|kinks| LinearisationReport { kinks, ..report })
        }
    };
    if result.is_ok() {
        columns.write_to(&model, wanted, keep, &mut outputs);
    }
    workers[0].columns = columns;
    result
}

/// Computes the rows of C and D that have no closed form by differences of inverse dynamics.
fn difference_sensors(
    workers: &mut [Worker],
    base: BasePoint<'_>,
    options: &TransitionOptions,
    outputs: TransitionOutputs<'_>,
    mut differenced: DifferencedTerms,
) -> Result<LinearisationReport> {
    let outputs = TransitionOutputs { a: None, b: None, ..outputs };
    let mut kinks = workers[0].analytic.kinks;
    if Wanted::by(&outputs).sensors {
        // The workers are borrowed while they difference the others.
        let mut keep = std::mem::take(&mut workers[0].keep);
        keep.clear();
        keep.extend_from_slice(workers[0].analytic.sensors_in_closed_form());
        let result = if keep.iter().all(|&keep| keep) {
            Ok(Kinks::empty())
        } else {
            differenced |= DifferencedTerms::SENSORS;
            let report = difference(workers, base, options, (TransitionMethod::Implicit, None), &keep, outputs);
            report.map(|report| report.kinks)
        };
        workers[0].keep = keep;
        kinks |= result?;
    }
    Ok(LinearisationReport { differenced, kinks, ..LinearisationReport::new(TransitionMethod::Analytic, None) })
}

/// Computes all columns by differences of a step.
fn difference_steps(
    workers: &mut [Worker],
    columns: &mut Columns,
    base: BasePoint<'_>,
    settings: Settings<'_>,
) -> Result<Kinks> {
    let Columns { order, rows, .. } = columns;
    let queue = column_queue(settings, order, rows);
    share(workers, |worker, first| {
        let mut kinks = Kinks::empty();
        if first || queue.is_worth_joining() {
            let Worker { point, differences, .. } = worker;
            point.set_base(base)?;
            kinks |= differences.prepare(point, settings)?;
            while let Some((&input, row)) = queue.take() {
                kinks |= differences.column(point, settings, input, row)?;
            }
        }
        Ok(kinks)
    })
}

/// Computes all columns by differences of inverse dynamics, and returns the kinks; `None` if the
/// solver has not converged.
fn differentiate_implicitly(
    workers: &mut [Worker],
    columns: &mut Columns,
    base: BasePoint<'_>,
    settings: Settings<'_>,
) -> Result<Option<Kinks>> {
    let Columns { order, rows, acceleration_sensors } = columns;
    for worker in &mut *workers {
        worker.prepared = None;
    }
    let mut kinks = Kinks::empty();
    if settings.wanted.sensors && workers[0].implicit.has_acceleration_sensors() {
        let width = acceleration_sensors.ncols().max(1);
        let items = (0..settings.model.nv()).zip(acceleration_sensors.as_mut_slice().chunks_exact_mut(width));
        let queue = WorkQueue::new(items);
        kinks |= share(workers, |worker, first| {
            let mut kinks = Kinks::empty();
            if (first || queue.is_worth_joining()) && worker.prepare_implicit(base, settings)? {
                while let Some((dof, row)) = queue.take() {
                    kinks |= worker.implicit.acceleration_row(&mut worker.point, settings, dof, row)?;
                }
            }
            Ok(kinks)
        })?;
    }
    let acceleration_sensors = &*acceleration_sensors;
    let queue = column_queue(settings, order, rows);
    kinks |= share(workers, |worker, first| {
        let mut kinks = Kinks::empty();
        if (first || queue.is_worth_joining()) && worker.prepare_implicit(base, settings)? {
            kinks |= worker.implicit.kinks;
            while let Some((&input, row)) = queue.take() {
                let Worker { point, implicit, .. } = worker;
                kinks |= implicit.column(point, settings, input, acceleration_sensors, row)?;
            }
        }
        Ok(kinks)
    })?;
    Ok((workers[0].prepared == Some(true)).then_some(kinks))
}

/// Creates the queue of inputs, each with the row that its column is written to.
fn column_queue<'a>(
    settings: Settings<'_>,
    order: &'a mut Vec<Input>,
    rows: &'a mut Matrix,
) -> WorkQueue<impl ExactSizeIterator<Item = (&'a Input, &'a mut [f64])> + use<'a>> {
    order.clear();
    order.extend(inputs(settings.model, settings.wanted));
    let width = rows.ncols().max(1);
    WorkQueue::new(order.iter().zip(rows.as_mut_slice().chunks_exact_mut(width)))
}

/// Runs `work` on all workers, and returns their kinks, or the error of the first worker that
/// failed.
fn share(workers: &mut [Worker], work: impl Fn(&mut Worker, bool) -> Result<Kinks> + Sync) -> Result<Kinks> {
    for_each_worker(workers, |worker, first| worker.outcome = work(worker, first));
    let mut outcomes = workers.iter_mut().map(|worker| std::mem::replace(&mut worker.outcome, Ok(Kinks::empty())));
    outcomes.try_fold(Kinks::empty(), |all, outcome| Ok(all | outcome?))
}
