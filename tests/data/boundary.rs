//! Every kind of call across the boundary to C, a few times each: small enough for valgrind's
//! memcheck (`scripts/valgrind memcheck`), which detects invalid accesses, uses of uninitialised
//! memory and leaks.

#![forbid(unsafe_code)]

use std::sync::Arc;

use mujoco_safe::data::Timer;
use mujoco_safe::derivative::TransitionOutputs;
use mujoco_safe::enums::{Cone, Integrator, JacobianStorage, Solver};
use mujoco_safe::model::EnableFlags;
use mujoco_safe::{
    Controller, Data, Differences, Error, LoadOptions, Lqr, Matrix, Model, PdController, RandomController, StateSpec,
    Trajectory, ZeroController, sample,
};

use crate::touch_all;

/// A model with an element of every kind for which the engine has arrays.
const EVERYTHING: &str = r#"<mujoco>
  <size nuserdata="3" nuser_body="1" nuser_jnt="1" nuser_geom="1" nuser_site="1" nuser_cam="1" nuser_tendon="1"
        nuser_actuator="1" nuser_sensor="1" njmax="80" nconmax="20"/>
  <asset>
    <texture name="texture" type="2d" builtin="checker" rgb1="1 0 0" rgb2="0 1 0" width="8" height="8"/>
    <material name="material" texture="texture"/>
    <mesh name="mesh" vertex="0 0 0  1 0 0  0 1 0  0 0 1" scale=".1 .1 .1"/>
    <hfield name="field" nrow="3" ncol="3" size="1 1 .1 .1"/>
  </asset>
  <worldbody>
    <light name="light" pos="0 0 2"/>
    <camera name="camera" pos="0 -1 1"/>
    <geom name="floor" type="plane" size="1 1 .1" material="material"/>
    <geom name="hills" type="hfield" hfield="field" pos="3 0 0"/>
    <body name="hand" mocap="true" pos="0 0 1"><geom name="hand" size=".02" contype="0"/></body>
    <body name="free" pos="0 0 .09">
      <freejoint name="free"/><geom name="box" type="box" size=".1 .1 .1"/><geom type="mesh" mesh="mesh" pos="0 .2 0"/>
      <site name="site" size=".01"/>
    </body>
    <body name="arm" pos=".5 0 .5">
      <joint name="ball" type="ball" damping=".1"/><geom name="arm" type="capsule" size=".02 .1" condim="6"/>
      <geom name="pulley" size=".03" contype="0" conaffinity="0"/><site name="arm" pos="0 0 .1"/>
      <body name="hand2" pos="0 0 .2">
        <joint name="hinge" axis="0 1 0" range="-1 1" limited="true" frictionloss=".1" armature=".01"/>
        <geom name="fore" type="cylinder" size=".02 .1"/><site name="end" pos="0 0 .1"/>
      </body>
    </body>
    <body name="slide" pos="-.5 0 .5"><joint name="slide" type="slide" axis="0 0 1"/><geom type="ellipsoid" size=".1 .05 .05"/></body>
  </worldbody>
  <contact><pair geom1="box" geom2="fore"/><exclude body1="arm" body2="slide"/></contact>
  <equality>
    <weld name="weld" body1="free" body2="hand"/><joint joint1="hinge" joint2="slide" active="false"/>
  </equality>
  <tendon>
    <fixed name="fixed" limited="true" range="-.01 .01" frictionloss=".1"><joint joint="hinge" coef="1"/><joint joint="slide" coef="-1"/></fixed>
    <spatial name="spatial" stiffness="10"><site site="site"/><geom geom="pulley"/><site site="end"/></spatial>
  </tendon>
  <actuator>
    <motor name="motor" joint="hinge" ctrllimited="true" ctrlrange="-1 1"/>
    <general name="filter" tendon="fixed" dyntype="filter" dynprm=".1"/>
  </actuator>
  <sensor>
    <touch name="touch" site="site"/><gyro site="end"/><accelerometer site="end"/><rangefinder site="end"/>
    <force site="end"/><subtreeangmom body="arm"/><framequat objtype="body" objname="arm"/><actuatorfrc actuator="motor"/>
  </sensor>
  <custom>
    <numeric name="numeric" data="1 2"/><text name="text" data="abc"/>
    <tuple name="tuple"><element objtype="body" objname="arm" prm="1"/></tuple>
  </custom>
  <keyframe><key name="key" time="1" ctrl=".1 .2"/></keyframe>
