//! Promises that hold with every supported engine: the smallest set of tests for a new one. The
//! independent sources are the C functions of the same engine, called directly, and identities of
//! mechanics.

#![allow(clippy::disallowed_methods, reason = "the engine's arrays are read without the library")]

#[macro_use]
#[path = "../common/fields.rs"]
mod fields;

#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/child.rs"]
mod child;

#[path = "../common/installed.rs"]
mod installed;

#[cfg(any(not(engine_since = "2.3.0"), engine_since = "3.5.0"))]
#[path = "../common/schema_models/mod.rs"]
mod schema_models;

// Its expectations are those of the arena of 3.5 and later.
#[cfg(engine_since = "3.5.0")]
mod arena;
mod shapes;

use std::sync::Arc;

use mujoco_safe::derivative::{Fallback, TransitionMethod, TransitionOptions};
use mujoco_safe::element::EqualityObjects;
use mujoco_safe::enums::Integrator;
use mujoco_safe::sys::{self, mjData};
use mujoco_safe::{Controller, Data, Differences, Error, Lineariser, Lqr, LqrWeights, Model, StateSpace, sample};

/// A direct call of the C API.
macro_rules! c {
    ($function:ident($($argument:expr),* $(,)?)) => {
        // SAFETY: the tests pass a model with its own data, and arrays of the engine's sizes.
        unsafe { sys::$function($($argument),*) }
    };
}

#[cfg(engine_since = "3.17.0")]
mod addresses;
mod collision_table;
#[cfg(engine_since = "3.17.0")]
mod controls;
#[cfg(engine_since = "3.5.0")]
mod copies;
#[cfg(engine_since = "3.5.0")]
mod engine_functions;
#[cfg(engine_since = "3.0.0")]
mod flex;
mod grasp;
#[cfg(engine_since = "3.5.0")]
mod history;
mod mesh;
mod newer;
mod newer_fields;
mod newer_functions;
mod platforms;
// Before, texts name plugins by another element.
#[cfg(engine_since = "2.3.3")]
mod plugin;
// The wheels have a plugin with a state since 3.1, whose size a text can state since 3.2.
#[cfg(engine_since = "3.2.0")]
mod plugin_state;
mod real_models;
mod scenes;
// With other engines, the compiler crashes on some of these models.
#[cfg(tested_in_full)]
mod schema;
#[cfg(engine_since = "3.0.0")]
mod signed_distance;
#[cfg(engine_since = "3.5.0")]
mod sleep;

/// A data of the C API.
struct Raw(*mut mjData);

impl Drop for Raw {
    fn drop(&mut self) {
        c!(mj_deleteData(self.0));
    }
}

fn squatting() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data
}

fn is_newer() -> bool {
    sys::mjVERSION_HEADER > 222
}

#[test]
fn the_engine_at_run_time_has_the_version_of_the_headers() {
    assert_eq!(mujoco_safe::engine_version(), mujoco_safe::built_against());
    // SAFETY: a constant string of the engine.
    let text = unsafe { std::ffi::CStr::from_ptr(sys::mj_versionString()) };
    assert_eq!(mujoco_safe::engine_version().to_string(), text.to_str().unwrap());
}

