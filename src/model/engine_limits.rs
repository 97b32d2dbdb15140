//! Validation of compiled models, and properties of a model for which the engine's own checks are
//! insufficient.

use std::ops::RangeInclusive;

use mujoco_sys::{
    mjGEOM_HFIELD, mjModel, mjSENS_GEOMDIST, mjSENS_GEOMFROMTO, mjSENS_GEOMNORMAL, mjSENS_RANGEFINDER, mjSOL_NEWTON,
};

#[cfg(engine_since = "3.6.0")]
use mujoco_sys::{mjTRN_JOINT, mjTRN_JOINTINPARENT};

use super::{EnableFlags, Model};
use crate::ffi;
use crate::stage::PipelineFeatures;

/// Sizes of a height field whose sums, squares and quotients are finite.
const RAY_SAFE_SIZES: RangeInclusive<f64> = 1e-100..=1e100;

/// Largest number of vertices of a polygon of a mesh in a binary model with the option `multiccd`.
/// The engine clips a polygon of one geom by the edges of one of another, in an array of 300
/// vertices, and assumes that both are convex. A clip of a polygon that is not convex multiplies
/// its vertices by up to 1.5, and 8 clips of 8 vertices give at most 202.
#[cfg(all(validates_binaries, engine_since = "3.5.0"))]
pub(super) const MOST_SAFE_POLYGON: i32 = 8;

/// Limit on the iterations of the convex collider in a model with sensors of distances, in some
/// engines. For more iterations the collider allocates memory by a function that its caller names,
/// and `mj_geomDistance` names none.
const MOST_DISTANCE_ITERATIONS: Option<usize> =
    if cfg!(all(engine_since = "3.3.3", not(engine_since = "3.8.0"))) { Some(170) } else { None };

/// Limit on the tolerance of Newton's method in steps that are differenced: of the size of rounding
/// errors.
const DIFFERENCED_TOLERANCE: f64 = 1e-15;

/// Returns `true` for the types of sensors of distances.
pub(super) fn measures_distance(kind: i32) -> bool {
    [mjSENS_GEOMDIST, mjSENS_GEOMNORMAL, mjSENS_GEOMFROMTO].contains(&(kind as u32))
}

impl Model {
    /// Returns the reason why the model's sensors cannot be computed with this number of iterations
    /// of the convex collider.
    pub(super) fn check_distances(&self, iterations: usize) -> Result<(), String> {
        match MOST_DISTANCE_ITERATIONS {
            Some(most) if iterations > most && self.sensor_type().iter().any(|&kind| measures_distance(kind)) => {
                Err(format!(
                    "the convex collider has {iterations} iterations; with a sensor of distances at most {most} are allowed"
                ))
            }
            _ => Ok(()),
        }
    }

    /// Returns `true` if the model has an adhesive actuator (`mjTRN_BODY`). For each contact of its
    /// body, the engine accesses the constraints and assumes that they exist. For a contact without
    /// room in the constraint buffer it writes before the start of an array.
    #[inline]
    pub(crate) fn has_adhesion(&self) -> bool {
        self.features.contains(PipelineFeatures::ADHESION_ACTUATOR)
    }

    /// Returns `true` if the engine reads constraints of this model without checking that there was
    /// room for them: the constraints of an adhesive actuator, and since 2.3 equality constraints.
    #[inline]
    pub(crate) fn needs_constraints(&self) -> bool {
        self.has_adhesion() || (cfg!(engine_since = "2.3.0") && self.raw().neq > 0)
    }

    /// Returns `true` if each step casts rays at height fields, which requires valid poses: see
    /// [`Data::check_field_poses`](crate::Data::check_field_poses).
    #[inline]
    pub(crate) fn has_rangefinder_and_height_field(&self) -> bool {
        self.has_rangefinder_and_height_field
    }

    pub(super) fn find_rangefinder_and_height_field(&self) -> bool {
        self.nhfield() > 0 && self.sensor_type().contains(&(mjSENS_RANGEFINDER as i32))
    }

    /// Reserves space for the moments of an actuator on all degrees of freedom, except with a
    /// joint, as older engines do. Newer ones reserve the elements that are not zero in the
    /// compiled model, and write those that are not zero in the present one. With a NaN in a pose
    /// these are all elements, and the last row would end outside of its array.
    #[cfg(engine_since = "3.6.0")]
    pub(super) fn reserve_moments(&mut self) {
        let is_sparse = |kind: i32| [mjTRN_JOINT, mjTRN_JOINTINPARENT].contains(&(kind as u32));
        let row = |actuator: usize| {
            let elements = if is_sparse(self.actuator_trntype()[actuator]) { 6.min(self.nv()) } else { self.nv() };
            self.outputs_of(actuator).len() * elements
        };
        let elements: usize = (0..self.nactuator()).map(row).sum();
        let raw = self.raw_mut();
        #[allow(clippy::useless_conversion, reason = "the type depends on the engine")]
        let compiled = i64::from(raw.nJmom);
        raw.nJmom = raw.nJmom.max(elements as _);
        self.compiled_moments = compiled;
    }

    /// Returns a copy of the engine's struct with the same arrays, for calls that read the model
    /// with another value of a field. The arrays belong to this model, which must outlive the
    /// calls.
    fn copy_of_struct(&self) -> mjModel {
        // SAFETY: a valid model, and plain data: numbers, and pointers that nothing frees with the
        // copy.
        unsafe { std::ptr::read(self.as_ptr()) }
    }