</mujoco>"#;

fn everything() -> Model {
    Model::from_xml_str(EVERYTHING).unwrap()
}

#[test]
fn every_accessor_reads_initialised_memory_at_every_stage() {
    for jacobian in [JacobianStorage::Dense, JacobianStorage::Sparse] {
        for (solver, cone) in [(Solver::Pgs, Cone::Elliptic), (Solver::Newton, Cone::Pyramidal)] {
            let mut model = everything();
            model
                .edit()
                .edit_options(|options| (options.jacobian, options.solver, options.cone) = (jacobian, solver, cone))
                .unwrap();
            assert!(touch_all::model(&model) > 0);
            assert!(touch_all::model_mut(&mut model.edit()) > 0);
            let mut data = Data::new(model).unwrap();
            let stages: [fn(&mut Data) -> mujoco_safe::Result<()>; 8] = [
                |_| Ok(()),
                Data::step,
                Data::step1,
                Data::step2,
                Data::forward,
                Data::inverse,
                |data| data.reset_to_key("key"),
                Data::reset,
            ];
            for stage in stages {
                stage(&mut data).unwrap();
                touch_all::data(&data);
                touch_all::data(&data.clone());
                touch_all::data_mut(&mut data);
            }
        }
    }
}

#[test]
fn every_view_prints() {
    let model = Arc::new(everything());
    let mut data = Data::new(model.clone()).unwrap();
    data.forward().unwrap();
    let mut text = format!("{model:?} {data:?}");
    macro_rules! print {
        ($($many:ident),*) => {$(
            for view in model.$many() { text.push_str(&[format!("{view:?}"), view.to_string()].concat()); }
            for view in data.$many() { text.push_str(&[format!("{view:?}"), view.to_string()].concat()); }
        )*};
    }
    print!(bodies, joints, geoms, sites, cameras, lights, tendons, actuators, sensors);
    model.keyframes().for_each(|key| text.push_str(&[format!("{key:?}"), key.to_string()].concat()));
    assert!(text.len() > 1000);
}

#[test]
fn loading_and_saving_make_no_invalid_access() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.xml");
    std::fs::write(&path, sample::CARTPOLE_XML).unwrap();
    // Other tests load models concurrently, and the engine keeps only the XML of the last model.
    let model = (0..1000)
        .find_map(|_| {
            let model = Model::from_xml_path(&path).unwrap();
            match model.save_xml(folder.path().join("saved.xml")) {
                Err(Error::XmlReplaced) => None,
                saved => Some(saved.map(|()| model).unwrap()),
            }
        })
        .unwrap();
    assert!(model.save_xml(folder.path().join("no/such/folder.xml")).is_err());
    assert!(model.save_xml(folder.path()).is_err());
    model.save_binary(folder.path().join("saved.mjb")).unwrap();
    let bytes = model.to_binary().unwrap();
    assert!(Model::from_binary(&bytes[..bytes.len() / 2]).is_err());
    assert!(Model::from_binary(b"").is_err());
    let _ = Model::from_binary_path(folder.path().join("saved.mjb"));
    assert_eq!(Model::from_xml_path(folder.path().join("saved.xml")).unwrap().nv(), 2);
    assert!(matches!(model.save_xml(folder.path().join("again.xml")), Err(Error::XmlReplaced)));
    for xml in ["", "<mujoco", "<mujoco><worldbod/></mujoco>", "<mujoco><worldbody><geom/></worldbody></mujoco>"] {
        assert!(matches!(Model::from_xml_str(xml), Err(Error::Load { .. })), "{xml}");
    }
    let part: (&str, &[u8]) = ("part.xml", b"<mujoco><worldbody><geom size='.1'/></worldbody></mujoco>");
    let whole = r#"<mujoco><include file="part.xml"/></mujoco>"#;
    assert_eq!(Model::from_xml_str_with(whole, &LoadOptions::default().with_files(&[part])).unwrap().ngeom(), 1);
    assert!(Model::from_xml_str_with(whole, &LoadOptions::default().with_files(&[])).is_err());
    assert!(Model::from_xml_str_with(whole, &LoadOptions::default().with_files(&[part, part])).is_err());
    assert!(Model::from_xml_str_with(whole, &LoadOptions::default().with_files(&[("", b"x")])).is_err());
    assert!(matches!(model.joint("nobody"), Err(Error::NoSuchName { .. })));
}

