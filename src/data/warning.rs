//! The engine's warnings, counted and logged.
//!
//! `mj_warning` prints the first warning of each type through a text buffer that all threads of the process share, which is a
//! data race in 2.2.2 as soon as two simulations warn at once. It prints only while the counter is zero. So the counters are
//! lifted for the time of a call, the engine counts in silence, and what it counted is read off and logged afterwards. A
//! counter that came back below the lift tells that the engine has reset the data.

use std::cmp::Ordering;
use std::fmt;

use mujoco_sys::{self as sys, mjData, mjWarningStat};

use super::Data;
use crate::engine::LOG_TARGET;
use crate::id::Kind;

const COUNT: usize = sys::mjNWARNING as usize;

/// What the engine warns about while it simulates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[doc(alias = "mjtWarning")]
pub enum Warning {
    /// The inertia matrix is singular, or nearly so, at a degree of freedom.
    Inertia,
    /// There are more contacts than `nconmax`; the rest is ignored.
    ContactFull,
    /// There are more constraints than `njmax`; the rest is ignored.
    ConstraintFull,
    /// The scene has more geoms than it has room for.
    VisualGeomFull,
    /// A number in `qpos` is out of range.
    BadQpos,
    /// A number in `qvel` is out of range.
    BadQvel,
    /// A number in `qacc` is out of range.
    BadQacc,
    /// A number in `ctrl` is out of range.
    BadCtrl,
}

impl Warning {
    /// All of them, in the engine's order.
    pub(crate) const ALL: [Self; COUNT] = [
        Self::Inertia,
        Self::ContactFull,
        Self::ConstraintFull,
        Self::VisualGeomFull,
        Self::BadQpos,
        Self::BadQvel,
        Self::BadQacc,
        Self::BadCtrl,
    ];

    /// What the number that comes with a warning means.
    pub(crate) fn message(self, info: i32, data: &Data) -> String {
        let time = data.time();
        match self {
            Self::Inertia => format!(
                "the inertia matrix is nearly singular at degree of freedom {info}; check the model (time {time} s)"
            ),
            Self::ContactFull => {
                format!("more than the {info} contacts that nconmax allows; increase it (time {time} s)")
            }
            Self::ConstraintFull => {
                format!("more than the {info} constraints that njmax allows; increase it (time {time} s)")
            }
            Self::VisualGeomFull => format!("more than the {info} geoms that the scene has room for"),
            Self::BadQpos => format!("qpos[{info}] is not a number or huge (time {time} s)"),
            Self::BadQvel => format!("qvel[{info}] is not a number or huge (time {time} s)"),
            Self::BadQacc => format!("qacc[{info}] is not a number or huge (time {time} s)"),
            Self::BadCtrl => format!(
                "ctrl[{info}]{} is not a number or huge (time {time} s)",
                usize::try_from(info)
                    .ok()
                    .and_then(|index| data.model().name_at(Kind::Actuator, index))
                    .map(|name| format!(" of actuator '{name}'"))
                    .unwrap_or_default()
            ),
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

/// How often a warning was raised since the last reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct WarningCount {
    /// How often.
    pub number: usize,
    /// What the last one was about: the index, or the limit that was reached.
    pub last_info: i32,
}

impl Data {
    /// How often a warning was raised since the last reset. The first of each kind is logged, under the target `mujoco`. Within
    /// a callback the count is that of the call so far.
    ///
    /// ```
    /// use mujoco_safe::{Data, Warning, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.step()?;
    /// assert_eq!(data.warning(Warning::ContactFull).number, 0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjWarningStat")]
    pub fn warning(&self, warning: Warning) -> WarningCount {
        let stat = &self.raw().warning[warning as usize];
        WarningCount { number: usize::try_from(stat.number % LIFT).unwrap_or(0), last_info: stat.lastinfo }
    }

    /// Logs the warnings whose counters were zero before.
    #[cold]
    pub(super) fn log_new_warnings(&self, before: &Lifted) {
        for (warning, old) in Warning::ALL.into_iter().zip(before.before) {
            let now = self.warning(warning);
            if old.number == 0 && now.number > 0 {
                log::warn!(target: LOG_TARGET, "{}", warning.message(now.last_info, self));
            }
        }
    }
}

/// By how much the counters are lifted: beyond what a call can count down or up to.
const LIFT: i32 = 1 << 30;

/// Puts down the counters of a copy, which was made in the middle of a call if they are lifted.
pub(super) fn lower_copied(data: &mut mjData) {
    for stat in &mut data.warning {
        stat.number %= LIFT;
    }
}

/// The counters of a data whose engine counters are lifted.
pub(super) struct Lifted {
    before: [mjWarningStat; COUNT],
}

/// What the engine did to the counters.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Counted {
    /// No warning.
    Nothing,
    /// At least one.
    Warned,
    /// The engine has reset the data.
    Reset,
}

impl Lifted {
    #[inline]
    pub(super) fn lift(data: &mut mjData) -> Self {
        // Whole, because that is a handful of vector instructions.
        Self { before: std::mem::replace(&mut data.warning, [mjWarningStat { lastinfo: 0, number: LIFT }; COUNT]) }
    }

