//! Control: Riccati equations, regulators, gain tables, iterative LQR, and the control examples.
#![forbid(unsafe_code)]

#[allow(dead_code, reason = "the example uses the rest")]
#[path = "../../examples/humanoid_predictive/attempt.rs"]
mod attempt;
#[path = "../common/cases.rs"]
mod cases;
#[path = "../../examples/humanoid_predictive/cost.rs"]
mod cost;
#[path = "../common/example.rs"]
mod example;
#[path = "../common/installed.rs"]
mod installed;
#[path = "../../examples/humanoid_predictive/planner.rs"]
mod planner;
#[allow(dead_code, reason = "the example uses the rest")]
#[path = "../../examples/learn_gait/policy.rs"]
mod policy;
#[path = "../../examples/humanoid_predictive/robot.rs"]
mod robot;
#[allow(dead_code, reason = "the example uses the rest")]
#[path = "../../examples/learn_gait/search.rs"]
mod search;
#[path = "../../examples/humanoid_lqr/set_point.rs"]
mod set_point;
#[path = "../../examples/humanoid_lqr/simulate.rs"]
mod simulate;
#[allow(dead_code, reason = "the example uses the rest")]
#[path = "../../examples/humanoid_stand_up/stand_up.rs"]
mod stand_up;
#[path = "../../examples/common/standing.rs"]
mod standing;
#[allow(dead_code, reason = "the example uses the rest")]
#[path = "../../examples/cartpole_swing_up/swing_up.rs"]
mod swing_up;
#[allow(dead_code, reason = "the example uses the rest")]
#[path = "../../examples/arm_tracking/tracking.rs"]
mod tracking;
#[path = "../../examples/humanoid_lqr/weights.rs"]
mod weights;

mod examples;
mod extreme_numbers;
mod gain_table;
mod goals;
mod humanoid_balance;
mod ilqr;
mod learning;
mod predictive;
mod recursion;
mod residual;
mod riccati;
mod sampling;
mod sizes;
mod threaded;

use mujoco_safe::matrix::StridedView;
use mujoco_safe::{Data, LqrWeights, Model, sample};
use nalgebra::{DMatrix, DVector};
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

    fn vector(&mut self, length: usize) -> DVector<f64> {
        DVector::from_fn(length, |_, _| self.number())
    }

    fn matrix(&mut self, rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |_, _| self.number())
    }

    /// Returns a symmetric matrix whose eigenvalues are at least `least`.
    fn positive(&mut self, size: usize, least: f64) -> DMatrix<f64> {
        let factor = self.matrix(size, size);
        &factor * factor.transpose() + DMatrix::identity(size, size) * least
    }
}

#[track_caller]
fn assert_close<'a>(found: impl Into<StridedView<'a>>, expected: impl Into<StridedView<'a>>, tolerance: f64) {
    let (found, expected) = (found.into().to_matrix().to_nalgebra(), expected.into().to_matrix().to_nalgebra());
    assert_eq!(found.shape(), expected.shape());
    let error = (&found - &expected).norm() / expected.norm().max(1e-300);
    assert!(error <= tolerance, "relative error {error:e}: {found} instead of {expected}");
}

/// Returns the weights of the worked example of the cart-pole.
fn weights() -> LqrWeights {
    LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0])
}

fn cartpole() -> Data {
    Data::new(sample::cartpole()).unwrap()
}

/// Returns two masses on springs between walls, with an unlimited motor on each. The steps are
/// linear.
fn springs() -> Model {
    Model::from_xml_str(
        r#"<mujoco><option gravity="0 0 0" timestep="0.02"/><worldbody>
          <body><joint name="left" type="slide" axis="1 0 0" stiffness="3" damping="0.2"/><geom size="0.1" mass="1.5"/>
            <body pos="1 0 0"><joint name="right" type="slide" axis="1 0 0" stiffness="-2" damping="0.1"/>
              <geom size="0.1" mass="0.5"/></body></body>
        </worldbody><actuator><motor joint="left"/><motor joint="right" gear="2"/></actuator></mujoco>"#,
    )
    .unwrap()
}