#[test]
fn editing_and_cloning_make_no_invalid_access() {
    let mut model = everything();
    model.edit().body_mut("arm").unwrap().set_mass(0.3);
    model.edit().update_constants().unwrap();
    model.edit().edit_visual(|visual| visual.global.offwidth += 1).unwrap();
    model.edit().edit_statistics(|statistics| statistics.center[0] += 1.0).unwrap();
    let copy = model.clone();
    assert_eq!(touch_all::model(&copy), touch_all::model(&model));
    let mut data = Data::new(model).unwrap();
    data.step().unwrap();
    let mut other = data.clone();
    other.edit_model(|model| model.set_timestep(0.001)).unwrap();
    other.copy_from(&data).unwrap();
    other.clone_from(&data);
    other.clone_from(&Data::new(copy).unwrap());
    assert!(other.copy_from(&Data::new(sample::cartpole()).unwrap()).is_err());
    other.step().unwrap();
    drop(data);
    other.step().unwrap();
}

#[test]
fn every_solver_makes_no_invalid_access() {
    let mut data = Data::new(everything()).unwrap();
    for solver in [Solver::Pgs, Solver::Cg, Solver::Newton] {
        for integrator in [Integrator::Euler, Integrator::Rk4, Integrator::Implicit] {
            for jacobian in [JacobianStorage::Dense, JacobianStorage::Sparse] {
                data.edit_model(|model| {
                    model.edit_options(|options| {
                        (options.solver, options.integrator, options.jacobian) = (solver, integrator, jacobian);
                        options.noslip_iterations = 1;
                        options.enable = crate::flags::enable_flags() - EnableFlags::OVERRIDE;
                        if integrator == Integrator::Rk4 {
                            // Newer engines reject discrete inverse dynamics with this integrator.
                            options.enable -= EnableFlags::INVDISCRETE;
                        }
                    })
                })
                .unwrap();
                data.reset().unwrap();
                data.step().unwrap();
                data.step1().unwrap();
                data.ctrl_mut()[0] = 0.5;
                data.step2().unwrap();
                data.inverse().unwrap();
                let improvement: f64 = data.solver().map(|iteration| iteration.improvement).sum();
                let duration: f64 = Timer::ALL.map(|timer| data.timer(timer).duration).iter().sum();
                assert!(improvement.is_finite() && duration.is_finite(), "{:?}", data.solver_fwdinv());
            }
        }
    }
}

#[test]
fn engine_errors_and_instability_make_no_invalid_access() {
    let mut data = Data::new(everything()).unwrap();
    data.qpos_mut()[0] = f64::NAN;
    assert!(matches!(data.step(), Err(Error::Unstable(_))));
    data.qpos_mut()[0] = 0.0;
    data.step().unwrap();
    data.qfrc_applied_mut().fill(1e300);
    assert!(matches!(data.step(), Err(Error::Unstable(_))));
    assert!(matches!(data.forward(), Err(Error::Poisoned { .. })));
    touch_all::data(&data);
    drop(data.clone());
    data.reset().unwrap();
    data.edit_model(|model| model.site_quat_mut().as_flattened_mut().fill(0.0)).unwrap();
    data.edit_model(|model| model.site_quat_mut().as_flattened_mut().fill(f64::MIN_POSITIVE)).unwrap();
    let _ = data.step();
    data.reset().unwrap();
    data.edit_model(|model| {
        model.body_mass_mut().fill(0.0);
        model.body_inertia_mut().as_flattened_mut().fill(0.0);
        model.dof_armature_mut().fill(0.0);
        let _ = model.update_constants();
        model.edit_options(|options| options.integrator = Integrator::Implicit)
    })
    .unwrap();
    let _ = data.step();
    touch_all::data(&data);
    drop(data.clone());
}

