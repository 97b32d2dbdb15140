//! The truth is found for an arm, a quadruped and a humanoid, from what such robots measure.

use std::sync::Arc;

use mujoco_safe::derivative::InertialParameters;
use mujoco_safe::enums::SensorType;
use mujoco_safe::identification::{Experiment, Fit, Identification, Measurement, Options, Signal, Unknown};
use mujoco_safe::rollout::{Parameter, Random};
use mujoco_safe::spec::Spec;
use mujoco_safe::{Data, Matrix, Model, sample};

use crate::{Log, record};

/// Writes true values to a model: the parameters of unknowns.
fn truth(start: &Data, values: &[(Parameter, f64)]) -> Data {
    // A search without steps writes values as the search does.
    let mut data = start.clone();
    let unknowns = values.iter().map(|&(parameter, value)| {
        Unknown::parameter(start.model(), parameter).unwrap().starting_at(value).between(value, value)
    });
    let experiment = Experiment::new("none", start).with_measurement(Measurement::of(
        "none",
        Signal::scalar(vec![start.time()], vec![0.0]).unwrap(),
        |_, _| Ok(()),
    ));
    let identification = Identification::new(unknowns.collect()).unwrap().with_experiment(experiment).unwrap();
    let model = Arc::new(identification.solve(Options::default()).unwrap().model(start.model().clone()).unwrap());
    data.adopt(&model).unwrap();
    data
}

/// Searches from the nominal values.
fn search(start: &Data, values: &[(Parameter, f64)], experiment: Experiment) -> Fit {
    let unknowns = values.iter().map(|&(parameter, _)| {
        let unknown = Unknown::parameter(start.model(), parameter).unwrap();
        unknown.logarithmic()
    });
    let identification = Identification::new(unknowns.collect()).unwrap().with_experiment(experiment).unwrap();
    identification.solve(Options::default()).unwrap()
}

#[track_caller]
fn check(fit: &Fit, values: &[(Parameter, f64)], tolerance: f64) {
    assert!(fit.undetermined().is_empty(), "{fit}");
    for (estimate, (_, truth)) in fit.estimates().iter().zip(values) {
        assert!((estimate.value / truth - 1.0).abs() < tolerance, "{fit}");
        // Noise of a known size is in the readings.
        let half = 0.5 * (estimate.interval[1] - estimate.interval[0]);
        assert!((estimate.value - truth).abs() < 2.5 * half, "{fit}");
    }
}

/// Standard deviation of the readings' noise, m and rad.
const NOISE: f64 = 1e-4;

/// Returns a measurement of all positions, by encoders with noise.
fn encoders(log: &Log, nq: usize) -> Measurement {
    let mut noise = Random::new(7, 0, 0);
    let values = log.states.rows().flat_map(|row| row[..nq].to_vec()).map(|it| it + NOISE * noise.normal());
    let values = Matrix::from_row_major(log.times.len(), nq, values.collect());
    Measurement::of("encoders", Signal::new(log.times.clone(), values).unwrap(), |data, output| {
        output.copy_from_slice(data.qpos());
        Ok(())
    })
    .with_deviation(NOISE)
}

/// The hand's mass, damping and a motor's gear of an arm, from its encoders, in segments.
#[test]
fn arm() {
    let model = Arc::new(Model::from_xml_path("models/arm.xml").unwrap());
    let mut start = Data::new(&model).unwrap();
    // It hangs down, away from the limits of its joints.
    start.joint_mut("pitch").unwrap().qpos_mut()[0] = 1.3;
    let body = |name: &str| model.body(name).unwrap().id();
    let values = [
        (Parameter::MassFactor(body("wrist")), 1.8),
        (Parameter::MassFactor(body("forearm")), 0.8),
        (Parameter::JointDamping(model.joint("pitch").unwrap().id()), 0.9),
        (Parameter::JointArmature(model.joint("yaw").unwrap().id()), 0.04),
        (Parameter::ActuatorGear(model.actuator(1).unwrap().id()), 1.2 * model.actuator_gear()[1][0]),
    ];
    let nu = model.nu();
    let log = record(truth(&start, &values), 400, |time| {
        (0..nu).map(|i| [0.15, 0.15, 0.1, 0.05, 0.05, 0.05][i] * ((2.0 + i as f64) * time + i as f64).sin()).collect()
    });
    walk(&start, &log, vec![encoders(&log, model.nq())], &values, 2e-2);
}

