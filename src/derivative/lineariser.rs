//! Repeated linearisation of steps, in several threads and without allocation.

use super::analytic;
use super::kinks;
use super::method::{Fallback, LinearisationReport, TransitionMethod, TransitionOptions};
use super::parameter::ParameterBuffers;
use super::perturbation::{BasePoint, Wanted, inputs};
use super::support::Obstacles;
use super::trajectory::Adjoint;
use super::worker::{Worker, linearise};
use super::{StateSpace, TransitionOutputs, check_eps};
use crate::data::{Data, StateSpec};
use crate::error::{Error, Result};
use crate::id::SensorId;
use crate::matrix::Matrix;
use crate::model::IntoModel;
use crate::parallel::{for_each_item, is_edited};

/// Minimum number of columns for which waking another thread is worthwhile.
const MIN_COLUMNS_TO_SHARE: usize = 16;

/// Maximum number of threads. A larger number is probably a mistake, and each thread uses the
/// memory of a simulation.
const MAX_THREADS: usize = 1024;

/// Linearises steps of a simulation by a choice of [methods](TransitionMethod), and keeps the
/// required buffers: a simulation for each thread, and the columns.
///
/// ```
/// use mujoco_safe::derivative::{TransitionMethod, TransitionOptions};
/// use mujoco_safe::{Data, Lineariser, StateSpace, sample};
///
/// let mut data = Data::new(sample::humanoid())?;
/// data.reset_to_key("squat")?;
/// let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default())?;
/// let mut system = StateSpace::zeros(data.model());
/// let report = lineariser.linear_system_into(&mut data, &mut system)?;
/// assert_eq!(report.method, TransitionMethod::Analytic);
/// assert_eq!(report.fallback, None);
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
///
/// The analytic method computes a system in the caller's thread. For the other methods, the threads
/// of the current rayon pool share the columns; `ThreadPool::install` selects another pool than the
/// global one. The caller's thread takes part. The result does not depend on the number of threads.
/// With one thread, or for a model of a few degrees of freedom, the caller's thread does all the
/// work.
///
/// At a kink of the step, the derivatives are one-sided, and the report names the kink: see
/// [`Kinks`](super::Kinks).
#[derive(Debug)]
pub struct Lineariser {
    pub(super) options: TransitionOptions,
    pub(super) workers: Vec<Worker>,
    /// Buffer for the base point: [`StateSpec::INTEGRATION`].
    pub(super) base: Vec<f64>,
    /// Obstacles for the model of the workers, which is never changed in place while they share it.
    pub(super) obstacles: Obstacles,
    /// Parameters of the last derivative by parameters.
    pub(super) parameters: ParameterBuffers,
    /// Created when a gradient along a trajectory is first computed.
    pub(super) adjoint: Option<Box<Adjoint>>,
}

impl Lineariser {
    /// Creates a lineariser for simulations of this model, or of copies of it.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] unless `eps` is between `1e-12` and 1 and there are from 1 to 1024
    /// threads, [`Error::Engine`] or [`Error::OutOfMemory`] if the engine cannot allocate the
    /// simulations.
    pub fn new(model: impl IntoModel, options: TransitionOptions) -> Result<Self> {
        let model = model.into_model();
        if let Some(eps) = options.eps {
            check_eps("TransitionOptions", eps)?;
        }
        if !(1..=MAX_THREADS).contains(&options.threads) {
            let expected = format!("from 1 to {MAX_THREADS}, as each has its own simulation");
            return Err(Error::out_of_range("threads of TransitionOptions", options.threads, expected));
        }
        let workers = (0..options.threads).map(|_| Worker::new(&model)).collect::<Result<_>>()?;
        let base = vec![0.0; model.state_size(StateSpec::INTEGRATION)];
        let (obstacles, parameters) = (Obstacles::of(&model), ParameterBuffers::default());
        Ok(Self { options, workers, base, obstacles, parameters, adjoint: None })
    }

    /// Returns the options that the lineariser was created with.
    pub fn options(&self) -> &TransitionOptions {
        &self.options
    }

