//! Multiple shooting as a least squares problem.
//!
//! The coordinates of a step are the unknowns. The states at the starts of segments, and the
//! uncertain coordinates of the first states, are eliminated ([`Chain`]). The cost has a penalty
//! for the gaps between the end of a segment and the start of the next one, whose weight grows
//! until they are negligible. States that are variables of their own keep the problem
//! well-conditioned for unstable motions, where a method that eliminates them forwards in time
//! (condensing) would not.

use std::iter::{once, repeat};

use nalgebra::DMatrix;

use super::chain::Chain;
use super::column::{Column, Derivative, Values};
use super::formulas::Formulas;
use super::measurement_error::{MeasurementError, errors_of};
use super::plan::{PART, Plan};
use super::segment::{self, Quadratic};
use super::simulate::{Simulated, Worker};
use super::states::first_state;
use super::unknown::Unknown;
use crate::error::{Error, Result};
use crate::least_squares::{Problem, damp};
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::add;
use crate::parallel::for_each_item;

/// Number of simulated columns that are kept at a time, for each thread.
const COLUMNS_PER_THREAD: usize = 64;

/// Point of the search, and the model of the cost there.
pub(super) struct Shooting<'p> {
    pub(super) unknowns: &'p [Unknown],
    pub(super) plans: Vec<Plan>,
    workers: Vec<Worker>,
    pub(super) present: Point,
    candidate: Point,
    /// Number of points so far.
    points: u64,
    /// States of each experiment, and the unknowns with the gradient: `(n + 1, n + 1)`.
    chains: Vec<Chain>,
    total: DMatrix<f64>,
    /// Weight of the gaps relative to that of the readings.
    penalty: f64,
    /// Weights of the coordinates of each gap, by the node before it. Empty before the first
    /// linearisation with a penalty.
    weights: Vec<Vec<f64>>,
    pub(super) residuals: Residuals,
    /// Costs of all linearisations.
    pub(super) costs: Vec<f64>,
}

/// Unknowns, and physics states at the starts of all segments of all experiments.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) coordinates: Vec<f64>,
    pub(super) nodes: Vec<Vec<f64>>,
    /// Simulations of all segments. Empty before them.
    base: Vec<Simulated>,
    /// Number that differs for other coordinates, from 1.
    version: u64,
}

impl Point {
    fn values<'v>(&'v self, unknowns: &'v [Unknown]) -> Values<'v> {
        Values { unknowns, coordinates: &self.coordinates, version: self.version }
    }

    fn is_stable(&self) -> bool {
        self.base.iter().all(Simulated::is_stable)
    }
}

/// Difference from what is known about an unknown, or about a coordinate of the state at the start
/// of an experiment, and its derivative, in units of the standard deviation.
struct Prior {
    plan: Option<usize>,
    coordinate: usize,
    error: f64,
    slope: f64,
}

/// Residuals at the last linearisation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Residuals {
    pub(super) count: usize,
    /// Sum of squares in units of the standard deviations.
    pub(super) squares: f64,
    /// Largest gap between two segments.
    pub(super) gap: f64,
}

/// Segment of an experiment. The node is its index among those of all experiments.
#[derive(Clone, Copy)]
struct Place {
    plan: usize,
    segment: usize,
    node: usize,
}

/// Derivatives of the simulation of a segment by one column, or those of a part by several with
/// formulas.
struct Job {
    place: Place,
    columns: Vec<Column>,
    part: Option<usize>,
    derivatives: Vec<Derivative>,
}

