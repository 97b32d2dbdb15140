//! Numbers for the bundled models against the official Python bindings, recorded by
//! `tests/oracle/record.py`.
//!
//! The bindings include the official build of the engine, of the same version as the library linked
//! here. For models of this size (dense, without long sums that a compiler may reorder), the
//! results of 2.2.2 are bitwise equal to those of Debian's build on x86-64 Linux, even after a fall
//! with many impacts. Newer engines are linked from the wheel of the bindings. The tests assert
//! equal bits. On other platforms another libm may differ in the last bit of sine and cosine:
//! quantities of a single state are then compared to 1e-9 relative, finite differences to 1e-6, and
//! a trajectory for 300 steps, before impacts amplify the differences.

use std::sync::Arc;

use mujoco_safe::{Data, Differences, Matrix, Model, engine_version, sample};
use serde_json::Value;

/// True on the platform of the recording, whose libm gives the same bits.
const SAME_BITS: bool = cfg!(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu"));

/// Returns the recording for a model with the linked engine.
fn recorded(model: &str) -> Value {
    let file = format!("{}/tests/oracle/recorded/{}.json", env!("CARGO_MANIFEST_DIR"), engine_version());
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}; see record.py"));
    let recording: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(recording["engine"], engine_version().to_string());
    recording[model].clone()
}

