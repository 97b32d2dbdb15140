//! Derivatives of quaternion subtraction and integration against finite differences of the engine's
//! functions.

use mujoco_safe::math;

use crate::{array, assert_near, c, random, unit};

const EPS: f64 = 1e-6;

/// Returns `quat` rotated about its local axis `axis` by `angle`.
fn turned(quat: &[f64; 4], axis: usize, angle: f64) -> [f64; 4] {
    let mut vel = [0.0; 3];
    vel[axis] = angle;
    integrated(quat, &vel, 1.0)
}

fn integrated(quat: &[f64; 4], vel: &[f64; 3], scale: f64) -> [f64; 4] {
    let mut res = *quat;
    c!(mju_quatIntegrate(res.as_mut_ptr(), vel.as_ptr(), scale));
    res
}

fn difference(qa: &[f64; 4], qb: &[f64; 4]) -> [f64; 3] {
    let mut res = [0.0; 3];
    c!(mju_subQuat(res.as_mut_ptr(), qa.as_ptr(), qb.as_ptr()));
    res
}

/// Returns the central differences: row `i`, column `j` is component `i` by argument `j`.
fn by_differences(of: impl Fn(usize, f64) -> [f64; 3]) -> [f64; 9] {
    let columns = [0, 1, 2].map(|j| {
        let (plus, minus) = (of(j, EPS), of(j, -EPS));
        [0, 1, 2].map(|i| (plus[i] - minus[i]) / (2.0 * EPS))
    });
    std::array::from_fn(|at| columns[at % 3][at / 3])
}

#[test]
fn the_derivative_of_sub_quat_equals_differences() {
    let mut random = random(60);
    for trial in 0..200 {
        let qb = unit(&mut random);
        // Close to each other, distant, and equal.
        let scale = [1.0, 1e-2, 1e-3, 1e-4, 0.0][trial % 5];
        let vector: [f64; 3] = array::<3>(&mut random).map(|value| 1.7 * value);
        let qa = integrated(&qb, &vector, scale);
        let derivative = math::sub_quat_derivative(&qa, &qb);
        assert_near(&derivative.da, &by_differences(|j, eps| difference(&turned(&qa, j, eps), &qb)), 1e-8);
        assert_near(&derivative.db, &by_differences(|j, eps| difference(&qa, &turned(&qb, j, eps))), 1e-8);
    }
}

#[test]
fn the_derivative_of_quat_integrate_equals_differences() {
    let mut random = random(61);
    for trial in 0..200 {
        let quat = unit(&mut random);
        let vel: [f64; 3] = array::<3>(&mut random).map(|value| 2.0 * value);
        let scale = [1.1, -0.4, 1e-3, 1e-5, 0.0][trial % 5];
        let end = integrated(&quat, &vel, scale);
        let derivative = math::quat_integrate_derivative(&vel, scale);
        let dquat = by_differences(|j, eps| difference(&integrated(&turned(&quat, j, eps), &vel, scale), &end));
        assert_near(&derivative.dquat, &dquat, 1e-8);
        let dvel = by_differences(|j, eps| {
            let mut other = vel;
            other[j] += eps;
            difference(&integrated(&quat, &other, scale), &end)
        });
        assert_near(&derivative.dvel.map(|value| scale * value), &dvel, 1e-8);
        let dscale = by_differences(|_, eps| difference(&integrated(&quat, &vel, scale + eps), &end));
        assert_near(&derivative.dscale, &[dscale[0], dscale[3], dscale[6]], 1e-8);
    }
}

#[test]
fn the_series_for_small_angles_is_continuous_with_the_formula() {
    // On both sides of the threshold between the series and the formula, 10⁻³.
    let q = [1.0, 0.0, 0.0, 0.0];
    let axis = [0.6, -0.48, 0.64];
    let at = |angle: f64| {
        let derivative = math::quat_integrate_derivative(&axis, angle);
        let sub = math::sub_quat_derivative(&integrated(&q, &axis, angle), &q);
        [derivative.dquat, derivative.dvel, sub.da]
    };
    for (below, above) in at(1e-3 - 1e-12).into_iter().zip(at(1e-3 + 1e-12)) {
        assert_near(&below, &above, 1e-11);
    }
}
