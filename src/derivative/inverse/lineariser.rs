//! Derivatives of inverse dynamics by a lineariser.

use super::{InverseForce, InverseJacobians, InverseOutputs};
use crate::data::{Data, SensorUpdate, Stage, StateSpec};
use crate::derivative::method::{DifferencedTerms, Fallback, LinearisationReport, TransitionMethod};
use crate::derivative::perturbation::BasePoint;
use crate::derivative::worker::Worker;
use crate::derivative::{Lineariser, analytic};
use crate::enums::Integrator;
use crate::error::Result;

/// Default step of the differences.
const EPS: f64 = 1e-6;

/// # Derivatives of inverse dynamics
impl Lineariser {
    /// Computes the derivatives of inverse dynamics at the present positions, velocities and
    /// accelerations (`qacc`), and reports the method that was used.
    ///
    /// The method is [`Analytic`](TransitionMethod::Analytic) if the [options](Self::options)
    /// select it and if it applies. All other methods are the forward differences of
    /// [`Data::inverse_fd`], with a step of `1e-6` unless the options have another, and the report
    /// names them [`Engine`](TransitionMethod::Engine). Neither the integrator nor the no-slip
    /// solver affects inverse dynamics, and [`InverseForce::Total`] does not depend on actuators.
    ///
    /// In closed form, the forces of the constraints are explicit functions of positions,
    /// velocities and accelerations, and the forces of the bodies have the derivatives of the
    /// recursive Newton–Euler algorithm (J. Carpentier and N. Mansard, "Analytical derivatives of
    /// rigid body dynamics algorithms", RSS 2018). Sensors without a formula
    /// ([`differenced_sensors`](Self::differenced_sensors)) are differenced.
    ///
    /// At a kink, for example where two geoms begin to touch, closed forms are the derivatives of
    /// the present side, and differences those to the right. The report names
    /// [`CONSTRAINTS`](crate::derivative::Kinks::CONSTRAINTS) and
    /// [`SPRINGS`](crate::derivative::Kinks::SPRINGS) with both methods, and
    /// [`FORCES`](crate::derivative::Kinks::FORCES), friction loss at its limit and kinks of
    /// impedances with the closed form. Other kinks of differences are not reported.
    ///
    /// # Errors
    ///
    /// As for [`inverse_jacobians_into`](Self::inverse_jacobians_into).
    ///
    /// ```
    /// use mujoco_safe::derivative::{InverseForce, TransitionMethod};
    /// use mujoco_safe::{Data, Lineariser, sample};
    ///
    /// let mut data = Data::new(sample::cartpole())?;
    /// data.qpos_mut()[1] = 0.3;
    /// let mut lineariser = Lineariser::new(data.model().clone(), Default::default())?;
    /// let (jacobians, report) = lineariser.inverse_jacobians(&mut data, InverseForce::Total)?;
    /// assert_eq!(report.method, TransitionMethod::Analytic);
    /// // Derivative of the moment at the hinge with respect to its angle: mass, gravity and lever.
    /// assert!((jacobians.df_dq[(1, 1)] + 0.5 * 9.81 * 0.3 * 0.3_f64.cos()).abs() < 1e-12);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn inverse_jacobians(
        &mut self,
        data: &mut Data,
        force: InverseForce,
    ) -> Result<(InverseJacobians, LinearisationReport)> {
        let mut jacobians = InverseJacobians::zeros(data.model());
        let report = self.inverse_jacobians_into(data, force, &mut jacobians)?;
        Ok((jacobians, report))
    }

    /// Computes the derivatives as [`inverse_jacobians`](Self::inverse_jacobians) does, into the
    /// caller's matrices, any of which may be omitted. Allocates nothing after the first call.
    ///
    /// The simulation is unchanged afterwards, to the last bit and also after an error, unless it
    /// has [callbacks](crate::callback): these are called on the simulation itself, as by
    /// [`Data::inverse_fd_into`].
    ///
    /// # Errors
    ///
    /// [`Error::Shape`](crate::Error::Shape) for a wrong shape,
    /// [`Error::OtherModel`](crate::Error::OtherModel) for a simulation of a model that was loaded
    /// separately, and the errors of [`Data::inverse_fd_into`].
    pub fn inverse_jacobians_into<'a>(
        &mut self,
        data: &mut Data,
        force: InverseForce,
        outputs: impl Into<InverseOutputs<'a>>,
    ) -> Result<LinearisationReport> {
        let mut outputs = outputs.into();
        outputs.check(data.model())?;
        self.adopt_model(data)?;
        data.model().check_without_sleep("inverse_jacobians")?;
        let requested = self.options().method;
        let eps = self.options().eps.unwrap_or(EPS);
        if data.has_callbacks() {
            let reason = (requested != TransitionMethod::Engine).then_some(Fallback::Callbacks);
            data.inverse_fd_into(eps, force, outputs)?;
            return Ok(report(data, reason));
        }
        let obstacle = self.obstacles.to_inverse(force);
        let worker = self.set_first_base(data)?;
        if Integrator::from_raw(data.model().raw().opt.integrator) == Some(Integrator::Discrete) {
            // Inverse dynamics of this integrator reads results of the last computation of the
            // forces.
            worker.point.data.forward()?;
        }
        worker.point.data.qacc_mut().copy_from_slice(data.qacc());
        if requested != TransitionMethod::Analytic {
            return by_differences(&mut worker.point.data, eps, force, outputs, None);
        }
        match obstacle {
            None => differentiate(worker, eps, force, &mut outputs),
            Some(_) => by_differences(&mut worker.point.data, eps, force, outputs, obstacle),
        }
    }

    /// Moves the first simulation to the present state of another.
    fn set_first_base(&mut self, data: &Data) -> Result<&mut Worker> {
        data.state_into(StateSpec::INTEGRATION, &mut self.base)?;
        let worker = &mut self.workers[0];
        worker.point.move_to(BasePoint { integration: &self.base, knot: None })?;
        Ok(worker)
    }
}

