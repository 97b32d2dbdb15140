//! The controller that plans in a second thread.

use std::fmt;
use std::mem;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{self, JoinHandle};

use super::{PlanReport, Planner};
use crate::control::TimeVaryingLqr;
use crate::control::ilqr::TrajectoryCost;
use crate::controller::Controller;
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result, catch_panic};
use crate::model::{Model, Relation};
use crate::parallel::is_edited;

/// Controller that plans in a second thread, and follows the newest plan with its gains.
///
/// The planner starts a plan from the present state as soon as the previous plan is finished. A
/// plan that took 20 ms is 20 ms old when the controller receives it; its table starts at the time
/// of the state that it was planned from, so the controller enters it at the present time. The
/// horizon must be longer than the time of two plans, and the simulation must run in real time: if
/// it runs faster, plans become older.
///
/// [`control`](Controller::control) does not wait for the planner and does not allocate. If the
/// planner delivers a plan at that moment, the controller receives it in its next step. Only after
/// a reset of the simulation, as in [`new`](Self::new), does it wait for a plan from the new state.
///
/// The number of plans depends on the speed of the machine, so a run is not reproducible.
/// [`PredictiveController`](super::PredictiveController) plans in the thread of the simulation, and
/// its runs are.
///
/// A planner that uses several [threads](crate::control::ilqr::IlqrOptions::threads) runs them in
/// rayon's global pool.
///
/// ```
/// use mujoco_safe::control::ilqr::IlqrOptions;
/// use mujoco_safe::control::predictive::{IlqrPlanner, ThreadedPredictiveController};
/// use mujoco_safe::control::residual::{Controls, JointPosition, JointVelocity, ResidualCost, Term};
/// use mujoco_safe::{Controller, Data, sample};
/// use std::time::{Duration, Instant};
///
/// let mut data = Data::new(sample::cartpole())?;
/// let model = data.model().clone();
/// let cost = ResidualCost::new(
///     &model,
///     [
///         Term::new("position", JointPosition::all(&model)).with_terminal_weight(100.0),
///         Term::new("velocity", JointVelocity::all(&model)).with_weight(0.01).with_terminal_weight(10.0),
///         Term::new("effort", Controls::new(&model)).with_weight(1e-2),
///     ],
/// )?;
/// let planner = IlqrPlanner::new(&model, 60, IlqrOptions::default().with_iterations(1))?;
/// data.qpos_mut()[1] = 0.1;
/// let mut controller = ThreadedPredictiveController::new(&data, planner, cost)?;
/// let start = Instant::now();
/// for _ in 0..50 {
///     controller.control(&mut data)?;
///     data.step()?;
///     // Real time: wait until the clock has reached the time of the simulation.
///     std::thread::sleep(Duration::from_secs_f64(data.time()).saturating_sub(start.elapsed()));
/// }
/// controller.wait()?;
/// assert!(controller.plans() > 1);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub struct ThreadedPredictiveController<P, C> {
    link: Arc<Link<P, C>>,
    /// Present until the controller is dropped.
    thread: Option<JoinHandle<()>>,
    policy: TimeVaryingLqr,
    report: PlanReport,
    plans: u64,
    /// Time of the last step, s.
    time: f64,
}

/// Shared state of the controller and of the planner's thread.
struct Link<P, C> {
    exchange: Mutex<Exchange>,
    /// Signals a change of the exchange.
    changed: Condvar,
    edits: Mutex<Vec<Edit<P, C>>>,
}

type Edit<P, C> = Box<dyn FnOnce(&mut P, &mut C) + Send>;

struct Exchange {
    state: PlanState,
    /// The controller was dropped, or the planner panicked: its thread ends.
    is_closed: bool,
}

/// Owner of the job.
enum PlanState {
    /// The controller has taken the previous plan.
    Idle(Box<Job>),
    Requested(Box<Job>),
    Planning,
    Finished(Box<Job>, Result<PlanReport>),
    /// The planner panicked with this message, and its thread has ended.
    Panicked(String),
}

/// State to plan from, and buffer for the plan.
struct Job {
    model: Arc<Model>,
    /// Values of [`StateSpec::INTEGRATION`].
    state: Vec<f64>,
    /// Discard the previous plan first.
    reset: bool,
    policy: TimeVaryingLqr,
}

