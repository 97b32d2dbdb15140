//! Contacts and limits at the distances where they begin to act or their impedance has a kink.

use mujoco_safe::Data;
use mujoco_safe::derivative::{Kinks, TransitionMethod};

use super::{WITH_SIDES, linearise};
use crate::transition::analytic::model;
use crate::transition::oracle::Oracle;

/// The gap is inside the margin, or, with newer engines, beyond it.
#[test]
fn contacts_with_a_gap_have_a_kink_where_the_engine_adds_rows() {
    for (geom, pair) in [(r#"margin="0.25" gap="0.125""#, ""), ("", r#"margin="0.25" gap="0.125""#)] {
        let pair = if pair.is_empty() { String::new() } else { format!(r#"<pair geom1="f" geom2="b" {pair}/>"#) };
        let mut data = model(&format!(
            r#"<mujoco><option gravity="0 0 0"/><worldbody><geom name="f" type="plane" size="1 1 1" {geom}/>
                 <body pos="0 0 0.5"><joint type="slide" axis="0 0 1"/><geom name="b" size="0.5" mass="2"/></body></worldbody>
               <contact>{pair}</contact></mujoco>"#
        ));
        let has_rows = |data: &mut Data, distance: f64| {
            data.qpos_mut()[0] = distance;
            data.forward().unwrap();
            data.nefc() > 0
        };
        let distances = [0.0, 0.125, 0.25, 0.375];
        let begins = distances.map(|at| has_rows(&mut data, at - 1e-6) && !has_rows(&mut data, at + 1e-6));
        assert_eq!(begins.iter().filter(|&&begins| begins).count(), 1, "{begins:?}");
        for (distance, begins) in distances.into_iter().zip(begins) {
            data.qpos_mut()[0] = distance;
            let kinks = |kind: Kinks| if begins { kind } else { Kinks::empty() };
            let report = linearise(&mut data, TransitionMethod::Analytic).1;
            assert_eq!((report.method, report.kinks), (TransitionMethod::Analytic, kinks(Kinks::CONSTRAINTS)));
            for method in [TransitionMethod::Columns, TransitionMethod::Implicit] {
                assert_eq!(linearise(&mut data, method).1.kinks, kinks(Kinks::DIFFERENCES), "{distance} {method:?}");
            }
        }
    }
}

/// The impedance is then a piecewise linear function of the violation.
#[test]
fn impedances_of_power_one_have_kinks() {
    let cases = [
        (r#"limited="true" range="-9 0" SOLIMP"#, "", 0.125),
        (
            "",
            r#"<equality><joint joint1="j" polycoef="0.125 0 0 0 0" solref="0.1 1" solimp="0.5 0.9 0.125 0.5 1"/></equality>"#,
            0.0,
        ),
        (
            "",
            r#"<equality><joint joint1="j" polycoef="0 0 0 0 0" solref="0.1 1" solimp="0.5 0.9 0.125 0.5 1"/></equality>"#,
            0.0,
        ),
        ("", "", 0.125),
    ];
    for power in [1, 2] {
        for (number, (joint, equality, qpos)) in cases.into_iter().enumerate() {
            let solimp = format!("0.5 0.9 0.125 0.5 {power}");
            let joint = joint.replace("SOLIMP", &format!(r#"solreflimit="0.1 1" solimplimit="{solimp}""#));
            let equality = equality.replace("0.5 0.9 0.125 0.5 1", &solimp);
            // The last case is a contact with a wall.
            let wall = if number == 3 { r#"<geom type="plane" size="1 1 1" pos="0 0 -0.25"/>"# } else { "" };
            let mut data = model(&format!(
                r#"<mujoco><option timestep="0.01" gravity="0 0 -9.81"/>
                     <default><geom solref="0.1 1" solimp="{solimp}"/></default>
                     <worldbody>{wall}<body><joint name="j" type="slide" axis="0 0 -1" {joint}/><geom size="0.25" mass="2"/></body></worldbody>
                   {equality}</mujoco>"#
            ));
            data.qpos_mut()[0] = qpos;
            let mut oracle = Oracle::new(&data);
            let base = oracle.base();
            let [right, left] = [1.0, -1.0].map(|side| oracle.one_sided(0, side, &base)[1].0);
            assert_eq!((right - left).abs() > 0.02 * right.abs(), power == 1, "{number} {power}: {right} {left}");
            for method in WITH_SIDES {
                let kinks = match (power, method) {
                    (1, TransitionMethod::Analytic) => Kinks::CONSTRAINTS,
                    (1, _) => Kinks::DIFFERENCES,
                    _ => Kinks::empty(),
                };
                let (system, report) = linearise(&mut data, method);
                assert_eq!((report.fallback, report.kinks), (None, kinks), "{number} {method:?}");
                let value = system.a[(1, 0)];
                let range = right.min(left) - 1e-3..right.max(left) + 1e-3;
                assert!(range.contains(&value), "{number} {power} {method:?}: {value}, not in {range:?}");
            }
        }
    }
}

/// The impedance of a contact is constant beyond the width of `solimp`, where its curvature jumps
/// from zero to about `0.05 / width²`, so that differences with the default step are several
/// percent wrong.
#[test]
fn contacts_as_deep_as_the_width_of_their_impedance_have_a_derivative() {
    let mut data = model(
        r#"<mujoco><option timestep="0.004"/><worldbody><geom type="plane" size="5 5 0.1"/>
             <body pos="0 0 0.099"><freejoint/><geom type="box" size="0.1 0.1 0.1" mass="1"/></body></worldbody></mujoco>"#,
    );
    data.qvel_mut().copy_from_slice(&[-0.346, -0.576, -0.531, 0.533, -0.0392, 0.18]);
    let systems = WITH_SIDES.map(|method| (method, linearise(&mut data, method)));
    let mut oracle = Oracle::new(&data);
    let base = oracle.base();
    for (column, side) in (0..12).flat_map(|column| [(column, 1.0), (column, -1.0)]) {
        let expected = oracle.one_sided(column, side, &base);
        let largest = expected.iter().fold(1.0, |largest: f64, (value, _)| largest.max(value.abs()));
        for (method, (system, report)) in &systems {
            // The steps of `Columns` are ten times larger.
            if *method == TransitionMethod::Columns && report.kinks == Kinks::DIFFERENCES {
                continue;
            }
            assert_eq!(report.kinks, Kinks::empty(), "{method:?}");
            for (row, (expected, error)) in expected.iter().enumerate() {
                let value = system.a[(row, column)];
                let tolerance = 2e-3 * expected.abs() + 1e-4 * largest + 10.0 * error;
                let is_near = (value - expected).abs() <= tolerance;
                assert!(is_near, "{method:?} [{row}, {column}] is {value:e} instead of {expected:e}, side {side}");
            }
        }
    }
}
