//! The angular momentum of a subtree as a linear function of velocities.

use super::{Data, Stage};
use crate::error::{Error, Result};
use crate::id::BodyId;
use crate::matrix::Matrix;

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Data {
    /// The matrix `(3, nv)` that maps `qvel` to the angular momentum, kg·m²/s, of a body and everything below it about their
    /// centre of mass, world frame (Orin and Goswami, Centroidal momentum matrix of a humanoid robot, IROS 2008). The meaning is
    /// that of `mj_angmomMat` in the newer engines, which 2.2.2 does not have; [`subtree_vel`](Self::subtree_vel) computes the
    /// momenta themselves.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
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
    pub fn angmom_mat(&self, body: impl Into<BodyId>) -> Result<Matrix> {
        let mut matrix = Matrix::zeros(3, self.model().nv());
        self.angmom_mat_into(body, &mut matrix)?;
        Ok(matrix)
    }

    /// As [`angmom_mat`](Self::angmom_mat), into a matrix of the shape `(3, nv)`.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::Shape`] for a wrong shape.
    ///
    /// # Panics
    ///
    /// If the id is of another model.
    #[doc(alias = "mj_angmomMat")]
    pub fn angmom_mat_into(&self, body: impl Into<BodyId>, matrix: &mut Matrix) -> Result<()> {
        let root = body.into();
        let model = self.model();
        model.check_id(root);
        self.check_computed("angmom_mat", Stage::Position)?;
        Error::check_shape("the matrix of angmom_mat", matrix.shape(), (3, model.nv()))?;
        matrix.as_mut_slice().fill(0.0);
        let (root, parents) = (root.index(), model.body_parentid());
        let centre = self.subtree_com()[root];
        // The bodies of a subtree follow each other.
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
                let swing = cross(rotation, offset);
                let orbital = cross(arm, [tx + swing[0], ty + swing[1], tz + swing[2]]);
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

    /// The last degree of freedom that moves a body; the others are its ancestors.
    fn last_dof(&self, mut body: usize) -> Option<usize> {
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
