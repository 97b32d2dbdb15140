//! Derivatives of steps and of inverse dynamics by parameters, by a lineariser.

use super::analytic::Analytic;
use super::method::{DifferencedTerms, Fallback, Kinks, LinearisationReport, TransitionMethod};
use super::parameter::{Effect, ModelParameter, ParameterBuffers, ParameterJacobian, ParameterOutputs, Resolved};
use super::perturbation::BasePoint;
use super::worker::Worker;
use super::{InverseForce, Lineariser, TransitionOutputs, sizes};
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::ffi;
use crate::matrix::Matrix;

/// # Derivatives by parameters
impl Lineariser {
    /// Computes the derivatives of a step by parameters of the model, and of the sensors at the
    /// present state: a column for each parameter. Also reports the method that was used.
    ///
    /// With the residual g of the equations of motion, the accelerations have the derivatives
    /// `∂a/∂θ = −(∂g/∂a)⁻¹ ∂g/∂θ`, with the matrix of the linearisation. Formulas give ∂g/∂θ for
    /// the inertia of bodies, for which it is the [regressor](Data::joint_regressor), and for
    /// gravity, armature, damping, dry friction, stiffness and rest positions of joints and
    /// tendons, affine gains and biases, gears of joints and tendons, time constants of filters,
    /// and the solver parameters of constraints: `geom_friction`, `pair_friction`, and `solref` and
    /// `solimp` of geoms (with `geom_solmix`), pairs, limits, dry friction and equality
    /// constraints. All other parameters, such as margins, sizes and poses, are
    /// [differenced](Self::differenced_parameters), and so are readings whose dependence on a
    /// parameter has no formula. The report names these
    /// [`PARAMETERS`](DifferencedTerms::PARAMETERS) and [`SENSORS`](DifferencedTerms::SENSORS).
    ///
    /// A contact mixes the parameters of its geoms as the engine documents it ("Computation",
    /// section "Collision detection"): by priority, the larger friction, the weighted mean of
    /// `solref` and `solimp`. Numbers that the engine replaces, such as a time constant below two
    /// time steps, have no effect. The formulas apply to states where they reproduce the stiffness,
    /// damping and impedance of all constraints and the parameters of all contacts; otherwise
    /// complete steps are differenced.
    ///
    /// Complete steps are differenced, and the method is [`Columns`](TransitionMethod::Columns), if
    /// the model or the state has no [closed form](TransitionMethod::Analytic), and if the options
    /// ask for another [method](crate::derivative::TransitionOptions::method).
    ///
    /// A parameter at the end of its range, such as a damping of zero, has the derivative inside
    /// the range. For other kinks see [`Kinks`].
    ///
    /// # Errors
    ///
    /// As for [`parameter_jacobian_into`](Self::parameter_jacobian_into).
    ///
    /// # Panics
    ///
    /// If the element of a parameter belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::derivative::{DifferencedTerms, ModelParameter, TransitionMethod};
    /// use mujoco_safe::rollout::Parameter;
    /// use mujoco_safe::{Data, Lineariser, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qvel_mut()[1] = 2.0;
    /// let model = data.model().clone();
    /// let parameters = [
    ///     ModelParameter::from(Parameter::JointDamping(model.joint("hinge")?.id())),
    ///     ModelParameter::Mass(model.body("pole")?.id()),
    /// ];
    /// let mut lineariser = Lineariser::new(model, Default::default())?;
    /// let (jacobian, report) = lineariser.parameter_jacobian(&mut data, &parameters)?;
    /// assert_eq!(report.method, TransitionMethod::Analytic);
    /// assert_eq!(report.differenced, DifferencedTerms::empty());
    /// // More damping, less velocity of the pole.
    /// assert!(jacobian.state[(3, 0)] < 0.0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// Sources: S. Le Lidec et al., "Differentiable simulation for physical system identification",
    /// RA-L 2021; C. Atkeson, C. An and J. Hollerbach, "Estimation of inertial parameters of
    /// manipulator loads and links", IJRR 1986; for constraints E. Todorov, "Convex and
    /// analytically-invertible dynamics with contacts and constraints", ICRA 2014.
    #[doc(alias = "sensitivity")]
    #[doc(alias = "differentiable simulation")]
    #[doc(alias = "gradient")]
    pub fn parameter_jacobian(
        &mut self,
        data: &mut Data,
        parameters: &[ModelParameter],
    ) -> Result<(ParameterJacobian, LinearisationReport)> {
        let mut jacobian = ParameterJacobian::zeros(data.model(), parameters.len());
        let report = self.parameter_jacobian_into(data, parameters, &mut jacobian)?;
        Ok((jacobian, report))
    }

