//! Random schedules of steps, resets, edits and failures: a batch equals a separate `Data` for each
//! simulation.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use mujoco_safe::callback::Callbacks;
use mujoco_safe::data::Warning;
use mujoco_safe::enums::GeomType;
use mujoco_safe::rollout::{Distribution, Parameter, Parameters};
use mujoco_safe::{Batch, Data, Model, ModelMut, Result, StateSpec, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::parameter_edits::edit;
use super::{bits, pool};

use crate::cases::cases;

const SPEC: StateSpec = StateSpec::INTEGRATION;

/// Changes that closures make to a simulation.
#[derive(Clone, Copy, Debug)]
enum Change {
    Nothing,
    Velocity,
    Inputs,
    Steps,
    Mass,
    Callbacks,
    NoCallbacks,
    Unstable,
    Error,
}

const CHANGES: [Change; 9] = [
    Change::Nothing,
    Change::Velocity,
    Change::Inputs,
    Change::Steps,
    Change::Mass,
    Change::Callbacks,
    Change::NoCallbacks,
    Change::Unstable,
    Change::Error,
];

/// Number of calls of the closures of [`Change::Callbacks`].
static CALLS: AtomicUsize = AtomicUsize::new(0);

fn random(seed: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(seed)
}

fn apply(change: Change, seed: u64, data: &mut Data) -> Result<()> {
    let mut random = random(seed);
    let mut fill = |values: &mut [f64]| values.iter_mut().for_each(|value| *value = random.random_range(-0.5..0.5));
    match change {
        Change::Nothing => {}
        Change::Velocity => fill(data.qvel_mut()),
        Change::Inputs => {
            fill(data.ctrl_mut());
            fill(data.qfrc_applied_mut());
            fill(data.xfrc_applied_mut().as_flattened_mut());
            fill(data.mocap_pos_mut().as_flattened_mut());
            fill(data.userdata_mut());
            data.set_time(3.0);
        }
        Change::Steps => {
            fill(data.ctrl_mut());
            data.step_n(3)?;
            // Results that a step does not compute, and values that it does not overwrite.
            data.rne_post_constraint()?;
            data.sensordata_mut().fill(5.0);
            data.qfrc_inverse_mut().fill(5.0);
        }
        Change::Mass => data.edit_model(|model| {
            let bodies = model.nbody();
            model.body_mass_mut()[bodies - 1] *= 1.5;
            model.update_constants()
        })?,
        Change::Callbacks => data.set_callbacks(Callbacks::new().with_control(|context| {
            CALLS.fetch_add(1, Ordering::Relaxed);
            let push = context.qvel().first().map_or(0.0, |velocity| -0.1 * velocity);
            context.ctrl_mut().iter_mut().for_each(|control| *control = push);
        })),
        Change::NoCallbacks => data.set_callbacks(Callbacks::new()),
        Change::Unstable => data.qvel_mut()[0] = 1e9 * (1 + seed % 20) as f64,
        Change::Error => return data.reset_to_key(1_000_000),
    }
    Ok(())
}

/// Separate simulation, with the rules of a batch.
struct Alone {
    data: Data,
    /// State that a batch keeps after a failure.
    state: Vec<f64>,
    failure: Option<String>,
    episode: u64,
    /// Number of warnings before the last call of `clear`.
    warnings: f64,
    observation: Vec<f64>,
}

fn warnings(data: &Data) -> f64 {
    [Warning::Inertia, Warning::ContactFull, Warning::ConstraintFull]
        .map(|warning| data.warning(warning).number as f64)
        .iter()
        .sum()
}

/// Numbers of an observation: of state and results, including values that a step may leave
/// unchanged.
fn observe(data: &Data, row: &mut [f64]) {
    let results = [
        data.qpos(),
        data.xpos().as_flattened(),
        data.qfrc_constraint(),
        data.sensordata(),
        data.qfrc_inverse(),
        data.cfrc_ext().as_flattened(),
        data.energy().as_slice(),
        data.ctrl(),
    ]
    .concat();
    row[0] = data.ncon() as f64;
    row[1] = warnings(data);
    row[2] = data.solver().len() as f64;
    row[3..].copy_from_slice(&results);
}

fn width(model: &Model) -> usize {
    3 + model.nq() + 9 * model.nbody() + 2 * model.nv() + model.nsensordata() + 2 + model.nu()
}

/// Returns parameters of the last elements of the model, with a valid range of values.
fn parameters(model: &Model) -> Vec<(Parameter, [f64; 2])> {
    let body = model.body(model.nbody() - 1).unwrap().id();
    let mut list = vec![(Parameter::Gravity(2), [-12.0, -8.0]), (Parameter::MassFactor(body), [0.5, 2.0])];
    // Newer engines do not allow the centre of mass of a body that moves independently to leave its
    // frame.
    if !cfg!(engine_since = "2.3.0") || !model.body(body).simple() {
        list.push((Parameter::CentreOfMass(body, 0), [-0.01, 0.01]));
    }
    if let Some(joint) = model.njnt().checked_sub(1).map(|joint| model.joint(joint).unwrap().id()) {
        list.push((Parameter::JointStiffness(joint), [0.0, 1.0]));
        list.push((Parameter::JointDamping(joint), [0.0, 1.0]));
        list.push((Parameter::JointFrictionLoss(joint), [0.0, 0.1]));
        list.push((Parameter::JointArmature(joint), [0.0, 0.1]));
    }
    let mut capsules = (0..model.ngeom()).filter(|&geom| model.geom(geom).unwrap().geom_type() == GeomType::Capsule);
    if let Some(geom) = capsules.next_back().map(|geom| model.geom(geom).unwrap().id()) {
        list.push((Parameter::GeomFriction(geom, 0), [0.0, 1.0]));
        list.push((Parameter::GeomSize(geom, 1), [0.05, 0.3]));
    }
    if let Some(actuator) = model.nu().checked_sub(1).map(|actuator| model.actuator(actuator).unwrap().id()) {
        list.push((Parameter::ActuatorGain(actuator, 0), [0.5, 2.0]));
        list.push((Parameter::ActuatorBias(actuator, 1), [-1.0, 1.0]));
        list.push((Parameter::ActuatorGear(actuator), [0.5, 2.0]));
    }
    list
}

/// Options of a batch.
#[derive(Clone, Copy, Debug)]
struct Setting {
    threads: usize,
    chunk: usize,
    substeps: usize,
    forward: bool,
}

impl Alone {
    fn new(model: &Arc<Model>, setting: Setting) -> Self {
        let data = Data::new(model.clone()).unwrap();
        let (state, observation) = (data.state(SPEC), vec![0.0; width(model)]);
        let mut alone = Self { data, state, failure: None, episode: 0, warnings: 0.0, observation };
        alone.observe(setting);
        alone
    }

    /// Clears everything except the state.
    fn clear(&mut self) {
        let state = self.data.state(SPEC);
        self.warnings += warnings(&self.data);
        self.data.reset().unwrap();
        self.data.set_state(SPEC, &state).unwrap();
    }

    fn observe(&mut self, setting: Setting) {
        self.state = self.data.state(SPEC);
        if setting.forward {
            if let Err(error) = self.data.forward() {
                return self.fail(error.to_string());
            }
            self.data.set_state(SPEC, &self.state).unwrap();
        }
        observe(&self.data, &mut self.observation);
        self.observation[1] += self.warnings;
    }

    fn fail(&mut self, failure: String) {
        self.failure = Some(failure);
        self.observation.fill(f64::NAN);
    }

    fn step(&mut self, controls: &[f64], setting: Setting) {
        if self.failure.is_some() {
            return;
        }
        self.data.ctrl_mut().copy_from_slice(controls);
        self.state = self.data.state(SPEC);
        if setting.substeps == 0 {
            self.clear();
        }
        match self.data.step_n(setting.substeps) {
            Ok(()) => self.observe(setting),
            Err(error) => self.fail(error.to_string()),
        }
    }

    fn set_parameters(&mut self, values: &[(Parameter, f64)], model: &Model, setting: Setting) {
        let edits = |copy: &mut ModelMut<'_>| {
            let has_derived =
                values.iter().filter(|&&(parameter, value)| edit(parameter, value, model, copy)).count() > 0;
            // Once, because the engine normalises the quaternions of welds in each call.
            if has_derived { copy.update_constants() } else { Ok(()) }
        };
        self.data.edit_model(edits).unwrap();
        if self.failure.is_none() {
            self.clear();
            self.observe(setting);
        }
    }

    fn change(&mut self, change: Change, seed: u64, reset: bool, setting: Setting) {
        if reset {
            (self.failure, self.episode, self.warnings) = (None, self.episode + 1, 0.0);
            self.data.reset().unwrap();
        } else if self.failure.is_some() {
            return;
        } else {
            self.clear();
        }
        match apply(change, seed, &mut self.data) {
            // The observation has the results of the closure; later steps do not.
            Ok(()) => self.observe(setting),
            Err(error) => self.fail(error.to_string()),
        }
        match &mut self.failure {
            None => self.clear(),
            // The call has returned the error itself.
            Some(failure) => *failure = format!("this data is unusable since {failure}; reset it first"),
        }
    }
}