/// The mass of the trunk, gears and damping of a quadruped that sways,
/// from encoders and the pose of its trunk, in segments.
#[test]
fn quadruped() {
    let model = Arc::new(Model::from_xml_path("tests/models/gymnasium/quadruped.xml").unwrap());
    let mut start = Data::new(&model).unwrap();
    let nu = model.nu();
    let control = move |time: f64| (0..nu).map(|i| 0.15 * (6.0 * time + i as f64).sin()).collect::<Vec<_>>();
    // It stands before the log begins.
    for _ in 0..100 {
        start.step().unwrap();
    }
    let gear = |index: usize| Parameter::ActuatorGear(model.actuator(index).unwrap().id());
    let damping = model.joint("front_left_knee").unwrap().id();
    let values = [
        (Parameter::MassFactor(model.body("torso").unwrap().id()), 1.3),
        (gear(0), 30.0),
        (gear(3), 20.0),
        (Parameter::JointDamping(damping), 1.2),
    ];
    let log = record(truth(&start, &values), 60, control);
    walk(&start, &log, vec![encoders(&log, model.nq())], &values, 2e-2);
}

/// Masses and a gear of a humanoid that moves on one leg, from sensors of its joints and the pose
/// of its torso, in segments: with derivatives in closed form.
#[test]
fn humanoid() {
    let bare = sample::humanoid();
    let hinges = bare.joints().skip(1).map(|joint| joint.name().unwrap().to_owned());
    let sensors: Vec<String> = hinges.map(|name| format!(r#"<jointpos joint="{name}"/>"#)).collect();
    let model = Arc::new(
        Model::from_xml_str(&sample::HUMANOID_XML.replace(
            "</mujoco>",
            &format!(
                r#"<sensor><framepos objtype="xbody" objname="torso"/>
                   <framequat objtype="xbody" objname="torso"/>{}</sensor></mujoco>"#,
                sensors.concat()
            ),
        ))
        .unwrap(),
    );
    let mut start = Data::new(&model).unwrap();
    start.reset_to_key("stand_on_left_leg").unwrap();
    let body = |name: &str| model.body(name).unwrap().id();
    let names: Vec<&str> = model.bodies().filter_map(|body| body.name()).collect();
    let thigh = names.iter().find(|name| name.contains("thigh")).expect("a thigh");
    let values = [
        (Parameter::MassFactor(body("torso")), 1.2),
        (Parameter::MassFactor(body(thigh)), 0.8),
        (Parameter::ActuatorGear(model.actuator(3).unwrap().id()), 1.3 * model.actuator_gear()[3][0]),
    ];
    let nu = model.nu();
    let log = record(truth(&start, &values), 60, |time| {
        (0..nu).map(|i| 0.3 * ((8.0 + i as f64) * time + i as f64).sin()).collect()
    });
    let mut noise = Random::new(3, 0, 0);
    // Without those of accelerations and rates.
    let measurements = model.sensors().skip(bare.nsensor()).map(|sensor| {
        let range = sensor.data_range();
        let values =
            log.readings.rows().flat_map(|row| row[range.clone()].to_vec()).map(|it| it + NOISE * noise.normal());
        let values = Matrix::from_row_major(log.times.len(), range.len(), values.collect());
        let signal = Signal::new(log.times.clone(), values).unwrap();
        Measurement::of_sensor(&model, sensor.id(), signal).unwrap().with_deviation(NOISE)
    });
    walk(&start, &log, measurements.collect(), &values, 5e-2);
}

/// Searches in segments of a tenth of a second, whose first states come from the log's positions
/// and their differences.
fn walk(start: &Data, log: &Log, measurements: Vec<Measurement>, values: &[(Parameter, f64)], tolerance: f64) {
    let model = start.model();
    let (nq, nv) = (model.nq(), model.nv());
    let mut states = Matrix::zeros(log.times.len(), nq + nv);
    let mut velocity = vec![0.0; nv];
    for row in 0..log.times.len() {
        let (low, high) = (row.saturating_sub(1), (row + 1).min(log.times.len() - 1));
        let [from, to] = [low, high].map(|row| &log.states.row(row)[..nq]);
        model.differentiate_pos_into(log.times[high] - log.times[low], from, to, &mut velocity).unwrap();
        states.row_mut(row)[..nq].copy_from_slice(&log.states.row(row)[..nq]);
        states.row_mut(row)[nq..].copy_from_slice(&velocity);
    }
    let experiment = measurements
        .into_iter()
        .fold(Experiment::new("walk", start), Experiment::with_measurement)
        .with_controls(log.controls())
        .with_segments(0.1, Signal::new(log.times.clone(), states).unwrap());
    check(&search(start, values, experiment), values, tolerance);
}

/// The whole inertia of a load at the hand of an arm, from the sensors of its joints: ten numbers,
/// each of which is a possible one in every step of the search.
#[test]
fn load() {
    let mut spec = Spec::from_xml_path("models/arm.xml").unwrap();
    let wrist = spec.body("wrist").unwrap().id();
    let mut load = spec.add_body(wrist);
    load.set_name("load").set_pos([0.15, 0.0, 0.0]);
    load.set_inertial(0.2, [0.0; 3], [1e-4; 3]);
    for joint in ["yaw", "pitch", "elbow", "wrist_roll", "wrist_pitch", "wrist_yaw"] {
        spec.add_sensor(SensorType::JointPosition).unwrap().set("joint", joint).unwrap();
        spec.add_sensor(SensorType::JointVelocity).unwrap().set("joint", joint).unwrap();
    }
    let model = Arc::new(spec.compile().unwrap());
    let mut start = Data::new(&model).unwrap();
    start.joint_mut("pitch").unwrap().qpos_mut()[0] = 1.3;
    let body = model.body("load").unwrap().id();
    let mut real = start.clone();
    real.edit_model(|model| {
        let index = body.index();
        model.body_mass_mut()[index] = 0.5;
        model.body_ipos_mut()[index] = [0.03, 0.02, -0.01];
        model.body_inertia_mut()[index] = [8e-4, 5e-4, 6e-4];
        model.update_constants()
    })
    .unwrap();
    let truth = InertialParameters::of(real.model(), body);
    let nu = model.nu();
    let log = record(real, 400, |time| {
        (0..nu).map(|i| [0.15, 0.15, 0.1, 0.05, 0.05, 0.05][i] * ((2.0 + i as f64) * time + i as f64).sin()).collect()
    });
    let identification = Identification::new(Unknown::all_inertia(&model, body).unwrap()).unwrap();
    let fit = identification.with_experiment(log.experiment(&start)).unwrap().solve(Options::default()).unwrap();
    let found = InertialParameters::of(&fit.model(&model).unwrap(), body);
    let largest = truth.0.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    for (found, truth) in found.0.iter().zip(truth.0) {
        assert!((found - truth).abs() < 1e-5 * largest, "{found} instead of {truth}\n{fit}");
    }
    assert!(fit.undetermined().is_empty(), "{fit}");
}

/// An extent of a body on which the readings hardly depend could become zero in a long step.
#[test]
fn load_with_armatures_and_dampings_from_a_rough_guess() {
    let model = crate::model(
        r#"<mujoco><option timestep=".002" integrator="implicit"><flag contact="disable"/></option><worldbody>
          <body><inertial pos="0 0 .05" mass="1" diaginertia=".01 .01 .005"/>
            <joint name="a" axis="0 0 1" armature=".3" damping=".6"/>
            <body name="middle" pos="0 0 .1"><inertial pos="0 0 .05" mass=".6" diaginertia=".006 .006 .003"/>
              <joint name="b" axis="0 1 0" armature=".2" damping=".4"/>
              <body name="load" pos="0 0 .1"><inertial pos="0 0 .05" mass=".2" diaginertia=".002 .002 .001"/>
                <joint name="c" axis="1 0 0" armature=".1" damping=".2"/></body></body></body></worldbody>
          <actuator><motor joint="a"/><motor joint="b"/><motor joint="c"/></actuator>
          <sensor><jointpos joint="a"/><jointpos joint="b"/><jointpos joint="c"/><jointvel joint="a"/>
            <jointvel joint="b"/><jointvel joint="c"/></sensor></mujoco>"#,
    );
    let start = Data::new(&model).unwrap();
    let body = model.body("load").unwrap().id();
    let mut real = start.clone();
    real.edit_model(|model| {
        model.body_mut(body).scale_mass(1.8)?;
        model.body_ipos_mut()[body.index()] = [0.01, 0.02, 0.06];
        model.update_constants()
    })
    .unwrap();
    let log = record(real, 1000, |time| {
        (0..3).map(|i| [4.0, 3.0, 2.0][i] * ([3.0, 4.4, 5.7][i] * time + 0.5 * i as f64).sin()).collect()
    });
    let mut unknowns = Unknown::all_inertia(&model, body).unwrap();
    for joint in model.joints().map(|joint| joint.id()) {
        for parameter in [Parameter::JointArmature(joint), Parameter::JointDamping(joint)] {
            unknowns.push(Unknown::parameter(&model, parameter).unwrap().starting_at(0.25).between(0.001, 2.0));
        }
    }
    let identification = Identification::new(unknowns).unwrap().with_experiment(log.experiment(&start)).unwrap();
    let fit = identification.solve(Options::default()).unwrap();
    let values = [0.3, 0.6, 0.2, 0.4, 0.1, 0.2];
    for (found, truth) in fit.estimates()[10..].iter().zip(values) {
        assert!((found.value - truth).abs() < 1e-6, "{fit}");
    }
}