impl Job {
    fn observe(&mut self, data: &Data, reset: bool) -> Result<()> {
        if is_edited(&self.model, data, "the simulation of a predictive controller")? {
            self.model = data.model().clone();
        }
        self.reset |= reset;
        data.state_into(StateSpec::INTEGRATION, &mut self.state)
    }

    fn plan(&mut self, planner: &mut impl Planner, cost: &impl TrajectoryCost, data: &mut Data) -> Result<PlanReport> {
        if self.model.relation(data.model()) != Relation::Same || data.check_usable().is_err() {
            // The model may have been edited since, or a plan may have failed.
            *data = Data::new(self.model.clone())?;
        }
        if mem::take(&mut self.reset) {
            planner.reset();
        }
        data.set_state(StateSpec::INTEGRATION, &self.state)?;
        planner.plan(data, cost, &mut self.policy)
    }
}

impl<P: Planner, C: TrajectoryCost> Link<P, C> {
    fn lock(&self) -> MutexGuard<'_, Exchange> {
        self.exchange.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits while a plan is requested or in progress.
    fn wait(&self) -> MutexGuard<'_, Exchange> {
        let is_busy = |exchange: &mut Exchange| matches!(exchange.state, PlanState::Requested(_) | PlanState::Planning);
        self.changed.wait_while(self.lock(), is_busy).unwrap_or_else(PoisonError::into_inner)
    }

    /// Plans until the controller is dropped or the planner panics.
    fn work(&self, mut planner: P, mut cost: C, mut data: Data) {
        // Unlocked only while it plans or waits, so that a controller that has noticed a new plan
        // can lock the exchange at once.
        let mut exchange = self.lock();
        while !exchange.is_closed {
            match mem::replace(&mut exchange.state, PlanState::Planning) {
                PlanState::Requested(mut job) => {
                    drop(exchange);
                    let planned = catch_panic(|| {
                        let edits = mem::take(&mut *self.edits.lock().unwrap_or_else(PoisonError::into_inner));
                        for edit in edits {
                            edit(&mut planner, &mut cost);
                        }
                        job.plan(&mut planner, &cost, &mut data)
                    });
                    exchange = self.lock();
                    exchange.is_closed |= planned.is_err();
                    exchange.state = match planned {
                        Ok(result) => PlanState::Finished(job, result),
                        Err(message) => PlanState::Panicked(message),
                    };
                    self.changed.notify_all();
                }
                other => {
                    exchange.state = other;
                    exchange = self.changed.wait(exchange).unwrap_or_else(PoisonError::into_inner);
                }
            }
        }
    }
}

impl<P: Planner + 'static, C: TrajectoryCost + Send + 'static> ThreadedPredictiveController<P, C> {
    /// Starts the thread of the planner, and waits for the first plan from the present state of
    /// `data`.
    ///
    /// # Errors
    ///
    /// The errors of [`Planner::plan`], and [`Error::Panicked`] if the planner panics.
    ///
    /// # Panics
    ///
    /// If the operating system cannot create a thread.
    pub fn new(data: &Data, planner: P, cost: C) -> Result<Self> {
        let policy = TimeVaryingLqr::hold_controls(data, planner.horizon())?;
        let model = data.model().clone();
        let observed = Data::new(model.clone())?;
        let state = vec![0.0; model.state_size(StateSpec::INTEGRATION)];
        // The controller and the planner write to separate tables.
        let buffer = TimeVaryingLqr::hold_controls(data, planner.horizon())?;
        let job = Box::new(Job { model, state, reset: false, policy: buffer });
        let link = Arc::new(Link {
            exchange: Mutex::new(Exchange { state: PlanState::Idle(job), is_closed: false }),
            changed: Condvar::new(),
            edits: Mutex::default(),
        });
        let thread = thread::Builder::new().name("planner".to_owned()).spawn({
            let link = link.clone();
            move || link.work(planner, cost, observed)
        });
        let thread = Some(thread.expect("the operating system creates a thread"));
        let report = PlanReport { initial_cost: 0.0, cost: 0.0 };
        let mut controller = Self { link, thread, policy, report, plans: 0, time: data.time() };
        controller.plan_now(data)?;
        Ok(controller)
    }

    /// Returns the present plan.
    pub fn policy(&self) -> &TimeVaryingLqr {
        &self.policy
    }

    /// Returns the cost of the present plan.
    pub fn report(&self) -> PlanReport {
        self.report
    }

    /// Returns the number of plans that the controller has received.
    pub fn plans(&self) -> u64 {
        self.plans
    }

