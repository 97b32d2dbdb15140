//! The extended Kalman filter.

use std::ops::Range;

use nalgebra::{Cholesky, DVector};

use super::covariance::{self, Propagation};
use super::measurement::Measurement;
use super::noise::ProcessNoise;
use super::plant::Plant;
use super::update::{Correction, Gate, ReadingOutcome, Update, UpdateStatus};
use crate::data::Data;
use crate::derivative::LinearisationReport;
use crate::error::{Error, Result};
use crate::matrix::{Matrix, StridedView};
use crate::numerics::linear_algebra::{add, symmetrise};

/// Extended Kalman filter for the state of a simulation: positions, velocities and activations.
///
/// The estimate is the state of a simulation that the filter owns ([`data`](Self::data)), with the
/// covariance of its error in tangent coordinates. The [module](super) has the equations.
///
/// In each step, call [`update`](Self::update) with the readings in the present state, then
/// [`predict`](Self::predict). Without a reading, call `predict` alone. Neither allocates, except
/// for a simulation with [callbacks](crate::callback) or with residuals that do.
///
/// ```
/// use mujoco_safe::estimation::{ExtendedKalmanFilter, Measurement, ProcessNoise};
/// use mujoco_safe::{Data, Matrix, Model};
///
/// let mut model = Model::from_xml_str(
///     r#"<mujoco>
///          <worldbody>
///            <body>
///              <joint name="hinge" axis="0 1 0" damping="0.02"/>
///              <geom type="capsule" fromto="0 0 0 0 0 -.5" size=".02" mass="1"/>
///            </body>
///          </worldbody>
///          <sensor><jointpos name="encoder" joint="hinge"/></sensor>
///        </mujoco>"#,
/// )?;
/// let mut pendulum = Data::new(model)?;
/// let model = pendulum.model().clone();
///
/// // The filter does not know that the pendulum is lifted.
/// let noise = ProcessNoise::new(&model).with_forces(&[0.01])?;
/// let encoder = Measurement::new(&model).with_sensor("encoder", 0.01)?;
/// let variances = Matrix::from_diagonal(&[1.0, 1.0]);
/// let mut filter = ExtendedKalmanFilter::new(Data::new(&model)?, &variances, noise, encoder)?;
/// pendulum.qpos_mut()[0] = 0.5;
/// for _ in 0..500 {
///     pendulum.step()?;
///     filter.update(&[], pendulum.sensordata())?; // readings in the state before the step
///     filter.predict(&[])?;
/// }
/// assert!((filter.data().qpos()[0] - pendulum.qpos()[0]).abs() < 0.01);
/// assert!((filter.data().qvel()[0] - pendulum.qvel()[0]).abs() < 0.03);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
#[derive(Debug)]
pub struct ExtendedKalmanFilter {
    pub(super) plant: Plant,
    /// `(nz, nz)`: covariance of the errors of the state and of the inputs of the present step.
    pub(super) joint: Matrix,
    /// `(nx, nx)`
    covariance: Matrix,
    /// Estimate of the inputs of the present step: the noise of the controls and the disturbance of
    /// the accelerations.
    pub(super) inputs: Vec<f64>,
    /// True if `joint` has the covariance of the disturbance in the present step.
    has_disturbance: bool,
    pub(super) rotations: Vec<usize>,
    gate: Option<Gate>,
    pub(super) propagation: Propagation,
    pub(super) correction: Correction,
    /// Copy of `joint` while it is changed.
    work: Matrix,
    /// Corrected state, `(nq + nv + na)`.
    state: Vec<f64>,
}

