//! Batches with parameters of the model for each simulation, and environments of reinforcement
//! learning.

use std::hint::black_box;
use std::sync::{Arc, OnceLock};

use mujoco_safe::data::MissingResults;
use mujoco_safe::environment::{Evaluation, Hopper, Task, Transition, VectorEnvironment};
use mujoco_safe::rollout::{Distribution, Parameter, Parameters, Random};
use mujoco_safe::{Batch, Data, Model, Result};

use super::{Bytes, Call, Scene, expected, must_panic, read_only};

fn parameter(data: &Data, bytes: &mut Bytes<'_>) -> Result<Parameter> {
    let model = data.model();
    let joint = |bytes: &mut Bytes<'_>| model.joint(bytes.index(model.njnt())).map(|joint| joint.id());
    let actuator = |bytes: &mut Bytes<'_>| model.actuator(bytes.index(model.nactuator())).map(|actuator| actuator.id());
    Ok(match bytes.below(12) {
        0 => Parameter::Gravity(bytes.index(3)),
        1 => Parameter::MassFactor(read_only::body(data, bytes)?),
        2 => Parameter::CentreOfMass(read_only::body(data, bytes)?, bytes.index(3)),
        3 => Parameter::JointStiffness(joint(bytes)?),
        4 => Parameter::JointDamping(joint(bytes)?),
        5 => Parameter::JointFrictionLoss(joint(bytes)?),
        6 => Parameter::JointArmature(joint(bytes)?),
        7 => Parameter::GeomFriction(read_only::geom(data, bytes)?, bytes.index(3)),
        8 => Parameter::GeomSize(read_only::geom(data, bytes)?, bytes.index(3)),
        9 => Parameter::ActuatorGain(actuator(bytes)?, bytes.index(3)),
        10 => Parameter::ActuatorBias(actuator(bytes)?, bytes.index(3)),
        _ => Parameter::ActuatorGear(actuator(bytes)?),
    })
}

/// Returns a distribution. About half of all are valid for every parameter.
fn distribution(bytes: &mut Bytes<'_>) -> Distribution {
    let (low, high) = (bytes.number(), bytes.number());
    match bytes.below(8) {
        0 => Distribution::Uniform { low, high },
        1 => Distribution::LogUniform { low, high },
        2 => Distribution::Normal { mean: low, deviation: high },
        3 => Distribution::Uniform { low: 0.0, high: high.abs() },
        4 => Distribution::Normal { mean: 1.0, deviation: 0.1 },
        5 => Distribution::LogUniform { low: 1e-3, high: 1e3 },
        6 => Distribution::Uniform { low: 0.5, high: 2.0 },
        _ => Distribution::Unchanged,
    }
}

/// Returns a list of parameters of the present model.
fn parameters(scene: &mut Scene<'_>, bytes: &mut Bytes<'_>) -> Parameters {
    let mut parameters = Parameters::new();
    for _ in 0..bytes.below(5) {
        let Ok(parameter) = parameter(&scene.data, bytes) else { continue };
        match parameters.clone().with(scene.data.model(), parameter, distribution(bytes)) {
            Ok(longer) => parameters = longer,
            Err(error) => (scene.log)(&format!("  {error}")),
        }
    }
    parameters
}

/// A task with arbitrary numbers, for any model.
struct Arbitrary {
    width: usize,
    skip: usize,
    limit: Option<u64>,
    forward: bool,
    body_forces: bool,
    memory: usize,
    number: f64,
    fails: bool,
}

impl Task for Arbitrary {
    fn observation_size(&self, _: &Model) -> usize {
        self.width
    }

    fn frame_skip(&self) -> usize {
        self.skip
    }

    fn time_limit(&self) -> Option<u64> {
        self.limit
    }

    fn forward_after_step(&self) -> bool {
        self.forward
    }

    fn body_forces(&self) -> bool {
        self.body_forces
    }

    fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
        data.qvel_mut().fill(random.uniform(0.0, self.number));
        if self.fails { data.reset_to_key(99) } else { Ok(()) }
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        observation.fill(data.time());
        Ok(())
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        let position = transition.data.qpos().first().copied().unwrap_or_default();
        let reward = transition.action.iter().chain(transition.memory).sum();
        for contact in transition.data.contacts() {
            black_box(contact.force().is_ok());
        }
        if self.body_forces {
            transition.data.require(MissingResults::BODY_FORCES).unwrap();
        }
        Ok(Evaluation { reward, terminated: position > self.number })
    }

    fn memory_size(&self, _: &Model) -> usize {
        self.memory
    }

    fn remember(&self, data: &Data, memory: &mut [f64]) -> Result<()> {
        memory.fill(data.cfrc_ext().as_flattened().iter().sum());
        Ok(())
    }
}