/// Runs a random schedule on a batch and on separate simulations. Returns the numbers of steps and
/// of failures.
fn run(model: &Arc<Model>, seed: u64) -> (usize, usize) {
    let mut random = random(seed);
    let count = random.random_range(1..9);
    let setting = Setting {
        threads: random.random_range(1..4),
        chunk: random.random_range(1..count + 2),
        substeps: random.random_range(0..4),
        forward: random.random_bool(0.3),
    };
    let what = |call: usize| format!("seed {seed}, call {call}, {setting:?}");
    let pool = pool(setting.threads);
    let mut batch = Batch::new(model, count).unwrap().with_substeps(setting.substeps).with_chunk(setting.chunk);
    batch = batch.with_observations(width(model), observe);
    batch = if setting.forward { batch.with_forward_after_step() } else { batch };
    let list = parameters(model);
    let columns = list.iter().fold(Parameters::new(), |columns, &(parameter, _)| {
        columns.with(model, parameter, Distribution::Unchanged).unwrap()
    });
    batch = batch.with_parameters(columns).unwrap();
    let mut alone: Vec<_> = (0..count).map(|_| Alone::new(model, setting)).collect();
    let mut data = Data::new(model).unwrap();
    let (mut steps, mut failures) = (0, 0);
    for call in 0..25 {
        let (change, change_seed) = (CHANGES[random.random_range(0..CHANGES.len())], random.random::<u64>() >> 8);
        let selected: Vec<bool> = (0..count).map(|_| random.random_bool(0.4)).collect();
        let which = |index: usize| selected[index];
        let seed_of = |index: usize| change_seed + index as u64;
        match random.random_range(0..7) {
            6 => {
                let mut values = std::collections::BTreeMap::new();
                for _ in 0..random.random_range(1..4) {
                    let column = random.random_range(0..list.len());
                    let [low, high] = list[column].1;
                    values.insert(column, random.random_range(low..high));
                }
                let set = |index: usize, row: &mut [f64]| {
                    for (&column, value) in &values {
                        row[column] = value + 1e-3 * index as f64;
                    }
                };
                pool.install(|| batch.set_parameters(which, set)).unwrap();
                for index in (0..count).filter(|&index| which(index)) {
                    let value = |(&column, value): (&usize, &f64)| (list[column].0, value + 1e-3 * index as f64);
                    alone[index].set_parameters(&values.iter().map(value).collect::<Vec<_>>(), model, setting);
                }
            }
            0 => {
                let start = |index: usize, _, data: &mut Data| apply(change, seed_of(index), data);
                drop(pool.install(|| batch.reset_where(which, start)));
                for index in (0..count).filter(|&index| which(index)) {
                    alone[index].change(change, seed_of(index), true, setting);
                }
            }
            1 => {
                let edit = |index: usize, data: &mut Data| apply(change, seed_of(index), data);
                drop(pool.install(|| batch.edit_where(which, edit)));
                for index in (0..count).filter(|&index| which(index)) {
                    alone[index].change(change, seed_of(index), false, setting);
                }
            }
            _ => {
                let nu = model.nu();
                let mut controls: Vec<f64> = (0..count * nu).map(|_| random.random_range(-1.0..1.0)).collect();
                if nu > 0 && random.random_bool(0.1) {
                    controls[random.random_range(0..count) * nu] = f64::NAN;
                }
                let policy = |_: mujoco_safe::MatrixView<'_>, to: &mut mujoco_safe::MatrixViewMut<'_>| {
                    to.as_mut_slice().copy_from_slice(&controls);
                };
                pool.install(|| batch.step(policy)).unwrap();
                for (index, alone) in alone.iter_mut().enumerate() {
                    alone.step(&controls[index * nu..][..nu], setting);
                }
                steps += 1;
            }
        }
        for (index, alone) in alone.iter().enumerate() {
            let what = || format!("simulation {index}, {}, {change:?}", what(call));
            assert_eq!(batch.failure(index).map(ToString::to_string), alone.failure, "{}", what());
            assert_eq!(batch.episode(index), alone.episode, "{}", what());
            let pairs = bits(batch.observations().row(index)).into_iter().zip(bits(&alone.observation));
            let differing = pairs.enumerate().find(|(_, (batch, alone))| batch != alone);
            assert_eq!(differing, None, "observation of {}", what());
            assert!(bits(batch.states().row(index)) == bits(&alone.state), "state of {}", what());
            if alone.failure.is_none() {
                batch.load(index, &mut data).unwrap();
                assert!(bits(&data.state(SPEC)) == bits(&alone.state), "loaded state of {}", what());
                assert_eq!(data.model().body_mass(), alone.data.model().body_mass(), "{}", what());
            }
            failures += usize::from(alone.failure.is_some());
        }
    }
    for (index, alone) in alone.iter().enumerate() {
        let loaded = batch.data(index).unwrap().model().to_binary().unwrap();
        let edited = alone.data.model().to_binary().unwrap();
        let differing = (0..edited.len()).find(|&byte| loaded[byte] != edited[byte]);
        assert_eq!(differing, None, "byte of the model of simulation {index}, {}", what(25));
    }
    (steps, failures)
}

#[test]
fn random_schedules_equal_separate_simulations() {
    let file = |name: &str| {
        let path = format!("{}/tests/models/{name}.xml", env!("CARGO_MANIFEST_DIR"));
        Arc::new(Model::from_xml_path(path).unwrap())
    };
    let crowd = r#"<mujoco><size nconmax="1"/><worldbody><geom type="plane" size="1 1 1"/>
        <body pos="0 0 .1"><freejoint/><geom size=".1"/></body>
        <body pos="0 0 .25"><freejoint/><geom size=".1"/></body></worldbody></mujoco>"#;
    let crowd = Arc::new(Model::from_xml_str(crowd).unwrap());
    let models =
        [crowd, Arc::new(sample::cartpole()), Arc::new(sample::humanoid()), file("every_element"), file("zoo")];
    let (mut steps, mut failures) = (0, 0);
    for seed in 0..cases(30, 100) {
        let (more_steps, more_failures) = run(&models[seed as usize % models.len()], seed);
        (steps, failures) = (steps + more_steps, failures + more_failures);
    }
    assert!(steps > cases(300, 1000) && failures > cases(30, 100), "{steps} steps, {failures} failures");
    assert!(CALLS.load(Ordering::Relaxed) > 100);
}
