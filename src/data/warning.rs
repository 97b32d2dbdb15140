//! Counters of the engine's warnings, and their log messages.
//!
//! `mj_warning` prints the first warning of each type through a text buffer that all threads of the
//! process share, which is a data race in 2.2.2 when two simulations warn at the same time. It
//! prints only while the counter of the type is zero. During a call the counters therefore start at
//! [`BASE`] instead: the engine counts without printing, and the new warnings are read from the
//! counters and logged afterwards. A counter below `BASE` after the call shows that the engine has
//! reset the data.

use std::cmp::Ordering;
use std::ffi::c_int;
use std::fmt;
use std::mem::MaybeUninit;

use mujoco_sys::{self as sys, guard, mjData, mjModel, mjWarningStat};

use super::Data;
use crate::error::{Instability, Result, UnstableField};
use crate::kind::Kind;
use crate::messages;

const COUNT: usize = sys::mjNWARNING as usize;

/// Type of warning that the engine raises during a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Warning {
    /// The inertia matrix is singular, or nearly so, at a degree of freedom.
    Inertia,
    /// The number of contacts exceeds `nconmax`, or since 2.3 the memory of the simulation; the
    /// engine ignores the rest.
    ContactFull,
    /// The number of constraints exceeds `njmax`, or since 2.3 the memory of the simulation; the
    /// engine ignores the rest.
    ConstraintFull,
    /// The number of geoms exceeds the capacity of the scene.
    VisualGeomFull,
    /// A value in `qpos` is out of range.
    BadQpos,
    /// A value in `qvel` is out of range.
    BadQvel,
    /// A value in `qacc` is out of range.
    BadQacc,
    /// A value in `ctrl` is out of range.
    BadCtrl,
}

impl Warning {
    /// All types, in the engine's order.
    pub(crate) const ALL: [Self; 8] = [
        Self::Inertia,
        Self::ContactFull,
        Self::ConstraintFull,
        Self::VisualGeomFull,
        Self::BadQpos,
        Self::BadQvel,
        Self::BadQacc,
        Self::BadCtrl,
    ];

    /// Returns the index of the warning's counter, or `None` for a warning that the engine does not
    /// have.
    const fn index(self) -> Option<usize> {
        let index = match self {
            Self::Inertia => sys::mjWARN_INERTIA,
            Self::ContactFull => sys::mjWARN_CONTACTFULL,
            Self::ConstraintFull => sys::mjWARN_CNSTRFULL,
            Self::VisualGeomFull => sys::mjWARN_VGEOMFULL,
            Self::BadQpos => sys::mjWARN_BADQPOS,
            Self::BadQvel => sys::mjWARN_BADQVEL,
            Self::BadQacc => sys::mjWARN_BADQACC,
            Self::BadCtrl => sys::mjWARN_BADCTRL,
        };
        if (index as usize) < COUNT { Some(index as usize) } else { None }
    }