fn step<T: Task>(mut environment: VectorEnvironment<T>, bytes: &mut Bytes<'_>) -> Result<()> {
    let count = environment.len() * environment.batch().model().nu();
    for _ in 0..bytes.below(4) {
        if bytes.once_in(8) {
            environment.reset()?;
        }
        environment.step(&bytes.vector(count))?;
        black_box((environment.observations().shape(), environment.final_observations().shape()));
        black_box((environment.rewards().len(), environment.terminated().len(), environment.truncated().len()));
    }
    Ok(())
}

pub(super) const CALLS: &[(&str, Call)] = &[
    ("Batch::with_parameters", |scene, bytes| {
        if scene.data.model().nv() >= 30 {
            return Ok(());
        }
        let parameters = parameters(scene, bytes);
        let mut batch = Batch::new(scene.data.model().clone(), bytes.below(4))?.with_parameters(parameters)?;
        for _ in 0..=bytes.below(6) {
            let (number, which, at) = (bytes.number(), bytes.below(4), bytes.below(5));
            let result = match bytes.below(8) {
                0 | 1 => batch.sample_parameters(|index| index != which, bytes.word()),
                2 | 3 => batch.set_parameters(
                    |index| index != which,
                    |_, values| values.iter_mut().skip(at).take(1).for_each(|value| *value = number),
                ),
                4 => batch.reset_where(|index| index != which, |_, _, data| data.qvel_mut().fill(number)),
                5 => batch.edit_where(
                    |index| index != which,
                    |_, data| data.edit_model(|model| model.body_mass_mut().fill(number)),
                ),
                6 if which < batch.len() => batch.load(which, &mut scene.data),
                _ => batch.step(|_, controls| controls.as_mut_slice().fill(number)),
            };
            expected(&result);
        }
        black_box((batch.parameters().shape(), batch.failures().count()));
        for index in 0..batch.len() {
            expected(&batch.data(index)?.step());
        }
        Ok(())
    }),
    ("Parameters of another model", |scene, bytes| {
        let Some(other) = scene.other.as_ref().filter(|other| !other.model().is_same_structure(scene.data.model()))
        else {
            return Ok(());
        };
        let mass = Parameter::MassFactor(other.model().body(0)?.id());
        let parameters = Parameters::new().with(other.model(), mass, Distribution::Unchanged)?;
        if bytes.once_in(2) {
            must_panic(|| Parameters::new().with(scene.data.model(), mass, Distribution::Unchanged));
        } else {
            let batch = Batch::new(scene.data.model().clone(), 1)?;
            must_panic(|| batch.with_parameters(parameters));
        }
        Ok(())
    }),
    ("VectorEnvironment", |scene, bytes| {
        if scene.data.model().nv() >= 30 {
            return Ok(());
        }
        let task = Arbitrary {
            width: bytes.below(4),
            skip: bytes.below(4),
            limit: bytes.once_in(2).then(|| bytes.below(4) as u64),
            forward: bytes.once_in(4),
            body_forces: bytes.once_in(2),
            memory: bytes.below(3),
            number: bytes.number(),
            fails: bytes.once_in(16),
        };
        let parameters = bytes.once_in(2).then(|| parameters(scene, bytes));
        let (count, seed) = (bytes.below(4), bytes.word());
        let mut environment = VectorEnvironment::new(scene.data.model().clone(), task, count, seed)?;
        if let Some(parameters) = parameters {
            environment = environment.with_parameters(parameters)?;
        }
        step(environment, bytes)
    }),
    ("VectorEnvironment of a ready task", |_, bytes| {
        static MODEL: OnceLock<Arc<Model>> = OnceLock::new();
        if !bytes.once_in(4) {
            return Ok(());
        }
        let model = MODEL.get_or_init(|| Arc::new(Hopper::model()));
        step(VectorEnvironment::new(model, Hopper, bytes.below(3), bytes.word())?, bytes)
    }),
];