    /// Returns the sensors for which the [analytic](TransitionMethod::Analytic) method has no
    /// formula, so that their rows of C and D are differenced. These are force and torque sensors
    /// of sites of the world (of all sites in models with spatial tendons, with engines after
    /// 2.2.2), user sensors, velocities of limits of ball joints, lengths of actuators of ball and
    /// free joints, frames of cameras that track or face a body, sensors that 2.2.2 does not have,
    /// sensors of subtrees after an edit of masses without
    /// [`update_constants`](crate::ModelMut::update_constants), and all sensors with a cutoff.
    ///
    /// A sensor at a state where its derivative is not finite is also differenced, and so is a
    /// rangefinder that meets a mesh, a height field or a signed distance field.
    ///
    /// ```
    /// use mujoco_safe::{Lineariser, Model};
    ///
    /// let model = Model::from_xml_str(
    ///     r#"<mujoco><worldbody><body><freejoint/><geom size="0.1"/><site name="imu"/></body></worldbody>
    ///          <sensor><gyro site="imu"/><accelerometer site="imu"/><gyro name="limited" site="imu" cutoff="9"/></sensor></mujoco>"#,
    /// )?;
    /// let lineariser = Lineariser::new(model.clone(), Default::default())?;
    /// let limited = model.sensor("limited")?.id();
    /// assert!(lineariser.differenced_sensors().any(|sensor| sensor == limited));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn differenced_sensors(&self) -> impl Iterator<Item = SensorId> {
        let model = self.workers[0].point.data.model();
        let differenced = (0..model.nsensor()).filter(|&sensor| !analytic::is_sensor_covered(model, sensor));
        differenced.map(|sensor| SensorId::new(sensor, model.lineage()))
    }

    /// Linearises a step about the present state, controls and other inputs. Also reports the
    /// method that was used.
    ///
    /// # Errors
    ///
    /// As for [`linear_system_into`](Self::linear_system_into).
    pub fn linear_system(&mut self, data: &mut Data) -> Result<(StateSpace, LinearisationReport)> {
        let mut system = StateSpace::zeros(data.model());
        let report = self.linear_system_into(data, &mut system)?;
        Ok((system, report))
    }

    /// Linearises a step as [`linear_system`](Self::linear_system) does, into the caller's
    /// matrices, any of which may be omitted. Allocates nothing, except what rayon occasionally
    /// needs to wake its threads.
    ///
    /// The simulation is unchanged afterwards, to the last bit and also after an error, unless it
    /// has [callbacks](crate::callback), which can only be called on the simulation itself. In that
    /// case its computed quantities count as not computed afterwards, and it must be reset after an
    /// error.
    ///
    /// # Errors
    ///
    /// [`Error::Shape`] for a wrong shape, [`Error::OtherModel`] for a simulation of a model that
    /// was loaded separately, [`Error::Unsupported`] for a model with delays of actuators or
    /// sensors, or with the option `sleep`, and for C and D of sensors with noise (2.2.2), and the
    /// errors of [`Data::step`]. With [`TransitionMethod::Engine`] also the errors of
    /// [`Data::transition_fd_into`].
    pub fn linear_system_into<'a>(
        &mut self,
        data: &mut Data,
        outputs: impl Into<TransitionOutputs<'a>>,
    ) -> Result<LinearisationReport> {
        self.linearise(data, outputs.into(), false)
    }

    /// Linearises a step. `for_parameters` is true if derivatives by parameters follow.
    pub(super) fn linearise(
        &mut self,
        data: &mut Data,
        outputs: TransitionOutputs<'_>,
        for_parameters: bool,
    ) -> Result<LinearisationReport> {
        outputs.check(data.model())?;
        self.adopt_model(data)?;
        data.model().check_linearisable("a linearisation")?;
        data.state_into(StateSpec::INTEGRATION, &mut self.base)?;
        let (method, fallback) = self.method(data);
        if fallback == Some(Fallback::Callbacks) {
            let step = self.options.step(method);
            let result = data.transition_fd_into(step.eps, step.differences, outputs);
            // The engine does not restore inputs that a closure sets.
            data.set_state(StateSpec::INTEGRATION, &self.base)?;
            let kinks = kinks::of_inputs(data, None);
            return result.map(|()| LinearisationReport { kinks, ..LinearisationReport::new(method, fallback) });
        }
        let columns = inputs(data.model(), Wanted::by(&outputs)).count();
        let workers = if columns < MIN_COLUMNS_TO_SHARE { &mut self.workers[..1] } else { &mut self.workers[..] };
        let base = BasePoint { integration: &self.base, knot: None };
        linearise(workers, base, &self.options, self.obstacles, outputs, for_parameters)
    }

    /// Linearises the steps along a trajectory, for a regulator whose gain varies with time.
    ///
    /// System `k` belongs to row `k` of `states`, `[qpos; qvel; act]`, and row `k` of `controls`.
    /// The time, applied forces, mocap poses and user data are taken from `data`. Each thread
    /// linearises a share of the rows; the result does not depend on the number of threads.
    ///
    /// ```
    /// use mujoco_safe::derivative::TransitionOptions;
    /// use mujoco_safe::{Data, Lineariser, Matrix, sample};
    ///
    /// let data = Data::new(sample::cartpole())?;
    /// let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default().with_threads(2))?;
    /// let states = Matrix::from_rows(&[[0.0, 0.1, 0.0, 0.0], [0.0, 0.2, 0.0, 1.0], [0.1, 0.3, 0.0, 2.0]]);
    /// let systems = lineariser.along(&data, &states, &Matrix::zeros(3, 1))?;
    /// // The effect of the angle on the acceleration decreases as the pole leans further.
    /// assert!(systems[0].0.a[(3, 1)] > systems[1].0.a[(3, 1)]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`linear_system_into`](Self::linear_system_into), [`Error::Shape`] unless `states` is
    /// `(N, nq + nv + na)` and `controls` is `(N, nu)`, and [`Error::Unsupported`] for a simulation
    /// with callbacks and for a model whose state has more parts: plugins with a state, and plastic
    /// flexes. If several rows fail, returns the error of the first one.
    pub fn along(
        &mut self,
        data: &Data,
        states: &Matrix,
        controls: &Matrix,
    ) -> Result<Vec<(StateSpace, LinearisationReport)>> {
        let report = LinearisationReport::new(self.options.method, None);
        let mut systems = vec![(StateSpace::zeros(data.model()), report); states.nrows()];
        self.along_into(data, states, controls, &mut systems)?;
        Ok(systems)
    }

    /// Linearises the steps along a trajectory as [`along`](Self::along) does, into the caller's
    /// systems. Allocates nothing, except what rayon needs.
    ///
    /// # Errors
    ///
    /// As for [`along`](Self::along), and [`Error::Shape`] unless there is one system of the right
    /// shapes for each row.
    pub fn along_into(
        &mut self,
        data: &Data,
        states: &Matrix,
        controls: &Matrix,
        systems: &mut [(StateSpace, LinearisationReport)],
    ) -> Result<()> {
        self.along_with(data, states, controls, systems, |system| system.into())
    }

    /// Computes A and B of the systems along a trajectory as [`along_into`](Self::along_into) does,
    /// and leaves C and D unchanged.
    pub(crate) fn along_without_sensors_into(
        &mut self,
        data: &Data,
        states: &Matrix,
        controls: &Matrix,
        systems: &mut [(StateSpace, LinearisationReport)],
    ) -> Result<()> {
        self.along_with(data, states, controls, systems, |StateSpace { a, b, .. }| TransitionOutputs {
            a: Some(a),
            b: Some(b),
            ..Default::default()
        })
    }

    /// Computes those parts of the systems along a trajectory that `outputs` selects.
    fn along_with(
        &mut self,
        data: &Data,
        states: &Matrix,
        controls: &Matrix,
        systems: &mut [(StateSpace, LinearisationReport)],
        outputs: fn(&mut StateSpace) -> TransitionOutputs<'_>,
    ) -> Result<()> {
        let model = data.model();
        let knots = states.nrows();
        Error::check_shape("states of along", states.shape(), (knots, model.state_size(StateSpec::PHYSICS)))?;
        Error::check_shape("controls of along", controls.shape(), (knots, model.nu()))?;
        Error::check_length("the systems of along", systems.len(), knots)?;
        for (system, _) in &mut *systems {
            TransitionOutputs::from(system).check(model)?;
        }
        self.adopt_model(data)?;
        model.check_linearisable("a linearisation")?;
        if model.plastic_len() + model.plugin_state_len() > 0 {
            return Err(Error::Unsupported(
                "along linearises about positions, velocities and activations, but the plugins or flexes of this model have a state too"
                    .to_owned(),
            ));
        }
        data.state_into(StateSpec::INTEGRATION, &mut self.base)?;
        let (_, fallback) = self.method(data);
        if fallback == Some(Fallback::Callbacks) {
            return Err(Error::Unsupported("along linearises only simulations without callbacks".to_owned()));
        }
        let (integration, options, obstacles) = (&self.base, &self.options, self.obstacles);
        for_each_item(&mut self.workers, systems, |worker, knot, (system, report)| {
            let base = BasePoint { integration, knot: Some((states.row(knot), controls.row(knot))) };
            let workers = std::slice::from_mut(worker);
            *report = linearise(workers, base, options, obstacles, outputs(system), false)?;
            Ok(())
        })
    }

    /// Adopts the model of a simulation, which may have been edited since.
    pub(super) fn adopt_model(&mut self, data: &Data) -> Result<()> {
        data.check_usable()?;
        data.check_inputs()?;
        if is_edited(self.workers[0].point.data.model(), data, "the data to linearise")? {
            self.obstacles = Obstacles::of(data.model());
            self.parameters.clear();
        }
        self.workers.iter_mut().for_each(|worker| worker.point.adopt_model(data));
        Ok(())
    }

    /// Selects the method, as far as it is known before the linearisation.
    fn method(&self, data: &Data) -> (TransitionMethod, Option<Fallback>) {
        if data.has_callbacks() {
            let is_other = self.options.method != TransitionMethod::Engine;
            return (TransitionMethod::Engine, is_other.then_some(Fallback::Callbacks));
        }
        self.obstacles.method(self.options.method)
    }
}
