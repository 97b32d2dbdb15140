//! Process noise: the random part of the motion between two readings.

use std::sync::Arc;

use super::covariance;
use crate::data::Data;
use crate::derivative;
use crate::error::{Error, Result};
use crate::id::{BodyId, IntoId};
use crate::kind;
use crate::matrix::{Matrix, StridedView};
use crate::model::{IntoModel, Model};
use crate::numerics::linear_algebra::{add, add_product, add_products, symmetrise};

/// Noise of a step of the simulation: disturbances and errors of the model, as standard deviations
/// of independent numbers that are drawn for each step.
///
/// | noise | acts on |
/// |---|---|
/// | [`with_covariance`](Self::with_covariance) | the state after the step, in tangent coordinates |
/// | [`with_forces`](Self::with_forces) | the degrees of freedom |
/// | [`with_body_forces`](Self::with_body_forces) | a body, as a force and a torque at its centre of mass |
/// | [`with_contact_forces`](Self::with_contact_forces) | the two bodies of each contact |
/// | [`with_controls`](Self::with_controls) | the controls |
///
/// A force f acts during the step. It changes the accelerations by `α = M⁻¹ f`, and the velocities
/// after the step by `h α` with the time step h. Accelerometers measure it too, so they tell the
/// filter how it acts; other sensors of accelerations and forces do not. The forces of contacts and
/// dampers that the simulation computes do not react to f in the same step.
///
/// White noise with the power spectral density S, N²/Hz, has the deviation `√(S / h)` in a step.
///
/// # Unknown contacts
///
/// Contacts begin and end between two states that differ by less than the error of the estimate,
/// and their forces are known badly. With [`with_contact_forces`](Self::with_contact_forces), the
/// accelerations that the contacts of the simulation cause are as uncertain as these forces, and an
/// accelerometer on a robot measures them instead. (M. Bloesch and others, *State Estimation for
/// Legged Robots*, 2012, take all accelerations of the base from its accelerometer, and allow for
/// contacts that slip by a random walk of their points.)
///
/// ```
/// use mujoco_safe::estimation::ProcessNoise;
/// use mujoco_safe::sample;
///
/// let model = sample::humanoid();
/// let (nv, nu) = (model.nv(), model.nu());
/// let noise = ProcessNoise::new(model)
///     .with_forces(&vec![0.5; nv])?        // N and N·m
///     .with_body_forces("torso", 20.0, 2.0)?
///     .with_contact_forces(50.0, 20.0)?
///     .with_controls(&vec![0.01; nu])?;
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct ProcessNoise {
    pub(super) model: Arc<Model>,
    /// `(nx, nx)`
    pub(super) covariance: Matrix,
    /// Variances of the generalised forces, `(nv)`.
    forces: Vec<f64>,
    /// Variances of the force and the torque on a body.
    bodies: Vec<(BodyId, [f64; 2])>,
    /// Variances of the force of a contact along its normal and its tangents.
    contacts: Option<[f64; 2]>,
    /// Variances of the controls, `(nu)`; empty for none.
    pub(super) controls: Vec<f64>,
}

impl ProcessNoise {
    /// Creates a process without noise.
    pub fn new(model: impl IntoModel) -> Self {
        let model = model.into_model();
        let (nx, ..) = derivative::sizes(&model);
        Self {
            covariance: Matrix::zeros(nx, nx),
            forces: vec![0.0; model.nv()],
            bodies: Vec::new(),
            contacts: None,
            controls: Vec::new(),
            model,
        }
    }

    /// Sets the covariance `(nx, nx)` of the noise that is added to the state after each step, in
    /// the coordinates `[dq; dv; da]` with `nx = 2 nv + na`.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape, [`Error::Invalid`] for a matrix that is not finite,
    /// symmetric and positive semidefinite.
    pub fn with_covariance<'a>(mut self, covariance: impl Into<StridedView<'a>>) -> Result<Self> {
        let covariance = covariance.into().to_matrix();
        covariance::check("the covariance of a ProcessNoise", &covariance, self.covariance.nrows())?;
        self.covariance = covariance;
        Ok(self)
    }

    /// Sets the standard deviations of generalised forces `(nv)`, N or N·m.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length, [`Error::Invalid`] for a number that is negative or
    /// not finite.
    pub fn with_forces(mut self, deviations: &[f64]) -> Result<Self> {
        Error::check_length("the deviations of the generalised forces (nv)", deviations.len(), self.model.nv())?;
        self.forces = variances("the deviation of the force of degree of freedom", deviations)?;
        Ok(self)
    }

    /// Adds noise of the force (N) and of the torque (N·m) on a body, with the same standard
    /// deviation in each direction.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchName`] or [`Error::NoSuchIndex`] for an unknown body, [`Error::Invalid`] for
    /// a number that is negative or not finite.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    pub fn with_body_forces(mut self, body: impl IntoId<kind::Body>, force: f64, torque: f64) -> Result<Self> {
        let body = body.id_in(&*self.model)?;
        let variances = variances("the deviation of the force on a body, number", &[force, torque])?;
        self.bodies.push((body, [variances[0], variances[1]]));
        Ok(self)
    }

    /// Sets the standard deviations of the force of each contact along its normal and along each
    /// of its tangents, N. A contact of a flex has no such noise.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] for a number that is negative or not finite.
    pub fn with_contact_forces(mut self, normal: f64, tangential: f64) -> Result<Self> {
        let variances = variances("the deviation of the force of a contact, number", &[normal, tangential])?;
        self.contacts = Some([variances[0], variances[1]]);
        Ok(self)
    }

    /// Sets the standard deviations of the controls `(nu)`, in their units.
    ///
    /// Sensors that depend on the controls, such as an accelerometer, see this noise too. The
    /// filter estimates it together with the state: see
    /// [`control_noise`](super::ExtendedKalmanFilter::control_noise).
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong length, [`Error::Invalid`] for a number that is negative or
    /// not finite.
    pub fn with_controls(mut self, deviations: &[f64]) -> Result<Self> {
        Error::check_length("the deviations of the controls (nu)", deviations.len(), self.model.nu())?;
        self.controls = variances("the deviation of control", deviations)?;
        Ok(self)
    }

    /// Returns `true` if there is noise of forces.
    pub(super) fn has_forces(&self) -> bool {
        self.contacts.is_some() || !self.bodies.is_empty() || self.forces.iter().any(|&variance| variance > 0.0)
    }
}

