//! What the constraint solver did, and how long each part of a step took.

use mujoco_sys::{self as sys, mjSolverStat};

use super::Data;
use crate::enums::engine_enum;

engine_enum! {
    /// A part of the computation whose time is taken.
    #[doc(alias = "mjtTimer")]
    Timer {
        /// A whole step.
        Step = mjTIMER_STEP,
        /// Forward dynamics.
        Forward = mjTIMER_FORWARD,
        /// Inverse dynamics.
        Inverse = mjTIMER_INVERSE,
        /// What depends on positions.
        Position = mjTIMER_POSITION,
        /// What depends on velocities.
        Velocity = mjTIMER_VELOCITY,
        /// Actuator forces.
        Actuation = mjTIMER_ACTUATION,
        /// Accelerations without constraints.
        Acceleration = mjTIMER_ACCELERATION,
        /// The constraint solver.
        Constraint = mjTIMER_CONSTRAINT,
        /// Of what depends on positions: kinematics, centres of mass, tendons, transmissions.
        PositionKinematics = mjTIMER_POS_KINEMATICS,
        /// Of what depends on positions: the inertia matrix.
        PositionInertia = mjTIMER_POS_INERTIA,
        /// Of what depends on positions: collision detection.
        PositionCollision = mjTIMER_POS_COLLISION,
        /// Of what depends on positions: making the constraints.
        PositionMake = mjTIMER_POS_MAKE,
        /// Of what depends on positions: the constraints' inertia.
        PositionProject = mjTIMER_POS_PROJECT,
    }
}

impl Timer {
    /// All of them, in the engine's order.
    pub const ALL: [Self; sys::mjNTIMER as usize] = [
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

/// How often a part was computed since the last reset, and how long that took.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct TimerCount {
    /// All the time it took, in the unit of the process's clock. Zero unless there is a clock (`mjcb_time`).
    pub duration: f64,
    /// How often. This is counted without a clock too.
    pub number: usize,
}

/// What the constraint solver did in one iteration. The engine scales costs by the mean inertia and the number of degrees of
/// freedom, so that they can be compared with the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[doc(alias = "mjSolverStat")]
pub struct SolverIteration {
    /// By how much the cost became smaller, scaled.
    pub improvement: f64,
    /// The norm of the gradient, scaled. Zero for PGS, which has none.
    pub gradient: f64,
    /// The slope where the line search ended. Zero for PGS.
    pub lineslope: f64,
    /// How many constraints are active.
    pub nactive: usize,
    /// How many constraints became active or inactive.
    pub nchange: usize,
    /// How often the line search computed the cost.
    pub neval: usize,
    /// How often the line search updated the Cholesky factor.
    pub nupdate: usize,
}

impl From<&mjSolverStat> for SolverIteration {
    fn from(raw: &mjSolverStat) -> Self {
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

impl Data {
    /// How often a part was computed since the last reset, and how long that took.
    ///
    /// The duration is zero unless the process has a clock (`mjcb_time`), for the engine has none of its own.
    ///
    /// ```
    /// use mujoco_safe::{Data, Timer, sample};
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
        let raw = &self.raw().timer[timer.raw() as usize];
        TimerCount { duration: raw.duration, number: usize::try_from(raw.number).unwrap_or(0) }
    }

    /// What the constraint solver did in each iteration of the last forward dynamics, the no-slip solver's iterations behind the main
    /// solver's: as many as [`solver_iter`](Self::solver_iter) says, but the first thousand at most, which is what the engine
    /// keeps.
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
    /// assert_eq!(data.solver().len(), data.solver_iter());
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjSolverStat")]
    pub fn solver(&self) -> impl ExactSizeIterator<Item = SolverIteration> {
        let raw = self.raw();
        raw.solver[..self.solver_iter().min(raw.solver.len())].iter().map(SolverIteration::from)
    }

    /// Agreement of inverse with forward dynamics: the norm of the difference of the constraint forces, and that of the difference
    /// between all forces applied and `qfrc_inverse`. [`compare_fwd_inv`](Self::compare_fwd_inv) computes both numbers, and so do
    /// `step` and `step2` while [`EnableFlags::FWDINV`](crate::EnableFlags::FWDINV) is set. They are zero if there are no
    /// constraints. A program that clears the flag reads old numbers until the next reset.
    ///
    /// ```
    /// use mujoco_safe::{Data, EnableFlags, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.edit_model(|model| model.options(|options| options.enable |= EnableFlags::FWDINV))??;
    /// data.reset_to_key("squat")?;
    /// data.step()?;
    /// assert!(data.solver_fwdinv().iter().all(|difference| *difference < 1e-3));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_compareFwdInv")]
    pub fn solver_fwdinv(&self) -> [f64; 2] {
        self.raw().solver_fwdinv
    }
}
