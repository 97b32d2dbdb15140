//! Actuators with several controls, forces and activations. The independent sources are the C
//! functions of the same engine and its arrays.

use mujoco_safe::callback::Callbacks;
use mujoco_safe::derivative::{InverseForce, TransitionOptions};
use mujoco_safe::element::Transmission;
use mujoco_safe::{Batch, Controller, Data, Differences, Error, Lineariser, Model, PdController, StateSpec, sys};

use super::Raw;

/// A ball joint with an orientation servo (three controls and forces), a hinge with a PID servo
/// (two controls, one activation) and a motor with two activations, and a plain motor.
const MODEL: &str = r#"<mujoco>
  <compiler angle="radian"/>
  <option gravity="0 0 -1"/>
  <worldbody>
    <body><joint name="ball" type="ball" damping=".1"/><geom size=".1" pos="0 0 .2"/>
      <body pos="0 0 .4"><joint name="hinge" axis="0 1 0" damping=".1"/><geom size=".1" pos=".2 0 0"/></body></body>
  </worldbody>
  <actuator>
    <motor name="first" joint="hinge" gear="2"/>
    <orientation name="turn" joint="ball" kp="3"/>
    <pid name="servo" joint="hinge" kp="5" ki="1" kv=".5"/>
    <dcmotor name="dc" joint="hinge" motorconst=".1 .1" resistance="1" inductance=".1" thermal="1 1"/>
    <motor name="last" joint="hinge" gear="3" ctrlrange="-.5 .5"/>
  </actuator>
  <sensor><actuatorfrc actuator="turn"/><actuatorfrc actuator="last"/></sensor>
</mujoco>"#;

fn model() -> Model {
    Model::from_xml_str(MODEL).unwrap()
}

fn control(step: usize, index: usize) -> f64 {
    0.3 * f64::sin(0.05 * step as f64 + index as f64)
}

#[test]
fn views_have_the_ranges_of_their_actuators() {
    let mut data = Data::new(model()).unwrap();
    let model = data.model().clone();
    let raw = model.as_ptr();
    assert_eq!((model.nactuator(), model.nu(), model.actuators().count()), (5, 8, 5));
    for (index, actuator) in model.actuators().enumerate() {
        // SAFETY: the arrays of a living model have a row for each actuator.
        let at = |array: *const i32| usize::try_from(unsafe { *array.add(index) }).unwrap_or(0);
        // SAFETY: the pointers of a living model.
        let [first, count] = unsafe { [(*raw).actuator_ctrladr, (*raw).actuator_ctrlnum].map(|array| at(array)) };
        assert_eq!(actuator.controls(), first..first + count);
        // SAFETY: as above.
        let [first, count] = unsafe { [(*raw).actuator_outadr, (*raw).actuator_outnum].map(|array| at(array)) };
        assert_eq!(actuator.outputs(), first..first + count);
        // SAFETY: as above.
        let [first, count] = unsafe { [(*raw).actuator_actadr, (*raw).actuator_actnum].map(|array| at(array)) };
        assert_eq!(actuator.activations(), first..first + count);
    }
    let ball = model.joint("ball").unwrap().id();
    assert_eq!(model.actuator("turn").unwrap().transmission(), Transmission::JointOrientation(ball));
    let last = model.actuator("last").unwrap();
    assert_eq!((last.gear()[0], last.ctrlrange(), last.ctrllimited()), (3.0, &[-0.5, 0.5], true));
    assert_eq!((last.controls(), last.outputs(), last.activations()), (7..8, 6..7, 0..0));

    data.actuator_mut("last").unwrap().set_ctrl(0.4);
    data.actuator_mut("turn").unwrap().ctrls_mut().copy_from_slice(&[0.1, 0.2, 0.3]);
    assert_eq!(data.ctrl(), [0.0, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 0.4]);
    data.forward().unwrap();
    let forces = data.actuator_force().to_vec();
    assert_eq!(data.actuator("turn").unwrap().forces(), &forces[1..4]);
    assert_eq!(data.actuator("last").unwrap().force(), forces[6]);
    assert_eq!(data.actuator("last").unwrap().force(), 0.4);
    assert_eq!(data.actuator("dc").unwrap().acts().len(), 2);

    // The moments are those of the forces.
    let moment = data.full_moment().unwrap();
    for dof in 0..model.nv() {
        let force: f64 = forces.iter().enumerate().map(|(output, force)| moment[(output, dof)] * force).sum();
        assert!((force - data.qfrc_actuator()[dof]).abs() < 1e-12, "{dof}");
    }
    // The velocities are those of the forces, not of the more numerous controls.
    data.qvel_mut().copy_from_slice(&[0.1, 0.2, 0.3, 0.4]);
    data.forward().unwrap();
    let velocities = data.actuator_velocity().to_vec();
    data.compute_actuator_velocity().unwrap();
    assert_eq!((data.actuator_velocity(), velocities.len()), (&velocities[..], 7));
    data.ctrl_mut()[6] = f64::NAN;
    let error = data.step().unwrap_err().to_string();
    assert!(error.contains("ctrl[6] of actuator 'dc'"), "{error}");
}

