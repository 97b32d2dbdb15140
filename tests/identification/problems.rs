//! The truth is found: problems of the tests of `mujoco.sysid`, which come with its package, and
//! others.

use std::f64::consts::TAU;
use std::fmt::Write;

use mujoco_safe::identification::{Experiment, Identification, Measurement, Options, Signal, Unknown};
use mujoco_safe::least_squares::LeastSquaresStatus;
use mujoco_safe::rollout::Parameter;
use mujoco_safe::{Data, Model};

use crate::{Log, SPRING, model, record};

fn push(time: f64) -> Vec<f64> {
    vec![5.0 * (TAU * 1.5 * time).sin() + 3.0 * (TAU * 3.7 * time).sin()]
}

fn spring_log(model: &std::sync::Arc<Model>) -> Log {
    record(Data::new(model).unwrap(), 1500, push)
}

#[test]
fn the_mass_on_a_spring() {
    let model = model(SPRING);
    let start = Data::new(&model).unwrap();
    let experiment = spring_log(&model).experiment(&start);
    let mass = model.body("mass").unwrap().id();
    let factor = Unknown::parameter(&model, Parameter::MassFactor(mass)).unwrap().starting_at(2.0).between(0.3, 3.0);
    let fit = Identification::new(vec![factor]).unwrap().with_experiment(experiment).unwrap();
    let fit = fit.solve(Options::default()).unwrap();
    assert_eq!(fit.status(), LeastSquaresStatus::Converged, "{fit}");
    assert!((fit.estimates()[0].value - 1.0).abs() < 1e-7, "{fit}");
    let changed = fit.model(&model).unwrap();
    assert!((changed.body_mass()[1] - 1.0).abs() < 1e-7);
    assert!(fit.errors().iter().all(|error| error.rms < 1e-9 && error.count == 1500), "{fit}");
}