    /// Changes the planner or the cost, for example weights and targets, before the next plan. The
    /// planner's thread calls the closure.
    pub fn edit(&mut self, edit: impl FnOnce(&mut P, &mut C) + Send + 'static) {
        self.link.edits.lock().unwrap_or_else(PoisonError::into_inner).push(Box::new(edit));
    }

    /// Waits for the plan in progress, if any, and takes it.
    ///
    /// # Errors
    ///
    /// The errors of [`Planner::plan`], and [`Error::Panicked`] if the planner panicked.
    pub fn wait(&mut self) -> Result<()> {
        let link = self.link.clone();
        self.take(&mut link.wait())
    }

    /// Discards the plan, and plans from the initial controls and the present state of a
    /// simulation. Waits for the planner.
    ///
    /// # Errors
    ///
    /// As for [`wait`](Self::wait), and [`Error::OtherModel`] for a simulation of a model that was
    /// loaded separately.
    pub fn plan_now(&mut self, data: &Data) -> Result<()> {
        let link = self.link.clone();
        let mut exchange = link.wait();
        // The plan in progress is from before a reset, and so is its error.
        let _ = self.take(&mut exchange);
        self.request(&mut exchange, data, true)?;
        drop(exchange);
        self.wait()
    }

    /// Takes a finished plan.
    fn take(&mut self, exchange: &mut Exchange) -> Result<()> {
        match mem::replace(&mut exchange.state, PlanState::Planning) {
            PlanState::Finished(mut job, result) => {
                if let Ok(report) = result {
                    mem::swap(&mut self.policy, &mut job.policy);
                    self.report = report;
                    self.plans += 1;
                }
                exchange.state = PlanState::Idle(job);
                result.map(drop)
            }
            PlanState::Panicked(message) => {
                let error = Error::Panicked { what: "the planner", message: message.clone() };
                exchange.state = PlanState::Panicked(message);
                Err(error)
            }
            other => {
                exchange.state = other;
                Ok(())
            }
        }
    }

    /// Requests a plan if the planner is idle.
    fn request(&self, exchange: &mut Exchange, data: &Data, reset: bool) -> Result<()> {
        match mem::replace(&mut exchange.state, PlanState::Planning) {
            PlanState::Idle(mut job) => {
                let observed = job.observe(data, reset);
                exchange.state = if observed.is_ok() { PlanState::Requested(job) } else { PlanState::Idle(job) };
                self.link.changed.notify_all();
                observed
            }
            other => {
                exchange.state = other;
                Ok(())
            }
        }
    }
}

impl<P: Planner + 'static, C: TrajectoryCost + Send + 'static> Controller for ThreadedPredictiveController<P, C> {
    /// Takes the newest plan, requests another one if the planner is idle, and sets the controls.
    /// If the time of the simulation went back, because of a reset, waits for a plan from the
    /// present state.
    ///
    /// # Errors
    ///
    /// The errors of [`Planner::plan`], once for each failed plan; the next plan then starts from
    /// the initial controls or, for some planners, from the previous plan. [`Error::Panicked`] in
    /// this and in all later steps if the planner panicked. [`Error::OtherModel`] for a simulation
    /// of a model that was loaded separately. The present plan remains available from
    /// [`policy`](ThreadedPredictiveController::policy).
    fn control(&mut self, data: &mut Data) -> Result<()> {
        let was_reset = data.time() < self.time;
        self.time = data.time();
        if was_reset {
            self.plan_now(data)?;
        }
        let link = self.link.clone();
        let exchange = match link.exchange.try_lock() {
            Ok(exchange) => Some(exchange),
            Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        };
        if let Some(mut exchange) = exchange {
            let taken = self.take(&mut exchange);
            self.request(&mut exchange, data, false)?;
            taken?;
        }
        self.policy.control(data)
    }
}

impl<P, C> Drop for ThreadedPredictiveController<P, C> {
    /// Waits for the end of the plan in progress.
    fn drop(&mut self) {
        self.link.exchange.lock().unwrap_or_else(PoisonError::into_inner).is_closed = true;
        self.link.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            // Panics of the planner were caught, and reported by `control`.
            let _ = thread.join();
        }
    }
}

impl<P, C> fmt::Debug for ThreadedPredictiveController<P, C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let steps = self.policy.steps();
        write!(f, "ThreadedPredictiveController: {} plans of {steps} steps, {:?}", self.plans, self.report)
    }
}
