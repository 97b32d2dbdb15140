//! Ray casting.
//!
//! A ray starts at a point and has a direction of any length. Distances are in units of that
//! length, so in metres for a direction of length 1. A direction of length zero and values that are
//! not finite are errors. (In C, they end the process.)

use std::ffi::c_int;
use std::ptr;

use mujoco_sys::{self as sys, guard, mjGEOM_HFIELD, mjGEOM_MESH};

use crate::data::{Data, PipelineFlags};
use crate::enums::GeomType;
use crate::error::{Error, InvalidKind, Result};
use crate::ffi;
use crate::id::{BodyId, GeomId, Id, IntoId};
use crate::kind;
use crate::macros::with_methods;
use crate::math::check_ray;
use crate::model::Model;

/// Filter of the geoms that a ray can hit. Invisible geoms are never hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct RayOptions {
    /// Selected groups of geoms; `None` selects all. Engines before 2.3.6 always select planes and
    /// height fields.
    pub geomgroup: Option<[bool; 6]>,
    /// Includes the geoms of the world body.
    #[doc(alias = "flg_static")]
    pub static_geoms: bool,
    /// Body whose geoms are excluded.
    pub bodyexclude: Option<BodyId>,
}

impl Default for RayOptions {
    /// Selects all visible geoms.
    fn default() -> Self {
        Self { geomgroup: None, static_geoms: true, bodyexclude: None }
    }
}

with_methods!(RayOptions {
    with_geomgroup(geomgroup: [bool; 6]) = Some(geomgroup),
    with_static_geoms(static_geoms: bool),
    with_bodyexclude(bodyexclude: impl Into<BodyId>) = Some(bodyexclude.into()),
});

/// Nearest intersection of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Distance from the start of the ray, in units of the length of its direction.
    pub distance: f64,
    /// Geom that the ray hits.
    pub geom: GeomId,
}

