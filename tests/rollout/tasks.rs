//! What a task sees of a simulation, against a loop over single simulations, and what a task cannot
//! do.

use std::mem::swap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use mujoco_safe::data::MissingResults;
use mujoco_safe::environment::{Evaluation, Hopper, Task, Transition, VectorEnvironment};
use mujoco_safe::rollout::Random;
use mujoco_safe::{Data, Error, Model, Result, Stage, sample};

use super::{bits, pool};

const COUNT: usize = 5;
const LIMIT: u64 = 7;

/// A task for the humanoid that reads everything.
struct Everything {
    forward: bool,
    body_forces: bool,
}

/// Writes poses, contacts with their forces, readings of sensors and forces on bodies.
fn read(data: &Data, row: &mut [f64]) {
    let (nbody, nv) = (data.model().nbody(), data.model().nv());
    row[0] = data.ncon() as f64;
    row[1] = data.contacts().map(|contact| contact.force().unwrap().force[0]).sum();
    row[2] = data.sensor("torso_accelerometer").unwrap().data().unwrap()[2];
    let parts = [
        data.qpos(),
        data.xpos().as_flattened(),
        data.qfrc_constraint(),
        data.cfrc_ext().as_flattened(),
        data.sensordata(),
    ];
    assert_eq!((parts[1].len(), parts[2].len()), (3 * nbody, nv));
    row[3..].iter_mut().zip(parts.into_iter().flatten()).for_each(|(to, from)| *to = *from);
}

fn width(model: &Model) -> usize {
    3 + model.nq() + 9 * model.nbody() + model.nv() + model.nsensordata()
}

impl Task for Everything {
    fn observation_size(&self, model: &Model) -> usize {
        width(model)
    }

    fn frame_skip(&self) -> usize {
        2
    }

    fn time_limit(&self) -> Option<u64> {
        Some(LIMIT)
    }

    fn forward_after_step(&self) -> bool {
        self.forward
    }

    fn body_forces(&self) -> bool {
        self.body_forces
    }

    fn start(&self, random: &mut Random, data: &mut Data) -> Result<()> {
        data.reset_to_key("squat")?;
        data.qpos_mut()[2] += random.uniform(-0.02, 0.0);
        Ok(())
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        assert!(data.require(MissingResults::BODY_FORCES).is_ok() || !self.body_forces);
        read(data, observation);
        Ok(())
    }

    /// Returns the number of remembered values, and their sum.
    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        let [steps, height] = transition.memory else { panic!("{} values", transition.memory.len()) };
        let motion = transition.before.qpos[2] + transition.data.qpos()[2];
        assert_eq!(transition.action, transition.data.ctrl());
        assert_eq!(transition.duration, 2.0 * 0.005);
        Ok(Evaluation { reward: 1000.0 * steps + height + motion, terminated: false })
    }

    fn memory_size(&self, _: &Model) -> usize {
        2
    }

    fn remember(&self, data: &Data, memory: &mut [f64]) -> Result<()> {
        memory[0] += 1.0;
        memory[1] = data.xpos()[1][2];
        Ok(())
    }
}

/// Refreshes a simulation as documented, but not its state. Returns an observation of it.
fn observation(data: &mut Data, forward: bool, body_forces: bool) -> Vec<f64> {
    let qpos = data.qpos().to_vec();
    if forward {
        data.forward().unwrap();
    }
    if body_forces {
        data.rne_post_constraint().unwrap();
    }
    // Forward dynamics normalises quaternions.
    data.qpos_mut().copy_from_slice(&qpos);
    let mut row = vec![0.0; width(data.model())];
    read(data, &mut row);
    row
}