impl<'p> Shooting<'p> {
    pub(super) fn new(unknowns: &'p [Unknown], mut plans: Vec<Plan>) -> Result<Self> {
        let mut nodes = Vec::new();
        for plan in &mut plans {
            plan.formulas = Formulas::unknowns(plan, unknowns)?;
            for segment in 0..plan.segments() {
                nodes.push(first_state(plan, segment)?);
            }
        }
        let coordinates = unknowns.iter().map(|unknown| unknown.coordinate(unknown.first)).collect();
        let present = Point { coordinates, nodes, base: Vec::new(), version: 1 };
        let n = unknowns.len();
        Ok(Self {
            unknowns,
            plans,
            workers: (0..rayon::current_num_threads()).map(|_| Worker::default()).collect(),
            candidate: present.clone(),
            present,
            points: 1,
            chains: Vec::new(),
            total: DMatrix::zeros(n + 1, n + 1),
            penalty: 1.0,
            weights: Vec::new(),
            residuals: Residuals::default(),
            costs: Vec::new(),
        })
    }

    /// Sets the weight of the gaps relative to that of the readings.
    pub(super) fn set_penalty(&mut self, penalty: f64) {
        self.penalty = penalty;
        self.weights.clear();
    }

    /// Returns `true` if an experiment has several segments.
    pub(super) fn has_gaps(&self) -> bool {
        self.plans.iter().any(|plan| plan.segments() > 1)
    }

    fn places(&self) -> Vec<Place> {
        let all = self.plans.iter().enumerate();
        let all = all.flat_map(|(index, plan)| (0..plan.segments()).map(move |segment| (index, segment)));
        all.enumerate().map(|(node, (plan, segment))| Place { plan, segment, node }).collect()
    }

    fn is_last(&self, place: Place) -> bool {
        place.segment + 1 == self.plans[place.plan].segments()
    }

    /// Returns the jobs of a segment.
    fn jobs(&self, place: Place) -> Vec<Job> {
        let plan = &self.plans[place.plan];
        let states = plan.states(place.segment).iter().map(|&coordinate| Column::State(coordinate));
        let unknowns = (0..self.unknowns.len()).filter(|&index| self.unknowns[index].has_column());
        let columns = states.chain(unknowns.map(Column::Unknown));
        let (by_formulas, by_differences): (Vec<Column>, Vec<Column>) =
            columns.partition(|&column| plan.has_formula(column));
        let job = |columns, part| Job { place, columns, part, derivatives: Vec::new() };
        let differences = by_differences.into_iter().map(|column| job(vec![column], None));
        let parts = if by_formulas.is_empty() { 0 } else { (plan.steps(place.segment) + 1).div_ceil(PART) };
        let all_states = (0..plan.experiment.uncertainty.len()).map(Column::State);
        let is_unknown = |column: &&Column| matches!(column, Column::Unknown(_));
        let later: Vec<Column> = all_states.chain(by_formulas.iter().filter(is_unknown).copied()).collect();
        let formulas = once(by_formulas).chain(repeat(later)).take(parts).enumerate();
        formulas.map(|(part, columns)| job(columns, Some(part))).chain(differences).collect()
    }

    /// Computes the derivatives of jobs at the present point. Returns `false` if a simulation
    /// becomes unstable.
    fn differentiate(&mut self, jobs: &mut [Job]) -> Result<bool> {
        let Self { unknowns, plans, workers, present, .. } = self;
        let values = present.values(unknowns);
        for_each_item(workers, jobs, |worker, _, job| {
            let Job { place: Place { plan, segment, node }, columns, part, derivatives } = job;
            let (plan, state, base) = (&plans[*plan], &present.nodes[*node], &present.base[*node]);
            if let Some(part) = *part {
                *derivatives = worker.by_formulas(plan, columns, &values, &base.states[part * PART..])?;
                return Ok(());
            }
            for &column in &*columns {
                derivatives.extend(worker.difference(plan, *segment, state, column, &values, base)?);
            }
            Ok(())
        })?;
        let is_stable = jobs.iter().all(|job| job.derivatives.len() == job.columns.len());
        let mut first: &mut [Derivative] = &mut [];
        for Job { part, derivatives, .. } in jobs {
            match part {
                Some(0) => first = derivatives,
                Some(_) => append(first, &std::mem::take(derivatives)),
                None => {}
            }
        }
        Ok(is_stable)
    }

