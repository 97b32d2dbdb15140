//! Rays: where a half-line meets a surface.
//!
//! A ray starts at a point and goes along a direction of any length; distances are in units of that length, so in metres for a
//! direction of length 1. A direction that is zero, or a number that is none, is an error here; the engine would end the process.

use std::ffi::c_int;
use std::ptr;

use mujoco_sys::{self as sys, guard, mjGEOM_HFIELD, mjGEOM_MESH};

use super::{Computed, Data};
use crate::enums::GeomType;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::{BodyId, GeomId, Id};
use crate::math::check_ray;
use crate::model::Model;

/// Which geoms a ray can meet. Invisible ones it never meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayOptions {
    /// For each group of geoms whether its geoms are met; all are if there is none. Planes and height fields always are.
    pub geomgroup: Option<[bool; 6]>,
    /// Whether the geoms of the world itself are met.
    #[doc(alias = "flg_static")]
    pub with_static: bool,
    /// A body whose geoms are not met.
    pub bodyexclude: Option<BodyId>,
}

impl Default for RayOptions {
    /// All visible geoms.
    fn default() -> Self {
        Self { geomgroup: None, with_static: true, bodyexclude: None }
    }
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// How far from the ray's point, in units of its direction's length.
    pub distance: f64,
    /// The geom.
    pub geom: GeomId,
}

impl Data {
    /// What a ray meets first.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before poses were computed, [`Error::Invalid`] for a direction that is zero or a number that is
    /// none, [`Error::Unsupported`] if the model has a geom of a height field with more rows than columns, of which 2.2.2 reads
    /// other numbers than it should, or of one whose sizes or orientation are out of all bounds.
    ///
    /// # Panics
    ///
    /// If the id of the body to exclude is of another model.
    ///
    /// ```
    /// use mujoco_safe::{Data, RayOptions, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let hit = data.ray([5.0, 5.0, 3.0], [0.0, 0.0, -1.0], &RayOptions::default())?.expect("there is a floor");
    /// assert_eq!(hit.distance, 3.0);
    /// assert_eq!(data.geom(hit.geom).name(), Some("floor"));
    /// assert!(data.ray([5.0, 5.0, 3.0], [0.0, 0.0, 1.0], &RayOptions::default())?.is_none());
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_ray")]
    pub fn ray(&self, point: [f64; 3], direction: [f64; 3], options: &RayOptions) -> Result<Option<RayHit>> {
        self.check_parts("ray", Computed::KINEMATICS)?;
        check_ray(&point, &direction)?;
        if let Some(geom) = self.model().first_geom_unsafe_for_rays() {
            return Err(misread(self.model(), geom));
        }
        if self.model().nhfield() > 0 {
            self.check_field_poses()?;
        }
        self.ray_unchecked(point, direction, options)
    }

    /// As [`ray`](Self::ray), for several directions from one point; what each meets first goes to `hits`. What is farther than
    /// `cutoff`, in units of each direction's length, is not met. Here each ray is one call of the engine's; newer engines have
    /// `mj_multiRay`.
    ///
    /// # Errors
    ///
    /// As for [`ray`](Self::ray), [`Error::Shape`] unless there are as many hits as directions, and [`Error::Invalid`] for a
    /// cutoff that is not a number.
    ///
    /// # Panics
    ///
    /// As for [`ray`](Self::ray).
    ///
    /// ```
    /// use mujoco_safe::{Data, RayOptions, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let directions = [[0.0, 0.0, -1.0], [0.0, 0.0, -0.1], [0.0, 0.0, 1.0]];
    /// let mut hits = [None; 3];
    /// data.multi_ray([5.0, 5.0, 3.0], &directions, 10.0, &RayOptions::default(), &mut hits)?;
    /// assert_eq!(hits.map(|hit| hit.map(|hit| hit.distance)), [Some(3.0), None, None]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_multiRay")]
    pub fn multi_ray(
        &self,
        point: [f64; 3],
        directions: &[[f64; 3]],
        cutoff: f64,
        options: &RayOptions,
        hits: &mut [Option<RayHit>],
    ) -> Result<()> {
        Error::check_length("the hits of multi_ray", hits.len(), directions.len())?;
        if cutoff.is_nan() {
            return Err(Error::invalid("cutoff of multi_ray", cutoff, "a number"));
        }
        for (hit, direction) in hits.iter_mut().zip(directions) {
            *hit = self.ray(point, *direction, options)?.filter(|hit| hit.distance <= cutoff);
        }
        Ok(())
    }

    /// Where a ray meets the mesh of a geom, in units of the direction's length.
    ///
    /// # Errors
    ///
    /// As for [`ray`](Self::ray), and [`Error::Invalid`] if the geom is no mesh.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mj_rayMesh")]
    pub fn ray_mesh(&self, geom: impl Into<GeomId>, point: [f64; 3], direction: [f64; 3]) -> Result<Option<f64>> {
        let index = self.geom_of_type("ray_mesh", geom.into(), mjGEOM_MESH, "a mesh")?;
        check_ray(&point, &direction)?;
        // SAFETY: a geom of this model that is a mesh, whose pose was computed, and three numbers each.
        let distance = unsafe {
            sys::mj_rayMesh(self.model().as_ptr(), self.as_ptr(), index as c_int, point.as_ptr(), direction.as_ptr())
        };
        Ok(met(distance))
    }

