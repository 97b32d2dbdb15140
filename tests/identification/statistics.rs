//! Confidence intervals, priors, outliers and held-out experiments.

use mujoco_safe::control::residual::Norm;
use mujoco_safe::identification::{Experiment, Fit, Identification, Measurement, Options, Signal, Unknown};
use mujoco_safe::rollout::{Parameter, Random};
use mujoco_safe::{Data, Matrix};

use crate::{Log, SPRING, add_noise, model, record};

fn swing() -> (Data, Log) {
    let mut data = Data::new(model(SPRING)).unwrap();
    data.qpos_mut()[0] = 0.1;
    (data.clone(), record(data, 600, |_| vec![0.0]))
}

fn unknowns(data: &Data) -> Vec<Unknown> {
    let joint = data.model().joint("slide").unwrap().id();
    [Parameter::JointDamping(joint), Parameter::JointStiffness(joint)]
        .map(|parameter| Unknown::parameter(data.model(), parameter).unwrap())
        .into()
}

fn fit(data: &Data, unknowns: Vec<Unknown>, measurement: Measurement) -> Fit {
    let experiment = Experiment::new("swing", data).with_measurement(measurement);
    Identification::new(unknowns).unwrap().with_experiment(experiment).unwrap().solve(Options::default()).unwrap()
}

/// With 100 samples of the noise, an interval of 95 % contains the truth in all but a few.
#[test]
fn intervals_contain_the_truth() {
    let (data, log) = swing();
    let exact = log.sensor(data.model(), "position", 10);
    let (mut inside, mut noise) = ([0; 2], Random::new(1, 0, 0));
    for _ in 0..100 {
        let signal = add_noise(&exact, 0.002, &mut noise);
        let measurement = Measurement::of_sensor(data.model(), "position", signal).unwrap().with_deviation(0.002);
        let fit = fit(&data, unknowns(&data), measurement);
        assert!((0.7..1.3).contains(&fit.noise()), "{}", fit.noise());
        for (inside, (estimate, truth)) in inside.iter_mut().zip(fit.estimates().iter().zip([5.0, 100.0])) {
            *inside += u32::from((estimate.interval[0]..=estimate.interval[1]).contains(&truth));
        }
    }
    // Fewer than 87 have a probability below 0.2 %.
    assert!(inside.iter().all(|count| (87..=100).contains(count)), "{inside:?}");
}

#[test]
fn a_prior_holds_what_the_data_do_not_say() {
    let (data, log) = swing();
    let mut signal = log.sensor(data.model(), "position", 10);
    // Two readings.
    signal = Signal::scalar(signal.times()[..2].to_vec(), signal.values().as_slice()[..2].to_vec()).unwrap();
    let measurement = Measurement::of_sensor(data.model(), "position", signal).unwrap().with_deviation(0.01);
    let priors = unknowns(&data).into_iter().zip([(4.0, 0.5), (90.0, 5.0)]);
    let priors: Vec<Unknown> = priors.map(|(unknown, (mean, deviation))| unknown.with_prior(mean, deviation)).collect();
    let fit = fit(&data, priors, measurement);
    assert!((fit.estimates()[0].value - 4.0).abs() < 0.1 && (fit.estimates()[1].value - 90.0).abs() < 1.0, "{fit}");
}

#[test]
fn a_norm_ignores_outliers() {
    let (data, log) = swing();
    let mut values = log.sensor(data.model(), "position", 10).values().clone();
    let times = log.sensor(data.model(), "position", 10).times().to_vec();
    for row in (3..values.nrows()).step_by(7) {
        values[(row, 0)] += 0.1;
    }
    let signal = Signal::new(times, values).unwrap();
    let measurement = Measurement::of_sensor(data.model(), "position", signal).unwrap().with_deviation(1e-3);
    let plain = fit(&data, unknowns(&data), measurement.clone());
    let robust = fit(&data, unknowns(&data), measurement.with_norm(Norm::SmoothAbs { width: 0.1 }));
    let error = |fit: &Fit| (fit.estimates()[1].value - 100.0).abs();
    assert!(error(&robust) < 0.1 && error(&plain) > 1.0, "{robust}{plain}");
}

#[test]
fn missing_readings_are_left_out() {
    let (data, log) = swing();
    let exact = log.sensor(data.model(), "position", 10);
    let mut values = exact.values().clone();
    (0..values.nrows()).step_by(2).for_each(|row| values[(row, 0)] = f64::NAN);
    let signal = Signal::new(exact.times().to_vec(), values).unwrap();
    let measurement = Measurement::of_sensor(data.model(), "position", signal).unwrap();
    let fit = fit(&data, unknowns(&data).into_iter().map(|unknown| unknown.starting_at(20.0)).collect(), measurement);
    assert_eq!(fit.errors()[0].count, 30);
    assert!((fit.estimates()[0].value - 5.0).abs() < 1e-5, "{fit}");
}

