//! Jacobians of frames, points and centres of mass, and the matrix of the angular momentum of a
//! subtree.
//!
//! Each function has two forms: one returns new matrices; the other, whose name ends in `_into`,
//! writes to existing matrices and does not allocate. All need the results of [`Data::com_pos`],
//! which [`Data::fwd_position`], [`Data::forward`] and [`Data::step`] compute too.

use std::ffi::c_int;
use std::ptr;

use mujoco_sys::{self as sys, guard};

use crate::data::{Data, PipelineFlags};
use crate::error::{Error, Result};
use crate::id::IntoId;
use crate::kind::{self, ElementKind};
use crate::math::cross;
use crate::matrix::Matrix;

/// Results that Jacobians are computed from.
const INPUTS: PipelineFlags = PipelineFlags::KINEMATICS.union(PipelineFlags::COM_POS);

/// Jacobians of a frame, each `(3, nv)`, world frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Jacobian {
    /// Derivative of the linear velocity of the origin, m/s, with respect to `qvel`.
    pub linear: Matrix,
    /// Derivative of the angular velocity, rad/s, with respect to `qvel`.
    pub angular: Matrix,
}

impl Jacobian {
    /// Returns the matrix `(6, nv)` with the linear part above the angular part, which maps `qvel`
    /// to the velocity of the frame.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// let jacobian = data.jac_body("hand_left")?;
    /// let stacked = jacobian.stacked();
    /// assert_eq!(stacked.row(2), jacobian.linear.row(2));
    /// assert_eq!(stacked.row(3), jacobian.angular.row(0));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn stacked(&self) -> Matrix {
        let values = [self.linear.as_slice(), self.angular.as_slice()].concat();
        Matrix::from_row_major(6, self.linear.ncols(), values)
    }
}

/// Returns the pointer to an output of shape `(3, nv)`, or NULL if the caller does not need the
/// output.
#[inline]
fn output_pointer(what: &'static str, matrix: Option<&mut Matrix>, nv: usize) -> Result<*mut f64> {
    match matrix {
        None => Ok(ptr::null_mut()),
        Some(matrix) => {
            Error::check_shape(what, matrix.shape(), (3, nv))?;
            Ok(matrix.as_mut_ptr())
        }
    }
}

