//! Validation of compiled models, and properties of a model on which the engine needs a closer watch.

use std::ops::RangeInclusive;

use mujoco_sys::{mjGEOM_HFIELD, mjSENS_RANGEFINDER, mjTRN_BODY};

use super::{Model, mjb};
use crate::ffi;

/// Sizes of a height field whose sums, squares and quotients are numbers.
const SIZES: RangeInclusive<f64> = 1e-100..=1e100;

impl Model {
    /// Whether an actuator sticks to what its body touches (`mjTRN_BODY`). The engine looks up the constraints of each
    /// contact for it, and trusts that there are some: a contact for which the constraint buffer had no room makes it write
    /// before the start of an array.
    #[inline]
    pub(crate) fn has_adhesion(&self) -> bool {
        self.adhesive
    }

    /// Whether each step sends rays to height fields, whose poses then matter: see
    /// [`Data::check_field_poses`](crate::Data::check_field_poses).
    #[inline]
    pub(crate) fn has_ranged_fields(&self) -> bool {
        self.ranged_fields
    }

    pub(super) fn find_ranged_fields(&self) -> bool {
        self.nhfield() > 0 && self.sensor_type().contains(&(mjSENS_RANGEFINDER as i32))
    }

    pub(super) fn find_adhesion(&self) -> bool {
        self.actuator_trntype().contains(&(mjTRN_BODY as i32))
    }

    /// Checks a model that the engine compiled by the rules for binary models, so that every model that loads from XML can be
    /// saved and loaded as a binary model too. Returns the reason for a rejection.
    pub(super) fn validate(&self) -> Result<(), String> {
        let bytes = self.to_binary().map_err(|error| error.to_string())?;
        mjb::check(&bytes).map_err(|error| error.to_string())
    }

    /// Whether rays that meet the walls of this geom, if it is a height field, lead the engine beyond the heights that there are. It
    /// also makes a row or a column of the quotient of two lengths, which is not a number if both are infinite or zero.
    pub(crate) fn is_misread(&self, geom: usize) -> bool {
        if self.geom_type()[geom] != mjGEOM_HFIELD as i32 {
            return false;
        }
        let field = ffi::size(self.geom_dataid()[geom]);
        let size = |sizes: &[i32]| ffi::size(sizes[field]) as u64;
        is_misread_by_rays(size(self.hfield_nrow()), size(self.hfield_ncol()))
            || !are_ray_sizes(&self.hfield_size()[field])
    }

    /// The first geom for which that is so.
    pub(crate) fn misread_height_field(&self) -> Option<usize> {
        if self.nhfield() == 0 { None } else { (0..self.ngeom()).find(|&geom| self.is_misread(geom)) }
    }
}

/// Returns `true` if the engine's ray functions can compute with these sizes of a height field.
pub(super) fn are_ray_sizes(sizes: &[f64]) -> bool {
    sizes.iter().all(|size| SIZES.contains(size))
}

/// Whether rays that meet the walls of a height field of this size lead the engine beyond it: it takes the number of rows for the
/// length of one, and reads two neighbours in each direction.
pub(super) fn is_misread_by_rays(rows: u64, columns: u64) -> bool {
    rows > columns || rows < 2 || columns < 2
}
