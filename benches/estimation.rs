//! A tick of the extended Kalman filter of the humanoid in a squat, 54 states: the correction by a
//! gyroscope, an accelerometer and 21 encoders, and the prediction, against what they need at
//! least: a step, and its linear system with sensors. Then with noise of the motors and of the
//! contact forces, which are estimated too (102 numbers), and the smoother over 10 steps, which
//! computes as many linear systems in each iteration.
//!
//! ```text
//! cargo bench --bench estimation
//! ```

mod common;

use mujoco_safe::control::residual::JointPosition;
use mujoco_safe::derivative::TransitionOptions;
use mujoco_safe::estimation::{ExtendedKalmanFilter, FixedLagSmoother, Measurement, ProcessNoise};
use mujoco_safe::{Data, Lineariser, Matrix, Result, StateSpace, StateSpec, sample};

/// Number of steps in a run, after which the state is restored.
const STEPS: u32 = 10;

struct Estimation {
    data: Data,
    start: Vec<f64>,
    covariance: Matrix,
    lineariser: Lineariser,
    system: StateSpace,
    simple: ExtendedKalmanFilter,
    complete: ExtendedKalmanFilter,
    smoother: FixedLagSmoother,
    readings: Vec<f64>,
}

fn filter(data: &Data, covariance: &Matrix, is_complete: bool) -> Result<ExtendedKalmanFilter> {
    let model = data.model();
    let mut noise = ProcessNoise::new(model).with_covariance(&Matrix::from_diagonal(&[1e-8; 54]))?;
    if is_complete {
        noise = noise.with_controls(&[0.01; 21])?.with_contact_forces(20.0, 10.0)?;
    }
    let mut measurement = Measurement::new(model).with_sensor("torso_gyro", 0.01)?;
    measurement = measurement.with_sensor("torso_accelerometer", 0.1)?;
    for joint in model.joints().skip(1) {
        measurement = measurement.with_residual(JointPosition::new(model, joint)?.with_target(&[0.0])?, 0.002)?;
    }
    ExtendedKalmanFilter::new(data.clone(), covariance, noise, measurement)
}

impl Estimation {
    fn new() -> Result<Self> {
        let mut data = Data::new(sample::humanoid())?;
        data.reset_to_key("squat")?;
        data.forward()?;
        let covariance = Matrix::from_diagonal(&[1e-6; 54]);
        let (simple, complete) = (filter(&data, &covariance, false)?, filter(&data, &covariance, true)?);
        let mut readings = data.sensor("torso_gyro")?.data()?.to_vec();
        readings.extend(data.sensor("torso_accelerometer")?.data()?);
        readings.extend(&data.qpos()[7..]);
        Ok(Self {
            start: data.state(StateSpec::INTEGRATION),
            lineariser: Lineariser::new(data.model(), TransitionOptions::default())?,
            system: StateSpace::zeros(data.model()),
            smoother: FixedLagSmoother::new(filter(&data, &covariance, false)?, STEPS as usize)?
                .with_iterations(1, 0.0)?,
            simple,
            complete,
            covariance,
            readings,
            data,
        })
    }

    fn tick(&mut self, choose: fn(&mut Self) -> &mut ExtendedKalmanFilter) -> Result<()> {
        self.data.set_state(StateSpec::INTEGRATION, &self.start)?;
        let (data, covariance, readings) = (self.data.clone(), self.covariance.clone(), self.readings.clone());
        let filter = choose(self);
        filter.reset(&data, &covariance)?;
        for _ in 0..STEPS {
            filter.update(&[0.0; 21], &readings)?;
            filter.predict(&[0.0; 21])?;
        }
        Ok(())
    }

    fn minimum(&mut self) -> Result<()> {
        self.data.set_state(StateSpec::INTEGRATION, &self.start)?;
        for _ in 0..STEPS {
            self.lineariser.linear_system_into(&mut self.data, &mut self.system)?;
            self.data.step()?;
        }
        Ok(())
    }
}

fn main() -> Result<()> {
    let mut estimation = Estimation::new()?;
    for _ in 0..STEPS {
        estimation.smoother.update(&[0.0; 21], &estimation.readings)?;
        estimation.smoother.predict(&[0.0; 21])?;
    }
    let stable = "the humanoid is stable for ten steps";
    common::compare(
        "estimation/humanoid",
        &mut estimation,
        STEPS,
        &[
            ("update + predict", &|state| state.tick(|state| &mut state.simple).expect(stable)),
            ("with noise of controls and contacts", &|state| state.tick(|state| &mut state.complete).expect(stable)),
            ("smooth, a step and iteration", &|state| _ = state.smoother.smooth().expect(stable)),
            ("step + linear_system_into", &|state| state.minimum().expect(stable)),
        ],
    );
    Ok(())
}
