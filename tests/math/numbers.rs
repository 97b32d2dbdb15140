//! Scalar functions, friction pyramids and rays, against formulas and the engine.

use mujoco_safe::Error;
use mujoco_safe::enums::GeomType;
use mujoco_safe::math::{self, SkinHit};
use rand::RngExt;

use crate::{array, assert_near, assert_same, c, numbers, random};

#[test]
fn a_spring_and_damper_follows_its_equation() {
    let mut random = random(70);
    for (kp, kv) in [(4.0, 0.5), (4.0, 4.0), (4.0, 9.0), (0.0, 2.0)] {
        let (pos0, vel0) = (random.random_range(-1.0..1.0), random.random_range(-1.0..1.0));
        let at = |time: f64| math::spring_damper(pos0, vel0, kp, kv, time);
        let (time, eps) = (0.8, 1e-4);
        let vel = (at(time + eps) - at(time - eps)) / (2.0 * eps);
        let acc = (at(time + eps) - 2.0 * at(time) + at(time - eps)) / (eps * eps);
        assert_near(&[acc], &[-kp * at(time) - kv * vel], 1e-6);
        assert_near(&[at(0.0), (at(eps) - at(-eps)) / (2.0 * eps)], &[pos0, vel0], 1e-6);
    }
}

#[test]
fn muscles_equal_c() {
    // Recorded from the engine's Python module, version 2.2.2.
    let prm = [0.75, 1.05, -1.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2];
    let lengthrange = [0.1, 0.4];
    assert_near(&[math::muscle_gain(0.3, -0.1, &lengthrange, 2.0, &prm)], &[-85.368_888_888_888_89], 1e-12);
    assert_near(&[math::muscle_bias(0.5, &lengthrange, 2.0, &prm)], &[-16.249_999_999_999_97], 1e-12);
    assert_near(&[math::muscle_dynamics(0.8, 0.3, &[0.01, 0.04])], &[52.631_578_947_368_425], 1e-12);
}

#[test]
fn the_sigmoid_is_a_smooth_step() {
    // Two parabolas in 2.2.2, then 6 x⁵ - 15 x⁴ + 10 x³.
    let quarter = if cfg!(engine_since = "2.3.7") { 0.103_515_625 } else { 0.125 };
    let expected = [0.0, 0.0, quarter, 0.5, 1.0 - quarter, 1.0, 1.0];
    assert_eq!([-1.0, 0.0, 0.25, 0.5, 0.75, 1.0, 2.0].map(math::sigmoid), expected);
}

#[test]
fn the_halton_sequence_reverses_the_digits() {
    for base in [2_u32, 3, 10] {
        for index in 0..200_u32 {
            let (mut rest, mut place, mut expected) = (index, 1.0, 0.0);
            while rest > 0 {
                place /= f64::from(base);
                expected += place * f64::from(rest % base);
                rest /= base;
            }
            assert_near(&[math::halton(index, base).unwrap()], &[expected], 1e-15);
        }
    }
    // The engine would divide by zero, never return, or treat them as negative numbers.
    for (index, base) in [(5, 0), (5, 1), (5, 1 << 31), (1 << 31, 2)] {
        assert!(matches!(math::halton(index, base), Err(Error::Invalid { .. })), "{index}, {base}");
    }
    math::halton(i32::MAX as u32, i32::MAX as u32).unwrap();
}

#[test]
fn pyramids_equal_c_and_invert() {
    let mut random = random(71);
    for dim in [3, 4, 6] {
        let mu: Vec<f64> = numbers(&mut random, dim - 1).iter().map(|value| 1.5 + value).collect();
        let mut force = numbers(&mut random, dim);
        force[0] = 20.0; // a large normal force, so inside the pyramid
        let (mut pyramid, mut theirs) = (vec![0.0; 2 * (dim - 1)], vec![0.0; 2 * (dim - 1)]);
        math::encode_pyramid(&mut pyramid, &force, &mu).unwrap();
        c!(mju_encodePyramid(theirs.as_mut_ptr(), force.as_ptr(), mu.as_ptr(), dim as i32));
        assert_same(&pyramid, &theirs);
        assert!(pyramid.iter().all(|&edge| edge >= 0.0));
        let mut again = vec![0.0; dim];
        math::decode_pyramid(&mut again, &pyramid, &mu).unwrap();
        assert_near(&again, &force, 1e-12);
    }
    // Without friction.
    let (mut pyramid, mut force) = ([0.0], [0.0]);
    math::encode_pyramid(&mut pyramid, &[3.0], &[]).unwrap();
    math::decode_pyramid(&mut force, &pyramid, &[]).unwrap();
    assert_eq!((pyramid, force), ([3.0], [3.0]));
}

#[test]
fn rays_hit_shapes_at_the_right_distance() {
    let upright = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let size = [0.3, 0.4, 0.5];
    let down = [0.0, 0.0, -2.0];
    let from_above = |kind| math::ray_geom(&[0.0; 3], &upright, &size, &[0.0, 0.0, 3.0], &down, kind);
    for (kind, distance) in [
        (GeomType::Plane, 1.5),
        (GeomType::Sphere, 1.35),
        (GeomType::Capsule, 1.15), // half length 0.4 plus radius 0.3
        (GeomType::Ellipsoid, 1.25),
        (GeomType::Cylinder, 1.3),
        (GeomType::Box, 1.25),
    ] {
        assert_near(&[from_above(kind).unwrap().unwrap()], &[distance], 1e-14);
    }
    let up = |kind| math::ray_geom(&[0.0; 3], &upright, &size, &[0.0, 0.0, 3.0], &[0.0, 0.0, 1.0], kind).unwrap();
    assert_eq!(up(GeomType::Box), None);
    for kind in [GeomType::Mesh, GeomType::HeightField] {
        assert!(matches!(from_above(kind), Err(Error::Invalid { .. })));
    }
    // Invalid shapes may be missed or hit. Invalid rays are rejected.
    let mut random = random(72);
    for kind in [GeomType::Plane, GeomType::Sphere, GeomType::Capsule, GeomType::Ellipsoid, GeomType::Box] {
        for value in [0.0, f64::NAN, f64::INFINITY, -1.0] {
            let [pnt, vec] = [array(&mut random), array(&mut random)];
            let found = math::ray_geom(&[value; 3], &[value; 9], &[value; 3], &pnt, &vec, kind);
            assert!(found.unwrap().is_none_or(|distance| distance >= 0.0));
            let found = math::ray_geom(&[0.0; 3], &upright, &size, &pnt, &[value; 3], kind);
            assert_eq!(found.is_err(), value != -1.0, "{value}");
        }
    }
}

#[test]
fn rays_hit_the_nearest_triangle_of_a_skin() {
    let vert = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    let face = [[0, 1, 2], [3, 4, 5]];
    let (pnt, down) = ([0.1, 0.6, 3.0], [0.0, 0.0, -1.0]);
    let hit = math::ray_skin(&face, &vert, &pnt, &down).unwrap().unwrap();
    assert_near(&[hit.distance], &[2.0], 1e-12);
    assert_eq!(hit, SkinHit { vertex: 5, ..hit });
    assert_eq!(math::ray_skin(&face, &vert, &[0.9, 0.9, 3.0], &down).unwrap(), None);
    assert_eq!(math::ray_skin(&[], &[], &pnt, &down).unwrap(), None);
    for wrong in [-1, 6, i32::MIN, i32::MAX] {
        let error = math::ray_skin(&[[0, 1, wrong]], &vert, &pnt, &down).unwrap_err();
        assert!(error.to_string().contains(&wrong.to_string()), "{error}");
    }
}