/// Defines both forms of the method for an engine function.
macro_rules! jacobian_of {
    ($(#[$doc:meta])* $name:ident, $into:ident, $kind:ident, $function:ident, $alias:literal) => {
        $(#[$doc])*
        ///
        /// # Errors
        ///
        /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key,
        /// [`Error::NotComputed`] before
    /// [`com_pos`](Self::com_pos).
        ///
        /// # Panics
        ///
        /// If the id belongs to another model.
        #[doc(alias = $alias)]
        pub fn $name(&self, key: impl IntoId<kind::$kind>) -> Result<Jacobian> {
            let mut jacobian = self.zero_jacobian();
            self.$into(key, Some(&mut jacobian.linear), Some(&mut jacobian.angular))?;
            Ok(jacobian)
        }

        #[doc = concat!("Writes the Jacobians of [`", stringify!($name), "`](Self::", stringify!($name), ") to matrices of the shape `(3, nv)`. Matrices that are `None` are not computed.")]
        ///
        /// # Errors
        ///
        /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key,
        /// [`Error::NotComputed`] before
    /// [`com_pos`](Self::com_pos), [`Error::Shape`] for a wrong shape.
        ///
        /// # Panics
        ///
        /// If the id belongs to another model.
        #[doc(alias = $alias)]
        #[inline]
        pub fn $into(&self, key: impl IntoId<kind::$kind>, translation: Option<&mut Matrix>, rotation: Option<&mut Matrix>) -> Result<()> {
            let index = self.index_for(stringify!($name), key)?;
            let (jacp, jacr) = self.output_pointers(translation, rotation)?;
            // SAFETY: the id is of this model; the outputs are NULL or have 3 × nv elements, and
            // the engine writes only there.
            unsafe { sys::$function(self.model().as_ptr(), self.as_ptr(), jacp, jacr, index) };
            Ok(())
        }
    };
}

/// # Jacobians
impl Data {
    jacobian_of! {
        /// Computes the Jacobian of the frame of a body.
        jac_body, jac_body_into, Body, mj_jacBody, "mj_jacBody"
    }
    jacobian_of! {
        /// Computes the Jacobian of the centre of mass of a body.
        ///
        /// ```
        /// use mujoco_safe::{Data, sample};
        ///
        /// let model = std::sync::Arc::new(sample::humanoid());
        /// let foot = model.body("foot_left")?;
        /// let mut data = Data::new(model.clone())?;
        /// data.forward()?;
        /// let jacobian = data.jac_body_com(foot)?;
        /// assert_eq!(jacobian.linear.shape(), (3, model.nv()));
        /// // The foot has the velocity of the root along z.
        /// assert_eq!(jacobian.linear[(2, 2)], 1.0);
        /// # Ok::<(), mujoco_safe::Error>(())
        /// ```
        jac_body_com, jac_body_com_into, Body, mj_jacBodyCom, "mj_jacBodyCom"
    }
    jacobian_of! {
        /// Computes the Jacobian of the frame of a geom.
        jac_geom, jac_geom_into, Geom, mj_jacGeom, "mj_jacGeom"
    }
    jacobian_of! {
        /// Computes the Jacobian of the frame of a site.
        jac_site, jac_site_into, Site, mj_jacSite, "mj_jacSite"
    }

    /// Computes the Jacobian of a point that is attached to a body. The point is in metres, world
    /// frame.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::NotComputed`]
    /// before [`com_pos`](Self::com_pos).
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_jac")]
    pub fn jac(&self, point: [f64; 3], body: impl IntoId<kind::Body>) -> Result<Jacobian> {
        let mut jacobian = self.zero_jacobian();
        self.jac_into(point, body, Some(&mut jacobian.linear), Some(&mut jacobian.angular))?;
        Ok(jacobian)
    }

    /// Writes the Jacobians of [`jac`](Self::jac) to matrices of the shape `(3, nv)`. Matrices that
    /// are `None` are not computed.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::NotComputed`]
    /// before [`com_pos`](Self::com_pos), [`Error::Shape`] for a wrong shape.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_jac")]
    pub fn jac_into(
        &self,
        point: [f64; 3],
        body: impl IntoId<kind::Body>,
        translation: Option<&mut Matrix>,
        rotation: Option<&mut Matrix>,
    ) -> Result<()> {
        let index = self.index_for("jac", body)?;
        let (jacp, jacr) = self.output_pointers(translation, rotation)?;
        // SAFETY: as for the other Jacobians, and the point has three coordinates.
        unsafe { sys::mj_jac(self.model().as_ptr(), self.as_ptr(), jacp, jacr, point.as_ptr(), index) };
        Ok(())
    }

    /// Computes the Jacobian `(3, nv)` of the centre of mass of the subtree of a body, world frame.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::NotComputed`]
    /// before [`com_pos`](Self::com_pos), [`Error::Engine`] if the engine's stack is too small.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_jacSubtreeCom")]
    pub fn jac_subtree_com(&mut self, body: impl IntoId<kind::Body>) -> Result<Matrix> {
        let mut jacobian = Matrix::zeros(3, self.model().nv());
        self.jac_subtree_com_into(body, &mut jacobian)?;
        Ok(jacobian)
    }

    /// Writes the Jacobian of [`jac_subtree_com`](Self::jac_subtree_com) to a matrix of the shape
    /// `(3, nv)`.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::NotComputed`]
    /// before [`com_pos`](Self::com_pos), [`Error::Shape`] for a wrong shape, [`Error::Engine`] if
    /// the engine's stack is too small.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_jacSubtreeCom")]
    pub fn jac_subtree_com_into(&mut self, body: impl IntoId<kind::Body>, jacobian: &mut Matrix) -> Result<()> {
        let index = self.index_for("jac_subtree_com", body)?;
        let jacp = output_pointer("jacobian", Some(jacobian), self.model().nv())?;
        self.call_mut("mj_jacSubtreeCom", |m, d| {
            // SAFETY: a body of this model, and an output of 3 × nv elements.
            unsafe { guard::mj_jac_subtree_com(m, d, jacp, index) }
        })
    }

    /// Computes the Jacobians `(3, nv)` of a point and of an axis that are attached to a body. Both
    /// are in the world frame, the point in metres.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::NotComputed`]
    /// before [`com_pos`](Self::com_pos), [`Error::Engine`] if the engine's stack is too small.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.forward()?;
    /// let pole = data.model().body("pole")?.id();
    /// let [point, axis] = data.jac_point_axis([0.0; 3], [0.0, 0.0, 1.0], pole)?;
    /// assert_eq!(point[(0, 0)], 1.0); // the cart translates the point,
    /// assert_eq!(axis[(0, 0)], 0.0); // and does not rotate the axis
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_jacPointAxis")]
    pub fn jac_point_axis(
        &mut self,
        point: [f64; 3],
        axis: [f64; 3],
        body: impl IntoId<kind::Body>,
    ) -> Result<[Matrix; 2]> {
        let nv = self.model().nv();
        let mut jacobians = [Matrix::zeros(3, nv), Matrix::zeros(3, nv)];
        let [jac_point, jac_axis] = &mut jacobians;
        self.jac_point_axis_into(point, axis, body, Some(jac_point), Some(jac_axis))?;
        Ok(jacobians)
    }

    /// Writes the Jacobians of [`jac_point_axis`](Self::jac_point_axis) to matrices of the shape
    /// `(3, nv)`. Matrices that are `None` are not computed.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::NotComputed`]
    /// before [`com_pos`](Self::com_pos), [`Error::Shape`] for a wrong shape, [`Error::Engine`] if
    /// the engine's stack is too small.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_jacPointAxis")]
    pub fn jac_point_axis_into(
        &mut self,
        point: [f64; 3],
        axis: [f64; 3],
        body: impl IntoId<kind::Body>,
        jac_point: Option<&mut Matrix>,
        jac_axis: Option<&mut Matrix>,
    ) -> Result<()> {
        let index = self.index_for("jac_point_axis", body)?;
        let nv = self.model().nv();
        let (jac_point, jac_axis) =
            (output_pointer("jac_point", jac_point, nv)?, output_pointer("jac_axis", jac_axis, nv)?);
        self.call_mut("mj_jacPointAxis", |m, d| {
            // SAFETY: a body of this model, outputs that are NULL or have 3 × nv elements, and two
            // vectors of three elements.
            unsafe { guard::mj_jac_point_axis(m, d, jac_point, jac_axis, point.as_ptr(), axis.as_ptr(), index) }
        })
    }

    /// Computes the matrix `(3, nv)` that maps `qvel` to the angular momentum, kg·m²/s, of the
    /// subtree of a body about its centre of mass, world frame (Orin and Goswami, Centroidal
    /// momentum matrix of a humanoid robot, IROS 2008). Newer engines provide this as
    /// `mj_angmomMat`; 2.2.2 does not. [`subtree_vel`](Self::subtree_vel) computes the momenta.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::NotComputed`]
    /// before [`com_pos`](Self::com_pos).
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.qvel_mut().fill(0.3);
    /// data.forward()?;
    /// data.subtree_vel()?;
    /// let torso = data.model().body("torso")?.id();
    /// let matrix = data.angmom_mat(torso)?;
    /// for (row, momentum) in matrix.rows().zip(data.subtree_angmom()[torso.index()]) {
    ///     let product: f64 = row.iter().zip(data.qvel()).map(|(entry, velocity)| entry * velocity).sum();
    ///     assert!((product - momentum).abs() < 1e-9);
    /// }
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_angmomMat")]
    pub fn angmom_mat(&self, body: impl IntoId<kind::Body>) -> Result<Matrix> {
        let mut matrix = Matrix::zeros(3, self.model().nv());
        self.angmom_mat_into(body, &mut matrix)?;
        Ok(matrix)
    }

    /// Writes the matrix of [`angmom_mat`](Self::angmom_mat) to a matrix of the shape `(3, nv)`.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown key, [`Error::NotComputed`]
    /// before [`com_pos`](Self::com_pos), [`Error::Shape`] for a wrong shape.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    #[doc(alias = "mj_angmomMat")]
    pub fn angmom_mat_into(&self, body: impl IntoId<kind::Body>, matrix: &mut Matrix) -> Result<()> {
        let model = self.model();
        let root = body.id_in(&**model)?;
        self.check_parts("angmom_mat", INPUTS)?;
        Error::check_shape("the matrix of angmom_mat", matrix.shape(), (3, model.nv()))?;
        matrix.as_mut_slice().fill(0.0);
        let (root, parents) = (root.index(), model.body_parentid());
        let centre = self.subtree_com()[root];
        // The bodies of a subtree are consecutive.
        let subtree = (root..model.nbody()).take_while(|&body| body == root || parents[body] as usize >= root);
        for body in subtree {
            let Some(last) = self.last_dof(body) else { continue };
            let (mass, inertia) = (model.body_mass()[body], model.body_inertia()[body]);
            let (position, axes) = (self.xipos()[body], self.ximat()[body]);
            let origin = self.subtree_com()[model.body_rootid()[body] as usize];
            let arm: [f64; 3] = std::array::from_fn(|i| position[i] - centre[i]);
            let offset: [f64; 3] = std::array::from_fn(|i| position[i] - origin[i]);
            let mut dof = Some(last);
            while let Some(index) = dof {
                let [rx, ry, rz, tx, ty, tz] = self.cdof()[index];
                let rotation = [rx, ry, rz];
                let swing = cross(&rotation, &offset);
                let orbital = cross(&arm, &[tx + swing[0], ty + swing[1], tz + swing[2]]);
                let spin: [f64; 3] = std::array::from_fn(|axis| {
                    let along: f64 = (0..3).map(|i| axes[3 * i + axis] * rotation[i]).sum();
                    inertia[axis] * along
                });
                for (i, orbital) in orbital.iter().enumerate() {
                    let spin: f64 = (0..3).map(|axis| axes[3 * i + axis] * spin[axis]).sum();
                    matrix[(i, index)] += mass * orbital + spin;
                }
                dof = usize::try_from(model.dof_parentid()[index]).ok();
            }
        }
        Ok(())
    }

    pub(super) fn zero_jacobian(&self) -> Jacobian {
        let nv = self.model().nv();
        Jacobian { linear: Matrix::zeros(3, nv), angular: Matrix::zeros(3, nv) }
    }

    #[inline]
    fn output_pointers(
        &self,
        translation: Option<&mut Matrix>,
        rotation: Option<&mut Matrix>,
    ) -> Result<(*mut f64, *mut f64)> {
        let nv = self.model().nv();
        Ok((output_pointer("translation", translation, nv)?, output_pointer("rotation", rotation, nv)?))
    }

    #[inline]
    fn index_for<K: ElementKind>(&self, call: &'static str, key: impl IntoId<K>) -> Result<c_int> {
        let id = key.id_in(&**self.model())?;
        self.check_parts(call, INPUTS)?;
        Ok(id.index() as c_int)
    }

    /// Returns the last degree of freedom that moves a body. The others are its ancestors.
    pub(super) fn last_dof(&self, mut body: usize) -> Option<usize> {
        let model = self.model();
        while body > 0 {
            let count = model.body_dofnum()[body];
            if count > 0 {
                return Some((model.body_dofadr()[body] + count - 1) as usize);
            }
            body = model.body_parentid()[body] as usize;
        }
        None
    }
}