    /// Where a ray meets the height field of a geom, in units of the direction's length.
    ///
    /// # Errors
    ///
    /// As for [`ray`](Self::ray), and [`Error::Invalid`] if the geom is no height field.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mj_rayHfield")]
    pub fn ray_hfield(&self, geom: impl Into<GeomId>, point: [f64; 3], direction: [f64; 3]) -> Result<Option<f64>> {
        let index = self.geom_of_type("ray_hfield", geom.into(), mjGEOM_HFIELD, "a height field")?;
        check_ray(&point, &direction)?;
        if self.model().is_unsafe_for_rays(index) {
            return Err(misread(self.model(), index));
        }
        self.check_field_poses()?;
        // SAFETY: a geom of this model that is a height field of which the engine stays within the numbers, whose pose was
        // computed, and three numbers each.
        let distance = unsafe {
            sys::mj_rayHfield(self.model().as_ptr(), self.as_ptr(), index as c_int, point.as_ptr(), direction.as_ptr())
        };
        Ok(met(distance))
    }

    fn ray_unchecked(&self, point: [f64; 3], direction: [f64; 3], options: &RayOptions) -> Result<Option<RayHit>> {
        let groups = options.geomgroup.map(|groups| groups.map(u8::from));
        let exclude = options.bodyexclude.map_or(-1, |body| {
            self.model().check_id(body);
            body.index() as c_int
        });
        let (mut geom, mut distance) = (-1, -1.0);
        let (point, direction) = (point.as_ptr(), direction.as_ptr());
        let groups = groups.as_ref().map_or(ptr::null(), |groups| groups.as_ptr());
        let (with_static, hit) = (options.with_static.into(), (&raw mut geom, &raw mut distance));
        self.call("mj_ray", |m, d| {
            // SAFETY: two vectors of three numbers, six groups or NULL, two places for the results; the poses were computed.
            unsafe { guard::mj_ray(m, d, point, direction, groups, with_static, exclude, hit.0, hit.1) }
        })?;
        let geom = usize::try_from(geom).ok();
        Ok(geom.map(|geom| RayHit { distance, geom: Id::new(geom, self.model().lineage()) }))
    }

    /// Refuses height fields whose orientation, as it is or as the model has it, is so far from a rotation that a point in their
    /// frame overflows. The engine makes an index of its coordinates. (One that is not a number never comes so far.)
    #[cold]
    pub(crate) fn check_field_poses(&self) -> Result<()> {
        /// No rotation has numbers that are anywhere near, nor has the square of one that has.
        const LARGEST: f64 = 1e20;
        let model = self.model();
        let is_field = |&geom: &usize| model.geom_type()[geom] == mjGEOM_HFIELD as i32;
        let far = |values: &[f64]| values.iter().any(|value| value.abs() > LARGEST);
        // The pose as it is, which can be written to, and what the next one is made of.
        let is_far = |&geom: &usize| {
            let body = ffi::size(model.geom_bodyid()[geom]);
            far(&self.geom_xmat()[geom]) || far(&model.geom_quat()[geom]) || far(&model.body_iquat()[body])
        };
        match (0..model.ngeom()).filter(is_field).find(is_far) {
            None => Ok(()),
            Some(geom) => Err(Error::Unsupported(format!(
                "rays on the height field of geom {geom}, whose orientation has numbers beyond {LARGEST:e}"
            ))),
        }
    }

    fn geom_of_type(&self, call: &'static str, geom: GeomId, geom_type: u32, expected: &str) -> Result<usize> {
        self.model().check_id(geom);
        self.check_parts(call, Computed::KINEMATICS)?;
        let found = self.model().geom_type()[geom.index()];
        if found == geom_type as i32 {
            Ok(geom.index())
        } else {
            let found = GeomType::of_field(found);
            Err(Error::invalid(format!("the geom of {call}"), format_args!("a {found:?}"), expected))
        }
    }
}

/// The engine's -1 is nothing.
fn met(distance: f64) -> Option<f64> {
    Some(distance).filter(|&distance| distance >= 0.0)
}

#[cold]
fn misread(model: &Model, geom: usize) -> Error {
    let field = ffi::size(model.geom_dataid()[geom]);
    let (rows, columns) = (model.hfield_nrow()[field], model.hfield_ncol()[field]);
    Error::Unsupported(format!(
        "rays on the height field {field} of {rows} rows and {columns} columns: MuJoCo 2.2.2 reads beyond one with more rows \
         than columns, with less than two of either, or with sizes that are not between 1e-100 and 1e100; turn the field by 90°"
    ))
}