impl ExtendedKalmanFilter {
    /// Creates a filter whose first estimate is the state of `data`, with this covariance `(nx,
    /// nx)` of its error in the coordinates `[dq; dv; da]`, `nx = 2 nv + na`.
    ///
    /// The inputs of `data` other than controls, such as applied forces and poses of mocap bodies,
    /// act in the prediction. The option `sensornoise` of its model is cleared.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] or [`Error::Invalid`] for a matrix that is not a covariance of this size,
    /// [`Error::OtherModel`] if the noise or the measurement are of a model that was loaded
    /// separately, [`Error::Unsupported`] for a model with delays, with the option `sleep`, or with
    /// plugins or flexes that have a state, and the errors of [`Lineariser::new`].
    ///
    /// [`Lineariser::new`]: crate::Lineariser::new
    pub fn new<'a>(
        data: Data,
        covariance: impl Into<StridedView<'a>>,
        noise: ProcessNoise,
        measurement: Measurement,
    ) -> Result<Self> {
        let plant = Plant::new(data, noise, measurement)?;
        let (nx, inputs) = plant.sizes();
        let nz = nx + inputs;
        let model = plant.data.model();
        let mut filter = Self {
            joint: Matrix::zeros(nz, nz),
            covariance: Matrix::zeros(nx, nx),
            inputs: vec![0.0; inputs],
            has_disturbance: false,
            rotations: covariance::rotations(model),
            gate: None,
            propagation: Propagation::default(),
            correction: Correction::new(nz, plant.measurement.len()),
            work: Matrix::zeros(nz, nz),
            state: plant.data.physics_state(),
            plant,
        };
        filter.set_covariance(covariance)?;
        Ok(filter)
    }

    /// Rejects readings that are less likely than this: with a probability of 0.999, one of 1000
    /// readings of each sensor is rejected if the filter is consistent.
    ///
    /// All components of a sensor or residual are rejected if the squared Mahalanobis distance of
    /// its innovation is above the quantile of the chi-square distribution. By default all readings
    /// are used.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless the probability is between 0 and 1.
    pub fn with_gate(mut self, probability: f64) -> Result<Self> {
        self.gate = Some(Gate::new(probability, &self.plant.measurement.parts, self.joint.nrows())?);
        Ok(self)
    }

    /// Returns the simulation whose state is the estimate.
    pub fn data(&self) -> &Data {
        &self.plant.data
    }

    /// Returns the simulation whose state is the estimate, for changes of its inputs, of its model
    /// by [`edit_model`](Data::edit_model), or of the estimate. The covariance is unchanged.
    ///
    /// If another model replaces that of the simulation, later calls return
    /// [`Error::OtherModel`].
    pub fn data_mut(&mut self) -> &mut Data {
        &mut self.plant.data
    }

    /// Returns the measurement.
    pub fn measurement(&self) -> &Measurement {
        &self.plant.measurement
    }

    /// Returns the covariance of the error of the estimate `(nx, nx)`, in the coordinates `[dq; dv;
    /// da]` of the tangent space at the estimate. It is symmetric.
    pub fn covariance(&self) -> &Matrix {
        &self.covariance
    }

    /// Replaces the covariance of the error of the estimate. What the readings of the present step
    /// have told about the noise of controls and forces is forgotten.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape, [`Error::Invalid`] for a matrix that is not finite,
    /// symmetric and positive semidefinite.
    pub fn set_covariance<'a>(&mut self, covariance: impl Into<StridedView<'a>>) -> Result<()> {
        let covariance = covariance.into().to_matrix();
        covariance::check("the covariance of the estimate", &covariance, self.covariance.nrows())?;
        self.covariance.as_mut_slice().copy_from_slice(covariance.as_slice());
        symmetrise(&mut self.covariance);
        self.restart_inputs();
        Ok(())
    }

    /// Starts again from the state of a simulation. The filter keeps its model. This is the remedy
    /// after an error of [`predict`](Self::predict).
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a simulation of a model that was loaded separately, and those of
    /// [`set_covariance`](Self::set_covariance), in which case only the state is that of `data`.
    pub fn reset<'a>(&mut self, data: &Data, covariance: impl Into<StridedView<'a>>) -> Result<()> {
        self.plant.data.copy_from(data)?;
        self.set_covariance(covariance)
    }

    /// Returns the estimate of the noise of the controls in the present step, `(nu)`, or an empty
    /// slice unless [`ProcessNoise::with_controls`] was called. It is zero before an update.
    pub fn control_noise(&self) -> &[f64] {
        &self.inputs[..self.plant.noise.controls.len()]
    }

    /// Returns the differences between the readings and their predictions in the last
    /// [`update`](Self::update); NaN for missing readings.
    pub fn innovations(&self) -> &[f64] {
        &self.correction.innovations
    }

    /// Returns the use of each component of the last reading.
    pub fn outcomes(&self) -> &[ReadingOutcome] {
        &self.correction.outcomes
    }

    /// Corrects the estimate by the `readings` in the present state, under the controls `(nu)` that
    /// act there. A component that is NaN is missing, and has no effect.
    ///
    /// After [`Data::step`], `sensordata` belongs to the state before the step, and to its
    /// controls. So for each step of the robot, call `update` with these, then
    /// [`predict`](Self::predict) with the same controls. Only sensors of accelerations and forces
    /// depend on the controls.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong number of controls or readings, [`Error::Invalid`] for an
    /// infinite reading, [`Error::OtherModel`] if the model of [`data_mut`](Self::data_mut) was
    /// replaced, [`Error::Poisoned`] after an error of `predict`, and the errors of
    /// [`Data::forward`], of
    /// [`Lineariser::linear_system_into`](crate::Lineariser::linear_system_into) and of the
    /// residuals.
    pub fn update(&mut self, controls: &[f64], readings: &[f64]) -> Result<Update> {
        Error::check_length("the readings of an estimator", readings.len(), self.plant.measurement.len())?;
        if let Some(index) = readings.iter().position(|reading| reading.is_infinite()) {
            let expected = "finite, or NaN if it is missing";
            return Err(Error::out_of_range(format!("reading {index}"), readings[index], expected));
        }
        self.plant.set_controls(controls, &self.inputs)?;
        self.plant.measure(&self.inputs)?;
        if !self.has_disturbance {
            self.plant.set_disturbance_covariance(&mut self.joint)?;
            self.has_disturbance = true;
        }
        let Plant { measurement, predicted, output, .. } = &self.plant;
        measurement.subtract(readings, predicted, &mut self.correction.innovations);
        self.work.as_mut_slice().copy_from_slice(self.joint.as_slice());
        self.correction.estimate.fill(0.0);
        let mut update = self.correction.run(&mut self.work, output, measurement, self.gate.as_mut());
        if update.status == UpdateStatus::Corrected && !self.apply()? {
            update.status = UpdateStatus::OutOfRange;
        }
        Ok(update)
    }

    /// Moves the estimate by the correction. Returns `false` and changes nothing if the result is
    /// not finite.
    fn apply(&mut self) -> Result<bool> {
        let Self { plant: Plant { data, .. }, correction, work, rotations, state, .. } = self;
        let (by, inputs) = correction.estimate.split_at(self.covariance.nrows());
        covariance::transport(work, rotations, by);
        data.physics_state_into(state)?;
        data.model().integrate_state(state, by)?;
        if !covariance::is_finite(work.as_slice()) || !covariance::is_finite(state) {
            return Ok(false);
        }
        data.set_physics_state(state)?;
        add(&mut self.inputs, inputs, 1.0);
        std::mem::swap(&mut self.joint, &mut self.work);
        self.read_covariance();
        Ok(true)
    }

    /// Advances the estimate by a step under these controls `(nu)`, plus the estimate of their
    /// noise. The report tells how the step was linearised, and if it has a kink.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong number of controls, [`Error::OtherModel`] if the model of
    /// [`data_mut`](Self::data_mut) was replaced, [`Error::Invalid`] if the covariance becomes
    /// infinite, in which case it is that before the step, and the errors of
    /// [`Data::step`] and of
    /// [`Lineariser::linear_system_into`](crate::Lineariser::linear_system_into). After an error of
    /// the step, [`reset`](Self::reset) the filter.
    pub fn predict(&mut self, controls: &[f64]) -> Result<LinearisationReport> {
        self.plant.set_controls(controls, &self.inputs)?;
        self.work.as_mut_slice().copy_from_slice(self.joint.as_slice());
        let report = self.plant.advance(&self.inputs, &mut self.work, self.has_disturbance)?;
        let noise = &self.plant.step_noise;
        self.propagation.propagate(&self.plant.transition, &self.work, noise, &mut self.covariance);
        if !covariance::is_finite(self.covariance.as_slice()) {
            self.read_covariance();
            let what = "the covariance after a step";
            return Err(Error::not_finite(what, "infinite or NaN"));
        }
        self.restart_inputs();
        Ok(report)
    }

    /// Writes the difference `truth ⊟ estimate` in the coordinates `[dq; dv; da]`, `(nx)`: the
    /// error of which [`covariance`](Self::covariance) is the covariance.
    ///
    /// # Errors
    ///
    /// [`Error::OtherModel`] for a simulation of a model that was loaded separately,
    /// [`Error::Shape`] for a wrong length.
    pub fn error_into(&self, truth: &Data, error: &mut [f64]) -> Result<()> {
        self.plant.check()?;
        let estimate = &self.plant.data;
        estimate.model().relation(truth.model()).check("the simulation to compare with an estimate")?;
        Error::check_length("the error of an estimate (2 nv + na)", error.len(), self.covariance.nrows())?;
        estimate.model().differentiate_state_into(&estimate.physics_state(), &truth.physics_state(), error)
    }

    /// Returns the normalised square `eᵀ P⁻¹ e` of the error e of these components of `[dq; dv;
    /// da]` (NEES), or `None` if the covariance P of these is singular or the error is not finite.
    ///
    /// If the filter is consistent, it has the chi-square distribution with as many degrees of
    /// freedom as there are components: see [`chi_square_quantile`](super::chi_square_quantile).
    /// (Y. Bar-Shalom, X. R. Li and T. Kirubarajan, *Estimation with Applications to Tracking and
    /// Navigation*, 2001, section 5.4.) The mean over runs and steps is the number of components.
    /// A larger one shows that the filter trusts its estimate too much.
    ///
    /// # Errors
    ///
    /// As for [`error_into`](Self::error_into), and [`Error::Invalid`] for components that do not
    /// exist.
    #[doc(alias = "normalised estimation error squared")]
    #[doc(alias = "consistency")]
    pub fn nees(&self, truth: &Data, components: Range<usize>) -> Result<Option<f64>> {
        let nx = self.covariance.nrows();
        let (is_valid, found) = (components.start <= components.end && components.end <= nx, format!("{components:?}"));
        Error::check_range(is_valid, "the components of nees", found, format_args!("a range in 0..{nx}"))?;
        let mut error = vec![0.0; nx];
        self.error_into(truth, &mut error)?;
        Ok(normalised_square(&self.covariance, &error, components))
    }

    /// Copies the covariance of the state from that of the state and the inputs.
    fn read_covariance(&mut self) {
        let shape = self.covariance.shape();
        self.covariance.transposed_mut().copy_from(&self.joint.transposed().view((0, 0), shape));
    }

    /// Sets the covariance of the state and the inputs at the start of a step, where they are
    /// independent.
    fn restart_inputs(&mut self) {
        self.inputs.fill(0.0);
        self.has_disturbance = false;
        self.plant.start(&self.covariance, &mut self.joint);
    }
}

/// Returns `eᵀ P⁻¹ e` of a range of components, unless P is singular.
fn normalised_square(covariance: &Matrix, error: &[f64], range: Range<usize>) -> Option<f64> {
    let factor = Cholesky::new(covariance::correlations(covariance, range.clone()))?;
    if factor.l_dirty().diagonal().iter().any(|root| root * root < 1e-14) {
        return None;
    }
    let scaled = range.map(|index| error[index] / covariance[(index, index)].sqrt());
    let scaled = DVector::from_iterator(factor.l_dirty().nrows(), scaled);
    let square = scaled.dot(&factor.solve(&scaled));
    square.is_finite().then_some(square)
}