    /// Simulates all segments from a point. One that becomes unstable has no readings.
    fn simulate(&mut self, is_candidate: bool) -> Result<()> {
        let mut jobs: Vec<_> = self.places().into_iter().map(|place| (place, Simulated::default())).collect();
        let Self { unknowns, plans, workers, present, candidate, .. } = self;
        let point = if is_candidate { candidate } else { present };
        let values = point.values(unknowns);
        for_each_item(workers, &mut jobs, |worker, _, (Place { plan, segment, node }, result)| {
            *result = worker.simulate(&plans[*plan], *segment, &point.nodes[*node], None, &values)?;
            Ok(())
        })?;
        point.base = jobs.into_iter().map(|(_, result)| result).collect();
        Ok(())
    }

    /// Simulates all segments from the present point unless that is done.
    fn simulate_present(&mut self) -> Result<()> {
        if self.present.base.is_empty() { self.simulate(false) } else { Ok(()) }
    }

    /// Returns the errors of all measurements at the present point. A simulation that becomes
    /// unstable has no readings.
    pub(super) fn errors(&mut self) -> Result<Vec<MeasurementError>> {
        self.simulate_present()?;
        let mut errors = Vec::new();
        let mut bases = self.present.base.iter();
        for plan in &self.plans {
            let segments = bases.by_ref().take(plan.segments()).enumerate().filter(|(_, base)| base.is_stable());
            let segments: Vec<_> = segments.map(|(segment, base)| (segment, &base.readings[..])).collect();
            errors.extend(errors_of(plan, &segments, &self.present.values(self.unknowns))?);
        }
        Ok(errors)
    }

    /// Returns the penalty of the gap after a segment, given the state at its end.
    fn gap_cost(&self, place: Place, end: &[f64], point: &Point) -> Result<f64> {
        if self.is_last(place) {
            return Ok(0.0);
        }
        let model = &self.plans[place.plan].experiment.model;
        let mut gap = vec![0.0; self.plans[place.plan].experiment.uncertainty.len()];
        model.differentiate_state_into(&point.nodes[place.node + 1], end, &mut gap)?;
        Ok(gap.iter().zip(&self.weights[place.node]).map(|(gap, weight)| 0.5 * (gap * weight).powi(2)).sum())
    }

    /// Returns the priors of unknowns and of first states, and their cost.
    fn priors(&self, point: &Point) -> Result<(Vec<Prior>, f64)> {
        let mut priors = Vec::new();
        let values = point.values(self.unknowns);
        for (coordinate, unknown) in self.unknowns.iter().enumerate() {
            if let Some((mean, deviation)) = unknown.prior {
                let error = (values.value(coordinate) - mean) / deviation;
                priors.push(Prior { plan: None, coordinate, error, slope: values.slope(coordinate) / deviation });
            }
        }
        for Place { plan, node, .. } in self.places().into_iter().filter(|place| place.segment == 0) {
            let (states, experiment) = (self.plans[plan].states(0), &self.plans[plan].experiment);
            let mut errors = vec![0.0; experiment.uncertainty.len()];
            if !states.is_empty() {
                let known = first_state(&self.plans[plan], 0)?;
                experiment.model.differentiate_state_into(&known, &point.nodes[node], &mut errors)?;
            }
            for (coordinate, &state) in states.iter().enumerate() {
                let deviation = experiment.uncertainty[state];
                let (error, slope) = (errors[state] / deviation, 1.0 / deviation);
                priors.push(Prior { plan: Some(plan), coordinate, error, slope });
            }
        }
        let cost = priors.iter().map(|prior| 0.5 * prior.error.powi(2)).sum();
        Ok((priors, cost))
    }

