//! What a hostile or mistaken caller can try without `unsafe`, and what must become of it: an error or a panic with a sentence,
//! never a crash, a hang or a wrong number.

#![forbid(unsafe_code)]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use mujoco_safe::{
    Controller, Data, Differences, Error, Integrator, JacobianStorage, Lqr, Matrix, Model, PdController,
    RandomController, Solver, StateSpec, Trajectory, TransitionOutputs, sample,
};

/// The text of the panic that `action` must end with.
fn panic_text<T>(action: impl FnOnce() -> T) -> String {
    let payload = catch_unwind(AssertUnwindSafe(action)).err().expect("no panic");
    payload.downcast_ref::<String>().cloned().or_else(|| payload.downcast_ref::<&str>().map(|&s| s.to_owned())).unwrap()
}

fn squatting() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data
}

/// A model of everything that collides by the general algorithm, and of a body that follows the mouse.
const COLLIDERS: &str = r#"<mujoco>
  <asset>
    <mesh name="tetrahedron" vertex="0 0 0  1 0 0  0 1 0  0 0 1" scale=".2 .2 .2"/>
    <hfield name="field" nrow="5" ncol="5" size="1 1 .2 .1"/>
  </asset>
  <worldbody>
    <geom type="plane" size="2 2 .1" pos="0 0 -1"/>
    <geom type="hfield" hfield="field"/>
    <body name="hand" mocap="true" pos="0 0 .4"><geom type="box" size=".1 .1 .1"/></body>
    <body pos="0 0 .1"><freejoint/><geom type="mesh" mesh="tetrahedron"/></body>
    <body pos=".1 0 .2"><freejoint/><geom type="ellipsoid" size=".1 .1 .2"/></body>
    <body pos="-.1 0 .2"><freejoint/><geom type="cylinder" size=".1 .1"/></body>
    <body pos="0 .2 .2"><joint name="ball" type="ball"/><geom type="capsule" size=".05 .1"/><site name="tip"/></body>
  </worldbody>
  <equality><weld body1="hand" body2="world" active="false"/></equality>
  <actuator><motor joint="ball" gear="1 0 0" ctrllimited="true" ctrlrange="-1 1"/></actuator>
  <sensor><gyro site="tip"/><rangefinder site="tip"/></sensor>
</mujoco>"#;

// The engine clears nq + nv + na numbers in a row of 2 nv + na when the last control can be moved to neither side.
#[test]
fn a_control_beyond_its_range_does_not_spoil_the_linearisation() {
    let mut data = squatting();
    let nu = data.model().nu();
    for differences in [Differences::Forward, Differences::Central] {
        data.reset_to_key("squat").unwrap();
        data.qpos_mut()[0] = 0.5;
        data.ctrl_mut()[nu - 1] = 1.0; // the limit, which acts as any control beyond it does
        data.set_time(3.0);
        let before = data.state(StateSpec::INTEGRATION);
        let good = data.transition_fd(1e-6, Differences::Central).unwrap();

        data.set_state(StateSpec::INTEGRATION, &before).unwrap();
        data.ctrl_mut()[nu - 1] = 2.0;
        let before = data.state(StateSpec::INTEGRATION);
        let system = data.transition_fd(1e-6, differences).unwrap();
        assert_eq!(data.state(StateSpec::FULL_PHYSICS), before[..data.state(StateSpec::FULL_PHYSICS).len()]);
        assert_eq!(data.state(StateSpec::USER), {
            data.set_state(StateSpec::INTEGRATION, &before).unwrap();
            data.state(StateSpec::USER)
        });
        if differences == Differences::Central {
            let worst = (0..system.a.nrows() * system.a.ncols())
                .map(|at| (system.a.as_slice()[at] - good.a.as_slice()[at]).abs())
                .fold(0.0, f64::max);
            assert!(worst < 1e-5, "{worst}");
        }
        let last = |row: usize| system.b[(row, nu - 1)];
        assert!((0..system.b.nrows()).all(|row| last(row) == 0.0), "a control that is clamped has no effect");
    }
}