#[test]
fn a_trajectory_with_contacts_equals_that_of_the_c_functions_bit_for_bit() {
    for integrator in [Integrator::Euler, Integrator::Rk4, Integrator::Implicit] {
        let mut model = sample::humanoid();
        model.edit().edit_options(|options| options.integrator = integrator).unwrap();
        let mut data = Data::new(model).unwrap();
        let model = data.model().clone();
        let raw = Raw(c!(mj_makeData(model.as_ptr())));
        data.reset_to_key("squat").unwrap();
        let squat = c!(mj_name2id(model.as_ptr(), sys::mjOBJ_KEY as i32, c"squat".as_ptr()));
        c!(mj_resetDataKeyframe(model.as_ptr(), raw.0, squat));
        let mut contacts = 0;
        for step in 0..200 {
            for actuator in 0..model.nu() {
                let control = f64::sin(0.1 * f64::from(step) + actuator as f64);
                data.ctrl_mut()[actuator] = control;
                // SAFETY: the array has nu numbers.
                unsafe { *(*raw.0).ctrl.add(actuator) = control };
            }
            data.step().unwrap();
            c!(mj_step(model.as_ptr(), raw.0));
            contacts += data.ncon();
            // SAFETY: the arrays have nq and nv numbers.
            let (qpos, qvel) = unsafe {
                (
                    std::slice::from_raw_parts((*raw.0).qpos, model.nq()),
                    std::slice::from_raw_parts((*raw.0).qvel, model.nv()),
                )
            };
            assert_eq!((data.qpos(), data.qvel()), (qpos, qvel), "{integrator:?}, step {step}");
        }
        assert!(contacts > 0);
    }
}

#[test]
fn elements_are_found_by_name_and_a_wrong_name_lists_similar_ones() {
    let data = squatting();
    assert_eq!(data.model().body("torso").unwrap().name(), Some("torso"));
    assert_eq!(data.joint("root").unwrap().qpos().len(), 7);
    let error = data.model().body("tors").unwrap_err();
    assert!(error.to_string().contains("torso"), "{error}");
}

#[test]
fn the_moments_map_actuator_forces_to_joint_forces() {
    let mut data = squatting();
    data.ctrl_mut().fill(0.3);
    data.forward().unwrap();
    let mut forces = vec![0.0; data.model().nv()];
    for actuator in data.model().actuators() {
        let actuator = data.actuator(actuator.id());
        for (dof, moment) in actuator.moment().iter() {
            forces[dof] += moment * actuator.force();
        }
    }
    assert!(forces.iter().any(|force| *force != 0.0));
    for (ours, engine) in forces.iter().zip(data.qfrc_actuator()) {
        assert!((ours - engine).abs() < 1e-12, "{ours} {engine}");
    }
}

#[test]
fn velocities_of_actuators_and_tendons_are_those_of_the_engine() {
    let mut data = Data::new(Model::from_xml_str(TENDONS).unwrap()).unwrap();
    for dense in [true, false] {
        let storage = if dense {
            mujoco_safe::enums::JacobianStorage::Dense
        } else {
            mujoco_safe::enums::JacobianStorage::Sparse
        };
        data.edit_model(|model| model.edit_options(|options| options.jacobian = storage)).unwrap();
        data.qvel_mut().copy_from_slice(&[0.3, -0.7, 0.2]);
        data.forward().unwrap();
        let expected = (data.ten_velocity().to_vec(), data.actuator_velocity().to_vec());
        assert!(expected.0.iter().chain(&expected.1).all(|velocity| *velocity != 0.0));
        data.compute_ten_velocity().unwrap();
        data.compute_actuator_velocity().unwrap();
        for (ours, engine) in
            data.ten_velocity().iter().chain(data.actuator_velocity()).zip(expected.0.iter().chain(&expected.1))
        {
            assert!((ours - engine).abs() < 1e-14, "{ours} {engine}");
        }
    }
}

const TENDONS: &str = r#"
<mujoco>
  <worldbody>
    <body><joint name="a" axis="0 1 0"/><geom type="capsule" size="0.05" fromto="0 0 0 0 0 1"/>
      <body pos="0 0 1"><joint name="b" axis="0 1 0"/><geom type="capsule" size="0.05" fromto="0 0 0 0 0 1"/><site name="tip" pos="0 0 1"/></body>
    </body>
    <body pos="1 0 0"><joint name="c" type="slide" axis="0 0 1"/><geom size="0.1"/><site name="anchor"/></body>
  </worldbody>
  <tendon>
    <fixed name="fixed"><joint joint="a" coef="1"/><joint joint="b" coef="-0.5"/></fixed>
    <spatial name="spatial"><site site="tip"/><site site="anchor"/></spatial>
  </tendon>
  <actuator>
    <motor name="first" joint="c"/>
    <general name="second" tendon="spatial" dyntype="integrator" gainprm="2"/>
    <general name="third" tendon="fixed" dyntype="filter" dynprm="0.1"/>
  </actuator>
  <equality><joint joint1="a" joint2="c" active="false"/></equality>
