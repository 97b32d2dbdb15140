//! The Jacobian of a residual, and its computation by differences.

use super::Residual;
use super::momentum::Momenta;
use crate::data::{Data, StateSpec};
use crate::derivative::{self, Lineariser, TransitionOptions, TransitionOutputs};
use crate::error::{Error, Result};
use crate::matrix::Matrix;
use crate::model::Model;
use crate::numerics::linear_algebra::add;

/// Step of the central differences. Their error is of order ε², and rounding of order 1e-16/ε.
const EPS: f64 = 1e-5;

/// State components that differences perturb, or that the evaluation of a perturbed state changes.
const SAVED: StateSpec = StateSpec::PHYSICS.union(StateSpec::WARMSTART).union(StateSpec::CTRL);

/// Jacobian of a residual with `n` components, `(n, nx)` with respect to the state `[dq; dv; da]`,
/// with `nx = 2 nv + na` and `dq` in the tangent space of positions, and `(n, nu)` with respect to
/// the controls.
///
/// ```
/// use mujoco_safe::control::residual::{JointPosition, Residual, ResidualJacobian};
/// use mujoco_safe::{Data, sample};
///
/// let mut data = Data::new(sample::cartpole())?;
/// let angle = JointPosition::new(data.model(), "hinge")?;
/// let mut jacobian = ResidualJacobian::zeros(data.model(), angle.size());
/// angle.differentiate(&mut data, &mut jacobian)?;
/// assert_eq!(jacobian.by_state(0), [0.0, 1.0, 0.0, 0.0]);
/// assert_eq!(jacobian.by_controls(0), [0.0]);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Debug)]
pub struct ResidualJacobian {
    /// `(n, nx + nu)`
    matrix: Matrix,
    /// Number of states.
    nx: usize,
    /// `(3, nv)`: Jacobians of frames.
    pub(super) linear: Matrix,
    pub(super) angular: Matrix,
    pub(super) momenta: Momenta,
    sensors: Option<Box<SensorDerivatives>>,
    differences: Differences,
}

/// Derivatives of all sensors at one point.
#[derive(Debug)]
struct SensorDerivatives {
    lineariser: Lineariser,
    c: Matrix,
    d: Matrix,
    /// True if C and D belong to the present point.
    present: bool,
}

/// Buffers of [`ResidualJacobian::difference`].
#[derive(Debug, Default)]
struct Differences {
    saved: Vec<f64>,
    direction: Vec<f64>,
    plus: Vec<f64>,
    minus: Vec<f64>,
}

impl ResidualJacobian {
    /// Creates a Jacobian of zeros for a residual with `size` components.
    pub fn zeros(model: &Model, size: usize) -> Self {
        let (nx, nu, _) = derivative::sizes(model);
        Self {
            matrix: Matrix::zeros(size, nx + nu),
            nx,
            linear: Matrix::zeros(3, model.nv()),
            angular: Matrix::zeros(3, model.nv()),
            momenta: Momenta::new(model),
            sensors: None,
            differences: Differences::default(),
        }
    }

    /// Returns the derivatives of a component with respect to the state, `(nx)`.
    ///
    /// # Panics
    ///
    /// If there is no such component.
    pub fn by_state(&self, component: usize) -> &[f64] {
        &self.matrix.row(component)[..self.nx]
    }

    /// Returns the derivatives of a component with respect to the controls, `(nu)`.
    ///
    /// # Panics
    ///
    /// If there is no such component.
    pub fn by_controls(&self, component: usize) -> &[f64] {
        &self.matrix.row(component)[self.nx..]
    }

    /// Returns the derivatives of a component with respect to the state, `(nx)`, for writing.
    ///
    /// # Panics
    ///
    /// If there is no such component.
    pub fn by_state_mut(&mut self, component: usize) -> &mut [f64] {
        let nx = self.nx;
        &mut self.matrix.row_mut(component)[..nx]
    }

    /// Returns the derivatives of a component with respect to the controls, `(nu)`, for writing.
    ///
    /// # Panics
    ///
    /// If there is no such component.
    pub fn by_controls_mut(&mut self, component: usize) -> &mut [f64] {
        let nx = self.nx;
        &mut self.matrix.row_mut(component)[nx..]
    }