#[test]
fn a_control_beyond_its_range_gives_the_matrices_that_each_alone_has() {
    let mut model = Model::from_xml_str(COLLIDERS).unwrap();
    model.edit().options(|options| options.tolerance = 0.0).unwrap();
    let mut data = Data::new(model).unwrap();
    data.ctrl_mut()[0] = 5.0;
    let system = data.transition_fd(1e-6, Differences::Forward).unwrap();
    let mut d = Matrix::zeros(system.d.nrows(), system.d.ncols());
    let outputs = TransitionOutputs { d: Some(&mut d), ..Default::default() };
    data.transition_fd_into(1e-6, Differences::Forward, outputs).unwrap();
    assert_eq!(d, system.d);
    let mut a = Matrix::zeros(system.a.nrows(), system.a.ncols());
    let outputs = TransitionOutputs { a: Some(&mut a), ..Default::default() };
    data.transition_fd_into(1e-6, Differences::Forward, outputs).unwrap();
    assert_eq!(a, system.a);
}

#[test]
fn linearising_leaves_the_time() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    data.set_time(1.5);
    data.transition_fd(1e-6, Differences::Central).unwrap();
    assert_eq!(data.time(), 1.5);
}

#[test]
fn the_second_half_of_a_step_needs_a_first_half_of_its_own() {
    for solver in [Solver::Pgs, Solver::Cg, Solver::Newton] {
        let mut model = sample::humanoid();
        model.edit().options(|options| options.solver = solver).unwrap();
        let mut data = Data::new(model).unwrap();
        let refused = |data: &mut Data| {
            let error = data.step2().unwrap_err();
            assert!(matches!(error, Error::NotComputed { call: "step2", .. }), "{error}");
            assert!(error.to_string().contains("call step1 first"), "{error}");
        };
        refused(&mut data);
        data.reset_to_key("squat").unwrap();
        refused(&mut data);
        data.step().unwrap();
        refused(&mut data);
        data.inverse().unwrap();
        refused(&mut data);
        data.step1().unwrap();
        data.step2().unwrap();
        refused(&mut data);
        data.forward().unwrap();
        let mut copy = data.clone();
        data.step2().unwrap();
        refused(&mut data);
        copy.step2().unwrap();
        assert_eq!(copy.qpos(), data.qpos());
        data.step1().unwrap();
        data.edit_model(|_| ()).unwrap();
        refused(&mut data);
        data.step1().unwrap();
        data.transition_fd(1e-6, Differences::Forward).unwrap();
        refused(&mut data);
    }
}

#[test]
fn options_changed_between_the_halves_of_a_step_are_refused_until_the_first_half_is_made_again() {
    let mut data = squatting();
    let changes: [fn(&mut mujoco_safe::Options); 5] = [
        |options| options.solver = Solver::Pgs,
        |options| options.noslip_iterations = 5,
        |options| options.jacobian = JacobianStorage::Sparse,
        |options| options.cone = mujoco_safe::Cone::Elliptic,
        |options| options.integrator = Integrator::Implicit,
    ];
    for change in changes {
        data.step1().unwrap();
        data.edit_model(|model| model.options(change)).unwrap().unwrap();
        assert!(matches!(data.step2(), Err(Error::NotComputed { .. })));
        assert!(matches!(data.jac_body(data.model().body("torso").unwrap().id()), Err(Error::NotComputed { .. })));
        for contact in data.contacts() {
            assert!(matches!(contact.force(), Err(Error::NotComputed { .. })));
        }
        data.step1().unwrap();
        data.step2().unwrap();
    }
}