</mujoco>"#;

#[test]
fn activations_belong_to_the_actuators_with_dynamics() {
    let mut data = Data::new(Model::from_xml_str(TENDONS).unwrap()).unwrap();
    let model = data.model().clone();
    let activation = |name: &str| model.actuator(name).unwrap().activation();
    assert_eq!((activation("first"), activation("second"), activation("third")), (None, Some(0), Some(1)));
    data.ctrl_mut().copy_from_slice(&[0.0, 1.0, 0.0]);
    data.step().unwrap();
    // The activation of an integrator is the integral of its control.
    assert_eq!(data.actuator("second").unwrap().act(), Some(model.timestep()));
    assert_eq!(data.actuator("third").unwrap().act(), Some(0.0));
}

#[test]
fn equality_constraints_are_switched_on_and_off() {
    let mut model = Model::from_xml_str(TENDONS).unwrap();
    let equality = model.equalities().next().unwrap().id();
    assert!(matches!(model.equality(equality).objects(), EqualityObjects::Joints(..)));
    for active in [false, true] {
        model.edit().equality_mut(equality).set_active(active);
        assert_eq!(model.equality(equality).active(), active);
        let mut data = Data::new(model.clone()).unwrap();
        data.forward().unwrap();
        assert_eq!(data.ne(), usize::from(active));
        // An edit of the model of a simulation switches the constraint in the simulation.
        data.edit_model(|model| model.equality_mut(equality).set_active(!active)).unwrap();
        data.forward().unwrap();
        assert_eq!(data.ne(), usize::from(!active));
    }
}

#[test]
fn products_with_the_inertia_matrix_agree() {
    let mut data = squatting();
    data.forward().unwrap();
    let nv = data.model().nv();
    let full = data.full_m().unwrap();
    let vector: Vec<f64> = (0..nv).map(|dof| f64::cos(dof as f64)).collect();
    let (mut product, mut root, mut solved) = (vec![0.0; nv], vec![0.0; nv], vec![0.0; nv]);
    data.mul_m_into(&vector, &mut product).unwrap();
    data.mul_m2_into(&vector, &mut root).unwrap();
    data.solve_m_into(&product, &mut solved).unwrap();
    for row in 0..nv {
        let expected: f64 = (0..nv).map(|column| full[(row, column)] * vector[column]).sum();
        assert!((expected - product[row]).abs() < 1e-12 * (1.0 + expected.abs()));
        assert!((solved[row] - vector[row]).abs() < 1e-9);
    }
    // vᵀ M v is the squared norm of a square root's product.
    let energy: f64 = vector.iter().zip(&product).map(|(a, b)| a * b).sum();
    let squared: f64 = root.iter().map(|value| value * value).sum();
    assert!((energy - squared).abs() < 1e-10 * energy, "{energy} {squared}");
    // vᵀ M⁻¹ v likewise.
    data.solve_m2_into(&vector, &mut root).unwrap();
    data.solve_m_into(&vector, &mut solved).unwrap();
    let inverse: f64 = vector.iter().zip(&solved).map(|(a, b)| a * b).sum();
    let squared: f64 = root.iter().map(|value| value * value).sum();
    assert!((inverse - squared).abs() < 1e-9 * inverse, "{inverse} {squared}");
}

#[test]
fn the_linearisation_equals_that_of_the_engine() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let ours = data.transition_fd(1e-6, Differences::Central).unwrap();
    let raw = Raw(c!(mj_makeData(data.model().as_ptr())));
    let (mut a, mut b) = (vec![0.0; 16], vec![0.0; 4]);
    let none = std::ptr::null_mut();
    c!(mjd_transitionFD(data.model().as_ptr(), raw.0, 1e-6, 1, a.as_mut_ptr(), b.as_mut_ptr(), none, none));
    assert_eq!((ours.a.as_slice(), ours.b.as_slice()), (&a[..], &b[..]));
}

