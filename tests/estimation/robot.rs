//! The pose of a floating base from an inertial measurement unit and joint encoders, with feet in
//! contact.

use mujoco_safe::Data;
use mujoco_safe::estimation::{ExtendedKalmanFilter, Measurement, ProcessNoise};

use crate::consistency::Squares;
use crate::{Random, diagonal, quadruped};

/// Returns a filter with the sensors of the robot: deviations in rad/s, m/s² and rad.
fn filter(data: &Data, start: &[f64], noise: ProcessNoise) -> ExtendedKalmanFilter {
    let measurement = Measurement::new(data.model()).with_sensor("gyro", 0.02).unwrap();
    let mut measurement = measurement.with_sensor("accelerometer", 0.2).unwrap();
    for sensor in 2..10 {
        measurement = measurement.with_sensor(sensor, 0.002).unwrap();
    }
    ExtendedKalmanFilter::new(data.clone(), &diagonal(start), noise, measurement).unwrap()
}

/// Returns deviations of pose, joints and velocities.
fn start(scale: f64) -> Vec<f64> {
    let pose = [0.02, 0.02, 0.0005 * scale, 0.003 * scale, 0.003 * scale, 0.02];
    [&pose[..], &[0.002 * scale; 8], &[0.01 * scale; 14]].concat()
}

fn noisy_readings(truth: &Data, filter: &ExtendedKalmanFilter, random: &mut Random) -> Vec<f64> {
    let noise = random.numbers(filter.measurement().deviations());
    truth.sensordata().iter().zip(noise).map(|(reading, noise)| reading + noise).collect()
}

/// All feet stay in contact, so the motion is smooth.
#[test]
fn the_pose_of_a_standing_quadruped_is_consistent() {
    let at_rest = quadruped::standing(quadruped::model(1.0).unwrap()).unwrap();
    let (servo, other) = ([0.005; 8], [&[1e-5; 14][..], &[1e-3; 14]].concat());
    let (mut poses, mut states): ([Squares; 2], [Squares; 2]) = Default::default();
    for seed in 0..12 {
        let mut random = Random::new(seed);
        let mut truth = at_rest.clone();
        let controls = truth.ctrl().to_vec();
        let noise = ProcessNoise::new(truth.model()).with_controls(&servo).unwrap();
        let noise = noise.with_covariance(&diagonal(&other)).unwrap();
        let mut filter = filter(&truth, &start(0.2), noise);
        random.disturb(&mut truth, &start(0.2));
        for step in 0..=40_usize {
            let noise = random.numbers(servo);
            truth.ctrl_mut().iter_mut().zip(controls.iter().zip(noise)).for_each(|(ctrl, (target, noise))| {
                *ctrl = target + noise;
            });
            truth.forward().unwrap();
            assert!(truth.ncon() == 4, "the feet stand on the floor");
            let readings = noisy_readings(&truth, &filter, &mut random);
            filter.update(&controls, &readings).unwrap();
            if step > 0 && step % 20 == 0 {
                poses[step / 20 - 1].add(&filter, &truth, 0..6);
                states[step / 20 - 1].add(&filter, &truth, 0..28);
            }
            truth.step().unwrap();
            random.disturb(&mut truth, &other);
            filter.predict(&controls).unwrap();
        }
    }
    for index in 0..2 {
        poses[index].check(&format!("poses, step {}", 20 * (index + 1)));
        states[index].check(&format!("states, step {}", 20 * (index + 1)));
    }
}

/// Errors along a trot: the mean normalised square of the error of height, roll and pitch, and the
/// root mean squares of the errors of the height, m, and of roll and pitch, rad.
#[derive(Debug)]
struct Errors {
    normalised: f64,
    height: f64,
    tilt: f64,
}

/// Runs the filter on a robot that trots on a floor that is more slippery than the filter believes.
fn trot(trunk: f64, joints: f64, contact: [f64; 2], other: f64) -> Errors {
    const STEPS: u32 = 200;
    let believed = quadruped::standing(quadruped::model(1.0).unwrap()).unwrap();
    let mut truth = quadruped::standing(quadruped::model(0.5).unwrap()).unwrap();
    let (start_x, mut random) = (truth.qpos()[0], Random::new(1));
    let noise = ProcessNoise::new(believed.model()).with_body_forces("trunk", trunk, 0.1 * trunk).unwrap();
    let noise = noise.with_forces(&[&[0.0; 6][..], &[joints; 8]].concat()).unwrap();
    let noise = noise.with_contact_forces(contact[0], contact[1]).unwrap();
    let noise = noise.with_covariance(&diagonal(&[&[other; 6][..], &[0.0; 22]].concat())).unwrap();
    let mut filter = filter(&believed, &start(1.0), noise);
    // The models were loaded separately, so the state of one is copied to compare.
    let mut compared = believed.clone();
    let (mut errors, mut error) = (Errors { normalised: 0.0, height: 0.0, tilt: 0.0 }, [0.0; 28]);
    for step in 0..STEPS {
        let controls = quadruped::trot(0.005 * f64::from(step));
        truth.ctrl_mut().copy_from_slice(&controls);
        truth.forward().unwrap();
        let readings = noisy_readings(&truth, &filter, &mut random);
        filter.update(&controls, &readings).unwrap();
        compared.set_physics_state(&truth.physics_state()).unwrap();
        filter.error_into(&compared, &mut error).unwrap();
        errors.normalised += filter.nees(&compared, 2..5).unwrap().unwrap();
        errors.height += error[2] * error[2];
        errors.tilt += error[3] * error[3] + error[4] * error[4];
        truth.step().unwrap();
        filter.predict(&controls).unwrap();
    }
    assert!(truth.qpos()[0] > start_x + 0.05, "the robot walks: {}", truth.qpos()[0]);
    let mean = |sum: f64| sum / f64::from(STEPS);
    Errors { normalised: mean(errors.normalised), height: mean(errors.height).sqrt(), tilt: mean(errors.tilt).sqrt() }
}

/// Impacts are much stronger than other disturbances. A filter that allows for them trusts its
/// accelerometer instead of its contacts.
#[test]
fn a_trotting_quadruped_needs_noise_of_contacts() {
    let confident = trot(5.0, 0.05, [0.0; 2], 0.0);
    let allowing = trot(50.0, 0.5, [50.0, 25.0], 2e-4);
    assert!(confident.normalised > 30.0, "{confident:?}");
    // Three components are expected.
    assert!(allowing.normalised < 9.0, "{allowing:?}");
    assert!(allowing.height < 0.01 && allowing.tilt < 0.01, "{allowing:?}");
}
