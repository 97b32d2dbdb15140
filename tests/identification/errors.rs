//! Wrong inputs.

use mujoco_safe::identification::{Experiment, Identification, Measurement, Options, Signal, Unknown};
use mujoco_safe::least_squares::LeastSquaresStatus;
use mujoco_safe::rollout::{Parameter, Random};
use mujoco_safe::{Data, Error, Matrix, Model, sample};

use crate::cases::cases;
use crate::{SPRING, model};

fn data() -> Data {
    Data::new(model(SPRING)).unwrap()
}

fn signal() -> Signal {
    Signal::scalar(vec![0.0, 0.1], vec![0.0, 0.0]).unwrap()
}

fn measurement(model: &Model) -> Measurement {
    Measurement::of_sensor(model, "position", signal()).unwrap()
}

fn damping(model: &Model) -> Unknown {
    Unknown::parameter(model, Parameter::JointDamping(model.joint("slide").unwrap().id())).unwrap()
}

#[track_caller]
fn fails<T>(result: Result<T, Error>, text: &str) {
    let error = result.err().expect("an error").to_string();
    assert!(error.contains(text), "{error}");
}

#[test]
fn signals() {
    fails(Signal::scalar(vec![], vec![]), "without samples");
    fails(Signal::scalar(vec![0.0], vec![0.0, 1.0]), "rows of a signal");
    fails(Signal::scalar(vec![0.0, 0.0], vec![0.0, 1.0]), "time 1 of a signal is 0");
    fails(Signal::scalar(vec![f64::NAN], vec![0.0]), "time 0 of a signal is NaN");
    fails(Signal::load_csv("no such file", "t", &[]), "no such file");
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(&file, "t, a ,b\n0,1,2\n0.5,,nan\n\n1,3,4\n").unwrap();
    let signal = Signal::load_csv(&file, "t", &["b", "a"]).unwrap();
    assert_eq!((signal.times(), signal.values().row(2)), (&[0.0, 0.5, 1.0][..], &[4.0, 3.0][..]));
    assert!(signal.values().row(1).iter().all(|value| value.is_nan()));
    fails(Signal::load_csv(&file, "time", &[]), r#"no column is called "time"; the file has t, a, b"#);
    std::fs::write(&file, "t,a\n0,1\n1,x\n").unwrap();
    fails(Signal::load_csv(&file, "t", &["a"]), r#"line 3: "x" is not a number"#);
    std::fs::write(&file, "t,a\n0\n").unwrap();
    fails(Signal::load_csv(&file, "t", &["a"]), "line 2: 1 cells instead of 2");
    assert!(signal.held(-1.0) == signal.values().row(0) && signal.held(9.0) == signal.values().row(2));
}

#[test]
fn unknowns() {
    let data = data();
    let one = || damping(data.model());
    for (unknown, text) in [
        (one().starting_at(f64::NAN), "the first value of dof_damping of joint 'slide' is NaN"),
        (one().starting_at(-1.0), "is -1"),
        (one().between(2.0, 1.0), "the lower bound"),
        (one().between(f64::NAN, 1.0), "the lower bound"),
        (one().with_prior(f64::INFINITY, 1.0), "the mean"),
        (one().with_prior(1.0, 0.0), "the standard deviation"),
        (one().with_scale(-1.0), "the scale"),
        (one().starting_at(0.0).logarithmic(), "positive, for its logarithm"),
        (Unknown::delay("position").between(0.0, f64::INFINITY), "a bound of the delay of position"),
    ] {
        fails(Identification::new(vec![unknown]), text);
    }
    fails(Identification::new(vec![one(), one()]), "two of dof_damping");
}

#[test]
fn experiments() {
    let data = data();
    let model = data.model();
    let with = |experiment| Identification::new(vec![damping(model)]).unwrap().with_experiment(experiment);
    let experiment = || Experiment::new("log", &data).with_measurement(measurement(model));
    fails(with(Experiment::new("log", &data)), "without measurements");
    fails(with(experiment().with_measurement(measurement(model))), "two of position");
    let controls = |values| Signal::new(vec![0.0], values).unwrap();
    fails(with(experiment().with_controls(controls(Matrix::zeros(1, 2)))), "controls of an experiment");
    fails(with(experiment().with_controls(controls(Matrix::from_rows(&[[f64::NAN]])))), "a control of log");
    fails(with(experiment().with_uncertain_start(&[0.1])), "uncertainty of a start");
    fails(with(experiment().with_uncertain_start(&[0.1, -1.0])), "a standard deviation of the start");
    fails(with(experiment().with_segments(0.0, controls(Matrix::zeros(1, 2)))), "the duration of the segments");
    fails(with(experiment().with_segments(0.1, controls(Matrix::zeros(1, 3)))), "states of segments");
    let bad = measurement(model).with_deviation(0.0);
    fails(with(Experiment::new("log", &data).with_measurement(bad)), "the standard deviation of position");
    let late = measurement(model).with_delay(5.0);
    let late = with(Experiment::new("log", &data).with_measurement(late)).unwrap();
    fails(late.solve(Options::default()), "the last reading of position in log is at 0.1 s");
    fails(Measurement::of_sensor(model, "angle", signal()), "angle");
    let wide = Signal::new(vec![0.0], Matrix::zeros(1, 3)).unwrap();
    fails(Measurement::of_sensor(model, "position", wide), "readings of a sensor");

    let other = Data::new(sample::cartpole()).unwrap();
    let foreign = Experiment::new("other", &other).with_measurement(Measurement::of("any", signal(), |_, _| Ok(())));
    fails(with(experiment()).unwrap().with_experiment(foreign), "another model");
    fails(Identification::new(vec![]).unwrap().solve(Options::default()), "number of experiments");
    let unknown = Identification::new(vec![Unknown::gain("angle")]).unwrap().with_experiment(experiment()).unwrap();
    fails(unknown.solve(Options::default()), "gain of angle is angle");
}

/// A closure's error is returned, and a simulation that is unstable from the start ends the search.
#[test]
fn simulations_that_fail() {
    let data = data();
    let run = |unknown: Unknown| {
        let experiment = Experiment::new("log", &data).with_measurement(measurement(data.model()));
        Identification::new(vec![unknown]).unwrap().with_experiment(experiment).unwrap().solve(Options::default())
    };
    let refused = Unknown::edit("mine", 1.0, |_, _| Err(Error::Unsupported("not today".into())));
    fails(run(refused), "not today");
    let explosive = Unknown::edit("stiffness", -1e12, |value, model| {
        model.jnt_stiffness_mut()[0] = value;
        model.qpos_spring_mut()[0] = 1.0;
        Ok(())
    });
    let fit = run(explosive).unwrap();
    assert_eq!(fit.status(), LeastSquaresStatus::NotFinite, "{fit}");
    assert_eq!(fit.errors()[0].count, 0);
    // Nothing to find is no error.
    let idle = run(Unknown::edit("idle", 1.0, |_, _| Ok(()))).unwrap();
    assert_eq!(idle.undetermined().len(), 1, "{idle}");
    assert!(idle.estimates()[0].deviation.is_infinite());
}

/// Numbers of any kind lead to errors or statuses, never to a panic or an endless search.
#[test]
fn hostile_numbers() {
    let extreme = [0.0, -0.0, 1.0, -1.0, 1e-310, 1e-9, 1e9, 1e160, -1e300, f64::MAX, f64::INFINITY, f64::NAN];
    let mut noise = Random::new(11, 0, 0);
    let mut pick = |usual: f64| match noise.uniform(-1.0, 1.0) {
        odd if odd > 0.75 => extreme[((odd - 0.75) * 47.9) as usize],
        _ => usual,
    };
    let (mut solved, mut refused) = (0, 0);
    for case in 0..cases(200, 1000) {
        let mut start = data();
        start.qpos_mut()[0] = pick(0.1);
        start.qvel_mut()[0] = pick(0.0);
        start.set_time(pick(0.0));
        let mut run = || -> Result<_, Error> {
            let model = start.model().clone();
            let times = (0..6).map(|i| pick(0.02 * f64::from(i))).collect();
            let signal = Signal::scalar(times, (0..6).map(|_| pick(0.05)).collect())?;
            let controls = Signal::scalar(vec![pick(0.0), pick(0.05)], vec![pick(1.0), pick(-1.0)])?;
            let measurement =
                Measurement::of_sensor(&model, "position", signal)?.with_deviation(pick(0.01)).with_delay(pick(0.0));
            let mut experiment = Experiment::new("log", &start).with_controls(controls).with_measurement(measurement);
            if case % 2 == 0 {
                experiment = experiment.with_uncertain_start(&[pick(0.1), pick(0.0)]);
            }
            if case % 3 == 0 {
                let states = Matrix::from_rows(&[[pick(0.1), pick(0.0)], [pick(0.1), pick(0.0)]]);
                experiment = experiment.with_segments(pick(0.04), Signal::new(vec![0.0, 0.1], states)?);
            }
            let mut unknowns = vec![damping(&model).starting_at(pick(5.0)).between(pick(0.0), pick(10.0))];
            unknowns.push(Unknown::delay("position").between(pick(0.0), pick(0.01)).with_scale(pick(1e-3)));
            unknowns.push(Unknown::gain("position").with_prior(pick(1.0), pick(0.1)).starting_at(pick(1.0)));
            if case % 5 == 0 {
                unknowns.push(Unknown::bias("position").starting_at(pick(1.0)).logarithmic());
            }
            Identification::new(unknowns)?.with_experiment(experiment)?.solve(Options::default())
        };
        match run() {
            Ok(fit) => {
                assert!(!fit.to_string().is_empty());
                solved += 1;
            }
            Err(_) => refused += 1,
        }
    }
    assert!(solved > 5 && refused > 5, "{solved} solved, {refused} refused");
}
