//! State estimation: agreement with an independent computation, consistency on simulated data, the
//! smoother, misuse, and extreme numbers.
#![forbid(unsafe_code)]

#[allow(dead_code, reason = "the example uses the rest")]
#[path = "../../examples/common/quadruped.rs"]
mod quadruped;

mod consistency;
mod extreme_numbers;
mod linear;
mod misuse;
mod robot;
mod smoother;

use mujoco_safe::{Data, Matrix, Model};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Reproducible normal random numbers.
struct Random(Xoshiro256PlusPlus);

impl Random {
    fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    fn number(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    fn numbers(&mut self, deviations: impl IntoIterator<Item = f64>) -> Vec<f64> {
        deviations.into_iter().map(|deviation| deviation * self.number()).collect()
    }

    /// Moves a state by noise of these deviations `(nx)`, in tangent coordinates.
    fn disturb(&mut self, data: &mut Data, deviations: &[f64]) {
        let nv = data.model().nv();
        let noise = self.numbers(deviations.iter().copied());
        data.integrate_pos(&noise[..nv], 1.0).unwrap();
        data.qvel_mut().iter_mut().zip(&noise[nv..]).for_each(|(value, noise)| *value += noise);
    }
}

fn diagonal(deviations: &[f64]) -> Matrix {
    let variances: Vec<f64> = deviations.iter().map(|deviation| deviation * deviation).collect();
    Matrix::from_diagonal(&variances)
}

#[track_caller]
fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let difference = found.iter().zip(expected).map(|(found, expected)| (found - expected).powi(2)).sum::<f64>().sqrt();
    let size = expected.iter().map(|value| value * value).sum::<f64>().sqrt().max(1e-300);
    assert!(difference <= tolerance * size, "relative error {}: {found:?} for {expected:?}", difference / size);
}

/// Returns two masses on springs between walls, with a motor on each. The steps are linear.
fn springs() -> Model {
    Model::from_xml_str(
        r#"<mujoco><option gravity="0 0 0" timestep="0.02"/><worldbody>
          <body><joint name="left" type="slide" axis="1 0 0" stiffness="3" damping="0.2"/><geom size="0.1" mass="1.5"/>
            <body pos="1 0 0"><joint name="right" type="slide" axis="1 0 0" stiffness="-2" damping="0.1"/>
              <geom size="0.1" mass="0.5"/><site name="second"/></body></body>
        </worldbody><actuator><motor joint="left"/><motor joint="right" gear="2"/></actuator>
        <sensor><accelerometer name="acceleration" site="second"/><jointpos name="left" joint="left"/>
          <jointvel name="right" joint="right"/></sensor></mujoco>"#,
    )
    .unwrap()
}

fn pendulum() -> Model {
    Model::from_xml_str(
        r#"<mujoco><option timestep="0.01"/><worldbody><body>
          <joint name="hinge" axis="0 1 0" damping="0.02"/><geom type="capsule" fromto="0 0 0 0 0 -.5" size=".02" mass="1"/>
        </body></worldbody><actuator><motor joint="hinge"/></actuator>
        <sensor><jointpos name="encoder" joint="hinge" noise="0.03"/></sensor></mujoco>"#,
    )
    .unwrap()
}

/// Returns a body that tumbles freely, with an inertial measurement unit away from its centre.
fn tumbler() -> Model {
    Model::from_xml_str(
        r#"<mujoco><option gravity="0 0 -1" timestep="0.01"/><worldbody><body>
          <freejoint/><geom type="box" size=".3 .2 .1" mass="2"/><site name="imu" pos=".2 .1 .05"/>
        </body></worldbody><sensor><framepos name="place" objtype="site" objname="imu"/>
          <gyro name="gyro" site="imu"/><accelerometer name="accelerometer" site="imu"/>
          <framequat name="orientation" objtype="site" objname="imu"/></sensor></mujoco>"#,
    )
    .unwrap()
}
