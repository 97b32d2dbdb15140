//! Several segments, and uncertain states at the start.

use mujoco_safe::identification::{Experiment, Fit, Identification, Measurement, Options, Signal, Unknown};
use mujoco_safe::least_squares::LeastSquaresStatus;
use mujoco_safe::{Data, Matrix};

use crate::{DOUBLE_PENDULUM, Log, model, record};

fn masses() -> Vec<Unknown> {
    ["upper", "lower"]
        .into_iter()
        .enumerate()
        .map(|(index, name)| {
            let body = index + 1;
            Unknown::edit(format!("length of {name}"), 1.0, move |value, model| {
                // The centre of mass moves with the length.
                model.body_ipos_mut()[body][2] *= value;
                model.update_constants()
            })
            .between(0.3, 3.0)
        })
        .collect()
}

const TRUTH: [f64; 2] = [1.15, 0.8];

fn start() -> Data {
    let mut data = Data::new(model(DOUBLE_PENDULUM)).unwrap();
    data.qpos_mut().copy_from_slice(&[2.2, 0.9]);
    data
}

fn log() -> (Data, Log) {
    let data = start();
    let mut truth = data.clone();
    truth
        .edit_model(|model| {
            for (body, factor) in TRUTH.into_iter().enumerate() {
                model.body_ipos_mut()[body + 1][2] *= factor;
            }
            model.update_constants()
        })
        .unwrap();
    (data, record(truth, 3000, |_| Vec::new()))
}

fn experiment(start: &Data, log: &Log) -> Experiment {
    let model = start.model();
    ["q1", "q2"].into_iter().fold(Experiment::new("fall", start), |experiment, name| {
        let signal = log.sensor(model, name, 5);
        experiment.with_measurement(Measurement::of_sensor(model, name, signal).unwrap().with_deviation(0.01))
    })
}

fn error(fit: &Fit) -> f64 {
    fit.estimates().iter().zip(TRUTH).map(|(estimate, truth)| (estimate.value - truth).abs()).fold(0.0, f64::max)
}

/// A chaotic motion of six seconds. From its start to its end, the cost has many local minima;
/// with segments, whose first states come from the readings alone, the search finds the truth.
#[test]
fn segments_find_what_a_single_simulation_does_not() {
    let (start, log) = log();
    let single = Identification::new(masses()).unwrap().with_experiment(experiment(&start, &log)).unwrap();
    let single = single.solve(Options::default()).unwrap();
    assert!(error(&single) > 1e-2, "a single simulation is expected to get stuck:\n{single}");

    // Positions from encoders, velocities from their differences.
    let mut states = Matrix::zeros(log.times.len(), 4);
    for row in 0..log.times.len() {
        let (low, high) = (row.saturating_sub(5), (row + 5).min(log.times.len() - 1));
        for joint in 0..2 {
            let rate = (log.states[(high, joint)] - log.states[(low, joint)]) / (log.times[high] - log.times[low]);
            states[(row, joint)] = log.states[(row, joint)];
            states[(row, 2 + joint)] = rate;
        }
    }
    let guess = Signal::new(log.times.clone(), states).unwrap();
    let segmented = experiment(&start, &log).with_segments(0.2, guess);
    let fit = Identification::new(masses()).unwrap().with_experiment(segmented).unwrap();
    let fit = fit.solve(Options::default()).unwrap();
    // The readings are exact, so that the last steps change rounding errors only.
    assert!(matches!(fit.status(), LeastSquaresStatus::Converged | LeastSquaresStatus::Stalled), "{fit}");
    assert!(error(&fit) < 1e-6, "{fit}");
    assert!(fit.gap() < 1e-6, "{}", fit.gap());
    // A simulation with the values has the readings without any segments.
    let [q1, q2] = &fit.validate([experiment(&start, &log)]).unwrap()[..] else { panic!() };
    assert!(q1.rms < 1e-3 && q2.rms < 1e-3, "{} {}", q1.rms, q2.rms);
}

#[test]
fn the_state_at_the_start_is_found() {
    let (start, log) = log();
    // Half a second of the motion, from a state that is wrong by a few hundredths.
    let mut wrong = start.clone();
    wrong.qpos_mut()[0] -= 0.03;
    wrong.qvel_mut()[1] += 0.05;
    let cut = |name: &str| {
        let signal = log.sensor(start.model(), name, 5);
        let rows = 50;
        let values = signal.values().as_slice()[..rows].to_vec();
        Signal::scalar(signal.times()[..rows].to_vec(), values).unwrap()
    };
    let experiment = ["q1", "q2"].into_iter().fold(Experiment::new("fall", &wrong), |experiment, name| {
        experiment.with_measurement(Measurement::of_sensor(start.model(), name, cut(name)).unwrap())
    });
    let solve = |deviation: &[f64]| {
        let experiment = experiment.clone().with_uncertain_start(deviation);
        Identification::new(masses()).unwrap().with_experiment(experiment).unwrap().solve(Options::default()).unwrap()
    };
    let fit = solve(&[f64::INFINITY; 4]);
    assert!(error(&fit) < 1e-5, "{fit}");
    // The truth is not found if the wrong start counts as known.
    assert!(error(&solve(&[0.0; 4])) > 1e-3);
}

#[test]
fn the_result_does_not_depend_on_threads() {
    let (start, log) = log();
    let states = Signal::new(log.times.clone(), log.states.clone()).unwrap();
    let experiment = experiment(&start, &log).with_segments(0.5, states);
    let identification = Identification::new(masses()).unwrap().with_experiment(experiment).unwrap();
    let with_threads = |threads| {
        let pool = mujoco_safe::rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let fit = pool.install(|| identification.solve(Options::default())).unwrap();
        fit.estimates().iter().map(|estimate| estimate.value).collect::<Vec<_>>()
    };
    assert_eq!(with_threads(1), with_threads(3));
}