/// Returns the squares of standard deviations.
pub(super) fn variances(what: &str, deviations: &[f64]) -> Result<Vec<f64>> {
    let check = |(index, &deviation): (usize, &f64)| {
        let variance = deviation * deviation;
        if deviation >= 0.0 && variance.is_finite() {
            Ok(variance)
        } else {
            Err(Error::out_of_range(format!("{what} {index}"), deviation, "from 0 to 1e154"))
        }
    };
    deviations.iter().enumerate().map(check).collect()
}

/// Covariance of the accelerations that result from noise of forces, with buffers.
#[derive(Clone, Debug)]
pub(super) struct Disturbance {
    /// `(nv, nv)`: covariance of the generalised forces.
    matrix: Matrix,
    /// `(nv, nv)`: covariance of the accelerations.
    solved: Matrix,
    /// `(3, nv)`
    linear: Matrix,
    angular: Matrix,
    other: Matrix,
    row: Vec<f64>,
}

impl Disturbance {
    pub(super) fn new(model: &Model) -> Self {
        let nv = model.nv();
        let rows = || Matrix::zeros(3, nv);
        Self {
            matrix: Matrix::zeros(nv, nv),
            solved: Matrix::zeros(nv, nv),
            linear: rows(),
            angular: rows(),
            other: rows(),
            row: vec![0.0; nv],
        }
    }

    /// Computes the covariance of the accelerations, `M⁻¹ F M⁻¹`. Positions, contacts and the
    /// inertia matrix must have been computed.
    pub(super) fn compute(&mut self, noise: &ProcessNoise, data: &mut Data) -> Result<&Matrix> {
        let nv = self.row.len();
        self.matrix.as_mut_slice().fill(0.0);
        for (dof, &variance) in noise.forces.iter().enumerate() {
            self.matrix[(dof, dof)] = variance;
        }
        self.add_bodies(noise, data)?;
        if let Some(variances) = noise.contacts {
            self.add_contacts(variances, data)?;
        }
        if nv == 0 {
            return Ok(&self.matrix);
        }
        // F is symmetric, so its rows are its columns: M⁻¹ F, transposed, is F M⁻¹.
        data.solve_m_into(self.matrix.as_slice(), self.solved.as_mut_slice())?;
        self.solved.transposed().transpose_to(&mut self.matrix.transposed_mut());
        data.solve_m_into(self.matrix.as_slice(), self.solved.as_mut_slice())?;
        symmetrise(&mut self.solved);
        Ok(&self.solved)
    }

    fn add_bodies(&mut self, noise: &ProcessNoise, data: &mut Data) -> Result<()> {
        for &(body, [force, torque]) in &noise.bodies {
            data.jac_body_com_into(body, Some(&mut self.linear), Some(&mut self.angular))?;
            for axis in 0..3 {
                for (row, variance) in [(self.linear.row(axis), force), (self.angular.row(axis), torque)] {
                    add_products(self.matrix.as_mut_slice(), row.len(), row, row, variance);
                }
            }
        }
        Ok(())
    }

    fn add_contacts(&mut self, [normal, tangential]: [f64; 2], data: &Data) -> Result<()> {
        let model = data.model();
        for contact in data.contacts() {
            let Some(geoms) = contact.geoms() else { continue };
            let [first, second] = geoms.map(|geom| model.geom_bodyid()[geom.index()] as usize);
            data.jac_into(*contact.pos(), first, Some(&mut self.other), None)?;
            data.jac_into(*contact.pos(), second, Some(&mut self.linear), None)?;
            add(self.linear.as_mut_slice(), self.other.as_slice(), -1.0);
            for (axis, direction) in contact.frame().chunks_exact(3).enumerate() {
                self.row.fill(0.0);
                add_product(&mut self.row, &self.linear, direction, 1.0);
                let variance = if axis == 0 { normal } else { tangential };
                add_products(self.matrix.as_mut_slice(), self.row.len(), &self.row, &self.row, variance);
            }
        }
        Ok(())
    }
}
