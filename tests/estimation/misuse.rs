//! Mistakes are errors that name the mistake, and leave the filter usable.

use std::sync::Arc;

use mujoco_safe::control::residual::JointPosition;
use mujoco_safe::estimation::{
    ExtendedKalmanFilter, FixedLagSmoother, Measurement, ProcessNoise, UpdateStatus, chi_square_quantile,
};
use mujoco_safe::{Data, Error, Matrix, Model};

use crate::{diagonal, pendulum, springs};

fn filter(model: &Arc<Model>) -> ExtendedKalmanFilter {
    let noise = ProcessNoise::new(model).with_forces(&[1.0; 2]).unwrap();
    let sensors = Measurement::new(model).with_sensor("left", 0.1).unwrap();
    ExtendedKalmanFilter::new(Data::new(model).unwrap(), &Matrix::identity(4), noise, sensors).unwrap()
}

#[track_caller]
fn fails<T: std::fmt::Debug>(result: mujoco_safe::Result<T>, expected: &str) {
    let error = result.unwrap_err().to_string();
    assert!(error.contains(expected), "{error}");
}

#[test]
fn wrong_sizes_are_errors() {
    let model = Arc::new(springs());
    let mut filter = filter(&model);
    fails(filter.update(&[0.0; 2], &[0.0; 2]), "the readings of an estimator has shape (2), but must have (1)");
    fails(filter.update(&[0.0; 1], &[0.0]), "the controls of an estimator (nu) has shape (1)");
    fails(filter.predict(&[0.0; 3]), "the controls of an estimator (nu) has shape (3)");
    fails(filter.set_covariance(&Matrix::identity(3)), "the covariance of the estimate has shape (3, 3)");
    let data = Data::new(&model).unwrap();
    fails(filter.error_into(&data, &mut [0.0; 3]), "the error of an estimate");
    fails(filter.nees(&data, 2..5), "must be a range in 0..4");
    #[allow(clippy::reversed_empty_ranges, reason = "the mistake")]
    let reversed = filter.nees(&data, 3..2);
    fails(reversed, "must be a range in 0..4");
    fails(filter.measurement().select_into(&[0.0; 2], &mut [0.0]), "sensordata of select_into");
    fails(filter.measurement().select_into(&[0.0; 5], &mut []), "the readings of select_into");
    let noise = || ProcessNoise::new(&model);
    fails(noise().with_forces(&[1.0]), "the generalised forces (nv)");
    fails(noise().with_controls(&[1.0]), "the controls (nu)");
    fails(noise().with_covariance(&Matrix::identity(2)), "the covariance of a ProcessNoise has shape (2, 2)");
    fails(FixedLagSmoother::new(self::filter(&model), 0), "must be at least 1");
    fails(FixedLagSmoother::new(self::filter(&model), usize::MAX), "as many as there is memory for");
    // The filter still works.
    assert_eq!(filter.update(&[0.0; 2], &[0.1]).unwrap().status, UpdateStatus::Corrected);
    filter.predict(&[0.0; 2]).unwrap();
}

#[test]
fn values_out_of_range_are_errors() {
    let model = Arc::new(springs());
    let mut filter = filter(&model);
    let before = filter.data().physics_state();
    fails(filter.update(&[0.0; 2], &[f64::INFINITY]), "reading 0 is inf");
    fails(filter.update(&[f64::NAN, 0.0], &[0.0]), "ctrl");
    fails(filter.predict(&[f64::NAN, 0.0]), "ctrl");
    assert_eq!(filter.data().physics_state(), before);
    let noise = || ProcessNoise::new(&model);
    fails(noise().with_forces(&[1.0, -1.0]), "the force of degree of freedom 1 is -1");
    fails(noise().with_controls(&[f64::NAN, 0.0]), "control 0 is NaN");
    fails(noise().with_contact_forces(1.0, f64::INFINITY), "number 1 is inf");
    fails(noise().with_body_forces(1, 1e200, 0.0), "number 0 is 1");
    fails(noise().with_body_forces("nobody", 1.0, 0.0), "nobody");
    for deviation in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-200] {
        fails(
            Measurement::new(&model).with_sensor("left", deviation),
            "the standard deviation of a sensor or residual",
        );
    }
    fails(Measurement::new(&model).with_sensor("middle", 1.0), "there is no sensor named 'middle'");
    let twice = Measurement::new(&model).with_sensor("left", 1.0).unwrap().with_sensor("left", 1.0);
    fails(twice, "added once");
    let late = Measurement::new(&model).with_residual(JointPosition::all(&model), 1.0).unwrap();
    fails(late.with_sensor("left", 1.0), "added before the residuals");
    for probability in [0.0, 1.0, f64::NAN, -0.1] {
        fails(chi_square_quantile(probability, 1), "between 0 and 1");
        fails(self::filter(&model).with_gate(probability), "between 0 and 1");
    }
    fails(chi_square_quantile(0.5, 0), "from 1 to 1000000");
    fails(chi_square_quantile(0.5, usize::MAX), "from 1 to 1000000");
    let smoother = || FixedLagSmoother::new(self::filter(&model), 2).unwrap();
    fails(smoother().with_iterations(0, 0.1), "at least 1");
    fails(smoother().with_iterations(1, f64::NAN), "not negative");
    let mut smoother = smoother();
    smoother.update(&[0.0; 2], &[0.0]).unwrap();
    fails(smoother.update(&[0.0; 2], &[0.0]), "a second update");
}