#[test]
fn a_task_sees_the_simulation_of_its_step_and_what_it_has_remembered() {
    for (forward, body_forces, threads) in [(false, false, 1), (false, true, 3), (true, false, 3), (true, true, 1)] {
        let task = Everything { forward, body_forces };
        let mut environment =
            pool(threads).install(|| VectorEnvironment::new(sample::humanoid(), task, COUNT, 9)).unwrap();
        let model = environment.batch().model().clone();
        let mut alone: Vec<Data> = (0..COUNT).map(|_| Data::new(&model).unwrap()).collect();
        let (mut contacts, mut height) = (0.0, [0.0; COUNT]);
        for step in 0..2 * LIMIT + 2 {
            let (steps, episode) = (step % LIMIT, 1 + step / LIMIT);
            if steps == 0 {
                for (index, data) in alone.iter_mut().enumerate() {
                    data.reset().unwrap();
                    environment.task().start(&mut Random::new(9, index, episode), data).unwrap();
                    let mut copy = data.clone();
                    let first = observation(&mut copy, true, body_forces);
                    assert!(bits(environment.observations().row(index)) == bits(&first), "start of {index}");
                    height[index] = copy.xpos()[1][2];
                }
            }
            let action = |index: usize| move |actuator: usize| 0.3 * ((step as usize + index + actuator) as f64).sin();
            let actions: Vec<f64> = (0..COUNT).flat_map(|index| (0..model.nu()).map(action(index))).collect();
            pool(threads).install(|| environment.step(&actions)).unwrap();
            for (index, data) in alone.iter_mut().enumerate() {
                let before = data.qpos()[2];
                data.ctrl_mut().copy_from_slice(&actions[index * model.nu()..][..model.nu()]);
                data.step_n(2).unwrap();
                let mut copy = data.clone();
                let row = observation(&mut copy, forward, body_forces);
                let what = format!("simulation {index}, step {step}, {forward}, {body_forces}");
                assert!(bits(environment.final_observations().row(index)) == bits(&row), "{what}");
                let reward = 1000.0 * (steps + 1) as f64 + height[index] + (before + data.qpos()[2]);
                assert_eq!(environment.rewards()[index].to_bits(), reward.to_bits(), "{what}");
                assert_eq!(environment.truncated()[index], steps + 1 == LIMIT, "{what}");
                height[index] = copy.xpos()[1][2];
                contacts += row[0];
            }
        }
        assert!(contacts > 0.0);
    }
}

/// The hopper, whose episodes start with this call.
struct Start<F>(F);

impl<F: Fn(&mut Data) -> Result<()> + Send + Sync> Task for Start<F> {
    fn observation_size(&self, model: &Model) -> usize {
        Hopper.observation_size(model)
    }

    fn time_limit(&self) -> Option<u64> {
        Some(3)
    }

    fn start(&self, _: &mut Random, data: &mut Data) -> Result<()> {
        (self.0)(data)
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        Hopper.observe(data, observation)
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        Hopper.evaluate(transition)
    }
}

#[test]
fn a_task_cannot_give_a_simulation_another_model() {
    let replace = |data: &mut Data| {
        *data = Data::new(sample::cartpole())?;
        Ok(())
    };
    let error = VectorEnvironment::new(Hopper::model(), Start(replace), 2, 0).map(|_| ()).unwrap_err();
    assert!(matches!(error, Error::OtherModel { .. }), "{error}");
}

#[test]
fn a_task_that_exchanges_simulations_changes_no_result() {
    let stash = Mutex::new(None);
    let exchange = |data: &mut Data| {
        let mut stash = stash.lock().unwrap();
        let other = stash.get_or_insert_with(|| Data::new(data.model()).unwrap());
        // The other one is of an earlier episode, and in motion.
        other.step()?;
        swap(data, other);
        data.reset()
    };
    let (model, actions) = (std::sync::Arc::new(Hopper::model()), [0.3, -0.2, 0.1].repeat(4));
    let mut plain = VectorEnvironment::new(&model, Start(Data::reset), 4, 0).unwrap();
    let mut exchanging = pool(3).install(|| VectorEnvironment::new(&model, Start(exchange), 4, 0)).unwrap();
    for _ in 0..10 {
        plain.step(&actions).unwrap();
        pool(3).install(|| exchanging.step(&actions)).unwrap();
        assert_eq!(bits(exchanging.observations().as_slice()), bits(plain.observations().as_slice()));
        assert_eq!(exchanging.rewards(), plain.rewards());
    }
}

#[test]
fn an_initial_state_that_forward_rejects_is_an_error() {
    let calls = AtomicU64::new(0);
    let start = |data: &mut Data| {
        if calls.fetch_add(1, Ordering::Relaxed) > 0 {
            data.qpos_mut()[0] = f64::NAN;
        }
        Ok(())
    };
    let mut environment = VectorEnvironment::new(Hopper::model(), Start(start), 1, 0).unwrap();
    assert!(matches!(environment.reset(), Err(Error::Unstable(_))));
    assert!(environment.observations().row(0).iter().all(|value| value.is_nan()));
}

