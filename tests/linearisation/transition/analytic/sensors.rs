//! C and D: the sensors with a formula against extrapolated differences of the engine's `mj_step`,
//! the others as differences.

use std::fmt::Write as _;
use std::ops::Range;

use mujoco_safe::derivative::{DifferencedTerms, TransitionMethod, TransitionOptions, TransitionOutputs};
use mujoco_safe::{Data, Lineariser, Matrix, StateSpace, sys};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{CONTROL_FACTOR, TOLERANCE, WIDTHS, analytic, model, randomise};
use crate::cases::cases;
use crate::transition::features::{ball, chain, moving};
use crate::transition::{deviation, oracle};

/// All joints in two trees, limits, tendons and actuators, with a floor that the first tree
/// touches.
pub(crate) fn machine(sensors: &str) -> String {
    format!(
        r#"<mujoco><option timestep="0.002" magnetic="0.2 -0.1 0.5" OPTION/>
          <worldbody>
            <geom type="plane" size="5 5 1" pos="0 0 -0.3"/><site name="fixed" pos="0.3 -0.2 0.1" euler="20 30 40"/>
            <body name="base" pos="0 0 0.1">
              <freejoint/><geom name="hull" type="capsule" size="0.3" fromto="-0.15 0 0 0.2 0.05 0.03"/>
              <camera name="eye" pos="0.1 0.2 0.1" euler="10 50 -30"/><camera name="follower" mode="track" pos="1 1 1"/>
              <body name="arm" pos="0.4 0 0.25">
                <joint name="ball" type="ball" pos="-0.03 0.02 0.01" limited="true" range="0 25" damping="0.1"/>
                <geom type="capsule" size="0.05" fromto="0 0 0 0.3 0.02 -0.05"/><site name="grip" pos="0.1 0 0.05" euler="40 -20 70"/>
                <body name="hand" pos="0.32 0 0.05" euler="10 20 30">
                  <joint name="slide" type="slide" axis="1 0.2 -0.1" limited="true" range="-0.2 0.1"/>
                  <joint name="hinge" axis="0 1 0.3" pos="0.01 0 0.02" armature="0.03" limited="true" range="-30 20"/>
                  <geom name="palm" type="box" size="0.08 0.05 0.03" pos="0.05 0 0.01" euler="5 15 25"/>
                  <site name="tip" pos="0.1 0.02 0" euler="-40 60 10" size="0.2"/>
                </body>
              </body>
            </body>
            <body name="pendulum" pos="2 0 0.5">
              <joint name="swing" axis="0 1 0"/><geom size="0.1" pos="0.2 0.1 -0.3"/>
              <body name="bob" pos="0.1 0.1 -0.5"><joint type="ball" damping="0.05"/><geom type="box" size="0.05 0.1 0.02" pos="0.1 0 0"/></body>
            </body>
          </worldbody>
          <tendon><fixed name="mix" limited="true" range="-0.01 0.01" stiffness="2">
            <joint joint="slide" coef="2"/><joint joint="hinge" coef="-0.5"/>
          </fixed></tendon>
          <actuator>
            <motor name="motor" joint="swing" gear="2"/><position name="servo" joint="hinge" kp="4"/>
            <general name="affine" tendon="mix" gaintype="affine" gainprm="2 0.5 0.3" biastype="affine" biasprm="0.1 -3 -0.4"/>
            <motor name="clamped" joint="slide" forcelimited="true" forcerange="-0.01 0.01"/>
            <motor name="torque" joint="ball" gear="1 2 3"/>
            <general name="filter" joint="swing" dyntype="filter" dynprm="0.05" gainprm="3"/>
          </actuator>
          <sensor>{sensors}</sensor></mujoco>"#
    )
}