#[test]
fn jacobians_inertia_and_contacts_make_no_invalid_access() {
    let mut data = Data::new(everything()).unwrap();
    data.step().unwrap();
    let model = data.model().clone();
    let nv = model.nv();
    let (mut first, mut second) = (Matrix::zeros(3, nv), Matrix::zeros(3, nv));
    for body in model.bodies() {
        data.jac_body_into(body, Some(&mut first), None).unwrap();
        data.jac_body_com_into(body, None, Some(&mut second)).unwrap();
        data.jac_into([0.1, 0.2, 0.3], body, Some(&mut first), Some(&mut second)).unwrap();
        data.jac_subtree_com_into(body, &mut first).unwrap();
    }
    model.geoms().for_each(|geom| drop(data.jac_geom(geom).unwrap()));
    model.sites().for_each(|site| drop(data.jac_site(site).unwrap()));
    assert_eq!(data.full_m().unwrap().shape(), (nv, nv));
    let (mut result, vector) = (vec![0.0; 2 * nv], vec![1.0; 2 * nv]);
    data.solve_m_into(&vector, &mut result).unwrap();
    data.mul_m_into(&vector[..nv], &mut result[..nv]).unwrap();
    assert!(data.contacts().len() > 0);
    for contact in data.contacts() {
        contact.force_in_world().unwrap();
        assert!(format!("{contact:?}").contains("Contact") && contact.is_active() && contact.dim() >= 1);
    }
    let (from, mut to, mut velocity) = (model.qpos0().to_vec(), model.qpos0().to_vec(), vec![0.1; nv]);
    model.integrate_pos(&mut to, &velocity, 0.5).unwrap();
    model.differentiate_pos_into(0.5, &from, &to, &mut velocity).unwrap();
}

#[test]
fn linearising_makes_no_invalid_access() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.transition_fd(1e-6, Differences::Central).unwrap();
    let mut data = Data::new(everything()).unwrap();
    data.ctrl_mut().fill(5.0);
    let system = data.transition_fd(1e-6, Differences::Forward).unwrap();
    let mut b = system.b.clone();
    data.transition_fd_into(1e-6, Differences::Forward, TransitionOutputs { b: Some(&mut b), ..Default::default() })
        .unwrap();
    assert_eq!(b.shape(), (2 * data.model().nv() + 1, 2));
}

#[test]
fn controllers_states_and_trajectories_make_no_invalid_access() {
    let mut data = Data::new(everything()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    trajectory.record(&mut data, &mut ZeroController, 2).unwrap();
    trajectory.record(&mut data, &mut RandomController::new(1), 2).unwrap();
    PdController::new(data.model(), 1.0, 0.1).control(&mut data).unwrap();
    let gain = Matrix::zeros(2, 2 * data.model().nv() + 1);
    Lqr::with_gain(&data, gain).unwrap().control(&mut data).unwrap();
    trajectory.apply(1, &mut data).unwrap();
    let state = data.state(StateSpec::INTEGRATION);
    data.set_state(StateSpec::INTEGRATION, &state).unwrap();
    let folder = tempfile::tempdir().unwrap();
    trajectory.save_csv(folder.path().join("t.csv")).unwrap();
    assert_eq!(Trajectory::load_csv(data.model(), folder.path().join("t.csv")).unwrap(), trajectory);
}

#[test]
fn threads_make_no_invalid_access() {
    let model = Arc::new(everything());
    let data = Data::new(model.clone()).unwrap();
    std::thread::scope(|scope| {
        for _ in 0..2 {
            let (mut own, shared) = (data.clone(), &data);
            scope.spawn(move || {
                own.step().unwrap();
                assert_eq!(touch_all::data(shared), touch_all::data(shared));
                assert!(Model::from_xml_str("<mujoco").is_err());
                Model::from_xml_str("<mujoco/>").unwrap();
            });
        }
    });
}
