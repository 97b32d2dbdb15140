//! Steps, and their initial states.

use std::sync::Arc;

use mujoco_safe::data::{UnstableField, Warning};
use mujoco_safe::enums::{Cone, Integrator, Solver};
use mujoco_safe::model::EnableFlags;
use mujoco_safe::{Error, Model, sample, sys};

use crate::cases::cases;
use crate::trouble;
use crate::twins::{Subject, Twins, c, differing, read, subjects, usual_subjects};

/// Returns a number of steps that takes a second at most.
fn steps(subject: &Subject) -> usize {
    match subject.model.nv() {
        0..=60 => cases(50, 500),
        61..=400 => cases(10, 100),
        401..=1000 => cases(5, 20),
        _ => cases(3, 10),
    }
}

#[test]
fn a_trajectory_with_random_controls_equals_c() {
    for subject in subjects() {
        let mut twins = Twins::new(subject);
        twins.shake();
        let steps = steps(subject);
        for step in 1..=steps {
            twins.control();
            twins.step();
            twins.assert_same_state(&format!("after step {step}"));
        }
        twins.assert_same_dynamics("at the end");
        println!("{}: {steps} steps, {} contacts at the end", twins.name, twins.ours.ncon());
    }
}

#[test]
fn trajectories_with_every_integrator_solver_and_cone_equal_c() {
    for integrator in [Integrator::Euler, Integrator::Rk4, Integrator::Implicit] {
        for solver in [Solver::Pgs, Solver::Cg, Solver::Newton] {
            for cone in [Cone::Pyramidal, Cone::Elliptic] {
                let mut model = sample::humanoid();
                let changed = model.edit().edit_options(|options| {
                    (options.integrator, options.solver, options.cone) = (integrator, solver, cone);
                });
                changed.unwrap();
                let name = format!("humanoid with {integrator:?}, {solver:?}, {cone:?}");
                let mut twins = Twins::new(&Subject { name, model: Arc::new(model) });
                let mut contacts = 0;
                for step in 1..=200 {
                    twins.control();
                    twins.step();
                    twins.assert_same_state(&format!("after step {step}"));
                    contacts += twins.ours.ncon();
                }
                assert!(contacts > 0, "{} must reach the ground", twins.name);
            }
        }
    }
}

/// Returns the contents of the arrays of a data, except contacts: the engine copies uninitialised
/// parts of local variables to them. Since 2.3 contacts are not among these arrays.
fn arrays(data: &sys::mjData, model: &Model) -> Vec<u8> {
    let length = usize::try_from(data.nbuffer).unwrap();
    // SAFETY: the buffer has this length, and the engine zeroes all of it on creation.
    let mut bytes = unsafe { read(data.buffer.cast::<u8>(), 0, length) };
    if cfg!(not(engine_since = "2.3.0")) {
        let contacts = data.contact as usize - data.buffer as usize;
        let room = model.nconmax() * size_of::<sys::mjContact>();
        bytes.drain(contacts..contacts + room);
    }
    bytes
}

/// The library's step is not a call of `mj_step`, so it must have all of its effects.
#[test]
fn a_step_writes_the_same_bytes_as_c() {
    for integrator in [Integrator::Euler, Integrator::Rk4, Integrator::Implicit] {
        for enable in [EnableFlags::empty(), EnableFlags::ENERGY | EnableFlags::FWDINV] {
            let mut model = sample::humanoid();
            let changed =
                model.edit().edit_options(|options| (options.integrator, options.enable) = (integrator, enable));
            changed.unwrap();
            let name = format!("humanoid with {integrator:?} and {enable:?}");
            let mut twins = Twins::new(&Subject { name: name.clone(), model: Arc::new(model) });
            let (mut contacts, mut differences) = (0, 0.0);
            for _ in 0..200 {
                twins.control();
                twins.step();
                assert_eq!(twins.ours.solver_fwdinv(), twins.raw.data().solver_fwdinv, "{name}");
                contacts += twins.ours.ncon();
                differences += twins.ours.solver_fwdinv()[1];
            }
            assert!(contacts > 0, "{name} must reach the ground");
            assert_eq!(differences > 0.0, enable.contains(EnableFlags::FWDINV), "{name}");
            // SAFETY: the library's data is valid, and nothing writes to it during the borrow.
            let (ours, raw) = (unsafe { &*twins.ours.as_ptr() }, twins.raw.data());
            assert_eq!(ours.nbuffer, raw.nbuffer);
            assert!(arrays(ours, &twins.model) == arrays(raw, &twins.model), "{name}: the arrays");
            assert_eq!((ours.time, ours.energy), (raw.time, raw.energy), "{name}");
            assert_eq!(
                (differing::solver_iterations(ours), ours.maxuse_con, ours.maxuse_efc),
                (differing::solver_iterations(raw), raw.maxuse_con, raw.maxuse_efc)
            );
            assert_eq!(ours.maxuse_stack, raw.maxuse_stack, "{name}");
            assert_eq!(ours.timer.map(|timer| timer.number), raw.timer.map(|timer| timer.number), "{name}");
            assert_eq!(ours.timer[sys::mjTIMER_STEP as usize].number, 200, "{name}");
        }
    }
}

