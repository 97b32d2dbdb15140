//! Outputs and buffers of derivatives by parameters.

use super::differences::ParameterDifferences;
use super::{ModelParameter, Resolved};
use crate::data::Data;
use crate::derivative::sizes;
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;

/// Derivatives of a step by parameters of the model, with a column for each parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterJacobian {
    /// `(2 nv + na, n)`: derivatives of the next state, in the tangent space of positions.
    pub state: Matrix,
    /// `(nsensordata, n)`: derivatives of the sensors at the present state.
    pub sensors: Matrix,
}

impl ParameterJacobian {
    /// Creates matrices of zeros for a model and a number of parameters.
    pub fn zeros(model: &Model, parameters: usize) -> Self {
        let (nx, _, ny) = sizes(model);
        Self { state: Matrix::zeros(nx, parameters), sensors: Matrix::zeros(ny, parameters) }
    }
}

/// Outputs of [`Lineariser::parameter_jacobian_into`](crate::Lineariser::parameter_jacobian_into).
/// Matrices that are `None` are not computed.
#[derive(Debug, Default)]
pub struct ParameterOutputs<'a> {
    /// `(2 nv + na, n)`
    pub state: Option<&'a mut Matrix>,
    /// `(nsensordata, n)`
    pub sensors: Option<&'a mut Matrix>,
}

impl ParameterOutputs<'_> {
    /// Checks the shapes for a number of parameters.
    pub(in crate::derivative) fn check(&self, model: &Model, parameters: usize) -> Result<()> {
        let (nx, _, ny) = sizes(model);
        for (what, output, rows) in [
            ("the state of parameter_jacobian", &self.state, nx),
            ("the sensors of parameter_jacobian", &self.sensors, ny),
        ] {
            if let Some(output) = output {
                Error::check_shape(what, output.shape(), (rows, parameters))?;
            }
        }
        Ok(())
    }
}

impl<'a> From<&'a mut ParameterJacobian> for ParameterOutputs<'a> {
    fn from(jacobian: &'a mut ParameterJacobian) -> Self {
        Self { state: Some(&mut jacobian.state), sensors: Some(&mut jacobian.sensors) }
    }
}

/// Parameters with their effects, and the simulation for differences.
#[derive(Debug, Default)]
pub(in crate::derivative) struct ParameterBuffers {
    pub(in crate::derivative) resolved: Vec<Resolved>,
    /// Created when a parameter is first differenced.
    differences: Option<Box<ParameterDifferences>>,
    /// Column of differences.
    column: Vec<f64>,
}

impl ParameterBuffers {
    /// Forgets the parameters, since the model changes.
    pub(in crate::derivative) fn clear(&mut self) {
        self.resolved.clear();
    }

    /// Resolves parameters, unless they are the last ones.
    pub(in crate::derivative) fn resolve(&mut self, model: &Model, parameters: &[ModelParameter]) -> Result<()> {
        if self.resolved.iter().map(|resolved| &resolved.parameter).eq(parameters) {
            return Ok(());
        }
        self.resolved.clear();
        for &parameter in parameters {
            self.resolved.push(Resolved::new(model, parameter)?);
        }
        Ok(())
    }

    /// Returns the differences about the present state and accelerations, and the buffer for a
    /// column.
    pub(in crate::derivative) fn differences_at(
        &mut self,
        data: &Data,
    ) -> Result<(&[Resolved], &mut ParameterDifferences, &mut Vec<f64>)> {
        let differences = match &mut self.differences {
            Some(differences) => differences,
            empty => empty.insert(Box::new(ParameterDifferences::new(data)?)),
        };
        differences.set_base(data)?;
        Ok((&self.resolved, differences, &mut self.column))
    }
}
