//! Vectors in space and spatial vectors, as inlined arithmetic.
//!
//! A spatial vector is `[angular; linear]`, as in the engine: a motion is `[ω; v]`, a force
//! `[torque; force]`, both about a reference point.

pub(crate) type Vec3 = [f64; 3];
pub(crate) type Spatial = [f64; 6];

/// Inertia of a rigid body about the reference point: the ten numbers of the engine's `cinert`.
/// They are the matrix of rotational inertia (`xx`, `yy`, `zz`, `xy`, `xz`, `yz`), the mass times
/// the centre of mass, and the mass.
pub(crate) type Inertia = [f64; 10];

#[inline]
pub(crate) fn add<const N: usize>(a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

#[inline]
pub(crate) fn sub<const N: usize>(a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] - b[i])
}

#[inline]
pub(crate) fn scale<const N: usize>(a: &[f64; N], factor: f64) -> [f64; N] {
    a.map(|value| factor * value)
}

/// Computes `a += factor b`.
#[inline]
pub(crate) fn add_scaled<const N: usize>(a: &mut [f64; N], b: &[f64; N], factor: f64) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += factor * b;
    }
}

#[inline]
pub(crate) fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for i in 0..N {
        sum += a[i] * b[i];
    }
    sum
}

#[inline]
pub(crate) fn norm<const N: usize>(a: &[f64; N]) -> f64 {
    dot(a, a).sqrt()
}

#[inline]
pub(crate) fn cross(a: &Vec3, b: &Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline]
pub(crate) fn angular(vector: &Spatial) -> Vec3 {
    [vector[0], vector[1], vector[2]]
}

#[inline]
pub(crate) fn linear(vector: &Spatial) -> Vec3 {
    [vector[3], vector[4], vector[5]]
}

#[inline]
pub(crate) fn spatial(angular: &Vec3, linear: &Vec3) -> Spatial {
    [angular[0], angular[1], angular[2], linear[0], linear[1], linear[2]]
}

/// Returns the rate of change `v × m` of a motion vector `m` that is fixed in a frame moving with
/// `v`.
#[inline]
pub(crate) fn cross_motion(v: &Spatial, m: &Spatial) -> Spatial {
    let (turn, shift) = (angular(v), linear(v));
    let (of, at) = (angular(m), linear(m));
    spatial(&cross(&turn, &of), &add(&cross(&turn, &at), &cross(&shift, &of)))
}

/// Returns the rate of change `v ×* f` of a force vector `f` that is fixed in a frame moving with
/// `v`.
#[inline]
pub(crate) fn cross_force(v: &Spatial, f: &Spatial) -> Spatial {
    let (turn, shift) = (angular(v), linear(v));
    let (torque, force) = (angular(f), linear(f));
    spatial(&add(&cross(&turn, &torque), &cross(&shift, &force)), &cross(&turn, &force))
}

/// Returns the momentum `I v`.
#[inline]
pub(crate) fn momentum(i: &Inertia, v: &Spatial) -> Spatial {
    let h = [i[6], i[7], i[8]];
    let (turn, shift) = (angular(v), linear(v));
    let rotational = [
        i[0] * turn[0] + i[3] * turn[1] + i[4] * turn[2],
        i[3] * turn[0] + i[1] * turn[1] + i[5] * turn[2],
        i[4] * turn[0] + i[5] * turn[1] + i[2] * turn[2],
    ];
    spatial(&add(&rotational, &cross(&h, &shift)), &sub(&scale(&shift, i[9]), &cross(&h, &turn)))
}

/// Returns the velocity of the point at `arm` from the reference point.
#[inline]
pub(crate) fn velocity_at(motion: &Spatial, arm: &Vec3) -> Vec3 {
    add(&linear(motion), &cross(&angular(motion), arm))
}

/// Returns the force vector about the reference point of a torque, and of a force at `arm` from the
/// reference point.
#[inline]
pub(crate) fn wrench(torque: &Vec3, force: &Vec3, arm: &Vec3) -> Spatial {
    spatial(&add(torque, &cross(arm, force)), force)
}

#[cfg(test)]
mod tests {
    use super::{Spatial, cross_force, cross_motion, dot, momentum};

    const V: Spatial = [0.3, -0.7, 1.1, 0.2, 0.9, -0.4];
    const M: Spatial = [-0.5, 0.6, 0.1, 1.2, -0.3, 0.8];
    const F: Spatial = [2.0, -1.0, 0.5, 0.7, 1.5, -2.5];

    #[test]
    fn power_does_not_depend_on_the_frame() {
        // The power m·f of vectors that move together is constant: (v × m)·f + m·(v ×* f) = 0.
        assert!((dot(&cross_motion(&V, &M), &F) + dot(&M, &cross_force(&V, &F))).abs() < 1e-14);
    }

    #[test]
    fn momentum_is_the_derivative_of_kinetic_energy() {
        // The energy of a point mass is m |v + ω × p|² / 2.
        let (mass, point) = (1.7, [0.4, -0.2, 0.9]);
        let [x, y, z] = point;
        let inertia = [
            mass * (y * y + z * z),
            mass * (x * x + z * z),
            mass * (x * x + y * y),
            -mass * x * y,
            -mass * x * z,
            -mass * y * z,
            mass * x,
            mass * y,
            mass * z,
            mass,
        ];
        let velocity = super::velocity_at(&V, &point);
        let energy = 0.5 * mass * dot(&velocity, &velocity);
        assert!((0.5 * dot(&V, &momentum(&inertia, &V)) - energy).abs() < 1e-13);
    }
}