    /// Adds the priors to the model of the cost. Returns their cost.
    fn add_priors(&mut self) -> Result<f64> {
        let n = self.unknowns.len();
        let (priors, cost) = self.priors(&self.present)?;
        for Prior { plan, coordinate, error, slope } in priors {
            if let Some(plan) = plan {
                self.chains[plan].add_prior(coordinate, error, slope);
            } else {
                self.total[(coordinate, coordinate)] += slope * slope;
                self.total[(coordinate, n)] += slope * error;
            }
        }
        Ok(cost)
    }

    /// Returns the state at the end of a segment as a function of `[x; θ; 1]`, relative to the
    /// start of the next one.
    fn end(&self, place: Place, derivatives: &[&Derivative]) -> Result<DMatrix<f64>> {
        let plan = &self.plans[place.plan];
        let columns = plan.states(place.segment).len() + self.unknowns.len();
        let mut end = DMatrix::zeros(plan.experiment.uncertainty.len(), columns + 1);
        let (next, base) = (&self.present.nodes[place.node + 1], &self.present.base[place.node].end);
        plan.experiment.model.differentiate_state_into(next, base, end.column_mut(columns).as_mut_slice())?;
        for derivative in derivatives {
            end.column_mut(plan.column(place.segment, derivative.column)).copy_from_slice(&derivative.end);
        }
        Ok(end)
    }
}

/// Appends those of the next steps to derivatives. They are by all coordinates of the state at the
/// start of these steps, and by the same unknowns.
fn append(derivatives: &mut [Derivative], next: &[Derivative]) {
    for Derivative { column, readings, end } in derivatives {
        let length = readings.len();
        readings.resize(length + next.first().map_or(0, |one| one.readings.len()), 0.0);
        let start = std::mem::replace(end, vec![0.0; end.len()]);
        for other in next {
            let factor = match other.column {
                Column::State(coordinate) => start[coordinate],
                unknown @ Column::Unknown(_) => f64::from(unknown == *column),
            };
            if factor != 0.0 {
                add(&mut readings[length..], &other.readings, factor);
                add(end, &other.end, factor);
            }
        }
    }
}