#[test]
fn held_out_experiments_are_simulated() {
    let (data, log) = swing();
    let measurement =
        Measurement::of_sensor(data.model(), "position", log.sensor(data.model(), "position", 10)).unwrap();
    let fit = fit(&data, unknowns(&data).into_iter().map(|unknown| unknown.starting_at(30.0)).collect(), measurement);
    // Another motion, with a constant error of 1 mm of its sensor.
    let mut other = data.clone();
    other.qpos_mut()[0] = -0.2;
    let log = record(other.clone(), 300, |_| vec![0.0]);
    let mut signal = log.sensor(other.model(), "position", 10);
    let shifted = Matrix::from_row_major(30, 1, signal.values().as_slice().iter().map(|value| value + 1e-3).collect());
    signal = Signal::new(signal.times().to_vec(), shifted).unwrap();
    let measurement = Measurement::of_sensor(other.model(), "position", signal.clone()).unwrap();
    let errors = fit.validate([Experiment::new("other", &other).with_measurement(measurement)]).unwrap();
    assert_eq!((&*errors[0].experiment, &*errors[0].measurement, errors[0].count), ("other", "position", 30));
    assert!((errors[0].rms - 1e-3).abs() < 1e-6, "{}", errors[0].rms);
    assert_eq!(errors[0].simulated.times(), signal.times());
}

/// Readings that depend on the parameters themselves, not only by the state: an accelerometer and
/// the force of a motor. The sensors have formulas; closures that read the same numbers are
/// differenced.
#[test]
fn formulas_and_differences_give_the_same_information() {
    let bodies: String = (0..4)
        .map(|i| {
            format!(
                r#"<body name="b{i}" pos=".2 0 0"><joint name="j{i}" axis="0 1 0" damping=".2" armature=".01"/>
           <geom type="capsule" fromto="0 0 0 .2 0 0" size=".02" mass=".3"/>"#
            )
        })
        .collect::<Vec<_>>()
        .concat();
    let model = model(&format!(
        r#"<mujoco><worldbody>{bodies}<site name="imu" pos=".2 0 0"/>{}</worldbody>
           <actuator><position name="servo" joint="j0" kp="3"/></actuator>
           <sensor><accelerometer name="acceleration" site="imu"/><actuatorfrc name="force" actuator="servo"/></sensor>
           </mujoco>"#,
        "</body>".repeat(4)
    ));
    let start = Data::new(&model).unwrap();
    let log = record(start.clone(), 60, |time| vec![(9.0 * time).sin()]);
    let mut noise = Random::new(5, 0, 0);
    let mut unknowns = Vec::new();
    for name in ["b0", "b1", "b2", "b3"] {
        let body = model.body(name).unwrap().id();
        unknowns.push(Unknown::parameter(&model, Parameter::MassFactor(body)).unwrap());
    }
    for name in ["j0", "j1", "j2", "j3"] {
        let joint = model.joint(name).unwrap().id();
        unknowns.push(Unknown::parameter(&model, Parameter::JointDamping(joint)).unwrap());
    }
    let actuator = model.actuator("servo").unwrap().id();
    unknowns.push(Unknown::parameter(&model, Parameter::ActuatorGain(actuator, 0)).unwrap());
    let signals =
        ["acceleration", "force"].map(|name| (name, add_noise(&log.sensor(&model, name, 1), 1e-3, &mut noise)));
    let solve = |has_formulas: bool| {
        let measurements = signals.clone().map(|(name, signal)| {
            let range = model.sensor(name).unwrap().data_range();
            if has_formulas {
                return Measurement::of_sensor(&model, name, signal).unwrap();
            }
            Measurement::of(name, signal, move |data, output| {
                output.copy_from_slice(&data.sensordata()[range.clone()]);
                Ok(())
            })
        });
        let experiment = Experiment::new("log", &start).with_controls(log.controls());
        let experiment = measurements
            .into_iter()
            .fold(experiment, |experiment, measurement| experiment.with_measurement(measurement.with_deviation(1e-3)));
        let identification = Identification::new(unknowns.clone()).unwrap().with_experiment(experiment).unwrap();
        identification.solve(Options::default()).unwrap()
    };
    let [formulas, differences] = [true, false].map(solve);
    for (one, other) in formulas.estimates().iter().zip(differences.estimates()) {
        assert!((one.deviation / other.deviation - 1.0).abs() < 1e-4, "{formulas}{differences}");
        assert!((one.value - other.value).abs() < 1e-2 * other.deviation, "{formulas}{differences}");
    }
}
