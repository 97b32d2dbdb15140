//! Residual of a linear combination of joint positions.

use super::{Needs, Residual, ResidualJacobian, check_model};
use crate::data::Data;
use crate::enums::JointType;
use crate::error::{Error, InvalidKind, Result};
use crate::ffi;
use crate::id::{IntoId, Lineage};
use crate::kind;
use crate::model::Model;

/// Linear combination of the positions of hinges and slides, minus a target: one component, in the
/// unit of the sum.
///
/// ```
/// use mujoco_safe::control::residual::{JointCoupling, Residual};
/// use mujoco_safe::{Data, sample};
///
/// // The knees bend together.
/// let mut data = Data::new(sample::humanoid())?;
/// let knees = JointCoupling::new(data.model(), &[("left_knee", 1.0), ("right_knee", -1.0)])?;
/// data.joint_mut("left_knee")?.qpos_mut()[0] = 0.3;
/// let mut residual = [0.0];
/// knees.evaluate(&mut data, &mut residual)?;
/// assert_eq!(residual, [0.3]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct JointCoupling {
    /// Place in `qpos`, degree of freedom and coefficient of each joint.
    terms: Vec<(usize, usize, f64)>,
    target: [f64; 1],
    lineage: Lineage,
}

impl JointCoupling {
    /// Creates the residual from joints and their coefficients. The target is zero.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown joint, [`Error::Invalid`] for
    /// a ball or a free joint, and for a coefficient that is not finite.
    ///
    /// # Panics
    ///
    /// If an id belongs to another model.
    pub fn new<J: IntoId<kind::Joint> + Clone>(model: &Model, terms: &[(J, f64)]) -> Result<Self> {
        let term = |(joint, coefficient): &(J, f64)| {
            let id = joint.clone().id_in(model)?;
            let index = id.index();
            if !matches!(JointType::of_field(model.jnt_type()[index]), JointType::Hinge | JointType::Slide) {
                return Err(Error::invalid(InvalidKind::Unsuitable, "a coupled joint", id, "a hinge or a slide"));
            }
            if !coefficient.is_finite() {
                return Err(Error::not_finite(format!("the coefficient of {id}"), coefficient));
            }
            Ok((ffi::size(model.jnt_qposadr()[index]), ffi::size(model.jnt_dofadr()[index]), *coefficient))
        };
        let terms = terms.iter().map(term).collect::<Result<_>>()?;
        Ok(Self { terms, target: [0.0], lineage: model.lineage() })
    }

    /// Sets the target.
    #[must_use]
    pub fn with_target(mut self, target: f64) -> Self {
        self.target = [target];
        self
    }
}

impl Residual for JointCoupling {
    fn size(&self) -> usize {
        1
    }

    fn needs(&self) -> Needs {
        Needs::State
    }

    fn evaluate(&self, data: &mut Data, residual: &mut [f64]) -> Result<()> {
        check_model(data, self.lineage)?;
        let sum: f64 = self.terms.iter().map(|&(place, _, coefficient)| coefficient * data.qpos()[place]).sum();
        residual[0] = sum - self.target[0];
        Ok(())
    }

    fn differentiate(&self, data: &mut Data, jacobian: &mut ResidualJacobian) -> Result<()> {
        check_model(data, self.lineage)?;
        for &(_, dof, coefficient) in &self.terms {
            jacobian.by_state_mut(0)[dof] += coefficient;
        }
        Ok(())
    }

    fn target_mut(&mut self) -> Option<&mut [f64]> {
        Some(&mut self.target)
    }
}