/// Compares the rows of each sensor with the differences, in states with and without contacts, and
/// checks that none is differenced. Returns the last state.
fn check(xml: &str, seed: u64) -> Data {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut last = None;
    for option in ["", r#"cone="elliptic" jacobian="sparse""#] {
        let mut data = model(&xml.replace("OPTION", option));
        for state in 0..cases(2, 4) {
            randomise(&mut data, &mut random);
            // The joints that limits hold are near them, and the free joint is near the floor.
            data.qpos_mut().iter_mut().for_each(|value| *value *= 0.5);
            data.qpos_mut()[2] = if state % 2 == 0 { -0.05 } else { 1.0 };
            data.forward().unwrap();
            assert_eq!(data.ncon() > 0, state % 2 == 0, "state {state}");
            let (ours, report) = analytic(&mut data);
            assert_eq!((report.method, report.fallback), (TransitionMethod::Analytic, None), "{option}, state {state}");
            assert!(!report.differenced.contains(DifferencedTerms::SENSORS));
            compare(&format!("{option}, state {state}"), &data, &ours);
        }
        last = Some(data);
    }
    last.unwrap()
}

/// Compares the rows of each sensor with the differences.
pub(super) fn compare(what: &str, data: &Data, ours: &StateSpace) {
    let model = data.model();
    let mut errors = vec![[f64::INFINITY; 2]; model.nsensor()];
    for width in WIDTHS {
        let truth = oracle::linear_system_by(data, width, CONTROL_FACTOR * width);
        for (sensor, least) in errors.iter_mut().enumerate() {
            let first = model.sensor_adr()[sensor] as usize;
            let rows = first..first + model.sensor_dim()[sensor] as usize;
            for (least, (ours, theirs)) in least.iter_mut().zip([(&ours.c, &truth.c), (&ours.d, &truth.d)]) {
                *least = least.min(error(ours, theirs, rows.clone()));
            }
        }
        if errors.as_flattened().iter().all(|&error| error <= TOLERANCE) {
            return;
        }
    }
    for (sensor, errors) in errors.into_iter().enumerate() {
        let [c, d] = errors;
        let kind = model.sensor_type()[sensor];
        assert!(c.max(d) <= TOLERANCE, "{what}: sensor {sensor} of type {kind} deviates by {c:.1e} in C, {d:.1e} in D");
    }
}

/// Largest number of the rows of a sensor below which the rounding of the differences is not small
/// any more: of a constant sensor.
const SMALL: f64 = 1e-3;

/// Returns the largest deviation of some rows, relative to the largest number of them.
fn error(ours: &Matrix, theirs: &Matrix, rows: Range<usize>) -> f64 {
    let [ours, theirs] = [ours, theirs].map(|matrix| rows.clone().flat_map(|row| matrix.row(row)));
    let largest = theirs.clone().fold(SMALL, |largest, value| largest.max(value.abs()));
    let worst = ours.zip(theirs).map(|(ours, theirs)| (ours - theirs).abs()).max_by(f64::total_cmp);
    worst.unwrap_or(0.0) / largest
}

/// Objects of sensors, and reference frames: none, of another tree, of the same tree above and
/// below, the object itself, and fixed.
const OBJECTS: [(&str, &str); 5] =
    [("body", "hand"), ("xbody", "arm"), ("geom", "palm"), ("site", "grip"), ("camera", "eye")];
const REFERENCES: [&str; 6] = [
    "",
    r#"reftype="body" refname="bob""#,
    r#"reftype="xbody" refname="base""#,
    r#"reftype="site" refname="tip""#,
    r#"reftype="body" refname="hand""#,
    r#"reftype="site" refname="fixed""#,
];