/// Differences inverse dynamics of a simulation whose computed quantities are not known.
fn by_differences(
    data: &mut Data,
    eps: f64,
    force: InverseForce,
    outputs: InverseOutputs<'_>,
    reason: Option<Fallback>,
) -> Result<LinearisationReport> {
    compute_actuation(data)?;
    data.inverse_fd_into(eps, force, outputs)?;
    Ok(report(data, reason))
}

/// Computes the forces of actuators, which inverse dynamics does not compute, but which sensors
/// read.
fn compute_actuation(data: &mut Data) -> Result<()> {
    if data.model().nactuator() > 0 && data.model().nsensor() > 0 {
        data.inverse_skip(Stage::None, SensorUpdate::Skip)?;
        data.fwd_actuation()?;
    }
    Ok(())
}

/// Returns the report of differences that were just computed.
fn report(data: &Data, reason: Option<Fallback>) -> LinearisationReport {
    let kinks = analytic::kinks_of_positions(data);
    LinearisationReport { kinks, ..LinearisationReport::new(TransitionMethod::Engine, reason) }
}

/// Differentiates inverse dynamics in closed form, as far as there are formulas.
fn differentiate(
    worker: &mut Worker,
    eps: f64,
    force: InverseForce,
    outputs: &mut InverseOutputs<'_>,
) -> Result<LinearisationReport> {
    let Worker { point, analytic, .. } = worker;
    let data = &mut point.data;
    let wants_sensors = outputs.ds_dq.is_some() || outputs.ds_dv.is_some() || outputs.ds_da.is_some();
    let mut differenced = match analytic.differentiate_inverse(data, force, wants_sensors)? {
        Ok(differenced) => differenced,
        Err(reason) => return by_differences(data, eps, force, outputs.reborrow(), Some(reason)),
    };
    // Differences of all sensors first, which the closed forms overwrite.
    if wants_sensors && !analytic.has_all_inverse_sensors() {
        differenced |= DifferencedTerms::SENSORS;
        let InverseOutputs { ds_dq, ds_dv, ds_da, .. } = outputs.reborrow();
        compute_actuation(data)?;
        data.inverse_fd_into(eps, force, InverseOutputs { ds_dq, ds_dv, ds_da, ..Default::default() })?;
    }
    analytic.write_inverse(data, outputs);
    let kinks = analytic.kinks;
    Ok(LinearisationReport { differenced, kinks, ..LinearisationReport::new(TransitionMethod::Analytic, None) })
}