    /// Puts the counters back, with what was counted meanwhile.
    #[inline]
    pub(super) fn lower(&self, data: &mut mjData) -> Counted {
        // A warning sets a bit below the lift, and a reset zeroes all of the counters at once, so no other bit than that of the lift
        // means that none has changed.
        if data.warning.iter().fold(0, |bits, stat| bits | stat.number) == LIFT {
            data.warning = self.before;
            Counted::Nothing
        } else {
            self.lower_changed(data)
        }
    }

    #[cold]
    fn lower_changed(&self, data: &mut mjData) -> Counted {
        let lowered = self.before.iter().zip(&mut data.warning).map(|(before, stat)| match stat.number.cmp(&LIFT) {
            Ordering::Equal => {
                *stat = *before;
                Counted::Nothing
            }
            Ordering::Greater => {
                stat.number = before.number.saturating_add(stat.number - LIFT);
                Counted::Warned
            }
            Ordering::Less => Counted::Reset,
        });
        lowered.max().unwrap_or(Counted::Nothing)
    }
}

#[cfg(test)]
mod tests {
    use mujoco_sys::mjWarningStat;

    use super::{Counted, Lifted};
    use crate::{Data, sample};

    /// Lifts counters of 3, has the engine's part done by `engine`, and lowers them again.
    fn lowered(engine: impl FnOnce(&mut [mjWarningStat])) -> (Counted, Vec<(i32, i32)>) {
        let mut data = Data::new(sample::cartpole()).unwrap();
        data.raw_mut().warning.fill(mjWarningStat { lastinfo: 7, number: 3 });
        let lifted = Lifted::lift(data.raw_mut());
        engine(&mut data.raw_mut().warning);
        let counted = lifted.lower(data.raw_mut());
        (counted, data.raw().warning.iter().map(|stat| (stat.number, stat.lastinfo)).collect())
    }

    #[test]
    fn counters_that_nothing_was_counted_on_are_as_before() {
        let (counted, stats) = lowered(|_| ());
        assert!(counted == Counted::Nothing && stats == [(3, 7); 8]);
    }

    #[test]
    fn a_warning_adds_to_its_counter_only() {
        let (counted, stats) = lowered(|warning| {
            warning[1].number += 2;
            warning[1].lastinfo = 5;
        });
        assert!(counted == Counted::Warned);
        assert_eq!((stats[0], stats[1], stats[2]), ((3, 7), (5, 5), (3, 7)));
    }

    #[test]
    fn a_reset_by_the_engine_is_told_from_a_warning() {
        let (counted, stats) = lowered(|warning| {
            warning.fill(mjWarningStat { lastinfo: 0, number: 0 });
            warning[6] = mjWarningStat { lastinfo: 1, number: 1 };
        });
        assert!(counted == Counted::Reset);
        assert_eq!((stats[0], stats[6]), ((0, 0), (1, 1)));
    }
}