fn frames(kinds: &[&str], references: &[&str]) -> String {
    let mut sensors = String::new();
    for kind in kinds {
        for (number, reference) in references.iter().enumerate() {
            for (object, name) in OBJECTS {
                // All objects without a reference, two of them with each.
                if number == 0 || object == "body" || object == "site" {
                    writeln!(sensors, r#"<{kind} objtype="{object}" objname="{name}" {reference}/>"#).unwrap();
                }
            }
        }
    }
    sensors
}

/// Returns sensors of the [`machine`]: one of each kind with a formula.
pub(crate) fn all_kinds() -> String {
    let mut sensors = frames(&["framepos", "framequat", "framexaxis"], &REFERENCES[..2]);
    sensors += &frames(&["framelinvel", "frameangvel"], &REFERENCES[..3]);
    sensors += &frames(&["framelinacc", "frameangacc"], &[""]);
    sensors
        + r#"<magnetometer site="tip"/><gyro site="tip"/><velocimeter site="tip"/><accelerometer site="tip"/>
             <subtreecom body="arm"/><subtreelinvel body="base"/><subtreeangmom body="arm"/>
             <jointpos joint="hinge"/><jointvel joint="slide"/><tendonpos tendon="mix"/><tendonvel tendon="mix"/><clock/>
             <ballquat joint="ball"/><ballangvel joint="ball"/><jointlimitpos joint="hinge"/><jointlimitvel joint="slide"/>
             <tendonlimitpos tendon="mix"/><tendonlimitvel tendon="mix"/><actuatorpos actuator="servo"/>
             <actuatorvel actuator="affine"/><actuatorfrc actuator="servo"/><touch site="tip"/>
             <jointlimitfrc joint="hinge"/><jointlimitfrc joint="ball"/><tendonlimitfrc tendon="mix"/>
             <force site="tip"/><torque site="grip"/><rangefinder site="grip"/>"#
}

#[test]
fn poses_of_frames_agree_with_differences() {
    let sensors = frames(&["framepos", "framequat", "framexaxis", "frameyaxis", "framezaxis"], &REFERENCES);
    check(&machine(&(sensors + r#"<magnetometer site="tip"/>"#)), 20);
}

#[test]
fn velocities_of_frames_agree_with_differences() {
    let sensors = frames(&["framelinvel", "frameangvel"], &REFERENCES);
    check(&machine(&(sensors + r#"<gyro site="tip"/><velocimeter site="tip"/><gyro site="fixed"/>"#)), 21);
}

#[test]
fn accelerations_of_frames_agree_with_differences() {
    let sensors = frames(&["framelinacc", "frameangacc"], &[""]);
    check(&machine(&(sensors + r#"<accelerometer site="tip"/><accelerometer site="fixed"/>"#)), 22);
}

#[test]
fn centres_of_mass_and_momenta_of_subtrees_agree_with_differences() {
    let mut sensors = String::new();
    for body in ["world", "base", "arm", "hand", "pendulum"] {
        for kind in ["subtreecom", "subtreelinvel", "subtreeangmom"] {
            writeln!(sensors, r#"<{kind} body="{body}"/>"#).unwrap();
        }
    }
    check(&machine(&sensors), 23);
}

#[test]
fn joints_tendons_limits_and_actuators_agree_with_differences() {
    let data = check(
        &machine(
            r#"<jointpos joint="hinge"/><jointvel joint="slide"/><tendonpos tendon="mix"/><tendonvel tendon="mix"/><clock/>
               <ballquat joint="ball"/><ballangvel joint="ball"/>
               <jointlimitpos joint="hinge"/><jointlimitvel joint="hinge"/><jointlimitpos joint="slide"/>
               <jointlimitvel joint="slide"/><jointlimitpos joint="ball"/>
               <tendonlimitpos tendon="mix"/><tendonlimitvel tendon="mix"/>
               <actuatorpos actuator="servo"/><actuatorvel actuator="servo"/><actuatorpos actuator="affine"/>
               <actuatorvel actuator="affine"/>
               <actuatorfrc actuator="motor"/><actuatorfrc actuator="servo"/><actuatorfrc actuator="affine"/>
               <actuatorfrc actuator="clamped"/><actuatorfrc actuator="torque"/><actuatorfrc actuator="filter"/>"#,
        ),
        24,
    );
    let is_limited = |kind: u32| data.efc_type().contains(&(kind as i32));
    assert!(is_limited(sys::mjCNSTR_LIMIT_JOINT) && is_limited(sys::mjCNSTR_LIMIT_TENDON));
}

#[test]
fn forces_of_contacts_and_limits_agree_with_differences() {
    let data = check(
        &machine(
            r#"<touch site="belly"/><touch site="ball_site"/><touch site="tip"/><jointlimitfrc joint="hinge"/><jointlimitfrc joint="slide"/>
               <jointlimitfrc joint="ball"/><tendonlimitfrc tendon="mix"/>"#,
        )
        // Sites around one end of the hull, around all of it, and away from the floor.
        .replace(
            "<camera name=\"eye\"",
            "<site name=\"belly\" type=\"box\" size=\"0.6 0.6 0.6\"/><site name=\"ball_site\" pos=\"0.2 0.05 0\" size=\"0.25\"/><camera name=\"eye\"",
        ),
        25,
    );
    assert!(data.sensordata()[3..].iter().any(|&force| force > 0.0));
}

/// Sensors of the forces between bodies of the [`machine`] and their parents. That on the free body
/// is always zero.
const FORCES: &str = r#"<force site="tip"/><torque site="tip"/><force site="grip"/><torque site="grip"/><force site="swinging"/>
    <torque site="swinging"/>"#;

/// Returns the [`machine`] with force and torque sensors.
fn loaded(rest: &str) -> String {
    let site = r#"<site name="swinging" pos="0 0.1 -0.1" euler="-70 10 5"/><body name="bob""#;
    machine(FORCES).replace(r#"<body name="bob""#, site).replace("<actuator>", &format!("{rest}<actuator>"))
}

#[test]
fn forces_between_bodies_agree_with_differences() {
    check(&loaded(""), 26);
}

#[test]
fn forces_between_bodies_with_applied_forces_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(27);
    let mut data = model(&loaded("").replace("OPTION", ""));
    for state in 0..2 {
        randomise(&mut data, &mut random);
        data.xfrc_applied_mut()[3] = [3.0, -2.0, 1.0, 0.3, 0.2, -0.5];
        data.xfrc_applied_mut()[5] = [-1.0, 2.0, 4.0, -0.3, 0.1, 0.2];
        let (ours, report) = analytic(&mut data);
        assert!(report.differenced.is_empty());
        compare(&format!("state {state}"), &data, &ours);
    }
}

#[test]
fn forces_of_equality_constraints_between_bodies_agree_with_differences() {
    // These constraints have no formula since 3.7.
    if cfg!(engine_since = "3.7.0") {
        return;
    }
    for equality in [
        r#"<connect body1="hand" body2="bob" anchor="0.1 0.05 0.02"/>"#,
        r#"<weld body1="arm" body2="pendulum" torquescale="0.6"/>"#,
        r#"<weld body1="hand" body2="base"/>"#,
        // Both bodies are in the subtree of a sensor, and the constraint is violated.
        r#"<connect body1="arm" body2="hand" anchor="0.1 0.05 0.02"/>"#,
        r#"<weld body1="arm" body2="hand"/>"#,
    ] {
        check(&loaded(&format!("<equality>{equality}</equality>")), 28);
    }
}

#[test]
fn contact_forces_of_each_cone_and_dimension_between_bodies_agree_with_differences() {
    for cone in ["pyramidal", "elliptic"] {
        for dim in [1, 3, 4, 6] {
            let sensors = r#"<sensor><force site="mark"/><torque site="mark"/></sensor>"#;
            let geom = format!(r#"type="sphere" size="0.1" condim="{dim}""#);
            let joints = r#"<joint type="slide" axis="0 0.2 1"/><joint axis="1 0 0.3"/>"#;
            let xml = ball(&format!(r#"cone="{cone}" impratio="2""#), joints, &geom, sensors);
            let mut data = moving(&xml, 4);
            data.forward().unwrap();
            assert!(data.nefc() > 0);
            let (ours, report) = analytic(&mut data);
            assert!(report.differenced.is_empty());
            compare(&format!("{cone}, {dim}"), &data, &ours);
        }
    }
}

#[test]
fn distances_to_each_shape_agree_with_differences() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(29);
    for shape in [
        r#"type="plane" size="3 3 1" pos="0 0 -0.6" euler="10 20 0""#,
        r#"type="sphere" size="0.3" pos="0 0 -0.6""#,
        r#"type="ellipsoid" size="0.5 0.3 0.2" pos="0 0 -0.6" euler="10 20 30""#,
        r#"type="capsule" size="0.2 0.4" pos="0 0 -0.6" euler="70 20 30""#,
        r#"type="capsule" size="0.2 0.2" pos="0 0 -0.6" euler="10 20 30""#,
        r#"type="cylinder" size="0.2 0.4" pos="0 0 -0.6" euler="70 20 30""#,
        r#"type="cylinder" size="0.4 0.1" pos="0 0 -0.6" euler="10 20 30""#,
        r#"type="box" size="0.5 0.3 0.2" pos="0 0 -0.6" euler="10 20 30""#,
    ] {
        // The ray points down from a moving site to a geom that moves too, except for the plane.
        let target = if shape.contains("plane") {
            format!("<geom {shape}/>")
        } else {
            format!(r#"<body pos="0 0 0"><joint type="ball" pos="1 0 0"/><geom {shape}/></body>"#)
        };
        let mut data = super::model(&format!(
            r#"<mujoco><default><geom contype="0" conaffinity="0"/></default><worldbody>{target}
                 <body pos="0 0 0.3"><freejoint/><geom size="0.1"/><site name="eye" pos="0.01 0.02 0" euler="180 0 0"/></body>
               </worldbody><sensor><rangefinder site="eye"/></sensor></mujoco>"#
        ));
        let mut hits = 0;
        for state in 0..cases(2, 6) {
            randomise(&mut data, &mut random);
            let model = data.model().clone();
            data.qpos_mut().copy_from_slice(model.qpos0());
            let shift: Vec<f64> = (0..model.nv()).map(|_| random.random_range(-0.15..0.15)).collect();
            model.integrate_pos(data.qpos_mut(), &shift, 1.0).unwrap();
            data.forward().unwrap();
            let (ours, report) = analytic(&mut data);
            assert!(report.differenced.is_empty(), "{shape}");
            compare(&format!("{shape}, state {state}"), &data, &ours);
            hits += usize::from(data.sensordata()[0] > 0.0);
        }
        assert!(hits > 0, "{shape}: no state in which the ray meets the geom");
    }
}

/// Found by the fuzzer: a formula that limited a coordinate to a negative length.
#[test]
fn a_distance_to_a_shape_of_negative_size_is_differenced() {
    let mut hits = 0;
    for (kind, read) in [("capsule", 2), ("cylinder", 2), ("ellipsoid", 3), ("box", 3)] {
        for negative in 0..read {
            let mut data = moving(
                &format!(
                    r#"<mujoco><worldbody><geom name="target" type="{kind}" size="0.5 0.4 0.3" pos="0 0 -3"/>
                         <body><joint axis="0 1 0"/><geom size="0.1"/><site name="eye" euler="180 0 0"/></body>
                       </worldbody><sensor><rangefinder site="eye"/></sensor></mujoco>"#
                ),
                5,
            );
            let target = data.model().geom("target").unwrap().id().index();
            data.edit_model(|edit| edit.geom_size_mut()[target][negative] *= -1.0).unwrap();
            data.forward().unwrap();
            let (system, report) = analytic(&mut data);
            let is_hit = data.sensordata()[0] > 0.0;
            assert!(!is_hit || report.differenced == DifferencedTerms::SENSORS, "{kind}, {negative}: {report:?}");
            assert!(system.c.as_slice().iter().all(|value| value.is_finite()), "{kind}, {negative}");
            hits += usize::from(is_hit);
        }
    }
    assert!(hits > 0);
}

#[test]
fn a_distance_to_a_mesh_is_differenced() {
    let mut data = moving(
        r#"<mujoco><asset><mesh name="m" vertex="1 1 0  -1 1 0  1 -1 0  -1 -1 0  0 0 1"/></asset>
             <worldbody><geom type="mesh" mesh="m" pos="0 0 -3"/>
               <body><joint axis="0 1 0"/><geom size="0.1"/><site name="eye" euler="180 0 0"/></body>
             </worldbody><sensor><rangefinder site="eye"/></sensor></mujoco>"#,
        5,
    );
    let (system, report) = analytic(&mut data);
    assert_eq!(report.differenced, DifferencedTerms::SENSORS);
    assert!(system.c.as_slice().iter().all(|value| value.is_finite()));
    assert_ne!(system.c[(0, 0)], 0.0);
}

#[test]
fn touch_sensors_of_each_cone_and_dimension_agree_with_differences() {
    for cone in ["pyramidal", "elliptic"] {
        for dim in [1, 3, 4, 6] {
            let touch = r#"<sensor><touch site="mark"/></sensor>"#;
            let geom = format!(r#"type="sphere" size="0.1" condim="{dim}""#);
            let xml = ball(&format!(r#"cone="{cone}" impratio="2""#), "<freejoint/>", &geom, touch)
                .replace(r#"pos="0.02 0 0""#, r#"size="0.2""#);
            let mut data = moving(&xml, 4);
            data.forward().unwrap();
            assert!(data.sensordata()[0] > 0.0);
            let (ours, report) = analytic(&mut data);
            assert!(report.differenced.is_empty());
            compare(&format!("{cone}, {dim}"), &data, &ours);
        }
    }
}

#[test]
fn a_sensor_with_a_cutoff_is_differenced() {
    let xml = chain("", "", "", r#"<sensor><jointvel joint="b" cutoff="0.001"/></sensor>"#);
    let mut data = moving(&xml, 5);
    let (system, report) = analytic(&mut data);
    assert_eq!(report.differenced, DifferencedTerms::SENSORS);
    assert!(system.c.as_slice().iter().all(|&value| value == 0.0), "the velocity is beyond the cutoff");
}

#[test]
fn only_sensors_without_a_formula_are_differenced() {
    let sensors =
        r#"<sensor><jointpos joint="a"/><framepos objtype="camera" objname="eye"/><gyro site="tip"/></sensor>"#;
    let motors = r#"<actuator><motor joint="a"/></actuator>"#;
    let xml = chain("", "", r#"damping="0.1""#, &format!("{motors}{sensors}")).replace(
        r#"<site name="tip""#,
        r#"<camera name="eye" mode="targetbody" target="upper" pos="0.1 0 0"/><site name="tip""#,
    );
    let mut data = moving(&xml, 5);
    let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    assert_eq!(lineariser.differenced_sensors().map(|sensor| sensor.index()).collect::<Vec<_>>(), [1]);
    let (system, report) = lineariser.linear_system(&mut data).unwrap();
    assert_eq!(report.differenced, DifferencedTerms::SENSORS);
    let options = TransitionOptions::default().with_method(TransitionMethod::Implicit);
    let mut implicit = Lineariser::new(data.model().clone(), options).unwrap();
    let (other, report) = implicit.linear_system(&mut data).unwrap();
    assert!(report.differenced.is_empty());
    for row in 0..7 {
        let is_camera = (1..4).contains(&row);
        assert_eq!(system.c.row(row) == other.c.row(row), is_camera, "row {row} of C");
        // D of the joint and of the gyro are zero by either method.
        assert_eq!(system.d.row(row), other.d.row(row));
    }
    assert!(deviation(&system.c, &other.c) < 1e-6 && deviation(&system.a, &other.a) < 1e-6);
}

#[test]
fn sensors_are_written_to_each_of_c_and_d_alone() {
    let sensors = r#"<sensor><accelerometer site="tip"/><framepos objtype="camera" objname="eye"/></sensor>"#;
    let motors = r#"<actuator><motor joint="a"/></actuator>"#;
    let xml = chain("", "", "", &format!("{motors}{sensors}"))
        .replace(r#"<site name="tip""#, r#"<camera name="eye" mode="targetbody" target="upper"/><site name="tip""#);
    let mut data = moving(&xml, 5);
    let (system, report) = analytic(&mut data);
    assert_eq!(report.differenced, DifferencedTerms::SENSORS);
    let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
    let (mut c, mut d) = (Matrix::zeros(6, 6), Matrix::zeros(6, 1));
    lineariser.linear_system_into(&mut data, TransitionOutputs { c: Some(&mut c), ..Default::default() }).unwrap();
    lineariser.linear_system_into(&mut data, TransitionOutputs { d: Some(&mut d), ..Default::default() }).unwrap();
    assert_eq!((c, d), (system.c, system.d));
}
