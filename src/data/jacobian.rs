//! Jacobians: how points on bodies move with the degrees of freedom.
//!
//! Each has two forms: one that returns new matrices, and one, ending in `_into`, that writes to the caller's and allocates
//! nothing. All need positions to be computed.

use std::ffi::c_int;
use std::ptr;

use mujoco_sys::{self as sys, guard};

use super::{Data, Stage};
use crate::error::{Error, Result};
use crate::id::{BodyId, ElementKind, GeomId, Id, SiteId};
use crate::matrix::Matrix;

/// The two Jacobians of a frame, each `(3, nv)`, world frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Jacobian {
    /// How its origin moves: m/s for each unit of velocity.
    pub translation: Matrix,
    /// How it turns: rad/s for each unit of velocity.
    pub rotation: Matrix,
}

/// A matrix that the engine may leave out, and the size that it must have.
#[inline]
fn output(what: &'static str, matrix: Option<&mut Matrix>, nv: usize) -> Result<*mut f64> {
    match matrix {
        None => Ok(ptr::null_mut()),
        Some(matrix) => {
            Error::check_shape(what, matrix.shape(), (3, nv))?;
            Ok(matrix.as_mut_ptr())
        }
    }
}

/// The pair of methods for one of the engine's functions.
macro_rules! jacobian_of {
    ($(#[$doc:meta])* $name:ident, $into:ident, $id:ty, $function:ident, $alias:literal) => {
        $(#[$doc])*
        ///
        /// # Errors
        ///
        /// [`Error::NotComputed`] before positions were computed.
        ///
        /// # Panics
        ///
        /// If the id is of another model.
        #[doc(alias = $alias)]
        pub fn $name(&self, id: impl Into<$id>) -> Result<Jacobian> {
            let mut jacobian = self.empty_jacobian();
            self.$into(id, Some(&mut jacobian.translation), Some(&mut jacobian.rotation))?;
            Ok(jacobian)
        }

        #[doc = concat!("As [`", stringify!($name), "`](Self::", stringify!($name), "), into matrices of the shape `(3, nv)`, each of which may be left out.")]
        ///
        /// # Errors
        ///
        /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong shape.
        ///
        /// # Panics
        ///
        /// If the id is of another model.
        #[doc(alias = $alias)]
        #[inline]
        pub fn $into(&self, id: impl Into<$id>, translation: Option<&mut Matrix>, rotation: Option<&mut Matrix>) -> Result<()> {
            let index = self.index_for(stringify!($name), id.into())?;
            let (jacp, jacr) = self.outputs(translation, rotation)?;
            // SAFETY: the id is one of this model's; the outputs are NULL or have 3 × nv values, and the engine writes only there.
            unsafe { sys::$function(self.model().as_ptr(), self.as_ptr(), jacp, jacr, index) };
            Ok(())
        }
    };
}

impl Data {
    jacobian_of! {
        /// The Jacobian of a body's frame.
        jac_body, jac_body_into, BodyId, mj_jacBody, "mj_jacBody"
    }
    jacobian_of! {
        /// The Jacobian of a body's centre of mass.
        ///
        /// ```
        /// use mujoco_safe::{Data, sample};
        ///
        /// let model = std::sync::Arc::new(sample::humanoid());
        /// let foot = model.body("foot_left")?;
        /// let mut data = Data::new(model.clone())?;
        /// data.forward()?;
        /// let jacobian = data.jac_body_com(foot)?;
        /// assert_eq!(jacobian.translation.shape(), (3, model.nv()));
        /// // Moving the root along z by 1 m/s moves the foot by 1 m/s.
        /// assert_eq!(jacobian.translation[(2, 2)], 1.0);
        /// # Ok::<(), mujoco_safe::Error>(())
        /// ```
        jac_body_com, jac_body_com_into, BodyId, mj_jacBodyCom, "mj_jacBodyCom"
    }
    jacobian_of! {
        /// The Jacobian of a geom's frame.
        jac_geom, jac_geom_into, GeomId, mj_jacGeom, "mj_jacGeom"
    }
    jacobian_of! {
        /// The Jacobian of a site's frame.
        jac_site, jac_site_into, SiteId, mj_jacSite, "mj_jacSite"
    }

    /// The Jacobian of a point, in metres in the world frame, that moves with a body.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mj_jac")]
    pub fn jac(&self, body: impl Into<BodyId>, point: [f64; 3]) -> Result<Jacobian> {
        let mut jacobian = self.empty_jacobian();
        self.jac_into(body, point, Some(&mut jacobian.translation), Some(&mut jacobian.rotation))?;
        Ok(jacobian)
    }

    /// As [`jac`](Self::jac), into matrices of the shape `(3, nv)`, each of which may be left out.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong shape.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mj_jac")]
    pub fn jac_into(
        &self,
        body: impl Into<BodyId>,
        point: [f64; 3],
        translation: Option<&mut Matrix>,
        rotation: Option<&mut Matrix>,
    ) -> Result<()> {
        let index = self.index_for("jac", body.into())?;
        let (jacp, jacr) = self.outputs(translation, rotation)?;
        // SAFETY: as for the others, and the point has three coordinates.
        unsafe { sys::mj_jac(self.model().as_ptr(), self.as_ptr(), jacp, jacr, point.as_ptr(), index) };
        Ok(())
    }

    /// The Jacobian `(3, nv)` of the centre of mass of a body and everything below it, world frame.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Engine`] if the engine's stack is too small.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mj_jacSubtreeCom")]
    pub fn jac_subtree_com(&mut self, body: impl Into<BodyId>) -> Result<Matrix> {
        let mut jacobian = Matrix::zeros(3, self.model().nv());
        self.jac_subtree_com_into(body, &mut jacobian)?;
        Ok(jacobian)
    }

    /// As [`jac_subtree_com`](Self::jac_subtree_com), into a matrix of the shape `(3, nv)`.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong shape, [`Error::Engine`] if the
    /// engine's stack is too small.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mj_jacSubtreeCom")]
    pub fn jac_subtree_com_into(&mut self, body: impl Into<BodyId>, jacobian: &mut Matrix) -> Result<()> {
        let index = self.index_for("jac_subtree_com", body.into())?;
        let jacp = output("jacobian", Some(jacobian), self.model().nv())?;
        self.call_mut("mj_jacSubtreeCom", |m, d| {
            // SAFETY: the index is that of a body of this model, and the output has 3 × nv values.
            unsafe { guard::mj_jac_subtree_com(m, d, jacp, index) }
        })
    }

    /// How a point on a body, in m, world frame, and an axis of the body, world frame, move: the Jacobians `(3, nv)` of the point
    /// and of the axis.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Engine`] if the engine's stack is too small.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.forward()?;
    /// let pole = data.model().body("pole")?.id();
    /// let [point, axis] = data.jac_point_axis(pole, [0.0; 3], [0.0, 0.0, 1.0])?;
    /// assert_eq!(point[(0, 0)], 1.0); // the cart takes the point along,
    /// assert_eq!(axis[(0, 0)], 0.0); // and turns nothing
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_jacPointAxis")]
    pub fn jac_point_axis(&mut self, body: impl Into<BodyId>, point: [f64; 3], axis: [f64; 3]) -> Result<[Matrix; 2]> {
        let nv = self.model().nv();
        let mut jacobians = [Matrix::zeros(3, nv), Matrix::zeros(3, nv)];
        let [jac_point, jac_axis] = &mut jacobians;
        self.jac_point_axis_into(body, point, axis, Some(jac_point), Some(jac_axis))?;
        Ok(jacobians)
    }

    /// As [`jac_point_axis`](Self::jac_point_axis), into matrices of the shape `(3, nv)`, each of which may be left out.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong shape, [`Error::Engine`] if the
    /// engine's stack is too small.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mj_jacPointAxis")]
    pub fn jac_point_axis_into(
        &mut self,
        body: impl Into<BodyId>,
        point: [f64; 3],
        axis: [f64; 3],
        jac_point: Option<&mut Matrix>,
        jac_axis: Option<&mut Matrix>,
    ) -> Result<()> {
        let index = self.index_for("jac_point_axis", body.into())?;
        let nv = self.model().nv();
        let (jac_point, jac_axis) = (output("jac_point", jac_point, nv)?, output("jac_axis", jac_axis, nv)?);
        self.call_mut("mj_jacPointAxis", |m, d| {
            // SAFETY: a body of this model, outputs that are NULL or have 3 × nv values, and two vectors of three numbers.
            unsafe { guard::mj_jac_point_axis(m, d, jac_point, jac_axis, point.as_ptr(), axis.as_ptr(), index) }
        })
    }

    fn empty_jacobian(&self) -> Jacobian {
        let nv = self.model().nv();
        Jacobian { translation: Matrix::zeros(3, nv), rotation: Matrix::zeros(3, nv) }
    }

    #[inline]
    fn outputs(&self, translation: Option<&mut Matrix>, rotation: Option<&mut Matrix>) -> Result<(*mut f64, *mut f64)> {
        let nv = self.model().nv();
        Ok((output("translation", translation, nv)?, output("rotation", rotation, nv)?))
    }

    #[inline]
    fn index_for<K: ElementKind>(&self, call: &'static str, id: Id<K>) -> Result<c_int> {
        self.model().check_id(id);
        self.check_computed(call, Stage::Position)?;
        Ok(id.index() as c_int)
    }
}
