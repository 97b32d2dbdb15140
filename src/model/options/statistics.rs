//! The figures that set the model's scale.

use std::ops::RangeInclusive;

use mujoco_sys::mjStatistic;

use super::check::Checks;
use super::mirror::{Mirror, mirror};
use crate::error::Result;
use crate::model::{Model, ModelMut};

mirror! {
    /// Figures of the model at `qpos0`, which set its scale. A copy: read it with [`Model::statistics`], change it with
    /// [`ModelMut::statistics`].
    ///
    /// The compiler computes them, and takes from `<statistic>` what the XML gives there.
    #[doc(alias = "mjStatistic")]
    Statistics = mjStatistic {
        /// Mean of the inertia matrix's diagonal. The constraint solver divides what it compares with its tolerance by it.
        /// Positive.
        meaninertia: f64 = 1.0,
        /// Mean mass of a body, kg. The visualiser divides forces by it. Zero where no body has a mass.
        meanmass: f64 = 1.0,
        /// Mean size of a body, m. The lengths of [`VisualScale`](super::VisualScale) are multiples of it. Positive.
        meansize: f64 = 0.2,
        /// Extent of the model, m. The distances of [`VisualMap`](super::VisualMap) are multiples of it. From 1e-6 to 1e10.
        extent: f64 = 2.0,
        /// Its centre, m, world frame: what the free camera looks at first.
        center: [f64; 3] = [0.0; 3],
    }
}

/// An extent whose product with the visualiser's clipping planes a 32-bit number can hold.
const EXTENT: RangeInclusive<f64> = 1e-6..=1e10;

impl Statistics {
    /// Refuses what makes the solver's tolerance meaningless, or leaves the visualiser nothing that can be seen.
    fn check(&self) -> Result<()> {
        let statistic = Checks("the statistic ");
        statistic.positive("meaninertia", self.meaninertia)?;
        statistic.not_negative("meanmass", self.meanmass)?;
        statistic.positive("meansize", self.meansize)?;
        statistic.require(EXTENT.contains(&self.extent), "extent", self.extent, "from 1e-6 to 1e10")?;
        statistic.finite("center", &self.center)
    }
}

impl Model {
    /// Figures of the model at `qpos0`, as a copy.
    ///
    /// ```
    /// let model = mujoco_safe::sample::humanoid();
    /// let statistics = model.statistics();
    /// let mass: f64 = model.body_mass().iter().sum();
    /// assert!((statistics.meanmass * (model.nbody() - 1) as f64 - mass).abs() < 1e-9);
    /// ```
    #[doc(alias = "stat")]
    pub fn statistics(&self) -> Statistics {
        Statistics::read(self.raw().stat)
    }
}

impl ModelMut<'_> {
    /// Changes the statistics, after checking them: nothing is changed if one is out of range. All of them are checked, also
    /// those that the XML had set.
    ///
    /// [`update_constants`](Self::update_constants) computes them anew and overwrites what was set here.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) with the figure, its value and what is allowed.
    ///
    /// ```
    /// use mujoco_safe::{Error, sample};
    ///
    /// let mut model = sample::cartpole();
    /// model.edit().statistics(|statistics| statistics.extent = 3.0)?;
    /// assert_eq!(model.statistics().extent, 3.0);
    /// // With zero, the constraint solver would divide by it and go on to its last iteration.
    /// assert!(model.edit().statistics(|statistics| statistics.meaninertia = 0.0).is_err());
    /// # Ok::<(), Error>(())
    /// ```
    #[doc(alias = "mjStatistic")]
    pub fn statistics(&mut self, change: impl FnOnce(&mut Statistics)) -> Result<()> {
        let mut statistics = Model::statistics(self);
        change(&mut statistics);
        statistics.check()?;
        self.raw_mut().stat = statistics.write();
        Ok(())
    }
}