#[test]
fn implicit_differentiation_agrees_with_differences_of_a_step() {
    let mut data = squatting();
    // In the air: the result of the solver at a contact has its tolerance, which differences of a
    // step magnify.
    data.qpos_mut()[2] += 1.0;
    data.ctrl_mut().fill(0.2);
    data.step().unwrap();
    let linearise = |method| {
        let options = TransitionOptions::default().with_method(method);
        let mut lineariser = Lineariser::new(data.model().clone(), options).unwrap();
        let mut system = StateSpace::zeros(data.model());
        let report = lineariser.linear_system_into(&mut data.clone(), &mut system).unwrap();
        (system, report)
    };
    let (implicit, report) = linearise(TransitionMethod::Implicit);
    let (differences, _) = linearise(TransitionMethod::Columns);
    // With an engine with which the formulas were not verified, the report says that the steps were
    // differenced.
    let is_verified = report.fallback != Some(Fallback::EngineVersion);
    assert_eq!(is_verified, cfg!(tested_in_full));
    assert_eq!(report.method, if is_verified { TransitionMethod::Implicit } else { TransitionMethod::Columns });
    let scale = differences.a.as_slice().iter().fold(0.0, |scale: f64, value| scale.max(value.abs()));
    for (one, other) in implicit.a.as_slice().iter().zip(differences.a.as_slice()) {
        assert!((one - other).abs() < 1e-5 * scale, "{one} {other}, scale {scale}");
    }
}

#[test]
fn an_lqr_balances_the_pole() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let system = data.transition_fd(1e-6, Differences::Central).unwrap();
    let solution = Lqr::solve(&system, &LqrWeights::diagonal(&[1.0, 10.0, 1.0, 5.0], &[1.0])).unwrap();
    let mut lqr = Lqr::with_gain(&data, solution.k).unwrap();
    data.joint_mut("hinge").unwrap().qpos_mut()[0] = 0.3;
    for _ in 0..(10.0 / data.model().timestep()) as usize {
        lqr.control(&mut data).unwrap();
        data.step().unwrap();
    }
    assert!(data.qpos()[1].abs() < 0.01 && data.qvel()[1].abs() < 0.01, "{:?}", data.qpos());
}

#[test]
fn an_engine_error_poisons_the_data_until_a_reset() {
    let mut data = squatting();
    data.step().unwrap();
    assert!(data.ncon() > 0);
    let model: *mut sys::mjModel = data.model().as_ptr().cast_mut();
    // SAFETY: no other thread uses the model. The engine checks the type of the solver while its
    // stack is in use.
    unsafe { (*model).opt.solver = 99 };
    let error = data.step().unwrap_err();
    assert!(
        matches!(&error, Error::Engine { message, .. } if message.to_lowercase().contains("unknown solver")),
        "{error}"
    );
    assert!(matches!(data.step(), Err(Error::Poisoned { .. })));
    // The counts and arrays of the failed call agree.
    assert_eq!(data.contacts().count(), data.ncon());
    if is_newer() {
        assert_eq!((data.ncon(), data.nefc(), data.efc_force().len()), (0, 0, 0));
    }
    assert!(data.clone().contacts().count() == data.ncon());
    // SAFETY: as above.
    unsafe { (*model).opt.solver = sys::mjSOL_NEWTON as i32 };
    data.reset_to_key("squat").unwrap();
    data.step().unwrap();
    let mut twin = squatting();
    twin.step().unwrap();
    assert_eq!(data.qpos(), twin.qpos());
}

