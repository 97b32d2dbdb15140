//! Noise and delays of vector environments, against a loop over single simulations with the
//! documented order of the random numbers.

use std::ops::RangeInclusive;

use mujoco_safe::environment::{Hopper, VectorEnvironment};
use mujoco_safe::rollout::{Distribution, Parameter, Parameters, Random};
use mujoco_safe::{Data, Result};

use super::environments::{Alone, ShortHopper};
use super::{bits, pool};

const SEED: u64 = 5;
const COUNT: usize = 4;

/// Noise and delays of an environment.
#[derive(Clone, Debug)]
struct Case {
    delay: RangeInclusive<usize>,
    action: [f64; 3],
    observation: [f64; 11],
}

impl Case {
    fn environment(&self) -> Result<VectorEnvironment<ShortHopper>> {
        let mut environment = VectorEnvironment::new(Hopper::model(), ShortHopper, COUNT, SEED)?;
        if *self.delay.end() > 0 {
            environment = environment.with_action_delay(self.delay.clone())?;
        }
        if self.action != [0.0; 3] {
            environment = environment.with_action_noise(&self.action)?;
        }
        if self.observation == [0.0; 11] {
            Ok(environment)
        } else {
            environment.with_observation_noise(&self.observation)
        }
    }
}

/// Single simulation with noise and delays.
struct Disturbed {
    alone: Alone,
    random: Random,
    delay: usize,
    sent: Vec<[f64; 3]>,
}

impl Disturbed {
    fn new(index: usize, episode: u64) -> Self {
        let alone = Alone { data: Data::new(Hopper::model()).unwrap(), index, episode: episode - 1, steps: 0 };
        Self { alone, random: Random::new(0, 0, 0), delay: 0, sent: Vec::new() }
    }

    /// Starts an episode, and returns its first observation.
    fn start(&mut self, case: &Case) -> Vec<f64> {
        self.alone.start(SEED);
        self.random = Random::stream(SEED, self.alone.index, self.alone.episode, u64::MAX);
        let (least, most) = (*case.delay.start(), *case.delay.end());
        self.delay = least + self.random.uniform(0.0, (most - least) as f64 + 1.0).floor() as usize;
        self.sent.clear();
        self.observation(case)
    }

    fn observation(&mut self, case: &Case) -> Vec<f64> {
        let clean = self.alone.observation();
        if case.observation == [0.0; 11] {
            return clean;
        }
        clean.iter().zip(case.observation).map(|(value, deviation)| value + deviation * self.random.normal()).collect()
    }

    fn step(&mut self, case: &Case, action: [f64; 3]) -> (f64, bool, bool) {
        self.sent.push(action);
        let arrived = self.sent.len().checked_sub(self.delay + 1).map_or([0.0; 3], |step| self.sent[step]);
        let received = if case.action == [0.0; 3] {
            arrived
        } else {
            std::array::from_fn(|entry| arrived[entry] + case.action[entry] * self.random.normal())
        };
        self.alone.step(&received)
    }
}