/// A task of which one part fails for large actions, with an error that names the action.
struct Fails(&'static str);

impl Fails {
    fn part(&self, part: &str, data: &Data) -> Result<()> {
        let action = data.ctrl()[0];
        if part == self.0 && action > 0.5 { data.body(&format!("{action}")).map(drop) } else { Ok(()) }
    }
}

impl Task for Fails {
    fn observation_size(&self, model: &Model) -> usize {
        model.nq() + model.nv()
    }

    fn start(&self, _: &mut Random, data: &mut Data) -> Result<()> {
        data.qpos_mut()[1] = 0.1;
        Ok(())
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        data.physics_state_into(observation)?;
        self.part("observe", data)
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        self.part("evaluate", transition.data)?;
        Ok(Evaluation { reward: 1.0, terminated: false })
    }

    fn remember(&self, data: &Data, _: &mut [f64]) -> Result<()> {
        self.part("remember", data)
    }
}

/// The first error is returned after all simulations have been stepped, and those with an error
/// start again.
#[test]
fn an_error_of_a_task_ends_the_episode_of_its_simulation() {
    let new = |part| VectorEnvironment::new(sample::cartpole(), Fails(part), 3, 0).unwrap();
    let mut expected = new("nothing");
    let start = expected.observations().row(0).to_vec();
    expected.step(&[0.1, 0.6, 0.7]).unwrap();
    for part in ["observe", "evaluate", "remember"] {
        let mut environment = new(part);
        let error = environment.step(&[0.1, 0.6, 0.7]).unwrap_err();
        assert!(matches!(&error, Error::NoSuchName { name, .. } if name == "0.6"), "{part}: {error}");
        assert_eq!(environment.terminated(), [false, true, true], "{part}");
        assert_eq!(environment.rewards(), [1.0, 0.0, 0.0], "{part}");
        assert_eq!(environment.observations().row(0), expected.observations().row(0), "{part}");
        for index in [1, 2] {
            assert!(environment.final_observations().row(index).iter().all(|value| value.is_nan()), "{part}");
            assert_eq!(environment.observations().row(index), start, "{part}");
        }
        environment.step(&[0.1; 3]).unwrap();
        assert_eq!(environment.rewards(), [1.0; 3], "{part}");
    }
}

/// A task that observes if poses have been computed.
struct StateOnly;

impl Task for StateOnly {
    fn observation_size(&self, _: &Model) -> usize {
        1
    }

    fn forward_after_start(&self) -> bool {
        false
    }

    fn start(&self, _: &mut Random, _: &mut Data) -> Result<()> {
        Ok(())
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        observation[0] = f64::from(data.require(Stage::Position).is_ok());
        Ok(())
    }

    fn evaluate(&self, _: &Transition<'_>) -> Result<Evaluation> {
        Ok(Evaluation { reward: 0.0, terminated: false })
    }
}

#[test]
fn a_task_can_start_without_forward_dynamics() {
    let mut environment = VectorEnvironment::new(Hopper::model(), StateOnly, 1, 0).unwrap();
    assert_eq!(environment.observations().as_slice(), [0.0]);
    environment.step(&[0.0; 3]).unwrap();
    assert_eq!(environment.observations().as_slice(), [1.0]);
    let poses = VectorEnvironment::new(Hopper::model(), Remembers(0), 1, 0).unwrap();
    assert!(poses.observations()[(0, 0)] > 0.5);
}

/// A task that remembers this number of values.
struct Remembers(usize);

impl Task for Remembers {
    fn observation_size(&self, _: &Model) -> usize {
        1
    }

    fn frame_skip(&self) -> usize {
        0
    }

    fn body_forces(&self) -> bool {
        true
    }

    fn start(&self, _: &mut Random, _: &mut Data) -> Result<()> {
        Ok(())
    }

    fn observe(&self, data: &Data, observation: &mut [f64]) -> Result<()> {
        observation[0] = data.xpos()[1][2];
        Ok(())
    }

    fn evaluate(&self, transition: &Transition<'_>) -> Result<Evaluation> {
        Ok(Evaluation { reward: transition.memory.len() as f64, terminated: false })
    }

    fn memory_size(&self, _: &Model) -> usize {
        self.0
    }
}

#[test]
fn too_many_values_to_remember_are_an_error() {
    for size in [usize::MAX, 1 << 61, 1 << 48] {
        let error = VectorEnvironment::new(Hopper::model(), Remembers(size), 2, 0).map(|_| ()).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
    }
}

#[test]
fn an_action_without_engine_steps_has_present_quantities() {
    let mut environment = VectorEnvironment::new(Hopper::model(), Remembers(3), 2, 0).unwrap();
    let first = environment.observations().to_matrix();
    environment.step(&[1.0; 6]).unwrap();
    assert!(first[(0, 0)] > 0.5 && environment.observations().to_matrix() == first);
    assert_eq!((environment.rewards(), environment.terminated()), (&[3.0; 2][..], &[false; 2][..]));
}