fn models() -> [(&'static str, Arc<Model>); 2] {
    [("humanoid", Arc::new(sample::humanoid())), ("cartpole", Arc::new(sample::cartpole()))]
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("not a number: {value}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap_or_else(|| panic!("not an array: {value}")).iter().map(number).collect()
}

fn items(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("not an array: {value}"))
}

/// Asserts equal numbers, bit for bit if possible on this platform. Otherwise the largest
/// difference is compared relative to the largest number, or 1.
#[track_caller]
fn assert_same(what: &str, ours: &[f64], theirs: &[f64], tolerance: f64) {
    assert_equal(what, ours, theirs, if SAME_BITS { 0.0 } else { tolerance });
}

#[track_caller]
fn assert_equal(what: &str, ours: &[f64], theirs: &[f64], tolerance: f64) {
    assert_eq!(ours.len(), theirs.len(), "{what}: length");
    let size = theirs.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
    for (index, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
        assert!((ours - theirs).abs() <= tolerance * size, "{what}[{index}] is {ours}, not {theirs}");
    }
}

/// Resets to a recorded keyframe; the recording of the reference position has no name.
fn reset(data: &mut Data, keyframe: &str) {
    let result = if keyframe.is_empty() { data.reset() } else { data.reset_to_key(keyframe) };
    result.unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn sizes_equal_python() {
    for (name, model) in models() {
        let recorded = recorded(name);
        for (size, ours) in [
            ("nq", model.nq()),
            ("nv", model.nv()),
            ("nu", model.nu()),
            ("na", model.na()),
            ("nbody", model.nbody()),
            ("ngeom", model.ngeom()),
            ("nsensordata", model.nsensordata()),
        ] {
            assert_eq!(recorded["sizes"][size].as_u64(), Some(ours as u64), "{name}: {size}");
        }
    }
}

#[test]
fn trajectories_equal_python() {
    for (name, model) in models() {
        let recorded = recorded(name);
        let mut data = Data::new(model).unwrap();
        let mut samples = items(&recorded["trajectory"]).iter();
        for step in 0..1000 {
            for (index, ctrl) in data.ctrl_mut().iter_mut().enumerate() {
                *ctrl = 0.3 * (f64::from(step) * 0.1 + index as f64).sin();
            }
            data.step().unwrap();
            if (step + 1) % 50 != 0 {
                continue;
            }
            let sample = samples.next().expect("a sample for every 50 steps");
            if !SAME_BITS && step > 300 {
                break;
            }
            let what = format!("{name}, step {}", step + 1);
            assert_eq!(sample["step"].as_i64(), Some(i64::from(step + 1)));
            assert_same(&format!("{what}: time"), &[data.time()], &[number(&sample["time"])], 1e-12);
            assert_same(&format!("{what}: qpos"), data.qpos(), &numbers(&sample["qpos"]), 1e-9);
            assert_same(&format!("{what}: qvel"), data.qvel(), &numbers(&sample["qvel"]), 1e-9);
            assert_eq!(sample["ncon"].as_u64(), Some(data.ncon() as u64), "{what}: ncon");
        }
    }
}

#[test]
fn inverse_dynamics_equal_python() {
    for (name, model) in models() {
        let recorded = recorded(name);
        let mut data = Data::new(model).unwrap();
        for pose in items(&recorded["poses"]) {
            let keyframe = pose["keyframe"].as_str().unwrap();
            reset(&mut data, keyframe);
            data.forward().unwrap();
            data.qacc_mut().fill(0.0);
            data.inverse().unwrap();
            let what = format!("{name}, '{keyframe}': qfrc_inverse");
            assert_same(&what, data.qfrc_inverse(), &numbers(&pose["qfrc_inverse"]), 1e-9);
        }
    }
}

#[test]
fn contacts_equal_python() {
    for (name, model) in models() {
        let recorded = recorded(name);
        let mut data = Data::new(model.clone()).unwrap();
        for pose in items(&recorded["poses"]) {
            let keyframe = pose["keyframe"].as_str().unwrap();
            reset(&mut data, keyframe);
            data.forward().unwrap();
            let contacts = items(&pose["contacts"]);
            assert_eq!(data.contacts().len(), contacts.len(), "{name}, '{keyframe}'");
            for (contact, recorded) in data.contacts().zip(contacts) {
                let what = format!("{name}, '{keyframe}', contact {}", contact.index());
                let names = contact.geoms().unwrap().map(|geom| model.geom(geom).name());
                assert_eq!([recorded["geoms"][0].as_str(), recorded["geoms"][1].as_str()], names, "{what}");
                let force = contact.force().unwrap();
                assert_same(&what, &[contact.dist()], &[number(&recorded["dist"])], 1e-9);
                assert_same(&what, contact.pos(), &numbers(&recorded["pos"]), 1e-9);
                assert_same(&what, &[force.force, force.torque].concat(), &numbers(&recorded["force"]), 1e-9);
            }
        }
    }
}

#[test]
fn jacobians_equal_python() {
    for (name, model) in models() {
        let recorded = recorded(name);
        let mut data = Data::new(model.clone()).unwrap();
        data.reset_to_key(model.nkey() - 1).unwrap();
        data.forward().unwrap();
        let near = |what: &str, ours: &Matrix, theirs: &Value| {
            assert_eq!(ours.shape(), (3, model.nv()), "{what}");
            assert_same(what, ours.as_slice(), &numbers(theirs), 1e-12);
        };
        for (body, recorded) in recorded["jacobians"]["bodies"].as_object().unwrap() {
            let what = format!("{name}, body '{body}'");
            let id = model.body(body).unwrap();
            let frame = data.jac_body(id).unwrap();
            near(&what, &frame.linear, &recorded["translation"]);
            near(&what, &frame.angular, &recorded["rotation"]);
            near(&what, &data.jac_body_com(id).unwrap().linear, &recorded["com"]);
            near(&what, &data.jac_subtree_com(id).unwrap(), &recorded["subtree_com"]);
        }
        for (site, recorded) in recorded["jacobians"]["sites"].as_object().unwrap() {
            let what = format!("{name}, site '{site}'");
            let frame = data.jac_site(model.site(site).unwrap()).unwrap();
            near(&what, &frame.linear, &recorded["translation"]);
            near(&what, &frame.angular, &recorded["rotation"]);
        }
    }
}

#[test]
fn linearisations_equal_python() {
    for (name, model) in models() {
        let recorded = recorded(name);
        let mut data = Data::new(model).unwrap();
        if name == "humanoid" {
            reset(&mut data, "stand_on_left_leg");
        }
        let mut system = data.transition_fd(1e-6, Differences::Central).unwrap();
        // The differences of sensors by older engines have the wrong sign; the library corrects it.
        if cfg!(not(engine_since = "4.0.0")) {
            system.d.as_mut_slice().iter_mut().for_each(|value| *value = -*value);
        }
        // From 3.12 on, the library lets the solver converge further for differences.
        let tolerance = if SAME_BITS && cfg!(not(engine_since = "3.12.0")) { 0.0 } else { 1e-6 };
        let recorded = &recorded["linearisation"];
        for (what, ours) in [("a", &system.a), ("b", &system.b), ("c", &system.c), ("d", &system.d)] {
            assert_equal(&format!("{name}: {what}"), ours.as_slice(), &numbers(&recorded[what]), tolerance);
        }
    }
}
