//! Parameters of the model for each simulation: distributions, reproducibility and errors. The
//! random schedules compare the simulations with models that were edited by hand.

use std::sync::Arc;

use mujoco_safe::rollout::{Distribution, Parameter, Parameters, Random};
use mujoco_safe::{Batch, Error, Model, sample};

use super::{bits, pool};

fn factor(model: &Model, body: &str) -> Parameter {
    Parameter::MassFactor(model.body(body).unwrap().id())
}

const UNIFORM: Distribution = Distribution::Uniform { low: 0.5, high: 2.5 };
const LOG_UNIFORM: Distribution = Distribution::LogUniform { low: 0.1, high: 10.0 };
const NORMAL: Distribution = Distribution::Normal { mean: -9.81, deviation: 0.5 };

#[test]
fn draws_have_the_moments_and_the_bounds_of_their_distributions() {
    let (model, count) = (Arc::new(sample::cartpole()), 4000);
    let hinge = model.joint("hinge").unwrap().id();
    let parameters = Parameters::new()
        .with(&model, Parameter::JointDamping(hinge), UNIFORM)
        .and_then(|list| list.with(&model, Parameter::JointStiffness(hinge), LOG_UNIFORM))
        .and_then(|list| list.with(&model, Parameter::Gravity(2), NORMAL))
        .and_then(|list| list.with(&model, Parameter::JointFrictionLoss(hinge), Distribution::Unchanged))
        .unwrap();
    let mut batch = Batch::new(model, count).unwrap().with_parameters(parameters).unwrap();
    batch.sample_parameters(|_| true, 1).unwrap();
    let column = |at: usize, f: fn(f64) -> f64| batch.parameters().rows().map(|row| f(row[at])).collect::<Vec<_>>();
    // A normal distribution truncated at three standard deviations has 0.9866 of the deviation.
    let expected = [
        (column(0, |value| value), 1.5, 2.0 / 12.0_f64.sqrt(), 0.5, 2.5),
        (column(1, f64::log10), 0.0, 2.0 / 12.0_f64.sqrt(), -1.0, 1.0),
        (column(2, |value| value), -9.81, 0.5 * 0.9866, -11.31, -8.31),
        (column(3, |value| value), 0.0, 0.0, 0.0, 0.0),
    ];
    for (at, (values, mean, deviation, low, high)) in expected.into_iter().enumerate() {
        assert!(values.iter().all(|value| (low - 1e-12..=high + 1e-12).contains(value)), "column {at}");
        let n = count as f64;
        let sample_mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|value| (value - sample_mean).powi(2)).sum::<f64>() / n;
        // Four standard errors, of which that of the deviation is at most that of the mean.
        let error = 4.0 * deviation / n.sqrt();
        assert!((sample_mean - mean).abs() <= error, "column {at}: mean {sample_mean}");
        assert!((variance.sqrt() - deviation).abs() <= error, "column {at}: deviation {}", variance.sqrt());
    }
}

#[test]
fn draws_depend_on_seed_simulation_episode_and_column_only() {
    let model = Arc::new(sample::cartpole());
    let draw = |count: usize, threads: usize, seed: u64, columns: usize| {
        let list =
            [(factor(&model, "pole"), UNIFORM), (Parameter::Gravity(2), NORMAL), (Parameter::Gravity(0), NORMAL)];
        let parameters = list[..columns].iter().fold(Parameters::new(), |parameters, &(parameter, distribution)| {
            parameters.with(&model, parameter, distribution).unwrap()
        });
        let mut batch = Batch::new(&model, count).unwrap().with_chunk(1).with_parameters(parameters).unwrap();
        pool(threads).install(|| batch.sample_parameters(|_| true, seed)).unwrap();
        batch.reset(1).unwrap();
        let before = batch.parameters().to_matrix();
        pool(threads).install(|| batch.sample_parameters(|index| index == 1, seed)).unwrap();
        assert_eq!(batch.parameters().row(0), before.row(0));
        assert_ne!(batch.parameters().row(1), before.row(1), "the episodes differ");
        batch.parameters().to_matrix()
    };
    let all = draw(6, 2, 7, 3);
    let fewer = draw(3, 1, 7, 2);
    for index in 0..3 {
        assert_eq!(bits(&all.row(index)[..2]), bits(fewer.row(index)), "simulation {index}");
    }
    let values: Vec<u64> =
        [all.as_slice(), draw(6, 1, 8, 3).as_slice()].iter().flat_map(|values| bits(values)).collect();
    let distinct: std::collections::HashSet<u64> = values.iter().copied().collect();
    assert_eq!(distinct.len(), values.len(), "seeds, simulations and columns are independent");
    assert_eq!(Random::new(1, 2, 3).uniform(0.0, 1.0).to_bits(), Random::new(1, 2, 3).uniform(0.0, 1.0).to_bits());
}

