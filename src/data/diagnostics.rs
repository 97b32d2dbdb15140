//! Timers, statistics of the constraint solver, and a text dump of all quantities.

use std::fs::File;
use std::path::Path;

use mujoco_sys::{self as sys, guard, mjSolverStat};

use super::{Data, Stage};
use crate::error::{Error, Result};
use crate::ffi;
use crate::macros::engine_enum;

engine_enum! {
    /// Timed part of the computation.
    Timer {
        /// Complete step.
        Step = mjTIMER_STEP,
        /// Forward dynamics.
        Forward = mjTIMER_FORWARD,
        /// Inverse dynamics.
        Inverse = mjTIMER_INVERSE,
        /// Position-dependent quantities.
        Position = mjTIMER_POSITION,
        /// Velocity-dependent quantities.
        Velocity = mjTIMER_VELOCITY,
        /// Actuator forces.
        Actuation = mjTIMER_ACTUATION,
        /// Accelerations without constraints. Zero with engines from 3.0.0.
        Acceleration = mjTIMER_ACCELERATION,
        /// The constraint solver.
        Constraint = mjTIMER_CONSTRAINT,
        /// Part of [`Position`](Self::Position): kinematics, centres of mass, tendons,
        /// transmissions.
        PositionKinematics = mjTIMER_POS_KINEMATICS,
        /// Part of [`Position`](Self::Position): the inertia matrix.
        PositionInertia = mjTIMER_POS_INERTIA,
        /// Part of [`Position`](Self::Position): collision detection.
        PositionCollision = mjTIMER_POS_COLLISION,
        /// Part of [`Position`](Self::Position): creation of the constraint rows.
        PositionMake = mjTIMER_POS_MAKE,
        /// Part of [`Position`](Self::Position): the inverse inertia in constraint space.
        PositionProject = mjTIMER_POS_PROJECT,
    }
}

impl Timer {
    /// All timers, in the engine's order.
    pub const ALL: [Self; 13] = [
        Self::Step,
        Self::Forward,
        Self::Inverse,
        Self::Position,
        Self::Velocity,
        Self::Actuation,
        Self::Acceleration,
        Self::Constraint,
        Self::PositionKinematics,
        Self::PositionInertia,
        Self::PositionCollision,
        Self::PositionMake,
        Self::PositionProject,
    ];
}

/// Number and total duration of the computations of one part since the last reset.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct TimerCount {
    /// Total duration in the unit of the clock, which is seconds for
    /// [`enable_timers`](crate::data::enable_timers). Zero without a clock (`mjcb_time`).
    pub duration: f64,
    /// Number of computations. Counted without a clock too.
    pub number: usize,
}

/// Statistics of one iteration of the constraint solver. The engine scales costs by the mean
/// inertia and the number of degrees of freedom, so that they can be compared with the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[doc(alias = "mjSolverStat")]
pub struct SolverIteration {
    /// Decrease of the cost, scaled.
    pub improvement: f64,
    /// Norm of the gradient, scaled. Zero for PGS, which does not compute a gradient.
    pub gradient: f64,
    /// Slope at the end of the line search. Zero for PGS.
    pub lineslope: f64,
    /// Number of active constraints.
    pub nactive: usize,
    /// Number of constraints that became active or inactive.
    pub nchange: usize,
    /// Number of cost evaluations in the line search.
    pub neval: usize,
    /// Number of updates of the Cholesky factor in the line search.
    pub nupdate: usize,
}

impl SolverIteration {
    fn from_raw(raw: &mjSolverStat) -> Self {
        let count = |raw: i32| usize::try_from(raw).unwrap_or(0);
        Self {
            improvement: raw.improvement,
            gradient: raw.gradient,
            lineslope: raw.lineslope,
            nactive: count(raw.nactive),
            nchange: count(raw.nchange),
            neval: count(raw.neval),
            nupdate: count(raw.nupdate),
        }
    }
}