#[test]
fn a_trajectory_equals_that_of_the_c_functions_bit_for_bit() {
    let mut data = Data::new(model()).unwrap();
    let model = data.model().clone();
    let raw = Raw(c!(mj_makeData(model.as_ptr())));
    for step in 0..300 {
        for index in 0..model.nu() {
            data.ctrl_mut()[index] = control(step, index);
            // SAFETY: the array has nu numbers, and nothing else uses the data.
            unsafe { *(*raw.0).ctrl.add(index) = control(step, index) };
        }
        data.step().unwrap();
        c!(mj_step(model.as_ptr(), raw.0));
        // SAFETY: arrays of a living data with these lengths.
        let (qpos, act) = unsafe {
            (
                std::slice::from_raw_parts((*raw.0).qpos, model.nq()),
                std::slice::from_raw_parts((*raw.0).act, model.na()),
            )
        };
        assert_eq!((data.qpos(), data.act()), (qpos, act), "step {step}");
    }
    // States and copies contain all controls and activations.
    let state = data.state(StateSpec::INTEGRATION);
    let mut copy = Data::new(model).unwrap();
    copy.set_state(StateSpec::INTEGRATION, &state).unwrap();
    for data in [&mut data, &mut copy] {
        data.step().unwrap();
    }
    assert_eq!(data.qpos(), copy.qpos());
}

#[test]
fn the_linear_system_is_that_of_the_engine() {
    let mut data = Data::new(model()).unwrap();
    let model = data.model().clone();
    for step in 0..50 {
        for index in 0..model.nu() {
            data.ctrl_mut()[index] = control(step, index);
        }
        data.step().unwrap();
    }
    let raw = Raw(c!(mj_makeData(model.as_ptr())));
    c!(mj_copyData(raw.0, model.as_ptr(), data.as_ptr()));
    let (nx, nu) = (2 * model.nv() + model.na(), model.nu());
    let (mut a, mut b) = (vec![0.0; nx * nx], vec![0.0; nx * nu]);
    let null = std::ptr::null_mut;
    c!(mjd_transitionFD(model.as_ptr(), raw.0, 1e-6, 1, a.as_mut_ptr(), b.as_mut_ptr(), null(), null()));
    let ours = data.transition_fd(1e-6, Differences::Central).unwrap();
    assert_eq!((ours.a.as_slice(), ours.b.as_slice()), (&a[..], &b[..]));
    // The other methods do not know these actuators, and fall back.
    let mut lineariser = Lineariser::new(&model, TransitionOptions::default()).unwrap();
    let (other, _) = lineariser.linear_system(&mut data).unwrap();
    assert!(other.b.as_slice().iter().zip(&b).all(|(x, y)| (x - y).abs() < 1e-4));
    assert!(matches!(PdController::new(&model, 1.0, 0.0).control(&mut data), Err(Error::Unsupported(_))));
}

/// The orientation servo has three forces, after which the index of an actuator is not that of its
/// force.
#[test]
fn sensors_of_actuators_are_differentiated_at_the_place_of_their_force() {
    let sensors = r#"<actuatorpos actuator="last"/><actuatorvel actuator="last"/></sensor>"#;
    let mut data = Data::new(Model::from_xml_str(&MODEL.replace("</sensor>", sensors)).unwrap()).unwrap();
    data.qvel_mut().copy_from_slice(&[0.1, 0.2, 0.3, 0.4]);
    let mut lineariser = Lineariser::new(data.model(), TransitionOptions::default()).unwrap();
    let (system, _) = lineariser.inverse_jacobians(&mut data, InverseForce::Total).unwrap();
    let (rows, gear) = (data.model().nsensordata(), 3.0);
    for (row, by_positions, by_velocities) in [(rows - 2, gear, 0.0), (rows - 1, 0.0, gear)] {
        for (jacobian, expected) in [(&system.ds_dq, by_positions), (&system.ds_dv, by_velocities)] {
            for dof in 0..4 {
                let expected = if dof == 3 { expected } else { 0.0 };
                assert!((jacobian[(dof, row)] - expected).abs() < 1e-6, "row {row}, dof {dof}: {jacobian:?}");
            }
        }
    }
}