#[test]
fn parts_of_a_batch_draw_the_values_of_the_whole() {
    let model = Arc::new(sample::cartpole());
    let parameters = Parameters::new()
        .with(&model, factor(&model, "pole"), LOG_UNIFORM)
        .and_then(|list| list.with(&model, Parameter::Gravity(2), NORMAL))
        .unwrap();
    let draw = |first: usize, count: usize| {
        let batch = Batch::new(&model, count).unwrap().with_parameters(parameters.clone()).unwrap();
        let mut batch = if first == 0 { batch } else { batch.with_first_index(first) };
        batch.sample_parameters(|_| true, 3).unwrap();
        batch.reset_where(|_| true, |_, _, _| ()).unwrap();
        batch.sample_parameters(|index| first.wrapping_add(index) % 2 == 0, 3).unwrap();
        bits(batch.parameters().as_slice())
    };
    let whole = draw(0, 7);
    assert_eq!([draw(0, 3), draw(3, 4)].concat(), whole);
    assert_ne!(draw(0, 4), draw(3, 4));
    draw(usize::MAX, 2); // The index wraps around.
}

#[test]
fn an_invalid_value_is_an_error_before_any_simulation_changes() {
    let model = Arc::new(sample::humanoid());
    let floor = model.geom("floor").unwrap().id();
    let knee = model.joint("left_knee").unwrap().id();
    let parameters = Parameters::new()
        .with(&model, factor(&model, "torso"), Distribution::Unchanged)
        .and_then(|list| list.with(&model, Parameter::GeomFriction(floor, 0), Distribution::Unchanged))
        .and_then(|list| list.with(&model, Parameter::JointDamping(knee), Distribution::Unchanged))
        .unwrap();
    assert_eq!(
        parameters.names().collect::<Vec<_>>(),
        ["factor of the mass of body 'torso'", "geom_friction[0] of geom 'floor'", "dof_damping of joint 'left_knee'"]
    );
    let mut batch = Batch::new(&model, 4).unwrap().with_parameters(parameters).unwrap();
    let nominal = batch.parameters().to_matrix();
    let friction = model.geom_friction()[floor.index()][0];
    assert_eq!(nominal.row(3), [1.0, friction, model.dof_damping()[model.joint(knee).dofs().start]]);
    for (at, value, expected) in [
        (0, -1.0, "the factor of the mass of body 'torso' of simulation 2 is -1, but must be from 1e-6 to 1e6"),
        (1, -0.5, "the geom_friction[0] of geom 'floor' of simulation 2 is -0.5, but must be finite and not negative"),
        (
            2,
            f64::NAN,
            "the dof_damping of joint 'left_knee' of simulation 2 is NaN, but must be finite and not negative",
        ),
    ] {
        let set = |index: usize, values: &mut [f64]| values[at] = if index == 2 { value } else { 0.5 };
        let error = batch.set_parameters(|_| true, set).unwrap_err();
        assert_eq!(error.to_string(), expected);
        assert_eq!(batch.parameters().to_matrix(), nominal);
        assert_eq!(batch.data(0).unwrap().model().body_mass(), model.body_mass());
    }
}

#[test]
fn a_parameter_that_the_model_does_not_have_is_an_error() {
    let model = sample::humanoid();
    let with = |parameter, distribution| Parameters::new().with(&model, parameter, distribution);
    let floor = model.geom("floor").unwrap().id();
    let fails = |parameter, distribution: Distribution, expected: &str| {
        let error = with(parameter, distribution).unwrap_err();
        assert_eq!(error.to_string(), expected);
    };
    fails(Parameter::Gravity(3), Distribution::Unchanged, "the component of gravity is 3, but must be less than 3");
    fails(
        Parameter::GeomSize(floor, 0),
        Distribution::Unchanged,
        "geom_size of geom 'floor' cannot vary: the geom must be a sphere, capsule, cylinder, ellipsoid or box",
    );
    let downward = Distribution::Uniform { low: 2.0, high: 1.0 };
    fails(Parameter::Gravity(0), downward, "the smallest value of gravity[0] is 2, but must be at most the largest, 1");
    let zero = Distribution::LogUniform { low: 0.0, high: 1.0 };
    fails(
        Parameter::Gravity(0),
        zero,
        "the smallest value of gravity[0] is 0, but must be positive, for its logarithm",
    );
    let twice = with(Parameter::Gravity(0), UNIFORM).unwrap().with(&model, Parameter::Gravity(0), NORMAL).unwrap_err();
    assert!(matches!(twice, Error::Invalid { .. }) && twice.to_string().contains("gravity[0] twice"), "{twice}");
}

#[test]
fn a_range_wider_than_the_largest_number_is_uniform() {
    let mut random = Random::new(1, 0, 0);
    let draws: Vec<f64> = (0..1000).map(|_| random.uniform(-1.7e308, 1.7e308)).collect();
    assert!(draws.iter().all(|draw| (-1.7e308..=1.7e308).contains(draw)));
    let below = |bound: f64| draws.iter().filter(|draw| **draw < bound).count();
    for (bound, expected) in [(-0.85e308, 250), (0.0, 500), (0.85e308, 750)] {
        assert!(below(bound).abs_diff(expected) < 60, "{} draws below {bound}", below(bound));
    }
}