/// # Rays
impl Data {
    /// Returns the nearest intersection of a ray with the geoms.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before poses were computed, [`Error::Invalid`] for a direction of
    /// length zero or a value that is not finite, [`Error::Unsupported`] if the model has a height
    /// field with more rows than columns, which 2.2.2 reads out of bounds, or one whose sizes or
    /// orientation are beyond the limits of the engine.
    ///
    /// # Panics
    ///
    /// If the id of the body to exclude belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::data::RayOptions;
    /// use mujoco_safe::{Data, sample};
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
        self.check_parts("ray", PipelineFlags::KINEMATICS)?;
        check_ray(&point, &direction)?;
        if let Some(geom) = self.model().first_geom_unsafe_for_rays() {
            return Err(out_of_bounds_field(self.model(), geom));
        }
        if self.model().nhfield() > 0 {
            self.check_field_poses()?;
        }
        self.ray_unchecked(point, direction, options)
    }

    /// Writes the nearest intersections of several rays from one point to `hits`. Intersections
    /// beyond `cutoff`, in units of the length of each direction, are ignored. Each ray is a
    /// separate call of the engine. Newer engines have `mj_multiRay`, which may return hits beyond
    /// the cutoff.
    ///
    /// # Errors
    ///
    /// As for [`ray`](Self::ray), [`Error::Shape`] unless `hits` and `directions` have the same
    /// length, and [`Error::Invalid`] for a cutoff that is NaN.
    ///
    /// # Panics
    ///
    /// As for [`ray`](Self::ray).
    ///
    /// ```
    /// use mujoco_safe::data::RayOptions;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let directions = [[0.0, 0.0, -1.0], [0.0, 0.0, -0.1], [0.0, 0.0, 1.0]];
    /// let mut hits = [None; 3];
    /// data.multi_ray_into([5.0, 5.0, 3.0], &directions, &RayOptions::default(), 10.0, &mut hits)?;
    /// assert_eq!(hits.map(|hit| hit.map(|hit| hit.distance)), [Some(3.0), None, None]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_multiRay")]
    pub fn multi_ray_into(
        &self,
        point: [f64; 3],
        directions: &[[f64; 3]],
        options: &RayOptions,
        cutoff: f64,
        hits: &mut [Option<RayHit>],
    ) -> Result<()> {
        Error::check_length("the hits of multi_ray_into", hits.len(), directions.len())?;
        if cutoff.is_nan() {
            return Err(Error::out_of_range("cutoff of multi_ray_into", cutoff, "a number"));
        }
        for (hit, direction) in hits.iter_mut().zip(directions) {
            *hit = self.ray(point, *direction, options)?.filter(|hit| hit.distance <= cutoff);
        }
        Ok(())
    }

    /// Returns the distance at which a ray hits the mesh of a geom, in units of the length of the
    /// direction.
    ///
    /// # Errors
    ///
    /// As for [`ray`](Self::ray), [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown
    /// key, and [`Error::Invalid`] if the geom is not a mesh.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_rayMesh")]
    pub fn ray_mesh(&self, geom: impl IntoId<kind::Geom>, point: [f64; 3], direction: [f64; 3]) -> Result<Option<f64>> {
        let index = self.geom_of_type("ray_mesh", geom, mjGEOM_MESH, "a mesh")?;
        check_ray(&point, &direction)?;
        // SAFETY: a geom of this model that is a mesh, whose pose was computed, and two vectors of
        // three elements.
        let distance = unsafe {
            sys::adapted::ray_mesh(
                self.model().as_ptr(),
                self.as_ptr(),
                index as c_int,
                point.as_ptr(),
                direction.as_ptr(),
            )
        };
        Ok(hit_distance(distance))
    }

    /// Returns the distance at which a ray hits the height field of a geom, in units of the length
    /// of the direction.
    ///
    /// # Errors
    ///
    /// As for [`ray`](Self::ray), [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown
    /// key, and [`Error::Invalid`] if the geom is not a height field.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_rayHfield")]
    pub fn ray_hfield(
        &self,
        geom: impl IntoId<kind::Geom>,
        point: [f64; 3],
        direction: [f64; 3],
    ) -> Result<Option<f64>> {
        let index = self.geom_of_type("ray_hfield", geom, mjGEOM_HFIELD, "a height field")?;
        check_ray(&point, &direction)?;
        if self.model().is_unsafe_for_rays(index) {
            return Err(out_of_bounds_field(self.model(), index));
        }
        self.check_field_poses()?;
        // SAFETY: a geom of this model that is a height field which the engine reads within bounds,
        // whose pose was computed, and two vectors of three elements.
        let distance = unsafe {
            sys::adapted::ray_hfield(
                self.model().as_ptr(),
                self.as_ptr(),
                index as c_int,
                point.as_ptr(),
                direction.as_ptr(),
            )
        };
        Ok(hit_distance(distance))
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
        let (with_static, hit) = (options.static_geoms.into(), (&raw mut geom, &raw mut distance));
        self.call("mj_ray", |m, d| {
            // SAFETY: two vectors of three elements, six groups or NULL, two valid pointers for the
            // results; the poses were computed.
            unsafe { guard::mj_ray(m, d, point, direction, groups, with_static, exclude, hit.0, hit.1) }
        })?;
        let geom = usize::try_from(geom).ok();
        Ok(geom.map(|geom| RayHit { distance, geom: Id::new(geom, self.model().lineage()) }))
    }

    /// Returns an error for a height field whose orientation, in the data or in the model, is so
    /// far from a rotation that the coordinates of a point in its frame overflow. The engine
    /// converts these coordinates to indices. (NaN does not reach that conversion.)
    #[cold]
    pub(crate) fn check_field_poses(&self) -> Result<()> {
        /// Limit of the elements, far above the elements of rotations and their squares.
        const LARGEST: f64 = 1e20;
        let model = self.model();
        let is_field = |&geom: &usize| model.geom_type()[geom] == mjGEOM_HFIELD as i32;
        let far = |values: &[f64]| values.iter().any(|value| value.abs() > LARGEST);
        // The present pose, which the program can modify, and the model's quaternions, which
        // determine the next pose.
        let is_far = |&geom: &usize| {
            let body = ffi::size(model.geom_bodyid()[geom]);
            far(&self.geom_xmat()[geom]) || far(&model.geom_quat()[geom]) || far(&model.body_iquat()[body])
        };
        match (0..model.ngeom()).filter(is_field).find(is_far) {
            None => Ok(()),
            Some(geom) => Err(Error::Unsupported(format!(
                "rays on the height field of geom {geom}, whose orientation has elements beyond {LARGEST:e}"
            ))),
        }
    }

    fn geom_of_type(
        &self,
        call: &'static str,
        geom: impl IntoId<kind::Geom>,
        geom_type: u32,
        expected: &str,
    ) -> Result<usize> {
        let geom = geom.id_in(&**self.model())?;
        self.check_parts(call, PipelineFlags::KINEMATICS)?;
        let found = self.model().geom_type()[geom.index()];
        if found == geom_type as i32 {
            Ok(geom.index())
        } else {
            let found = GeomType::of_field(found);
            Err(Error::invalid(
                InvalidKind::Unsuitable,
                format!("the geom of {call}"),
                format_args!("a {found:?}"),
                expected,
            ))
        }
    }
}

/// Converts the engine's distance, which is -1 for no intersection.
fn hit_distance(distance: f64) -> Option<f64> {
    Some(distance).filter(|&distance| distance >= 0.0)
}

#[cold]
fn out_of_bounds_field(model: &Model, geom: usize) -> Error {
    let field = ffi::size(model.geom_dataid()[geom]);
    let (rows, columns) = (model.hfield_nrow()[field], model.hfield_ncol()[field]);
    Error::Unsupported(format!(
        "rays on the height field {field} of {rows} rows and {columns} columns: MuJoCo 2.2.2 reads out of bounds in a field \
         with more rows than columns, with less than two of either, or with sizes that are not between 1e-100 and 1e100; turn the field by 90°"
    ))
}