#[test]
fn callbacks_use_the_places_of_controls_and_activations() {
    let mut data = Data::new(model()).unwrap();
    data.set_callbacks(Callbacks::new().with_control(|context| context.set_ctrl("last", 0.4).unwrap()));
    data.step().unwrap();
    assert_eq!(data.ctrl(), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.4]);

    // The engine would ignore the number of the closure.
    let text = r#"<mujoco><worldbody><body><joint name="a"/><geom size=".1" pos=".1 0 0"/></body></worldbody>
        <actuator><general joint="a" dyntype="user" actdim="2"/></actuator></mujoco>"#;
    for (text, is_ok) in [(text.to_owned(), false), (text.replace("actdim=\"2\"", ""), true)] {
        let mut data = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
        data.set_callbacks(Callbacks::new().with_actuator_dynamics(|_, _| 2.0));
        let result = data.step();
        assert_eq!(result.is_ok(), is_ok, "{result:?}");
        assert!(is_ok || matches!(result, Err(Error::Unsupported(_))));
        assert!(!is_ok || data.act()[0] > 0.0);
    }
}

/// The engine's step of `mjd_transitionFD` searches for damping of actuators by the number of
/// controls, beyond arrays of one number per actuator. Behind the end of these arrays are a type
/// and an address that lead it outside of the process's memory.
#[test]
fn a_linear_system_reads_no_actuator_beyond_the_last() {
    let text = MODEL.replace(" damping=\".1\"", "");
    let mut data = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
    let expected = data.transition_fd(1e-6, Differences::Central).unwrap();
    let model = data.model().clone();
    let raw = model.as_ptr().cast_mut();
    let mut types = model.actuator_trntype().to_vec();
    types.resize(model.nu(), sys::mjTRN_JOINT as i32);
    // SAFETY: the array has a number for each actuator.
    let mut outputs = unsafe { std::slice::from_raw_parts((*raw).actuator_outadr, model.nactuator()) }.to_vec();
    outputs.resize(model.nu(), i32::MAX);
    // SAFETY: nothing else uses the model, and the arrays live until the original ones are in their
    // places again.
    let originals = unsafe {
        let (types, outputs) = (types.as_mut_ptr(), outputs.as_mut_ptr());
        (
            std::mem::replace(&mut (*raw).actuator_trntype, types),
            std::mem::replace(&mut (*raw).actuator_outadr, outputs),
        )
    };
    let system = data.transition_fd(1e-6, Differences::Central);
    // SAFETY: as above.
    unsafe { ((*raw).actuator_trntype, (*raw).actuator_outadr) = originals };
    assert_eq!(system.unwrap(), expected);
}

/// The check of the integrator counted controls instead of actuators.
#[test]
fn a_lineariser_of_the_implicit_integrator_accepts_several_controls() {
    let text = MODEL.replace("<option ", "<option integrator=\"implicit\" ");
    let mut data = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
    let expected = data.transition_fd(1e-6, Differences::Central).unwrap();
    let mut lineariser = Lineariser::new(data.model(), TransitionOptions::default()).unwrap();
    let (system, report) = lineariser.linear_system(&mut data).unwrap();
    assert!(report.fallback.is_some());
    let (ours, engine) = (system.b.as_slice(), expected.b.as_slice());
    assert!(ours.iter().zip(engine).all(|(ours, engine)| (ours - engine).abs() < 1e-4));
}

#[test]
fn a_batch_and_the_text_of_the_model_keep_all_controls() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("saved.xml");
    // Tests in other threads load models, and the engine keeps only the XML of the last one.
    let mut model = (0..1000)
        .find_map(|_| {
            let model = model();
            match model.save_xml(&path) {
                Err(Error::XmlReplaced) => None,
                saved => Some(saved.map(|()| model).unwrap()),
            }
        })
        .unwrap();
    assert_eq!(Model::from_xml_path(&path).unwrap().nu(), 8);
    model.edit().actuator_mut("last").unwrap().gear_mut()[0] = 4.0;
    assert_eq!(model.actuator_gear()[6][0], 4.0);

    let mut batch = Batch::new(model.clone(), 3).unwrap();
    let mut single = Data::new(model).unwrap();
    for step in 0..20 {
        for index in 0..single.model().nu() {
            single.ctrl_mut()[index] = control(step, index);
        }
        single.step().unwrap();
        batch
            .step(|_, controls| {
                for (at, value) in controls.as_mut_slice().iter_mut().enumerate() {
                    *value = control(step, at % 8);
                }
            })
            .unwrap();
    }
    assert_eq!(batch.data(1).unwrap().qpos(), single.qpos());
}