#[test]
fn the_armatures_of_an_arm() {
    let lengths = [0.5, 0.4, 0.3, 0.2, 0.1];
    let masses = [1.0, 0.8, 0.6, 0.4, 0.2];
    let axes = ["0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0"];
    let (mut bodies, mut ends, mut motors, mut sensors) = (String::new(), String::new(), String::new(), String::new());
    for (i, ((armature, mass), axis)) in lengths.iter().zip(masses).zip(axes).enumerate() {
        write!(
            bodies,
            r#"<body pos="0 0 .1"><inertial pos="0 0 .05" mass="{mass}" diaginertia="{0} {0} {1}"/>
               <joint name="j{i}" axis="{axis}" armature="{armature}" damping="{2}"/>"#,
            0.01 * mass,
            0.005 * mass,
            2.0 * armature
        )
        .unwrap();
        ends += "</body>";
        write!(motors, r#"<motor joint="j{i}"/>"#).unwrap();
        write!(sensors, r#"<jointpos name="q{i}" joint="j{i}"/><jointvel name="v{i}" joint="j{i}"/>"#).unwrap();
    }
    let model = model(&format!(
        r#"<mujoco><compiler angle="radian"/><option timestep="0.002"><flag contact="disable"/></option>
           <worldbody>{bodies}{ends}</worldbody><actuator>{motors}</actuator><sensor>{sensors}</sensor></mujoco>"#
    ));
    let log = record(Data::new(&model).unwrap(), 1000, |time| {
        let rates = [0.5, 0.7, 0.4, 0.9, 0.6];
        (0..5).map(|i| (5 - i) as f64 * (TAU * rates[i] * time + 0.5 * i as f64).sin()).collect()
    });
    let start = Data::new(&model).unwrap();
    let unknowns = (0..5).map(|i| {
        let joint = model.joint(&*format!("j{i}")).unwrap().id();
        Unknown::parameter(&model, Parameter::JointArmature(joint)).unwrap().starting_at(0.01).between(0.001, 1.0)
    });
    let identification = Identification::new(unknowns.collect()).unwrap();
    let fit = identification.with_experiment(log.experiment(&start)).unwrap().solve(Options::default()).unwrap();
    for (estimate, truth) in fit.estimates().iter().zip(lengths) {
        assert!((estimate.value - truth).abs() < 1e-6, "{fit}");
    }
    assert!(fit.undetermined().is_empty());
}

#[test]
fn delay_gain_and_bias_of_a_sensor() {
    let model = model(SPRING);
    let log = spring_log(&model);
    let start = Data::new(&model).unwrap();
    // The clock of the sensor is not that of the simulation, and it reports 13.7 ms late.
    let (gain, bias, delay) = (1.2, -0.03, 0.0137);
    let exact = log.sensor(&model, "position", 1);
    let times: Vec<f64> = (0..400).map(|i| 0.02 + 0.0071 * f64::from(i)).collect();
    let readings = times.iter().map(|time| {
        let mut value = [0.0];
        exact.interpolate_into(time - delay, &mut value);
        gain * value[0] + bias
    });
    let signal = Signal::scalar(times.clone(), readings.collect()).unwrap();
    let experiment = Experiment::new("log", &start)
        .with_controls(log.controls())
        .with_measurement(Measurement::of_sensor(&model, "position", signal).unwrap());
    let unknowns = vec![
        Unknown::delay("position").between(0.0, 0.02),
        Unknown::gain("position"),
        Unknown::bias("position"),
        Unknown::edit("damping", 3.0, |value, model| {
            model.dof_damping_mut().fill(value);
            Ok(())
        })
        .logarithmic(),
    ];
    let identification = Identification::new(unknowns).unwrap().with_experiment(experiment).unwrap();
    let fit = identification.solve(Options::default()).unwrap();
    let found: Vec<f64> = fit.estimates().iter().map(|estimate| estimate.value).collect();
    for (found, truth) in found.iter().zip([delay, gain, bias, 5.0]) {
        assert!((found - truth).abs() < 1e-6 * truth.abs(), "{fit}");
    }
}

/// A mass and the gear of its motor: only their ratio shows, unless a known load is added.
#[test]
fn what_the_data_do_not_determine() {
    let model = model(&SPRING.replace(r#"stiffness="100" damping="5""#, ""));
    let truth = |load: f64| {
        let mut data = Data::new(&model).unwrap();
        data.edit_model(|model| {
            model.body_mut(1).unwrap().scale_mass(2.0).unwrap();
            model.actuator_gear_mut()[0][0] = 3.0;
            model.body_mass_mut()[1] += load;
            model.update_constants()
        })
        .unwrap();
        record(data, 800, push)
    };
    let alone = truth(0.0).experiment(&Data::new(&model).unwrap());
    let body = model.body("mass").unwrap().id();
    let motor = model.actuator("push").unwrap().id();
    let mass = Unknown::edit("mass", 1.4, move |value, model| {
        // The experiment's model may have a load.
        let load = model.body_mass()[body.index()] - 1.0;
        model.body_mass_mut()[body.index()] = value + load;
        model.update_constants()
    });
    let gear = Unknown::parameter(&model, Parameter::ActuatorGear(motor)).unwrap().starting_at(1.9);
    let identification = Identification::new(vec![mass.between(0.1, 10.0), gear.between(0.1, 10.0)]).unwrap();

    let identification = identification.with_experiment(alone).unwrap();
    let fit = identification.solve(Options::default()).unwrap();
    let [combination] = fit.undetermined() else { panic!("{fit}") };
    let value = |name: &str| fit.value(name).unwrap();
    let gear = "actuator_gear[0] of actuator 'push'";
    let ratio = value(gear) / value("mass");
    assert!((ratio - 1.5).abs() < 1e-5, "{fit}");
    // Both change together by the ratio.
    let factor = |name: &str| combination.terms.iter().find(|term| term.0 == name).unwrap().1;
    assert!((factor(gear) / factor("mass") - 1.5).abs() < 1e-3, "{fit}");
    assert!(fit.estimates().iter().all(|estimate| estimate.deviation.is_infinite()));

    let mut loaded = Data::new(&model).unwrap();
    loaded
        .edit_model(|model| {
            model.body_mass_mut()[1] += 1.0;
            model.update_constants()
        })
        .unwrap();
    let loaded = truth(1.0).experiment(&loaded);
    let fit = identification.with_experiment(loaded).unwrap().solve(Options::default()).unwrap();
    assert!(fit.undetermined().is_empty(), "{fit}");
    let value = |name: &str| fit.value(name).unwrap();
    assert!((value("mass") - 2.0).abs() < 1e-5 && (value(gear) - 3.0).abs() < 1e-5, "{fit}");
}

/// A spinning plate with an orientation sensor, whose readings have random signs.
#[test]
fn the_sign_of_a_quaternion_does_not_matter() {
    let model = model(
        r#"<mujoco><option gravity="0 0 0"/>
           <worldbody><body name="plate"><joint name="ball" type="ball" damping=".02"/>
             <geom type="box" size=".3 .2 .05"/></body></worldbody>
           <sensor><ballquat name="orientation" joint="ball"/></sensor></mujoco>"#,
    );
    let mut start = Data::new(&model).unwrap();
    start.qvel_mut().copy_from_slice(&[3.0, 5.0, 1.0]);
    let log = record(start.clone(), 1000, |_| Vec::new());
    let exact = log.sensor(&model, "orientation", 10);
    let mut values = exact.values().clone();
    for row in (0..values.nrows()).step_by(3) {
        values.row_mut(row).iter_mut().for_each(|value| *value = -*value);
    }
    let signal = Signal::new(exact.times().to_vec(), values).unwrap();
    let experiment = Experiment::new("spin", &start)
        .with_measurement(Measurement::of_sensor(&model, "orientation", signal).unwrap());
    let joint = model.joint("ball").unwrap().id();
    let damping = Unknown::parameter(&model, Parameter::JointDamping(joint)).unwrap().starting_at(0.1);
    let fit = Identification::new(vec![damping]).unwrap().with_experiment(experiment).unwrap();
    let fit = fit.solve(Options::default()).unwrap();
    assert!((fit.estimates()[0].value - 0.02).abs() < 1e-7, "{fit}");
    assert!(fit.errors()[0].rms < 1e-7, "{fit}");
}