#[test]
fn matrices_that_are_no_covariances_are_errors() {
    let model = Arc::new(springs());
    let mut filter = filter(&model);
    let changed = |entries: &[((usize, usize), f64)]| {
        let mut matrix = Matrix::identity(4);
        for &(index, value) in entries {
            matrix[index] = value;
        }
        matrix
    };
    for (entries, expected) in [
        (&[((1, 1), -1.0)][..], "entry (1, 1) of the covariance of the estimate is -1"),
        (&[((1, 2), f64::NAN)], "entry (1, 2) of the covariance of the estimate is NaN"),
        (&[((0, 0), f64::INFINITY)], "entry (0, 0) of the covariance of the estimate is inf"),
        (&[((1, 2), 0.5)], "must be equal to its mirror image, 0"),
        (&[((1, 2), 1.5), ((2, 1), 1.5)], "indefinite"),
        (&[((1, 1), 0.0), ((1, 2), 0.5), ((2, 1), 0.5)], "mirror image"),
        (&[((0, 1), 0.8), ((1, 0), 0.8), ((1, 2), 0.8), ((2, 1), 0.8), ((0, 2), -0.8), ((2, 0), -0.8)], "indefinite"),
    ] {
        let matrix = changed(entries);
        let result = filter.set_covariance(&matrix);
        let error = result.unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
        let text = error.to_string();
        assert!(text.contains(expected) || text.contains("indefinite"), "{text} for {expected}");
        assert!(ProcessNoise::new(&model).with_covariance(&matrix).is_err());
    }
    // Known and fully correlated parts have no positive definite covariance.
    let semidefinite = changed(&[((3, 3), 0.0), ((0, 1), 1.0), ((1, 0), 1.0)]);
    filter.set_covariance(&semidefinite).unwrap();
    filter.predict(&[0.0; 2]).unwrap();
    filter.update(&[0.0; 2], &[0.2]).unwrap();
    assert!(filter.nees(&Data::new(&model).unwrap(), 0..1).unwrap().is_some());
}

#[test]
fn other_models_are_errors() {
    let (model, other) = (Arc::new(springs()), Arc::new(springs()));
    let build = |noise: &Arc<Model>, sensors: &Arc<Model>| {
        let (noise, sensors) = (ProcessNoise::new(noise), Measurement::new(sensors));
        ExtendedKalmanFilter::new(Data::new(&model).unwrap(), &Matrix::identity(4), noise, sensors)
    };
    fails(build(&other, &model), "the process noise belongs to another model");
    fails(build(&model, &other), "the measurement belongs to another model");
    let mut filter = filter(&model);
    let stranger = Data::new(&other).unwrap();
    fails(filter.reset(&stranger, &Matrix::identity(4)), "another model");
    fails(filter.nees(&stranger, 0..1), "another model");
    // Also if the model is replaced by one of other sizes.
    *filter.data_mut() = Data::new(pendulum()).unwrap();
    fails(filter.update(&[0.0; 2], &[0.0]), "the simulation of an estimator belongs to another model");
    fails(filter.predict(&[0.0; 2]), "the simulation of an estimator belongs to another model");
    fails(filter.error_into(&stranger, &mut [0.0; 4]), "the simulation of an estimator belongs to another model");
    fails(filter.reset(&Data::new(&model).unwrap(), &Matrix::identity(4)), "another model");
    let mut smoother = FixedLagSmoother::new(self::filter(&model), 2).unwrap();
    *smoother.data_mut() = Data::new(pendulum()).unwrap();
    fails(smoother.smooth(), "the simulation of an estimator belongs to another model");
    assert!(smoother.predict(&[0.0; 2]).is_err() && smoother.update(&[0.0; 2], &[0.0]).is_err());
    // A residual of another model is an error of the update.
    let sensors = Measurement::new(&model).with_residual(JointPosition::all(&other), 1.0).unwrap();
    let noise = ProcessNoise::new(&model);
    let mut filter =
        ExtendedKalmanFilter::new(Data::new(&model).unwrap(), &Matrix::identity(4), noise, sensors).unwrap();
    fails(filter.update(&[0.0; 2], &[0.0; 2]), "a residual belongs to another model");
}

