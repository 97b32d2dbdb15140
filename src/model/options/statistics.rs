//! Statistics that define the scale of a model.

use std::ops::RangeInclusive;

use mujoco_sys::mjStatistic;

use super::fields::{Checks, Mirror, mirror};
use crate::error::Result;
use crate::model::{Model, ModelMut};

mirror! {
    /// Statistics of the model at `qpos0`, which define its scale.
    ///
    /// The struct is a copy of the engine's values: [`Model::statistics`] reads them,
    /// [`ModelMut::edit_statistics`] changes them. The compiler computes them, unless `<statistic>`
    /// in the XML overrides them.
    Statistics = mjStatistic {
        /// Mean of the diagonal of the inertia matrix. The constraint solver divides the
        /// improvement of the cost by it before the comparison with its tolerance. Positive.
        meaninertia: f64 = 1.0,
        /// Mean mass of a body, kg. The visualiser divides forces by it. Zero if no body has a
        /// mass.
        meanmass: f64 = 1.0,
        /// Mean size of a body, m. The lengths of [`VisualScale`](super::VisualScale) are multiples
        /// of it. Positive.
        meansize: f64 = 0.2,
        /// Extent of the model, m. The distances of [`VisualMap`](super::VisualMap) are multiples
        /// of it. From 1e-6 to 1e10.
        extent: f64 = 2.0,
        /// Centre of the model, m, world frame: the initial target of the free camera.
        center: [f64; 3] = [0.0; 3],
    }
}

/// Extents whose products with the visualiser's clipping planes fit into a 32-bit float.
const EXTENT: RangeInclusive<f64> = 1e-6..=1e10;

impl Statistics {
    /// Rejects values that make the solver's tolerance meaningless or the visualiser's image empty.
    fn check(&self) -> Result<()> {
        let statistic = Checks("the statistic ");
        statistic.positive("meaninertia", self.meaninertia)?;
        statistic.not_negative("meanmass", self.meanmass)?;
        statistic.positive("meansize", self.meansize)?;
        statistic.require(EXTENT.contains(&self.extent), "extent", self.extent, "from 1e-6 to 1e10")?;
        statistic.finite("center", &self.center)
    }
}

/// # Statistics
impl Model {
    /// Returns a copy of the statistics of the model at `qpos0`.
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

/// # Statistics
impl ModelMut<'_> {
    /// Changes the statistics. Rejects the change if a value is out of range. The check includes
    /// values that `change` does not modify, for example those from the XML.
    ///
    /// [`update_constants`](Self::update_constants) recomputes the statistics and overwrites these
    /// changes. With engines since 3.17 it recomputes `meanmass` and `meaninertia` only.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`](crate::Error::Invalid) with the name, the value and the valid values. The
    /// model is then unchanged.
    ///
    /// ```
    /// use mujoco_safe::{Error, sample};
    ///
    /// let mut model = sample::cartpole();
    /// model.edit().edit_statistics(|statistics| statistics.extent = 3.0)?;
    /// assert_eq!(model.statistics().extent, 3.0);
    /// // The constraint solver would divide by zero, and never reach its tolerance.
    /// assert!(model.edit().edit_statistics(|statistics| statistics.meaninertia = 0.0).is_err());
    /// # Ok::<(), Error>(())
    /// ```
    #[doc(alias = "mjStatistic")]
    pub fn edit_statistics(&mut self, change: impl FnOnce(&mut Statistics)) -> Result<()> {
        let mut statistics = self.statistics();
        change(&mut statistics);
        statistics.check()?;
        statistics.write_into(&mut self.raw_mut().stat);
        Ok(())
    }
}
