//! Vector functions against the engine, bit for bit.

use mujoco_safe::math;
use nalgebra::DVector;

use crate::{assert_near, assert_same, c, numbers, random};

/// Lengths below and above the engine's unrolled blocks.
const LENGTHS: [usize; 6] = [0, 1, 3, 4, 11, 64];

#[test]
fn reductions_equal_c() {
    let mut random = random(1);
    for n in LENGTHS {
        let (a, b) = (numbers(&mut random, n), numbers(&mut random, n));
        let count = n as i32;
        assert_same(&[math::sum(&a)], &[c!(mju_sum(a.as_ptr(), count))]);
        assert_same(&[math::l1(&a)], &[c!(mju_L1(a.as_ptr(), count))]);
        assert_same(&[math::norm(&a)], &[c!(mju_norm(a.as_ptr(), count))]);
        assert_same(&[math::dot(&a, &b).unwrap()], &[c!(mju_dot(a.as_ptr(), b.as_ptr(), count))]);
        let (x, y) = (DVector::from_vec(a.clone()), DVector::from_vec(b.clone()));
        assert_near(
            &[math::sum(&a), math::norm(&a), math::dot(&a, &b).unwrap()],
            &[x.sum(), x.norm(), x.dot(&y)],
            1e-14,
        );
        assert_near(&[math::l1(&a)], &[x.abs().sum()], 1e-14);
    }
}

#[test]
fn sums_and_multiples_equal_c() {
    let mut random = random(2);
    for n in LENGTHS {
        let (a, b) = (numbers(&mut random, n), numbers(&mut random, n));
        let (p, q, count) = (a.as_ptr(), b.as_ptr(), n as i32);
        let (mut ours, mut theirs) = (vec![9.0; n], vec![9.0; n]);
        let result = theirs.as_mut_ptr();
        math::scl(&mut ours, &a, 1.7).unwrap();
        c!(mju_scl(result, p, 1.7, count));
        assert_same(&ours, &theirs);
        let mut in_place = a.clone();
        math::scl_in_place(&mut in_place, 1.7);
        assert_same(&in_place, &theirs);
        math::add(&mut ours, &a, &b).unwrap();
        c!(mju_add(result, p, q, count));
        assert_same(&ours, &theirs);
        math::sub(&mut ours, &a, &b).unwrap();
        c!(mju_sub(result, p, q, count));
        assert_same(&ours, &theirs);
        math::add_scl(&mut ours, &a, &b, -0.3).unwrap();
        c!(mju_addScl(result, p, q, -0.3, count));
        assert_same(&ours, &theirs);
        // Functions that accumulate into the result.
        math::add_to(&mut ours, &a).unwrap();
        c!(mju_addTo(result, p, count));
        assert_same(&ours, &theirs);
        math::sub_from(&mut ours, &b).unwrap();
        c!(mju_subFrom(result, q, count));
        assert_same(&ours, &theirs);
        math::add_to_scl(&mut ours, &a, 2.5).unwrap();
        c!(mju_addToScl(result, p, 2.5, count));
        assert_same(&ours, &theirs);
    }
}

#[test]
fn a_difference_and_a_sum_have_the_right_signs() {
    let mut res = [0.0; 2];
    math::sub(&mut res, &[5.0, 1.0], &[2.0, 4.0]).unwrap();
    assert_eq!(res, [3.0, -3.0]);
    math::add_scl(&mut res, &[5.0, 1.0], &[2.0, 4.0], 10.0).unwrap();
    assert_eq!(res, [25.0, 41.0]);
    math::sub_from(&mut res, &[1.0, 1.0]).unwrap();
    assert_eq!(res, [24.0, 40.0]);
}

#[test]
fn normalize_equals_c_and_accepts_an_empty_vector() {
    let mut random = random(3);
    for n in [1, 2, 5, 40] {
        for scale in [1.0, 1e-20] {
            let mut ours: Vec<f64> = numbers(&mut random, n).iter().map(|value| value * scale).collect();
            let mut theirs = ours.clone();
            let length = math::normalize(&mut ours);
            assert_same(&[length], &[c!(mju_normalize(theirs.as_mut_ptr(), n as i32))]);
            assert_same(&ours, &theirs);
            assert_near(&[math::norm(&ours)], &[1.0], 1e-15);
        }
    }
    assert_eq!(math::normalize(&mut []), 0.0);
}

#[test]
fn fill_copy_and_conversions_are_exact() {
    let mut res = [1.0; 3];
    math::zero(&mut res);
    assert!(math::is_zero(&res) && math::is_zero(&[-0.0]) && math::is_zero(&[]));
    math::fill(&mut res, -2.0);
    assert!(!math::is_zero(&res));
    assert_eq!(res, [-2.0; 3]);
    math::copy(&mut res, &[1.0, f64::INFINITY, 0.1]).unwrap();
    let mut single = [0.0_f32; 3];
    math::n2f(&mut single, &res).unwrap();
    assert_eq!(single, [1.0, f32::INFINITY, 0.1]);
    math::f2n(&mut res, &single).unwrap();
    assert_eq!(res, [1.0, f64::INFINITY, f64::from(0.1_f32)]);
    let mut theirs = [0.0; 3];
    c!(mju_f2n(theirs.as_mut_ptr(), single.as_ptr(), 3));
    assert_same(&res, &theirs);
    let (ours, mut theirs) = (single, [0.0_f32; 3]);
    c!(mju_n2f(theirs.as_mut_ptr(), res.as_ptr(), 3));
    assert_eq!(ours, theirs);
}

#[test]
fn sorting_equals_the_standard_library() {
    let mut random = random(4);
    for n in LENGTHS {
        let mut ours = numbers(&mut random, n);
        let mut theirs = ours.clone();
        math::insertion_sort(&mut ours).unwrap();
        theirs.sort_by(f64::total_cmp);
        assert_same(&ours, &theirs);
        let mut ours: Vec<i32> = numbers(&mut random, n).iter().map(|value| (value * 5.0) as i32).collect();
        let mut theirs = ours.clone();
        math::insertion_sort_int(&mut ours).unwrap();
        theirs.sort_unstable();
        assert_eq!(ours, theirs);
    }
    // With NaN, the order is unspecified, but the numbers are the same.
    let mut list = [3.0, f64::NAN, 1.0];
    math::insertion_sort(&mut list).unwrap();
    assert!(list.contains(&3.0) && list.contains(&1.0) && list.iter().any(|value| value.is_nan()));
}

#[test]
fn is_bad_equals_c() {
    for x in [0.0, 1e10, -1e10, 1.000_001e10, -1.000_001e10, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MIN] {
        assert_eq!(math::is_bad(x), c!(mju_isBad(x)) != 0, "{x}");
    }
}