    /// Computes the derivatives as [`parameter_jacobian`](Self::parameter_jacobian) does, into the
    /// caller's matrices, any of which may be omitted. Allocates nothing after the first call with
    /// the same parameters. The simulation is unchanged afterwards, to the last bit.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape, the errors of [`ModelParameter::name`],
    /// [`Error::Unsupported`] for a simulation with [callbacks](crate::callback) and as for
    /// [`linear_system_into`](Self::linear_system_into), [`Error::OtherModel`] for a simulation of
    /// a model that was loaded separately, and the errors of [`Data::step`].
    ///
    /// # Panics
    ///
    /// If the element of a parameter belongs to another model.
    pub fn parameter_jacobian_into<'a>(
        &mut self,
        data: &mut Data,
        parameters: &[ModelParameter],
        outputs: impl Into<ParameterOutputs<'a>>,
    ) -> Result<LinearisationReport> {
        let mut outputs = outputs.into();
        outputs.check(data.model(), parameters.len())?;
        self.set_parameters(data, parameters, outputs.sensors.is_some())?;
        data.state_into(StateSpec::INTEGRATION, &mut self.base)?;
        let base = BasePoint { integration: &self.base, knot: None };
        self.workers[0].point.move_to(base)?;
        self.differentiate_parameters(&mut outputs, false)
    }

    /// Linearises a step, and differentiates it by parameters, in less time than both one after the
    /// other.
    ///
    /// # Errors
    ///
    /// As for [`linear_system_into`](Self::linear_system_into) and
    /// [`parameter_jacobian_into`](Self::parameter_jacobian_into).
    pub(crate) fn linear_system_with_parameters_into(
        &mut self,
        data: &mut Data,
        system: TransitionOutputs<'_>,
        parameters: &[ModelParameter],
        mut outputs: ParameterOutputs<'_>,
    ) -> Result<LinearisationReport> {
        outputs.check(data.model(), parameters.len())?;
        self.set_parameters(data, parameters, outputs.sensors.is_some())?;
        let has_sensors = outputs.sensors.is_none() || system.c.is_some() || system.d.is_some();
        let mut report = self.linearise(data, system, !parameters.is_empty())?;
        if parameters.is_empty() {
            return Ok(report);
        }
        let is_at_point = has_sensors && report.is_at_point();
        if !is_at_point {
            self.workers[0].point.move_to(BasePoint { integration: &self.base, knot: None })?;
        }
        report.merge(self.differentiate_parameters(&mut outputs, is_at_point)?);
        Ok(report)
    }

    /// Returns the parameters of a list for which there is no formula, so that they are
    /// differenced: where the [analytic](TransitionMethod::Analytic) method applies, margins, gaps
    /// and ranges, sizes, poses and joint axes, `eq_data`, `pair_solreffriction`, muscles, gears of
    /// transmissions other than hinges, slides and tendons, dry friction that is zero,
    /// `geom_solmix` that is zero, parameters of inertia in a medium; where it does not apply, all
    /// of them.
    ///
    /// # Errors
    ///
    /// As for [`ModelParameter::name`].
    ///
    /// # Panics
    ///
    /// If the element of a parameter belongs to another model.
    pub fn differenced_parameters(&self, parameters: &[ModelParameter]) -> Result<Vec<ModelParameter>> {
        let model = self.workers[0].point.data.model();
        let has_formulas = self.obstacles.method(self.options().method).0 == TransitionMethod::Analytic;
        let mut differenced = Vec::new();
        for &parameter in parameters {
            if Resolved::new(model, parameter)?.is_differenced || !has_formulas {
                differenced.push(parameter);
            }
        }
        Ok(differenced)
    }

    /// Computes the derivatives of the forces of inverse dynamics by parameters, `(nv, n)`, at the
    /// present positions, velocities and accelerations (`qacc`). They have formulas for the same
    /// parameters as those of a [step](Self::parameter_jacobian); for the inertia of bodies they
    /// are columns of the [regressor](Data::joint_regressor). `force` selects the forces as in
    /// [`inverse_jacobians`](Self::inverse_jacobians).
    ///
    /// # Errors
    ///
    /// As for [`parameter_jacobian_into`](Self::parameter_jacobian_into).
    ///
    /// # Panics
    ///
    /// If the element of a parameter belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::derivative::{InverseForce, ModelParameter};
    /// use mujoco_safe::{Data, Lineariser, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// let model = data.model().clone();
    /// let pole = model.body("pole")?.id();
    /// data.qacc_mut()[0] = 1.0;
    /// let mut lineariser = Lineariser::new(model, Default::default())?;
    /// let (forces, _) =
    ///     lineariser.inverse_parameter_jacobian(&mut data, &[ModelParameter::Mass(pole)], InverseForce::Total)?;
    /// // The force that accelerates the cart is proportional to the mass.
    /// assert!((forces[(0, 0)] - 1.0).abs() < 1e-12);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "regressor")]
    pub fn inverse_parameter_jacobian(
        &mut self,
        data: &mut Data,
        parameters: &[ModelParameter],
        force: InverseForce,
    ) -> Result<(Matrix, LinearisationReport)> {
        let mut forces = Matrix::zeros(data.model().nv(), parameters.len());
        let report = self.inverse_parameter_jacobian_into(data, parameters, force, &mut forces)?;
        Ok((forces, report))
    }

    /// Computes the derivatives as
    /// [`inverse_parameter_jacobian`](Self::inverse_parameter_jacobian) does, into the caller's
    /// matrix. Allocates nothing after the first call with the same parameters. The simulation is
    /// unchanged afterwards, to the last bit.
    ///
    /// # Errors
    ///
    /// As for [`parameter_jacobian_into`](Self::parameter_jacobian_into).
    ///
    /// # Panics
    ///
    /// If the element of a parameter belongs to another model.
    pub fn inverse_parameter_jacobian_into(
        &mut self,
        data: &mut Data,
        parameters: &[ModelParameter],
        force: InverseForce,
        forces: &mut Matrix,
    ) -> Result<LinearisationReport> {
        let what = "the result of inverse_parameter_jacobian";
        Error::check_shape(what, forces.shape(), (data.model().nv(), parameters.len()))?;
        self.set_parameters(data, parameters, false)?;
        data.state_into(StateSpec::INTEGRATION, &mut self.base)?;
        let base = BasePoint { integration: &self.base, knot: None };
        let (requested, obstacle) = (self.options().method, self.obstacles.to_inverse(force));
        let Self { workers, parameters: buffers, .. } = self;
        let Worker { point, analytic, .. } = &mut workers[0];
        point.move_to(base)?;
        let copy = &mut point.data;
        copy.qacc_mut().copy_from_slice(data.qacc());
        let is_requested = requested == TransitionMethod::Analytic;
        let mut report = LinearisationReport::new(TransitionMethod::Columns, obstacle.filter(|_| is_requested));
        let mut is_closed = false;
        if is_requested && obstacle.is_none() {
            if let Some(columns) = analytic.differentiate_inverse_terms(copy, &buffers.resolved, force)? {
                forces.as_mut_slice().copy_from_slice(columns.residual.as_slice());
                is_closed = true;
                report = LinearisationReport { kinks: analytic.kinks, ..LinearisationReport::new(requested, None) };
            } else {
                report.fallback = Some(Fallback::Constraint);
            }
        }
        if is_closed && !buffers.resolved.iter().any(|resolved| resolved.is_differenced) {
            return Ok(report);
        }
        copy.qacc_mut().copy_from_slice(data.qacc());
        let (resolved, differences, column) = buffers.differences_at(copy)?;
        for (index, resolved) in resolved.iter().enumerate() {
            if !is_closed || resolved.is_differenced {
                report.kinks |= differences.of_inverse(resolved, force, column)?;
                report.differenced |= DifferencedTerms::PARAMETERS;
                column.iter().enumerate().for_each(|(dof, value)| forces[(dof, index)] = *value);
            }
        }
        Ok(report)
    }

    /// Adopts the model of a simulation, and checks and resolves the parameters.
    pub(in crate::derivative) fn set_parameters(
        &mut self,
        data: &Data,
        parameters: &[ModelParameter],
        wants_sensors: bool,
    ) -> Result<()> {
        self.adopt_model(data)?;
        data.model().check_linearisable("a derivative by parameters")?;
        if data.has_callbacks() {
            return Err(Error::Unsupported("derivatives by parameters of a simulation with callbacks".to_owned()));
        }
        if wants_sensors && data.model().has_noise() {
            let text = "derivatives of sensors with noise: clear EnableFlags::SENSORNOISE";
            return Err(Error::Unsupported(text.to_owned()));
        }
        self.parameters.resolve(data.model(), parameters)
    }

    /// Differentiates a step of the first worker by the resolved parameters. `is_linearised` is
    /// true directly after a linearisation for this purpose.
    pub(in crate::derivative) fn differentiate_parameters(
        &mut self,
        outputs: &mut ParameterOutputs<'_>,
        is_linearised: bool,
    ) -> Result<LinearisationReport> {
        let requested = self.options().method;
        let (method, mut fallback) = self.obstacles.method(requested);
        let Self { workers, parameters, .. } = self;
        let worker = &mut workers[0];
        if method == TransitionMethod::Analytic {
            match in_closed_form(worker, parameters, outputs, is_linearised)? {
                Ok(report) => return Ok(report),
                Err(reason) => fallback = Some(reason),
            }
        }
        let fallback = if requested == TransitionMethod::Analytic { fallback } else { None };
        let report = LinearisationReport::new(TransitionMethod::Columns, fallback);
        by_steps(worker, parameters, |_| true, report, outputs)
    }
}