#[test]
fn an_edit_of_the_model_acts_in_the_next_step() {
    let model = Arc::new(springs());
    let mut filter = filter(&model);
    let mut truth = Data::new(&model).unwrap();
    for data in [filter.data_mut(), &mut truth] {
        data.edit_model(|model| model.jnt_stiffness_mut()[0] = 50.0).unwrap();
        data.qpos_mut()[0] = 0.3;
    }
    truth.step().unwrap();
    filter.predict(&[0.0; 2]).unwrap();
    assert_eq!(filter.data().physics_state(), truth.physics_state());
    // A simulation with another copy of the model can restart the filter.
    let fresh = Data::new(&model).unwrap();
    filter.reset(&fresh, &diagonal(&[0.1; 4])).unwrap();
    assert_eq!(filter.data().model().jnt_stiffness()[0], 50.0);
    assert_eq!(filter.data().physics_state(), fresh.physics_state());
    let mut smoother = FixedLagSmoother::new(filter, 3).unwrap();
    smoother.update(&[0.0; 2], &[0.1]).unwrap();
    smoother.predict(&[0.0; 2]).unwrap();
    smoother.data_mut().edit_model(|model| model.jnt_stiffness_mut()[0] = 3.0).unwrap();
    smoother.update(&[0.0; 2], &[0.1]).unwrap();
    assert!(smoother.smooth().unwrap().converged);
}

#[test]
fn models_without_a_linear_system_are_errors() {
    let delayed = Model::from_xml_str(
        r#"<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>
          <actuator><motor joint="j" delay=".02" nsample="5"/></actuator></mujoco>"#,
    );
    // Older engines have no delays.
    let Ok(model) = delayed else { return };
    let model = Arc::new(model);
    let (noise, sensors) = (ProcessNoise::new(&model), Measurement::new(&model));
    let result = ExtendedKalmanFilter::new(Data::new(&model).unwrap(), &Matrix::identity(2), noise, sensors);
    assert!(matches!(result.unwrap_err(), Error::Unsupported(_)));
}

/// The step of an estimate that explodes is an error; a reset makes the filter usable.
#[test]
fn an_unstable_step_is_an_error_until_a_reset() {
    let model = Arc::new(springs());
    let mut filter = filter(&model);
    filter.data_mut().qvel_mut()[0] = 1e300;
    assert!(filter.predict(&[0.0; 2]).is_err());
    let fresh = Data::new(&model).unwrap();
    filter.reset(&fresh, &Matrix::identity(4)).unwrap();
    filter.update(&[0.0; 2], &[0.0]).unwrap();
    filter.predict(&[0.0; 2]).unwrap();
}

/// The filter's own simulation reads without noise.
#[test]
fn noise_of_the_sensors_of_the_model_is_off() {
    let mut model = pendulum();
    let noisy = mujoco_safe::model::EnableFlags::SENSORNOISE;
    if model.edit().edit_options(|options| options.enable.insert(noisy)).is_err() {
        return; // engines after 3.1.3 have no such flag
    }
    let model = Arc::new(model);
    let sensors = Measurement::new(&model).with_noisy_sensors().unwrap();
    assert_eq!(sensors.deviations().collect::<Vec<_>>(), [0.03]);
    let noise = ProcessNoise::new(&model);
    let mut filter =
        ExtendedKalmanFilter::new(Data::new(&model).unwrap(), &Matrix::identity(2), noise, sensors).unwrap();
    filter.update(&[0.0], &[0.2]).unwrap();
    assert_eq!(filter.innovations(), [0.2]);
}