#[test]
fn an_acceleration_out_of_range_is_detected_as_in_c() {
    for index in [0, 6, sample::humanoid().nv() - 1] {
        let mut twins = Twins::new(&Subject { name: "humanoid".to_owned(), model: Arc::new(sample::humanoid()) });
        let mut force = vec![0.0; twins.model.nv()];
        force[index] = 1e300;
        twins.ours.qfrc_applied_mut().copy_from_slice(&force);
        twins.raw.write(|d| d.qfrc_applied, &force);
        c!(mj_step(twins.raw.m(), twins.raw.d));
        let warning = twins.raw.data().warning[sys::mjWARN_BADQACC as usize];
        assert!(warning.number == 1, "the engine has reset the simulation");
        match twins.ours.step() {
            Err(Error::Unstable(found)) => {
                assert_eq!((found.field, found.index as i32), (UnstableField::Acceleration, warning.lastinfo));
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn step1_and_step2_equal_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::new(subject);
        twins.shake();
        for step in 1..=steps(subject) / 10 {
            twins.ours.step1().unwrap();
            c!(mj_step1(twins.raw.m(), twins.raw.d));
            twins.assert_same_state(&format!("in the middle of step {step}"));
            twins.control();
            twins.ours.step2().unwrap();
            // SAFETY: a model and its data.
            unsafe { differing::step2(twins.raw.m(), twins.raw.d) };
            twins.assert_same_state(&format!("after step {step}"));
        }
        twins.assert_same_dynamics("at the end");
    }
}

#[test]
fn forward_dynamics_equal_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        twins.assert_same_dynamics("in motion");
        twins.control();
        twins.shake();
        twins.forward();
        twins.assert_same_state("shaken");
        twins.assert_same_dynamics("shaken");
    }
}

#[test]
fn inverse_dynamics_equal_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        let nv = twins.model.nv();
        let accelerations = twins.numbers(nv);
        twins.ours.qacc_mut().copy_from_slice(&accelerations);
        twins.raw.write(|d| d.qacc, &accelerations);
        twins.ours.inverse().unwrap();
        c!(mj_inverse(twins.raw.m(), twins.raw.d));
        let theirs = twins.raw.values(|d| d.qfrc_inverse, nv);
        crate::twins::assert_same(&twins.name, twins.ours.qfrc_inverse(), &theirs);
        twins.assert_same_dynamics("after inverse");
    }
}

#[test]
fn a_reset_equals_c() {
    for subject in usual_subjects() {
        let mut twins = Twins::in_motion(subject);
        twins.ours.reset().unwrap();
        c!(mj_resetData(twins.raw.m(), twins.raw.d));
        twins.assert_same_state("after reset");
        for key in 0..twins.model.nkey() {
            twins.shake();
            twins.control();
            twins.step();
            twins.ours.reset_to_key(key).unwrap();
            c!(mj_resetDataKeyframe(twins.raw.m(), twins.raw.d, key as i32));
            let when = format!("after reset to keyframe {key}");
            twins.assert_same_state(&when);
            let nmocap = twins.model.nmocap();
            let (pos, quat) =
                (twins.raw.values(|d| d.mocap_pos, 3 * nmocap), twins.raw.values(|d| d.mocap_quat, 4 * nmocap));
            crate::twins::assert_same(&when, twins.ours.mocap_pos().as_flattened(), &pos);
            crate::twins::assert_same(&when, twins.ours.mocap_quat().as_flattened(), &quat);
            twins.forward();
            twins.assert_same_dynamics(&when);
        }
    }
}

/// Returns models in which the engine raises a warning in many steps, with the engine's number of
/// the warning.
fn warning_models() -> Vec<(&'static str, Model, Warning, u32)> {
    // Since 2.3 the limits of contacts and constraints have no effect.
    if cfg!(engine_since = "2.3.0") {
        let (model, warning) = trouble::warning();
        let number = if warning == Warning::Inertia { sys::mjWARN_INERTIA } else { sys::mjWARN_CONTACTFULL };
        return vec![("warning", model, warning, number)];
    }
    let humanoid = |size: &str| {
        Model::from_xml_str(&sample::HUMANOID_XML.replacen("<option ", &format!("{size}<option "), 1)).unwrap()
    };
    let contacts = humanoid(r#"<size nconmax="2" njmax="500"/>"#);
    let constraints = humanoid(r#"<size nconmax="100" njmax="5"/>"#);
    vec![
        ("humanoid with two contacts", contacts, Warning::ContactFull, sys::mjWARN_CONTACTFULL),
        ("humanoid with five constraints", constraints, Warning::ConstraintFull, sys::mjWARN_CNSTRFULL),
    ]
}

#[test]
fn warnings_are_counted_as_in_c() {
    for (name, model, warning, number) in warning_models() {
        let mut twins = Twins::new(&Subject { name: name.to_owned(), model: Arc::new(model) });
        for step in 1..=300 {
            twins.control();
            twins.step();
            let counted = twins.ours.warning(warning);
            let stat = twins.raw.data().warning[number as usize];
            assert_eq!(counted.number, stat.number as usize, "{}, step {step}", twins.name);
            assert_eq!(counted.lastinfo, stat.lastinfo, "{}, step {step}", twins.name);
            twins.assert_same_state(&format!("after step {step}"));
        }
        assert!(twins.ours.warning(warning).number > 10, "{}: {warning} is raised", twins.name);
    }
}