/// Result of the closed form, or the reason why it does not apply.
type Outcome = std::result::Result<LinearisationReport, Fallback>;

/// Differentiates a step in closed form, as far as there are formulas.
fn in_closed_form(
    worker: &mut Worker,
    parameters: &mut ParameterBuffers,
    outputs: &mut ParameterOutputs<'_>,
    is_linearised: bool,
) -> Result<Outcome> {
    let Worker { point, analytic, .. } = worker;
    let data = &mut point.data;
    let wants_sensors = outputs.sensors.is_some();
    if let Err(reason) = analytic.prepare_parameters(data, &parameters.resolved, wants_sensors, is_linearised)? {
        return Ok(Err(reason));
    }
    let mut report = LinearisationReport::new(TransitionMethod::Analytic, None);
    report.kinks = analytic.kinks;
    analytic.differentiate_terms(data, &parameters.resolved, wants_sensors);
    // Other numbers can change Q of the implicit integrator in ways that only the engine knows.
    let is_implicit = analytic.integrator.is_implicit();
    let takes_step = |resolved: &Resolved| is_implicit && resolved.is_differenced && !resolved.acts_by_constraints;
    let takes_residual = |resolved: &Resolved| resolved.is_differenced && !takes_step(resolved);
    if parameters.resolved.iter().any(takes_residual) {
        report.differenced |= DifferencedTerms::PARAMETERS;
        report.kinks |= difference_residuals(analytic, data, parameters, takes_residual)?;
    }
    let columns = analytic.finish_columns(data, wants_sensors);
    let is_finite = columns.residual.as_slice().iter().all(|value| value.is_finite());
    if !is_finite {
        return Ok(Err(Fallback::Singular));
    }
    if let Some(sensors) = &mut outputs.sensors {
        sensors.as_mut_slice().copy_from_slice(columns.reading.as_slice());
        report.kinks |= difference_readings(analytic, data, parameters, sensors, &mut report.differenced)?;
    }
    if let Some(state) = &mut outputs.state {
        analytic.write_columns(data.model(), state);
    }
    if parameters.resolved.iter().any(takes_step) {
        return by_steps(worker, parameters, takes_step, report, outputs).map(Ok);
    }
    Ok(Ok(report))
}