#[test]
fn every_combination_of_discrete_options_steps() {
    let mut data = squatting();
    for solver in [Solver::Pgs, Solver::Cg, Solver::Newton] {
        for integrator in [Integrator::Euler, Integrator::Rk4, Integrator::Implicit] {
            for jacobian in [JacobianStorage::Dense, JacobianStorage::Sparse] {
                for cone in [mujoco_safe::Cone::Elliptic, mujoco_safe::Cone::Pyramidal] {
                    for noslip in [0, 3] {
                        data.edit_model(|model| {
                            model.options(|options| {
                                (options.solver, options.integrator, options.jacobian) = (solver, integrator, jacobian);
                                (options.cone, options.noslip_iterations) = (cone, noslip);
                            })
                        })
                        .unwrap()
                        .unwrap();
                        data.reset_to_key("squat").unwrap();
                        for _ in 0..3 {
                            data.step().unwrap();
                            assert!(data.contacts().all(|contact| contact.force().is_ok()));
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn matrices_whose_size_overflows_panic() {
    let half = 1_usize << (usize::BITS / 2);
    assert!(panic_text(|| Matrix::zeros(half, half)).contains("too large"));
    assert!(panic_text(|| Matrix::from_row_major(half, half, Vec::new())).contains("too large"));
    for shape in [(0, 5), (5, 0), (0, 0)] {
        let mut empty = Matrix::zeros(shape.0, shape.1);
        assert_eq!(empty.transposed().shape(), (shape.1, shape.0));
        assert_eq!(empty.transposed_mut().shape(), (shape.1, shape.0));
        assert_eq!(empty.to_nalgebra().shape(), shape);
    }
}

#[test]
fn a_record_whose_place_overflows_is_no_record() {
    let mut data = Data::new(sample::cartpole()).unwrap();
    let mut trajectory = Trajectory::new(data.model());
    trajectory.push(&data).unwrap();
    let wrapped = 1_usize << (usize::BITS - 2); // times 4 numbers a state: 0
    assert!(panic_text(|| trajectory.state(wrapped).len()).contains("of a trajectory of 1"));
    assert!(panic_text(|| trajectory.ctrl(1).len()).contains("of a trajectory of 1"));
    assert!(panic_text(|| trajectory.apply(wrapped, &mut data)).contains("of a trajectory of 1"));

    let mut other = Data::new(sample::humanoid()).unwrap();
    assert!(matches!(trajectory.push(&other), Err(Error::Shape { .. })));
    assert!(matches!(trajectory.apply(0, &mut other), Err(Error::Shape { .. })));
}

/// Two models whose vectors have equal lengths, made of other joints.
fn lookalikes() -> (Model, Model) {
    let model = |joints: &str, actuator: &str| {
        Model::from_xml_str(&format!(
            r#"<mujoco><worldbody><body>{joints}<geom size=".1"/></body></worldbody><actuator>{actuator}</actuator></mujoco>"#
        ))
        .unwrap()
    };
    let first = model(
        r#"<joint type="ball" name="j"/>"#,
        r#"<general joint="j" dyntype="filter"/><general joint="j" dyntype="filter"/>"#,
    );
    let second = model(
        r#"<joint axis="1 0 0" name="j"/><joint axis="0 1 0"/><joint axis="0 0 1"/><joint type="slide"/>"#,
        r#"<general joint="j"/><general joint="j"/>"#,
    );
    assert_eq!((first.nq(), second.nq()), (4, 4));
    assert_eq!(2 * first.nv() + first.na(), 2 * second.nv() + second.na());
    (first, second)
}

#[test]
fn a_regulator_does_not_take_a_lookalike_for_its_model() {
    let (first, second) = lookalikes();
    let first = Data::new(first).unwrap();
    let mut second = Data::new(second).unwrap();
    let mut lqr = Lqr::with_gain(&first, Matrix::zeros(2, 8)).unwrap();
    assert!(matches!(lqr.control(&mut second), Err(Error::Shape { .. })));
    let mut trajectory = Trajectory::new(first.model());
    assert!(trajectory.push(&second).is_err());
}

#[test]
fn a_target_of_another_model_panics() {
    let mut pd = PdController::new(&sample::cartpole(), 1.0, 1.0);
    let other = sample::cartpole();
    let text = panic_text(|| pd.set_target(other.actuator("slide").unwrap(), 1.0));
    assert!(text.contains("another model"), "{text}");
    assert!(matches!(pd.control(&mut Data::new(sample::humanoid()).unwrap()), Err(Error::Shape { .. })));
}

#[test]
fn ids_of_another_model_panic_wherever_they_go() {
    let other = sample::humanoid();
    let (body, geom, joint) = (other.body(1).unwrap().id(), other.geom(0).unwrap().id(), other.joint(0).unwrap().id());
    let mut data = squatting();
    data.forward().unwrap();
    for text in [
        panic_text(|| data.jac_body(body)),
        panic_text(|| data.jac_geom(geom)),
        panic_text(|| data.jac(body, [0.0; 3])),
        panic_text(|| data.jac_subtree_com(body)),
        panic_text(|| data.joint(joint).qpos().len()),
        panic_text(|| data.joint_mut(joint).qpos_mut().len()),
        panic_text(|| data.model().name(joint).map(str::len)),
        panic_text(|| data.edit_model(|model| model.joint_mut(joint).set_stiffness(1.0))),
        panic_text(|| data.reset_to_key(other.keyframe(0).unwrap().id())),
    ] {
        assert!(text.contains("belongs to another model"), "{text}");
    }
    data.forward().unwrap();
    data.step2().unwrap();
}

#[test]
fn data_of_separately_loaded_models_are_not_copied_and_clones_are() {
    let (mut a, b) = (squatting(), squatting());
    assert!(matches!(a.copy_from(&b), Err(Error::OtherModel { .. })));
    a.clone_from(&b);
    assert!(Arc::ptr_eq(a.model(), b.model()));

    // A clone whose options differ: the state comes over, what was computed does not count.
    let mut edited = a.clone();
    edited.edit_model(|model| model.options(|options| options.cone = mujoco_safe::Cone::Elliptic)).unwrap().unwrap();
    edited.step().unwrap();
    assert!(edited.contacts().len() > 0);
    a.copy_from(&edited).unwrap();
    assert!(a.contacts().all(|contact| matches!(contact.force(), Err(Error::NotComputed { .. }))));
    assert!(matches!(a.step2(), Err(Error::NotComputed { .. })));
    a.step().unwrap();
    a.clone_from(&edited);
    assert!(a.contacts().all(|contact| contact.force().is_ok()));
}

#[test]
fn an_edit_that_panics_leaves_a_simulation_that_works() {
    let mut data = squatting();
    data.step().unwrap();
    let weak = Arc::downgrade(data.model());
    let shared = data.model().clone();
    assert_eq!(
        panic_text(|| data.edit_model(|model| {
            model.body_mass_mut()[1] = 100.0;
            panic!("in the closure");
        })),
        "in the closure"
    );
    assert!(!Arc::ptr_eq(&shared, data.model()), "what others share stays as it was");
    assert!(shared.body_mass()[1] < 100.0);
    assert_eq!(data.model().body_mass()[1], 100.0);
    drop(shared);
    assert!(weak.upgrade().is_none());
    data.step().unwrap();

    // A weak reference alone makes a copy, too: it could be upgraded later.
    let weak = Arc::downgrade(data.model());
    data.edit_model(|_| ()).unwrap();
    assert!(weak.upgrade().is_none());
    data.step().unwrap();
}

#[test]
fn models_without_joints_or_without_anything_work_in_every_call() {
    for xml in [
        "<mujoco/>",
        r#"<mujoco><worldbody><geom type="plane" size="1 1 1"/><body mocap="true"><geom size=".1"/></body></worldbody></mujoco>"#,
        r#"<mujoco><worldbody><body><freejoint/><geom size=".1"/></body></worldbody></mujoco>"#,
        r#"<mujoco><size njmax="0" nconmax="0"/><worldbody><body><joint/><geom size=".1"/></body></worldbody></mujoco>"#,
    ] {
        let model = Model::from_xml_str(xml).unwrap();
        let nv = model.nv();
        let mut data = Data::new(model).unwrap();
        data.step().unwrap();
        data.step1().unwrap();
        data.step2().unwrap();
        data.forward().unwrap();
        data.inverse().unwrap();
        data.forward().unwrap();
        let world = data.model().body(0).unwrap().id();
        assert_eq!(data.jac_body_com(world).unwrap().translation.shape(), (3, nv));
        assert_eq!(data.jac_subtree_com(world).unwrap().shape(), (3, nv));
        assert_eq!(data.full_m().unwrap().shape(), (nv, nv));
        let (mut result, vector) = (vec![0.0; nv], vec![1.0; nv]);
        data.mul_m(&mut result, &vector).unwrap();
        data.solve_m(&mut result, &vector).unwrap();
        let system = data.transition_fd(1e-6, Differences::Central).unwrap();
        assert_eq!(system.a.shape(), (2 * nv, 2 * nv));
        assert_eq!(data.contacts().len(), data.ncon());
        let state = data.state(StateSpec::INTEGRATION);
        data.set_state(StateSpec::INTEGRATION, &state).unwrap();
        let mut trajectory = Trajectory::new(data.model());
        trajectory.record(&mut data, &mut RandomController::new(1), 3).unwrap();
        PdController::new(data.model(), 1.0, 1.0).control(&mut data).unwrap();
        Lqr::with_gain(&data, Matrix::zeros(0, 2 * nv)).unwrap().control(&mut data).unwrap();
        data.edit_model(|model| model.update_constants()).unwrap().unwrap();
        drop(data.clone());
        data.reset().unwrap();
    }
}

#[test]
fn unknown_flags_are_refused_or_empty() {
    let mut model = sample::cartpole();
    let error = model.edit().options(|options| options.enable = mujoco_safe::EnableFlags::from_bits_retain(1 << 20));
    assert!(error.unwrap_err().to_string().contains("unknown bits"));
    let spec = StateSpec::from_bits_retain(u32::MAX);
    let mut data = Data::new(model).unwrap();
    let state = data.state(spec);
    assert_eq!(state.len(), data.model().state_size(StateSpec::INTEGRATION));
    data.set_state(spec, &state).unwrap();
}

/// Every number that a caller can write, replaced by what no one would: errors are allowed, nothing else.
#[test]
fn no_number_in_a_simulation_crashes_or_hangs_a_step() {
    let numbers = [f64::NAN, f64::INFINITY, -1e300, 1e9, 0.0];
    let targets: [fn(&mut Data) -> &mut [f64]; 22] = [
        |data| data.qpos_mut(),
        |data| data.qvel_mut(),
        |data| data.act_mut(),
        |data| data.ctrl_mut(),
        |data| data.qacc_warmstart_mut(),
        |data| data.qfrc_applied_mut(),
        |data| data.xfrc_applied_mut().as_flattened_mut(),
        |data| data.mocap_pos_mut().as_flattened_mut(),
        |data| data.mocap_quat_mut().as_flattened_mut(),
        |data| data.qacc_mut(),
        |data| data.sensordata_mut(),
        |data| data.xpos_mut().as_flattened_mut(),
        |data| data.xmat_mut().as_flattened_mut(),
        |data| data.qM_mut(),
        |data| data.qLD_mut(),
        |data| data.efc_J_mut(),
        |data| data.efc_D_mut(),
        |data| data.efc_AR_mut(),
        |data| data.efc_force_mut(),
        |data| data.efc_aref_mut(),
        |data| data.qfrc_bias_mut(),
        |data| data.geom_xpos_mut().as_flattened_mut(),
    ];
    for xml in [sample::HUMANOID_XML, COLLIDERS] {
        for solver in [Solver::Pgs, Solver::Newton] {
            let mut model = Model::from_xml_str(xml).unwrap();
            model.edit().options(|options| options.solver = solver).unwrap();
            let mut data = Data::new(model).unwrap();
            for target in targets {
                for number in numbers {
                    data.reset().unwrap();
                    data.step1().unwrap();
                    target(&mut data).fill(number);
                    let halves = data.step2().and_then(|()| data.step());
                    let _ = data.reset();
                    data.forward().unwrap();
                    target(&mut data).fill(number);
                    let nv = data.model().nv();
                    let (mut result, vector) = (vec![0.0; nv], vec![1.0; nv]);
                    let _ = data.solve_m(&mut result, &vector);
                    let _ = data.mul_m(&mut result, &vector);
                    for contact in data.contacts() {
                        let _ = contact.force_in_world();
                    }
                    let _ = data.inverse();
                    let _ = data.transition_fd(1e-6, Differences::Forward);
                    if let Err(error) = halves {
                        assert!(
                            matches!(error, Error::Unstable(_) | Error::Engine { .. } | Error::Poisoned { .. }),
                            "{error}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn no_number_in_a_model_crashes_or_hangs_a_step() {
    let targets: [fn(&mut mujoco_safe::ModelMut<'_>, f64); 24] = [
        |model, number| model.qpos0_mut().fill(number),
        |model, number| model.body_mass_mut().fill(number),
        |model, number| model.body_inertia_mut().as_flattened_mut().fill(number),
        |model, number| model.body_pos_mut().as_flattened_mut().fill(number),
        |model, number| model.body_quat_mut().as_flattened_mut().fill(number),
        |model, number| model.body_ipos_mut().as_flattened_mut().fill(number),
        |model, number| model.body_iquat_mut().as_flattened_mut().fill(number),
        |model, number| model.jnt_axis_mut().as_flattened_mut().fill(number),
        |model, number| model.jnt_range_mut().as_flattened_mut().fill(number),
        |model, number| model.dof_armature_mut().fill(number),
        |model, number| model.dof_damping_mut().fill(number),
        |model, number| model.dof_invweight0_mut().fill(number),
        |model, number| model.geom_size_mut().as_flattened_mut().fill(number),
        |model, number| model.geom_pos_mut().as_flattened_mut().fill(number),
        |model, number| model.geom_quat_mut().as_flattened_mut().fill(number),
        |model, number| model.geom_rbound_mut().fill(number),
        |model, number| model.geom_margin_mut().fill(number),
        |model, number| model.geom_friction_mut().as_flattened_mut().fill(number),
        |model, number| model.geom_solref_mut().as_flattened_mut().fill(number),
        |model, number| model.geom_solimp_mut().as_flattened_mut().fill(number),
        |model, number| model.site_quat_mut().as_flattened_mut().fill(number),
        |model, number| model.actuator_gear_mut().as_flattened_mut().fill(number),
        |model, number| model.actuator_ctrlrange_mut().as_flattened_mut().fill(number),
        |model, number| model.hfield_data_mut().fill(number as f32),
    ];
    for xml in [sample::HUMANOID_XML, COLLIDERS] {
        let shared = Arc::new(Model::from_xml_str(xml).unwrap());
        for integrator in [Integrator::Euler, Integrator::Implicit] {
            for target in targets {
                for number in [f64::NAN, f64::INFINITY, -1e300, 1e9, -1.0, 0.0] {
                    let mut data = Data::new(shared.clone()).unwrap();
                    data.edit_model(|model| {
                        model.options(|options| options.integrator = integrator).unwrap();
                        target(model, number);
                    })
                    .unwrap();
                    let mut random = RandomController::new(1);
                    let mut run = || -> mujoco_safe::Result<()> {
                        for _ in 0..3 {
                            random.control(&mut data)?;
                            data.step()?;
                        }
                        data.inverse()?;
                        data.transition_fd(1e-6, Differences::Forward).map(drop)
                    };
                    if let Err(error) = run() {
                        assert!(matches!(error, Error::Unstable(_) | Error::Engine { .. }), "{error}");
                    }
                    data.reset().unwrap();
                    let _ = data.edit_model(|model| model.update_constants()).unwrap();
                    data.reset().unwrap();
                    let _ = data.step();
                }
            }
        }
    }
}

#[test]
fn files_that_include_each_other_without_end_are_refused() {
    let load = |names: usize, body: &str, end: &str| {
        let texts: Vec<(String, String)> = (0..names)
            .map(|file| {
                let next = format!(r#"<include file="f{}.xml"/>"#, file + 1);
                let inner = if file + 1 < names { next } else { r#"<geom size=".1"/>"#.to_owned() };
                (format!("f{file}.xml"), format!("<mujoco>{body}{inner}{end}</mujoco>"))
            })
            .collect();
        let files: Vec<(&str, &[u8])> = texts.iter().map(|(name, text)| (name.as_str(), text.as_bytes())).collect();
        let first = r#"<mujoco><worldbody><include file="f0.xml"/></worldbody></mujoco>"#;
        Model::from_xml_str_with_files(first, &files)
    };
    assert_eq!(load(40, "", "").unwrap().ngeom(), 1);
    assert!(load(1900, "", "").unwrap_err().to_string().contains("include each other"));
    assert_eq!(load(4, &"<body>".repeat(80), &"</body>".repeat(80)).unwrap().nbody(), 321);
    let deep = load(40, &"<body>".repeat(80), &"</body>".repeat(80)).unwrap_err();
    assert!(deep.to_string().contains("nested more than 400 deep"), "{deep}");
}

#[test]
fn a_bad_file_name_in_an_included_file_does_not_lock_the_loader() {
    let dir = std::env::temp_dir().join(format!("mujoco_safe_include_{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let part = dir.join("part.xml");
    std::fs::write(&part, r#"<mujoco><include file=""/></mujoco>"#).unwrap();
    let xml = format!(r#"<mujoco><include file="{}"/></mujoco>"#, part.display());
    for _ in 0..2 {
        let error = Model::from_xml_str(&xml).unwrap_err();
        assert!(error.to_string().contains("nothing behind its last slash"), "{error}");
    }
    let main = dir.join("main.xml");
    std::fs::write(&main, r#"<mujoco><include file="part.xml"/></mujoco>"#).unwrap();
    assert!(matches!(Model::from_xml_path(&main), Err(Error::Load { .. })));
    std::fs::write(&part, "<mujoco><worldbody><geom size='.1'/></worldbody></mujoco>").unwrap();
    assert_eq!(Model::from_xml_path(&main).unwrap().ngeom(), 1);
    std::fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn texts_on_which_the_compiler_crashes_are_refused() {
    for (xml, expected) in [
        ("<mujoco>\0</mujoco>", "NUL byte"),
        (
            "<mujoco><asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 -99000000 0 2 1'/></asset></mujoco>",
            "0 to 3",
        ),
        ("<mujoco><asset><hfield name='h' nrow='50000' ncol='50000' size='1 1 1 1'/></asset></mujoco>", "too large"),
        (
            "<mujoco><asset><texture name='t' type='cube' builtin='flat' width='40000' height='40000'/></asset></mujoco>",
            "too large",
        ),
        (
            "<mujoco><option jacobian='sparse'/><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody>
             <tendon><fixed><joint joint='j' coef='1'/><joint joint='j' coef='1'/></fixed></tendon></mujoco>",
            "same joint twice",
        ),
        (
            "<mujoco><option jacobian='sparse'/><worldbody><body><joint name='j'/><geom size='.1'/></body></worldbody>
             <tendon><fixed><joint joint='j' coef='1'/><joint joint='&#106;' coef='1'/></fixed></tendon></mujoco>",
            "same joint twice",
        ),
        (
            "<mujoco><size njmax='5'/><worldbody><geom type='plane' size='1 1 1'/>
             <body name='b'><freejoint/><geom size='.1'/></body></worldbody>
             <actuator><adhesion body='b' ctrlrange='0 1'/></actuator></mujoco>",
            "adhesion needs room",
        ),
        ("<mujoco><include file='/dev/zero'/></mujoco>", "regular file"),
        ("<mujoco><include file='/dev/stdin'/></mujoco>", ""),
    ] {
        let error = Model::from_xml_str(xml).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    Model::from_xml_str("<mujoco/>").unwrap();
}

#[test]
fn names_may_be_anything() {
    let long = "n".repeat(5000);
    let xml = format!(
        r#"<mujoco><worldbody><body name="{long}"><joint name="Gelenk äöü &#x2713;"/><geom size=".1"/><geom size=".1" name=""/></body></worldbody></mujoco>"#
    );
    let model = Model::from_xml_str(&xml).unwrap();
    assert_eq!(model.body(&long).unwrap().name(), Some(&long[..]));
    assert_eq!(model.joint("Gelenk äöü ✓").unwrap().index(), 0);
    for name in ["", "\0", "no\0such", "\u{FFFD}", &"x".repeat(1 << 20)] {
        assert!(matches!(model.geom(name), Err(Error::NoSuchName { .. })));
    }
    assert!(matches!(model.joint(usize::MAX), Err(Error::NoSuchIndex { .. })));
    assert!(matches!(model.joint(1 << 32), Err(Error::NoSuchIndex { .. })));

    // Latin 1, which is no UTF-8: the element is there, its name is not.
    let path = std::env::temp_dir().join(format!("mujoco_safe_latin_{}.xml", std::process::id()));
    std::fs::write(&path, b"<mujoco><worldbody><geom name='\xe4' size='.1'/></worldbody></mujoco>").unwrap();
    let model = Model::from_xml_path(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(model.geom(0).unwrap().name(), None);
    assert!(format!("{}", model.geom(0).unwrap()).contains("(none)"));
}

#[test]
fn sizes_without_measure_are_errors() {
    for size in [
        "njmax='1000000000'",
        "njmax='46341' nstack='1000000'",
        "nconmax='1000000000'",
        "nuserdata='2000000000'",
        "nuserdata='-7'",
        "nuser_body='-5'",
        "nuser_geom='200000000'",
        "nstack='10'",
    ] {
        let xml = format!(
            "<mujoco><size {size}/><worldbody><body><freejoint/><geom size='.1'/><geom size='.1'/></body></worldbody></mujoco>"
        );
        assert!(matches!(Model::from_xml_str(&xml), Err(Error::Load { .. } | Error::OutOfMemory { .. })), "{size}");
    }
    for size in ["njmax='-5'", "nconmax='-5'", "nstack='-5'", "nkey='-3'", "njmax='0' nconmax='0' nstack='0'"] {
        let xml = format!(
            "<mujoco><size {size}/><worldbody><geom type='plane' size='1 1 1'/><body><freejoint/><geom size='.1'/></body></worldbody></mujoco>"
        );
        let mut data = Data::new(Model::from_xml_str(&xml).unwrap()).unwrap();
        data.step().unwrap();
        drop(data.clone());
    }
}