#[test]
fn a_clone_and_a_rollout_continue_like_the_original() {
    let mut data = squatting();
    for _ in 0..10 {
        data.step().unwrap();
    }
    let mut copy = data.clone();
    for _ in 0..50 {
        data.step().unwrap();
        copy.step().unwrap();
    }
    assert_eq!((data.qpos(), data.qvel(), data.ncon()), (copy.qpos(), copy.qvel(), copy.ncon()));
}

#[test]
fn accessors_of_arrays_that_do_not_exist_are_empty() {
    let data = Data::new(sample::humanoid()).unwrap();
    // No constraint exists before the first computation.
    assert_eq!((data.nefc(), data.efc_force().len(), data.efc_pos().len(), data.contacts().count()), (0, 0, 0, 0));
}

#[test]
fn binary_models_load_where_their_rules_are_known_and_are_rejected_elsewhere() {
    let bytes = sample::cartpole().to_binary().unwrap();
    match Model::from_binary(&bytes) {
        Ok(model) => assert!(cfg!(validates_binaries) && model.nv() == 2),
        Err(error) => assert!(cfg!(not(validates_binaries)) && matches!(error, Error::Unsupported(_)), "{error}"),
    }
}

#[test]
fn a_trusted_binary_model_loads_with_every_engine() {
    let bytes = sample::humanoid().to_binary().unwrap();
    // SAFETY: the bytes of a compiled model, of the same engine.
    let model = unsafe { Model::from_binary_unchecked(&bytes) }.unwrap();
    assert_eq!(model.to_binary().unwrap(), bytes);

    // SAFETY: the engine compares the first numbers with its own before it uses the others.
    let error = unsafe { Model::from_binary_unchecked(&[0; 4096]) }.unwrap_err();
    assert!(matches!(error, Error::InvalidBinary { .. }), "{error}");
}

#[test]
fn unsupported_features_of_newer_engines_are_rejected_with_a_reason() {
    let ipc = r#"<mujoco><option integrator="discrete"><flag ipc="enable"/></option></mujoco>"#;
    let error = Model::from_xml_str(ipc).unwrap_err();
    assert!(matches!(error, Error::Load { .. }), "{error}");
    if cfg!(engine_since = "4.0.0") {
        assert!(error.to_string().contains("the option ipc is enabled"), "{error}");
    }
}

#[test]
fn an_edit_of_the_options_keeps_those_that_this_crate_does_not_know() {
    let mut model = sample::cartpole();
    let raw = model.as_ptr().cast_mut();
    // SAFETY: nothing else uses the model. The bit is none of those in `DisableFlags`.
    let before = unsafe {
        (*raw).opt.disableflags |= if is_newer() { 1 << 21 } else { 0 };
        (*raw).opt.disableflags
    };
    model.edit().edit_options(|options| options.timestep = 0.003).unwrap();
    // SAFETY: as above.
    assert_eq!(unsafe { ((*raw).opt.disableflags, (*raw).opt.timestep) }, (before, 0.003));
}

#[cfg(feature = "renderer")]
#[test]
fn a_picture_shows_the_textured_floor_and_the_humanoid() {
    use mujoco_safe::render::Renderer;
    let mut data = squatting();
    data.forward().unwrap();
    let mut renderer = Renderer::new(data.model(), 160, 120).unwrap();
    let picture = renderer.snapshot(&mut data, "side").unwrap().rgb().unwrap();
    let mut colours: Vec<[u8; 3]> = picture.as_bytes().as_chunks().0.to_vec();
    colours.sort_unstable();
    colours.dedup();
    assert!(colours.len() > 100, "only {} colours", colours.len());
}

#[test]
fn the_model_is_shared_between_threads() {
    let model = Arc::new(sample::humanoid());
    let run = || {
        let mut data = Data::new(model.clone()).unwrap();
        data.reset_to_key("squat").unwrap();
        for _ in 0..100 {
            data.step().unwrap();
        }
        data.qpos().to_vec()
    };
    let alone = run();
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(run)).collect();
        for thread in threads {
            assert_eq!(thread.join().unwrap(), alone);
        }
    });
}