    /// Returns the log message for a warning and the value that the engine stores with it.
    pub(crate) fn message(self, info: i32, data: &Data) -> String {
        let time = data.time();
        match self {
            Self::Inertia => format!(
                "the inertia matrix is nearly singular at degree of freedom {info}; check the model (time {time} s)"
            ),
            Self::ContactFull if cfg!(engine_since = "2.3.0") => {
                format!(
                    "the memory of the simulation is too small for {info} contacts; increase memory in <size> (time {time} s)"
                )
            }
            Self::ConstraintFull if cfg!(engine_since = "2.3.0") => {
                format!(
                    "memory for the constraints needs more than {info} bytes; increase memory in <size> (time {time} s)"
                )
            }
            Self::ContactFull => {
                format!("more than the {info} contacts that nconmax allows; increase it (time {time} s)")
            }
            Self::ConstraintFull => {
                format!("more than the {info} constraints that njmax allows; increase it (time {time} s)")
            }
            Self::VisualGeomFull => format!("more than the {info} geoms that fit in the scene"),
            Self::BadQpos => format!("qpos[{info}] is not between -1e10 and 1e10 (time {time} s)"),
            Self::BadQvel => format!("qvel[{info}] is not between -1e10 and 1e10 (time {time} s)"),
            Self::BadQacc => format!("qacc[{info}] is not between -1e10 and 1e10 (time {time} s)"),
            Self::BadCtrl => format!(
                "ctrl[{info}]{} is not between -1e10 and 1e10 (time {time} s)",
                usize::try_from(info)
                    .ok()
                    .filter(|&control| control < data.model().nu())
                    .and_then(|control| {
                        data.model().name_at(Kind::Actuator, data.model().actuator_of_control(control))
                    })
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

/// Number of warnings of one type since the last reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct WarningCount {
    /// Number of warnings.
    pub number: usize,
    /// Value of the last warning: an index, or the limit that was reached.
    pub lastinfo: i32,
}

/// Counters of all types of warnings, as the engine stores them.
pub(crate) type WarningCounters = [mjWarningStat; COUNT];

/// Start value of the counters during a call. It is so large that counters do not reach zero or
/// overflow within a call.
const BASE: i32 = 1 << 30;

/// Counters of a data while the engine uses counters that start at [`BASE`].
pub(super) struct SavedCounters {
    before: WarningCounters,
}

/// Change of the counters during a call.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum CounterChange {
    /// No warning.
    None,
    /// At least one warning.
    Warned,
    /// The engine has reset the data.
    Reset,
}

impl SavedCounters {
    /// Saves the engine's counters, and sets them to [`BASE`].
    #[inline]
    pub(super) fn replace(data: &mut mjData) -> Self {
        // Replacing the complete array takes a few vector instructions.
        Self { before: std::mem::replace(&mut data.warning, [mjWarningStat { lastinfo: 0, number: BASE }; COUNT]) }
    }

    /// Restores the counters, increased by the warnings of the call.
    #[inline]
    pub(super) fn restore(&self, data: &mut mjData) -> CounterChange {
        // A warning sets a bit below BASE, and a reset clears all counters at once. So no counter
        // has changed if the union of all bits is BASE.
        if data.warning.iter().fold(0, |bits, stat| bits | stat.number) == BASE {
            data.warning = self.before;
            CounterChange::None
        } else {
            self.restore_changed(data)
        }
    }

    #[cold]
    fn restore_changed(&self, data: &mut mjData) -> CounterChange {
        let changes = self.before.iter().zip(&mut data.warning).map(|(before, stat)| match stat.number.cmp(&BASE) {
            Ordering::Equal => {
                *stat = *before;
                CounterChange::None
            }
            Ordering::Greater => {
                stat.number = before.number.saturating_add(stat.number - BASE);
                CounterChange::Warned
            }
            Ordering::Less => CounterChange::Reset,
        });
        changes.max().unwrap_or(CounterChange::None)
    }
}

/// Restores the counters of a copy, which start at [`BASE`] if the copy was made during a call.
pub(super) fn restore_copied(data: &mut mjData) {
    for stat in &mut data.warning {
        stat.number %= BASE;
    }
}

/// Prevents the engine from printing warnings about a data. Its counters are meaningless
/// afterwards.
pub(crate) fn silence(data: &mut mjData) {
    for stat in &mut data.warning {
        stat.number = 1;
    }
}

/// Makes a call on a model for which a full constraint buffer must be handled, or be an error: see
/// [`guard::begin_full`].
pub(super) fn with_full_constraints(
    is_fatal: bool,
    model: *const mjModel,
    data: *mut mjData,
    call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
) -> c_int {
    const COUNTER: usize = sys::mjWARN_CNSTRFULL as usize;
    // SAFETY: `run` passes its own data, and nothing else refers to the counter. The engine calls
    // the warning handler only while the counter is zero.
    let before = std::mem::take(unsafe { &mut (*data).warning[COUNTER].number });
    let mut outer = MaybeUninit::uninit();
    // SAFETY: replaces the setting of this thread, which is restored below.
    unsafe { guard::begin_full(data, c_int::from(is_fatal), outer.as_mut_ptr()) };
    let mut status = call(model, data);
    let mut count = 0;
    // SAFETY: written above, and the setting refers to this data.
    if unsafe { guard::end_full(outer.as_ptr(), &raw mut count) } != 0 && status == guard::OK {
        status = guard::ERROR;
    }
    // SAFETY: as above.
    unsafe { (*data).warning[COUNTER].number = before.saturating_add(count) };
    status
}

/// # Warnings
impl Data {
    /// Returns the number of warnings of a type since the last reset. The first warning of each
    /// type is logged under the target `mujoco`. Within a callback only the warnings of the present
    /// call are counted.
    ///
    /// ```
    /// use mujoco_safe::data::Warning;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.step()?;
    /// assert_eq!(data.warning(Warning::ContactFull).number, 0);
    /// assert_eq!(data.warnings().count(), 0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjWarningStat")]
    pub fn warning(&self, warning: Warning) -> WarningCount {
        let Some(index) = warning.index() else { return WarningCount::default() };
        let stat = &self.raw().warning[index];
        WarningCount { number: usize::try_from(stat.number % BASE).unwrap_or(0), lastinfo: stat.lastinfo }
    }

    /// Returns the types of warnings that were raised since the last reset, and their numbers. None
    /// after a run without a warning.
    pub fn warnings(&self) -> impl Iterator<Item = (Warning, WarningCount)> {
        Warning::ALL.map(|warning| (warning, self.warning(warning))).into_iter().filter(|(_, count)| count.number > 0)
    }

    /// Returns the counters of all types of warnings.
    #[inline]
    pub(crate) fn warning_counters(&self) -> WarningCounters {
        self.raw().warning
    }

    /// Sets the counters of all types of warnings.
    #[inline]
    pub(crate) fn set_warnings(&mut self, counters: &WarningCounters) {
        self.raw_mut().warning = *counters;
    }

    /// Logs the warnings whose counters were zero before the call.
    #[cold]
    pub(super) fn log_new_warnings(&self, counters: &SavedCounters) {
        for warning in Warning::ALL {
            let Some(index) = warning.index() else { continue };
            let (old, now) = (counters.before[index], self.warning(warning));
            if old.number == 0 && now.number > 0 {
                messages::warn(&warning.message(now.lastinfo, self));
            }
        }
    }

    /// Makes a call like [`call_mut`](Self::call_mut) that may raise `warning`. Returns `true` if
    /// it did.
    pub(crate) fn call_mut_with_warning(
        &mut self,
        warning: Warning,
        function: &'static str,
        call: impl FnOnce(*const mjModel, *mut mjData) -> c_int,
    ) -> Result<bool> {
        let Some(counter) = warning.index() else { return self.call_mut(function, call).map(|()| false) };
        // The engine does not print a warning whose counter is not zero.
        let during = mjWarningStat { lastinfo: 0, number: 1 };
        let before = std::mem::replace(&mut self.raw_mut().warning[counter], during);
        let result = self.call_mut(function, call);
        let stat = &mut self.raw_mut().warning[counter];
        let raised = stat.number - 1;
        *stat = if raised == 0 {
            before
        } else {
            mjWarningStat { lastinfo: stat.lastinfo, number: before.number.saturating_add(raised) }
        };
        result.map(|()| raised > 0)
    }

    /// Returns the cause of a reset by the engine, from the warnings that the reset left.
    #[cold]
    pub(super) fn instability_after_reset(&self, time: f64) -> Instability {
        let (field, warning) = [
            (UnstableField::Acceleration, Warning::BadQacc),
            (UnstableField::Velocity, Warning::BadQvel),
            (UnstableField::Position, Warning::BadQpos),
        ]
        .into_iter()
        .find(|&(_, warning)| self.warning(warning).number > 0)
        .unwrap_or((UnstableField::Acceleration, Warning::BadQacc));
        let index = usize::try_from(self.warning(warning).lastinfo).unwrap_or(0);
        self.instability(field, index, None, time)
    }
}

#[cfg(test)]
mod tests {
    use mujoco_sys::mjWarningStat;

    use super::{CounterChange, SavedCounters};
    use crate::{Data, sample};

    /// Replaces counters of 3, changes them like the engine with `engine`, and restores them.
    fn restored(engine: impl FnOnce(&mut [mjWarningStat])) -> (CounterChange, Vec<(i32, i32)>) {
        let mut data = Data::new(sample::cartpole()).unwrap();
        data.raw_mut().warning.fill(mjWarningStat { lastinfo: 7, number: 3 });
        let counters = SavedCounters::replace(data.raw_mut());
        engine(&mut data.raw_mut().warning);
        let change = counters.restore(data.raw_mut());
        (change, data.raw().warning.iter().map(|stat| (stat.number, stat.lastinfo)).collect())
    }

    #[test]
    fn counters_without_warnings_are_unchanged() {
        let (change, stats) = restored(|_| ());
        assert!(change == CounterChange::None && stats == vec![(3, 7); stats.len()]);
    }

    #[test]
    fn a_warning_changes_only_its_counter() {
        let (change, stats) = restored(|warning| {
            warning[1].number += 2;
            warning[1].lastinfo = 5;
        });
        assert!(change == CounterChange::Warned);
        assert_eq!((stats[0], stats[1], stats[2]), ((3, 7), (5, 5), (3, 7)));
    }

    #[test]
    fn a_reset_by_the_engine_is_distinguished_from_a_warning() {
        let (change, stats) = restored(|warning| {
            warning.fill(mjWarningStat { lastinfo: 0, number: 0 });
            warning[5] = mjWarningStat { lastinfo: 1, number: 1 };
        });
        assert!(change == CounterChange::Reset);
        assert_eq!((stats[0], stats[5]), ((0, 0), (1, 1)));
    }
}