/// Differences the terms of the equations of motion that have no formula.
fn difference_residuals(
    analytic: &mut Analytic,
    data: &Data,
    parameters: &mut ParameterBuffers,
    is_wanted: impl Fn(&Resolved) -> bool,
) -> Result<Kinks> {
    let nv = data.model().nv();
    let (resolved, differences, column) = parameters.differences_at(data)?;
    let mut kinks = Kinks::empty();
    for (index, resolved) in resolved.iter().enumerate().filter(|(_, resolved)| is_wanted(resolved)) {
        let columns = &mut analytic.parameters.columns;
        kinks |= differences.of_residual(resolved, analytic.integrator.spread(), column)?;
        let (residual, rest) = column.split_at(nv);
        let (spread, activation) = rest.split_at(nv);
        residual.iter().enumerate().for_each(|(dof, value)| columns.residual[(dof, index)] = *value);
        if resolved.effect == Effect::Other {
            spread.iter().enumerate().for_each(|(dof, value)| columns.spread[(dof, index)] = *value);
        }
        activation.iter().enumerate().for_each(|(at, value)| columns.activation[(at, index)] += *value);
    }
    Ok(kinks)
}

/// Differences the readings that have no formula.
fn difference_readings(
    analytic: &mut Analytic,
    data: &Data,
    parameters: &mut ParameterBuffers,
    sensors: &mut Matrix,
    differenced: &mut DifferencedTerms,
) -> Result<Kinks> {
    let model = data.model();
    let has_formula = |resolved: &Resolved, sensor: usize| analytic.has_reading(model, &resolved.effect, sensor);
    let is_complete = |resolved: &Resolved| (0..model.nsensor()).all(|sensor| has_formula(resolved, sensor));
    let mut kinks = Kinks::empty();
    if parameters.resolved.iter().all(is_complete) {
        return Ok(kinks);
    }
    *differenced |= DifferencedTerms::SENSORS;
    let (resolved, differences, column) = parameters.differences_at(data)?;
    for (index, resolved) in resolved.iter().enumerate().filter(|(_, resolved)| !is_complete(resolved)) {
        let deceleration = &analytic.parameters.columns.deceleration;
        kinks |= differences.of_sensors(resolved, |dof| deceleration[(dof, index)], column)?;
        for sensor in (0..model.nsensor()).filter(|&sensor| !has_formula(resolved, sensor)) {
            let first = ffi::size(model.sensor_adr()[sensor]);
            for address in first..first + ffi::size(model.sensor_dim()[sensor]) {
                sensors[(address, index)] = column[address];
            }
        }
    }
    Ok(kinks)
}

/// Differences complete steps by the parameters that `is_wanted` selects.
fn by_steps(
    worker: &mut Worker,
    parameters: &mut ParameterBuffers,
    is_wanted: impl Fn(&Resolved) -> bool,
    mut report: LinearisationReport,
    outputs: &mut ParameterOutputs<'_>,
) -> Result<LinearisationReport> {
    let data = &worker.point.data;
    let (nx, _, _) = sizes(data.model());
    let (resolved, differences, column) = parameters.differences_at(data)?;
    for (index, resolved) in resolved.iter().enumerate().filter(|(_, resolved)| is_wanted(resolved)) {
        report.differenced |= DifferencedTerms::PARAMETERS;
        report.kinks |= differences.of_step(resolved, column)?;
        let (state, sensors) = column.split_at(nx);
        for (output, values) in [(&mut outputs.state, state), (&mut outputs.sensors, sensors)] {
            if let Some(output) = output {
                values.iter().enumerate().for_each(|(row, value)| output[(row, index)] = *value);
            }
        }
    }
    Ok(report)
}