    /// Computes the Jacobian by central differences. This is the default of
    /// [`Residual::differentiate`]. It evaluates the residual and the results that it needs
    /// `2 (nx + nu)` times, which for a humanoid takes several hundred times as long as a Jacobian
    /// in closed form. The relative error is about 1e-10.
    ///
    /// The state and the results of the simulation are unchanged afterwards, except for rounding.
    ///
    /// # Errors
    ///
    /// The errors of the residual and of [`Data::forward`].
    pub fn difference<R: Residual + ?Sized>(&mut self, residual: &R, data: &mut Data) -> Result<()> {
        let model = data.model().clone();
        let nv = model.nv();
        let columns = self.matrix.ncols();
        let Self { matrix, nx, differences: Differences { saved, direction, plus, minus }, .. } = self;
        saved.resize(model.state_size(SAVED), 0.0);
        data.state_into(SAVED, saved)?;
        direction.clear();
        direction.resize(nv, 0.0);
        plus.resize(residual.size(), 0.0);
        minus.resize(residual.size(), 0.0);
        for column in 0..columns {
            for (eps, output) in [(EPS, &mut *plus), (-EPS, &mut *minus)] {
                data.set_state(SAVED, saved)?;
                if column < nv {
                    direction[column] = 1.0;
                    model.integrate_pos(data.qpos_mut(), direction, eps)?;
                    direction[column] = 0.0;
                } else if column < *nx {
                    // Velocities and activations follow the positions in the state.
                    let index = column - nv;
                    let value = if index < nv { &mut data.qvel_mut()[index] } else { &mut data.act_mut()[index - nv] };
                    *value += eps;
                } else {
                    data.ctrl_mut()[column - *nx] += eps;
                }
                residual.needs().compute(data)?;
                residual.evaluate(data, output)?;
            }
            for (component, (plus, minus)) in plus.iter().zip(&*minus).enumerate() {
                matrix[(component, column)] = (plus - minus) / (2.0 * EPS);
            }
        }
        data.set_state(SAVED, saved)?;
        residual.needs().compute(data)
    }

    /// Prepares for the Jacobians at another point.
    pub(crate) fn move_point(&mut self) {
        if let Some(sensors) = &mut self.sensors {
            sensors.present = false;
        }
    }

    /// Sets the first `size` rows to zero.
    pub(crate) fn clear(&mut self, size: usize) {
        let width = self.matrix.ncols();
        self.matrix.as_mut_slice()[..size * width].fill(0.0);
    }

    /// Returns the derivatives of a component, `(nx + nu)`.
    pub(crate) fn row(&self, component: usize) -> &[f64] {
        self.matrix.row(component)
    }

    /// Copies the Jacobian of a point to the first three rows.
    pub(super) fn copy_linear(&mut self) {
        for (component, values) in self.linear.rows().enumerate() {
            self.matrix.row_mut(component)[..values.len()].copy_from_slice(values);
        }
    }

    /// Adds a linear combination of the rows of the linear Jacobian to a row.
    pub(super) fn add_linear(&mut self, component: usize, factors: [f64; 3]) {
        add_rows(self.matrix.row_mut(component), &self.linear, factors);
    }

    /// Adds a linear combination of the rows of the angular Jacobian to a row.
    pub(super) fn add_angular(&mut self, component: usize, factors: [f64; 3]) {
        add_rows(self.matrix.row_mut(component), &self.angular, factors);
    }

    /// Writes the rows of sensors from `first` on to the first `size` rows.
    pub(super) fn write_sensors(&mut self, data: &mut Data, first: usize, size: usize) -> Result<()> {
        if self.sensors.is_none() {
            let (nx, nu, ny) = derivative::sizes(data.model());
            let lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default())?;
            let (c, d) = (Matrix::zeros(ny, nx), Matrix::zeros(ny, nu));
            self.sensors = Some(Box::new(SensorDerivatives { lineariser, c, d, present: false }));
        }
        let Some(sensors) = &mut self.sensors else { unreachable!("Bug: the derivatives were just created") };
        if !sensors.present {
            let SensorDerivatives { lineariser, c, d, .. } = &mut **sensors;
            let outputs = TransitionOutputs { c: Some(c), d: Some(d), ..Default::default() };
            lineariser.linear_system_into(data, outputs)?;
            sensors.present = true;
        }
        Error::check_shape("C of the sensors", sensors.c.shape(), (data.model().nsensordata(), self.nx))?;
        for component in 0..size {
            let (state, controls) = self.matrix.row_mut(component).split_at_mut(self.nx);
            state.copy_from_slice(sensors.c.row(first + component));
            controls.copy_from_slice(sensors.d.row(first + component));
        }
        Ok(())
    }
}

/// Adds a linear combination of the rows of a matrix to the first entries of `output`.
fn add_rows(output: &mut [f64], matrix: &Matrix, factors: [f64; 3]) {
    for (values, factor) in matrix.rows().zip(factors) {
        if factor != 0.0 {
            add(output, values, factor);
        }
    }
}
