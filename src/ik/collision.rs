//! Distances between geoms, as inequalities of the displacement.
//!
//! The distance of two geoms changes by the relative velocity of the nearest points along the line
//! through both. It may decrease by a fraction of what is above the minimum (B. Faverjon, P.
//! Tournassoud, "A local based approach for path planning of manipulators with a high number of
//! degrees of freedom", ICRA 1987).

use super::Ik;
use crate::data::Data;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{BodyId, GeomId, Id, IntoId};
use crate::kind;
use crate::matrix::Matrix;
use crate::numerics::linear_algebra::add_product;
use crate::numerics::spatial::{norm, sub};

/// Distance that two geoms keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Avoidance {
    /// Smallest distance, m; 0.005 by default.
    pub minimum: f64,
    /// Distance, m, from which on a pair is considered; 0.05 by default.
    pub detection: f64,
    /// Fraction of the distance above the minimum that a tick may use up, up to 1; 0.5 by default.
    pub gain: f64,
}

impl Default for Avoidance {
    fn default() -> Self {
        Self { minimum: 0.005, detection: 0.05, gain: 0.5 }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) geoms: [GeomId; 2],
    avoidance: Avoidance,
}

/// # Distances between geoms
impl Ik {
    /// Keeps two geoms apart. Distances are those of [`Data::geom_distance`]: closed forms for
    /// spheres, capsules and planes, and iterations for other shapes, which take microseconds to
    /// milliseconds.
    ///
    /// A pair that is already nearer than the minimum moves apart if the other limits allow it; if
    /// they do not, the tick does not decrease the distance.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown geom, [`Error::Invalid`] for
    /// twice the same geom, a distance that is negative or not finite, a detection distance below
    /// the minimum, or a gain that is not above 0 and at most 1.
    ///
    /// # Panics
    ///
    /// If an id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::ik::{Avoidance, Ik};
    /// use mujoco_safe::sample;
    ///
    /// let model = sample::humanoid();
    /// let mut ik = Ik::new(model);
    /// ik.avoid("hand_left", "thigh_left", Avoidance { minimum: 0.02, ..Avoidance::default() })?;
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias("collision avoidance", "CollisionAvoidanceLimit", "obstacle"))]
    pub fn avoid(
        &mut self,
        geom1: impl IntoId<kind::Geom>,
        geom2: impl IntoId<kind::Geom>,
        avoidance: Avoidance,
    ) -> Result<()> {
        let geoms = [geom1.id_in(&*self.model)?, geom2.id_in(&*self.model)?];
        if geoms[0] == geoms[1] {
            return Err(Error::out_of_range("the second geom of a pair", geoms[1], "another than the first"));
        }
        let Avoidance { minimum, detection, gain } = avoidance;
        Error::check_not_negative("the minimum of an Avoidance", minimum)?;
        let (is_valid, expected) = (detection >= minimum && detection.is_finite(), "finite and at least the minimum");
        Error::check_range(is_valid, "the detection of an Avoidance", detection, expected)?;
        Error::check_range(gain > 0.0 && gain <= 1.0, "the gain of an Avoidance", gain, "above 0 and at most 1")?;
        self.inequalities.push(Pair { geoms, avoidance }.into());
        // The workspace has no row for the pair.
        self.levels.clear();
        self.is_prepared = false;
        Ok(())
    }
}

impl Pair {
    /// Returns the distance below the minimum, or zero.
    pub(super) fn violation(&self, data: &mut Data) -> Result<f64> {
        let minimum = self.avoidance.minimum;
        let found = data.geom_distance(self.geoms[0], self.geoms[1], minimum)?;
        Ok(found.map_or(0.0, |found| (minimum - found.distance).max(0.0)))
    }

    /// Writes the derivative of the distance to a row of zeros, and returns the smallest change of
    /// the distance, which is positive for a pair that is too near.
    pub(super) fn write(&self, data: &mut Data, buffers: &mut [Matrix; 2], row: &mut [f64]) -> Result<f64> {
        let Avoidance { minimum, detection, gain } = self.avoidance;
        let [first, second] = self.geoms;
        // The bounding spheres of most pairs are far apart; those of planes have the radius zero.
        let radii = self.geoms.map(|geom| data.model().geom_rbound()[geom.index()]);
        if radii.iter().all(|&radius| radius > 0.0) {
            let offset = sub(&data.geom_xpos()[first.index()], &data.geom_xpos()[second.index()]);
            if norm(&offset) > radii[0] + radii[1] + detection {
                return Ok(f64::NEG_INFINITY);
            }
        }
        let Some(found) = data.geom_distance(first, second, detection)? else { return Ok(f64::NEG_INFINITY) };
        let [from, to] = found.fromto;
        let offset = sub(&to, &from);
        let length = norm(&offset);
        if length < 1e-12 {
            // The nearest points coincide, so the direction is unknown.
            return Ok(f64::NEG_INFINITY);
        }
        // For penetration, the nearest points have changed sides.
        let normal = offset.map(|value| value / length * found.distance.signum());
        for (geom, point, buffer) in [(first, from, 0), (second, to, 1)] {
            let model = data.model();
            let body: BodyId = Id::new(ffi::size(model.geom_bodyid()[geom.index()]), model.lineage());
            data.jac_into(point, body, Some(&mut buffers[buffer]), None)?;
        }
        add_product(row, &buffers[1], &normal, 1.0);
        add_product(row, &buffers[0], &normal, -1.0);
        Ok(-gain * (found.distance - minimum))
    }
}