    /// Passes the model to the engine with the sizes that its compiler chose, which the writer of
    /// XML compares.
    #[allow(clippy::unused_self, reason = "older engines have no other sizes")]
    pub(super) fn with_compiled_sizes<T>(&self, call: impl FnOnce(*const mjModel) -> T) -> T {
        #[cfg(engine_since = "3.6.0")]
        {
            let mut copy = self.copy_of_struct();
            copy.nJmom = self.compiled_moments as _;
            call(&raw const copy)
        }
        #[cfg(not(engine_since = "3.6.0"))]
        call(self.as_ptr())
    }

    /// Returns `true` if the engine adds noise to readings of this model.
    pub(crate) fn has_noise(&self) -> bool {
        let flag = self.raw().opt.enableflags as u32 & EnableFlags::SENSORNOISE.bits();
        flag != 0 && self.sensor_noise().iter().any(|&noise| noise > 0.0)
    }

    /// Passes the model to the engine for steps that are differenced, with corrections.
    ///
    /// The solver iterates as far as it can. With the usual tolerance, CG and PGS stop after one
    /// iteration for a small change of the state, and from 3.12 on Newton and CG before the first
    /// one: they keep their initial guess, which lacks the effect of the change on the constraints.
    /// (Before 3.12, one iteration of Newton converges for a small change.) The tolerance is one of
    /// the cost, which is quadratic in the error, so CG and PGS have none.
    ///
    /// Readings have no noise, which 2.2.2 adds.
    ///
    /// And there is a type of transmission for each control, of which there can be more than
    /// actuators. The step of `mjd_transitionFD` reads as many when it searches for actuators with
    /// damping.
    pub(crate) fn for_differences<T>(&self, call: impl FnOnce(*const mjModel) -> T) -> T {
        self.for_differences_with(self.raw().opt.iterations, call)
    }

    /// Passes the model as [`for_differences`](Self::for_differences) does, with another limit of
    /// the solver's iterations.
    pub(crate) fn for_differences_with<T>(&self, iterations: i32, call: impl FnOnce(*const mjModel) -> T) -> T {
        let is_newton = self.raw().opt.solver == mjSOL_NEWTON as i32;
        let is_unchanged = is_newton && !self.has_noise() && iterations == self.raw().opt.iterations;
        if cfg!(not(engine_since = "3.12.0")) && is_unchanged {
            return call(self.as_ptr());
        }
        let mut copy = self.copy_of_struct();
        copy.opt.iterations = iterations;
        copy.opt.tolerance = if is_newton { copy.opt.tolerance.min(DIFFERENCED_TOLERANCE) } else { 0.0 };
        copy.opt.enableflags &= !(EnableFlags::SENSORNOISE.bits() as i32);
        #[cfg(engine_since = "3.17.0")]
        let mut types = Vec::new();
        #[cfg(engine_since = "3.17.0")]
        if self.nu() > self.nactuator() {
            types.extend_from_slice(self.actuator_trntype());
            types.resize(self.nu(), mujoco_sys::mjTRN_UNDEFINED as i32);
            // The list of types outlives the call.
            copy.actuator_trntype = types.as_mut_ptr();
        }
        call(&raw const copy)
    }

    /// Returns `true` if a polygon of a mesh has so many vertices that the engine's clipping of
    /// polygons may write beyond an array, unless the polygon is convex. The compiler merges faces
    /// of convex hulls, but a binary model may have any polygons. Without the option `multiccd` the
    /// engine clips none.
    #[cfg(all(validates_binaries, engine_since = "3.5.0"))]
    pub(super) fn find_unsafe_polygons(&self) -> bool {
        self.mesh_polyvertnum().iter().any(|&count| count > MOST_SAFE_POLYGON)
    }

    /// Returns `true` if this geom is a height field on which the engine's ray functions may read
    /// out of bounds. They read beyond the grid if its shape is unsuitable. They also compute a row
    /// or a column from a quotient of two lengths, which is NaN if both are infinite or zero.
    pub(crate) fn is_unsafe_for_rays(&self, geom: usize) -> bool {
        if self.geom_type()[geom] != mjGEOM_HFIELD as i32 {
            return false;
        }
        let field = ffi::size(self.geom_dataid()[geom]);
        let size = |sizes: &[i32]| ffi::size(sizes[field]) as u64;
        rays_overrun_grid(size(self.hfield_nrow()), size(self.hfield_ncol()))
            || !are_ray_safe_sizes(&self.hfield_size()[field])
    }

    /// Returns the first geom that is [unsafe for rays](Self::is_unsafe_for_rays).
    pub(crate) fn first_geom_unsafe_for_rays(&self) -> Option<usize> {
        if self.nhfield() == 0 { None } else { (0..self.ngeom()).find(|&geom| self.is_unsafe_for_rays(geom)) }
    }
}

/// Returns `true` if the engine's ray functions can compute with these sizes of a height field.
pub(super) fn are_ray_safe_sizes(sizes: &[f64]) -> bool {
    sizes.iter().all(|size| RAY_SAFE_SIZES.contains(size))
}

/// Returns `true` if the engine reads beyond a grid of this shape for rays that hit the sides of a
/// height field: it uses the number of rows as the length of a row, and reads two neighbours in
/// each direction.
pub(super) fn rays_overrun_grid(rows: u64, columns: u64) -> bool {
    rows > columns || rows < 2 || columns < 2
}
