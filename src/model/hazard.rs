//! Models that the engine compiles, and then runs out of its arrays with. A binary model is refused by its own check; these
//! come from valid XML too.

use std::ops::RangeInclusive;

use mujoco_sys::{mjGEOM_HFIELD, mjSENS_RANGEFINDER, mjTRN_BODY, mjWRAP_JOINT};

use super::Model;
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

    /// Why the engine cannot be trusted with this model, if it cannot.
    pub(super) fn hazard(&self) -> Option<String> {
        // The engine counts the entries of its matrices with a C int, and would write before its stack. The largest is the
        // derivative of the bodies' accelerations, of the integrator `Implicit`.
        let (nv, nbody) = (self.nv(), self.nbody());
        if i32::try_from(6 * nv * nv.max(nbody)).is_err() || i32::try_from(nbody * nbody).is_err() {
            return Some(format!("{nbody} bodies and {nv} degrees of freedom are more than the engine can count"));
        }
        let timestep = self.timestep();
        if !(timestep.is_finite() && timestep > 0.0) {
            return Some(format!("the timestep is {timestep}, but must be positive and finite: time would not go on"));
        }
        if self.has_adhesion() && self.njmax() == 0 {
            // The engine does not even warn then.
            return Some("an adhesion actuator needs room for constraints, but njmax is 0".to_owned());
        }
        if self.find_ranged_fields()
            && let Some(geom) = self.misread_height_field()
        {
            return Some(format!(
                "a rangefinder would read beyond the height field of geom {geom}, which has more rows than columns, or sizes \
                     out of all bounds; turn it by 90°"
            ));
        }
        self.bad_skin().or_else(|| self.repeated_joint())
    }

    /// A skin with a face of a vertex that it does not have, which is found when the skin is drawn.
    fn bad_skin(&self) -> Option<String> {
        let of = |addresses: &[i32], counts: &[i32], skin: usize| {
            // Without any the address may be anything.
            let count = ffi::size(counts[skin]);
            if count == 0 { 0..0 } else { ffi::size(addresses[skin])..ffi::size(addresses[skin]) + count }
        };
        (0..self.nskin()).find_map(|skin| {
            let vertices = self.skin_vertnum()[skin];
            let faces = &self.skin_face()[of(self.skin_faceadr(), self.skin_facenum(), skin)];
            let outside = faces.as_flattened().iter().find(|vertex| !(0..vertices).contains(*vertex))?;
            Some(format!("skin {skin} has a face of vertex {outside}, but only the vertices 0 to {}", vertices - 1))
        })
    }

    fn repeated_joint(&self) -> Option<String> {
        self.tendons().find_map(|tendon| {
            let (start, count) =
                (ffi::size(self.tendon_adr()[tendon.index()]), ffi::size(self.tendon_num()[tendon.index()]));
            let is_joint = |&at: &usize| self.wrap_type()[at] == mjWRAP_JOINT as i32;
            let mut joints: Vec<i32> =
                (start..start + count).filter(is_joint).map(|at| self.wrap_objid()[at]).collect();
            joints.sort_unstable();
            joints.windows(2).find(|pair| pair[0] == pair[1])?;
            // Its sparse Jacobian has room for one number for each degree of freedom.
            Some(format!(
                "the fixed {tendon:?} has the same joint twice; give it once, with the sum of the coefficients"
            ))
        })
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
            || !self.hfield_size()[field].iter().all(|size| SIZES.contains(size))
    }

    /// The first geom for which that is so.
    pub(crate) fn misread_height_field(&self) -> Option<usize> {
        if self.nhfield() == 0 { None } else { (0..self.ngeom()).find(|&geom| self.is_misread(geom)) }
    }
}

/// Whether rays that meet the walls of a height field of this size lead the engine beyond it: it takes the number of rows for the
/// length of one, and reads two neighbours in each direction.
pub(super) fn is_misread_by_rays(rows: u64, columns: u64) -> bool {
    rows > columns || rows < 2 || columns < 2
}