impl Problem for Shooting<'_> {
    fn len(&self) -> usize {
        self.unknowns.len()
    }

    fn bounds(&self, lower: &mut [f64], upper: &mut [f64]) {
        for (index, unknown) in self.unknowns.iter().enumerate() {
            let (bounds, coordinate) = (unknown.bounds(), self.present.coordinates[index]);
            let longest = unknown.longest_step();
            // Rounding may have moved a coordinate beyond its bound.
            lower[index] = (bounds[0] - coordinate).clamp(-longest, 0.0);
            upper[index] = (bounds[1] - coordinate).clamp(0.0, longest);
        }
    }

    fn linearise(&mut self) -> Result<f64> {
        self.simulate_present()?;
        if !self.present.is_stable() {
            return Ok(f64::NAN);
        }
        let n = self.unknowns.len();
        self.chains = self.plans.iter().map(|plan| Chain::new(plan, n)).collect();
        self.total.fill(0.0);
        self.residuals = Residuals::default();
        let places = self.places();
        // Ends of all segments but the last, with the weights of the states after them.
        let mut ends: Vec<(Place, DMatrix<f64>)> = Vec::new();
        let mut weights = vec![Vec::new(); places.len()];
        let mut cost = 0.0;
        let columns = self.plans.iter().map(|plan| plan.experiment.uncertainty.len()).max().unwrap_or(0) + n;
        for places in places.chunks((COLUMNS_PER_THREAD * self.workers.len()).div_ceil(columns.max(1))) {
            let mut jobs: Vec<Job> = places.iter().flat_map(|&place| self.jobs(place)).collect();
            if !self.differentiate(&mut jobs)? {
                return Ok(f64::NAN);
            }
            for &place in places {
                let of_place = jobs.iter().filter(|job| job.place.node == place.node);
                let derivatives: Vec<&Derivative> = of_place.flat_map(|job| &job.derivatives).collect();
                let (values, base) = (self.present.values(self.unknowns), &self.present.base[place.node]);
                let Quadratic { cost: of_segment, matrix, count, squares } =
                    segment::quadratic(&self.plans[place.plan], place.segment, base, &derivatives, &values);
                self.chains[place.plan].add(place.segment, &matrix, &mut self.total);
                cost += of_segment;
                self.residuals.count += count;
                self.residuals.squares += squares;
                if place.segment > 0 {
                    let size = self.plans[place.plan].states(1).len();
                    let information = (0..size).map(|i| self.penalty * (1.0 + matrix[(i, i)]).sqrt());
                    weights[place.node - 1] = information.collect();
                }
                if !self.is_last(place) {
                    ends.push((place, self.end(place, &derivatives)?));
                }
            }
        }
        if self.weights.is_empty() {
            self.weights = weights;
        }
        for (place, end) in ends {
            let gap = end.column(end.ncols() - 1);
            self.residuals.gap = self.residuals.gap.max(gap.amax());
            cost += gap.iter().zip(&self.weights[place.node]).map(|(gap, w)| 0.5 * (gap * w).powi(2)).sum::<f64>();
            self.chains[place.plan].add_gap(place.segment, &end, &self.weights[place.node], &mut self.total);
        }
        cost += self.add_priors()?;
        self.costs.push(cost);
        Ok(cost)
    }

    fn damped(&mut self, damping: f64, hessian: &mut Matrix, gradient: &mut [f64]) -> Option<f64> {
        let n = self.unknowns.len();
        let mut total = self.total.clone();
        for chain in &mut self.chains {
            if !chain.eliminate(damping, &mut total) {
                return None;
            }
        }
        // The damping of the unknowns is that of the whole matrix, not of what remains.
        let change = &total - &self.total;
        hessian.transposed_mut().copy_from(&self.total.view((0, 0), (n, n)));
        damp(damping, hessian);
        let mut hessian = hessian.transposed_mut();
        hessian += change.view((0, 0), (n, n));
        gradient.copy_from_slice(&total.column(n).as_slice()[..n]);
        Some(-0.5 * change[(n, n)])
    }

    fn evaluate(&mut self, step: &[f64]) -> Result<f64> {
        let Self { candidate, present, chains, plans, .. } = self;
        for ((candidate, present), step) in candidate.coordinates.iter_mut().zip(&present.coordinates).zip(step) {
            *candidate = present + step;
        }
        let mut node = 0;
        for (plan, chain) in plans.iter().zip(chains) {
            for (segment, change) in chain.states(step).into_iter().enumerate() {
                candidate.nodes[node].copy_from_slice(&present.nodes[node]);
                let mut all = vec![0.0; plan.experiment.uncertainty.len()];
                for (&place, &value) in plan.states(segment).iter().zip(change.iter()) {
                    all[place] = value;
                }
                plan.experiment.model.integrate_state(&mut candidate.nodes[node], &all)?;
                node += 1;
            }
        }
        self.points += 1;
        self.candidate.version = self.points;
        match self.simulate(true) {
            Ok(()) if self.candidate.is_stable() => {}
            // Values with which the engine cannot compute are no candidate.
            Ok(()) | Err(Error::Engine { .. }) => return Ok(f64::INFINITY),
            Err(error) => return Err(error),
        }
        let (_, mut cost) = self.priors(&self.candidate)?;
        for (place, base) in self.places().into_iter().zip(&self.candidate.base) {
            let values = self.candidate.values(self.unknowns);
            cost += segment::cost(&self.plans[place.plan], place.segment, &base.readings, &values);
            cost += self.gap_cost(place, &base.end, &self.candidate)?;
        }
        Ok(cost)
    }

    fn accept(&mut self) {
        std::mem::swap(&mut self.present, &mut self.candidate);
    }
}