#[test]
fn noise_and_delays_equal_those_of_single_simulations() {
    let none = Case { delay: 0..=0, action: [0.0; 3], observation: [0.0; 11] };
    let cases = [
        Case { delay: 1..=4, action: [0.1, 0.0, 0.3], observation: std::array::from_fn(|entry| 0.01 * entry as f64) },
        Case { action: [0.2; 3], ..none.clone() },
        Case { observation: [0.1; 11], ..none.clone() },
        Case { delay: 3..=3, ..none },
    ];
    let (mut delays, mut ends) = (Vec::new(), 0);
    for (number, case) in cases.iter().enumerate() {
        let pool = pool(1 + 2 * (number % 2));
        let mut environment = pool.install(|| case.environment()).unwrap();
        let mut expected: Vec<Disturbed> =
            (0..COUNT).map(|index| Disturbed::new(index, environment.batch().episode(index))).collect();
        for (index, expected) in expected.iter_mut().enumerate() {
            assert_eq!(bits(environment.observations().row(index)), bits(&expected.start(case)), "{case:?}");
            delays.push(expected.delay);
        }
        for step in 0..50 {
            let action = |index: usize| [0, 1, 2].map(|entry| (0.3 * f64::from(step) + (index + entry) as f64).sin());
            let actions: Vec<f64> = (0..COUNT).flat_map(action).collect();
            pool.install(|| environment.step(&actions)).unwrap();
            for (index, expected) in expected.iter_mut().enumerate() {
                let what = format!("simulation {index}, step {step}, {case:?}");
                let (reward, terminated, truncated) = expected.step(case, action(index));
                assert_eq!(environment.rewards()[index].to_bits(), reward.to_bits(), "reward of {what}");
                assert_eq!(
                    (environment.terminated()[index], environment.truncated()[index]),
                    (terminated, truncated),
                    "{what}"
                );
                let mut observation = expected.observation(case);
                assert_eq!(bits(environment.final_observations().row(index)), bits(&observation), "end of {what}");
                if terminated || truncated {
                    observation = expected.start(case);
                    delays.push(expected.delay);
                    ends += 1;
                }
                assert_eq!(bits(environment.observations().row(index)), bits(&observation), "start of {what}");
            }
        }
    }
    assert!((1..=4).all(|delay| delays.contains(&delay)) && ends >= 8, "delays {delays:?}, {ends} ends");
}

#[test]
fn parts_of_an_environment_compute_the_results_of_the_whole() {
    let run = |first: usize, count: usize| -> Result<_> {
        let model = Hopper::model();
        let torso = Parameter::MassFactor(model.body("torso")?.id());
        let parameters = Parameters::new().with(&model, torso, Distribution::Uniform { low: 0.8, high: 1.2 })?;
        let mut environment = VectorEnvironment::new(model, ShortHopper, count, SEED)?
            .with_first_index(first)?
            .with_parameters(parameters)?
            .with_action_delay(0..=3)?
            .with_action_noise(&[0.1; 3])?
            .with_observation_noise(&[0.01; 11])?;
        let (mut results, mut ends) = (vec![Vec::new(); count], 0);
        for step in 0..50 {
            let actions: Vec<f64> =
                (0..3 * count).map(|at| (0.3 * f64::from(step) + (3 * first + at) as f64).sin()).collect();
            environment.step(&actions)?;
            for (index, results) in results.iter_mut().enumerate() {
                results.extend(bits(environment.observations().row(index)));
                results.push(environment.rewards()[index].to_bits());
                ends += usize::from(environment.terminated()[index] || environment.truncated()[index]);
            }
        }
        Ok((results, ends))
    };
    let (whole, ends) = run(0, 5).unwrap();
    assert_eq!([run(0, 2).unwrap().0, run(2, 3).unwrap().0].concat(), whole);
    assert!(ends > 5, "only {ends} episodes end");
}

#[test]
fn invalid_noise_and_delays_are_errors() {
    let hoppers = || VectorEnvironment::new(Hopper::model(), Hopper, 1, 1).unwrap();
    for (result, expected) in [
        (hoppers().with_action_noise(&[0.1; 2]), "the standard deviations of the action noise (nu)"),
        (
            hoppers().with_action_noise(&[0.1, -0.1, 0.0]),
            "noise of action 1 is -0.1, but must be finite and not negative",
        ),
        (hoppers().with_observation_noise(&[0.1; 3]), "the standard deviations of the observation noise (nobs)"),
        (hoppers().with_observation_noise(&[f64::NAN; 11]), "noise of observation 0 is NaN"),
        (
            hoppers().with_action_delay(RangeInclusive::new(3, 1)),
            "the range of the delay is 3..=1, but must be not empty",
        ),
    ] {
        let message = result.unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}