/// # Timers and solver statistics
impl Data {
    /// Returns the number and the total duration of the computations of a part since the last
    /// reset.
    ///
    /// The duration is zero unless the process has installed a clock
    /// ([`enable_timers`](crate::data::enable_timers)), because the engine does not include one.
    ///
    /// ```
    /// use mujoco_safe::data::Timer;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// for _ in 0..3 {
    ///     data.step()?;
    /// }
    /// assert_eq!(data.timer(Timer::Step).number, 3);
    /// for timer in Timer::ALL {
    ///     println!("{timer:?}: {:?}", data.timer(timer));
    /// }
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjTimerStat")]
    pub fn timer(&self, timer: Timer) -> TimerCount {
        let raw = usize::try_from(timer.raw()).ok().and_then(|index| self.raw().timer.get(index));
        let Some(raw) = raw else { return TimerCount::default() };
        TimerCount { duration: raw.duration, number: usize::try_from(raw.number).unwrap_or(0) }
    }

    /// Returns the statistics of each solver iteration of the last forward dynamics. The iterations
    /// of the no-slip solver follow the iterations of the main solver. Their number is at most
    /// 1000, which is the limit of 2.2.2. Engines from 3.0 can solve each island of constraints by
    /// itself ([`DisableFlags::ISLAND`](crate::model::DisableFlags::ISLAND)); these are the
    /// iterations of the first one.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.reset_to_key("squat")?;
    /// data.forward()?;
    /// for (index, iteration) in data.solver().enumerate() {
    ///     println!("{index}: {:e}, {} constraints", iteration.improvement, iteration.nactive);
    /// }
    /// assert!(data.solver().len() > 0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjSolverStat")]
    pub fn solver(&self) -> impl ExactSizeIterator<Item = SolverIteration> {
        self.solver_statistics(0).iter().map(SolverIteration::from_raw)
    }

    /// Returns the discrepancy between forward and inverse dynamics: the norm of the difference of
    /// the constraint forces, and the norm of the difference between all applied forces and
    /// `qfrc_inverse`. [`compare_fwd_inv`](Self::compare_fwd_inv) computes both, and so do `step`
    /// and `step2` while [`EnableFlags::FWDINV`](crate::model::EnableFlags::FWDINV) is set. They
    /// are zero without constraints. If the flag is cleared, the values are stale until the next
    /// reset.
    ///
    /// ```
    /// use mujoco_safe::model::EnableFlags;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.edit_model(|model| model.edit_options(|options| options.enable |= EnableFlags::FWDINV))?;
    /// data.reset_to_key("squat")?;
    /// data.step()?;
    /// assert!(data.solver_fwdinv().iter().all(|difference| *difference < 1e-3));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_compareFwdInv")]
    pub fn solver_fwdinv(&self) -> [f64; 2] {
        self.raw().solver_fwdinv
    }

    /// Writes all quantities to a human-readable text file. An existing file is overwritten.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::File`] if the file cannot be
    /// written, [`Error::Invalid`] for a path with a NUL byte, [`Error::Engine`], which poisons the
    /// data, if the engine's stack is too small for the full inertia matrix.
    ///
    /// ```no_run
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// data.print_to("humanoid.txt")?;
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_printData")]
    pub fn print_to(&mut self, path: impl AsRef<Path>) -> Result<()> {
        self.check_computed("print_to", Stage::Position)?;
        let path = path.as_ref();
        let name = ffi::c_string("the path of print_to", path.as_os_str().as_encoded_bytes())?;
        // The engine only raises a warning if it cannot open the file.
        File::create(path).map_err(Error::file(path))?;
        self.call_mut("mj_printData", |m, d| {
            // SAFETY: a NUL-terminated path, and rows of tendons and constraints that were computed
            // for this model.
            unsafe { guard::mj_print_data(m, d, name.as_ptr()) }
        })
    }
}
