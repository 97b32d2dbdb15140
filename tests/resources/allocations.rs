//! Control loops do not allocate, neither in this crate nor, after the first call, in the engine.
#![forbid(unsafe_code)]
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use std::sync::Arc;

use mujoco_safe::data::Timer;
use mujoco_safe::flight::FlightRecorder;
use mujoco_safe::math::{self, BandShape, BoxQp, BoxQpStatus};
use mujoco_safe::scene::{
    Camera, Categories, MouseAction, NewGeom, Perturbation, PerturbationFlags, Scene, SceneOptions, VisualFlags,
};
use mujoco_safe::{Controller, Data, Matrix, Model, RandomController, StateSpec, Trajectory, sample};

use crate::allocator::allocations;
use crate::lock_process;

/// Calls `action` once to warm up, and then asserts that further calls do not allocate.
#[track_caller]
pub(crate) fn allocates_nothing(what: &str, mut action: impl FnMut()) {
    action();
    let (number, ()) = allocations(|| (0..5).for_each(|_| action()));
    assert_eq!(number, 0, "allocations in five calls of {what}");
}

pub(crate) fn squatting() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data.forward().unwrap();
    data
}

#[test]
fn the_counter_counts_allocations_of_rust_and_the_engine() {
    let _lock = lock_process();
    assert!(allocations(|| std::hint::black_box(vec![1_u8; 100])).0 >= 1);
    let model = Arc::new(sample::cartpole());
    // The structure, its buffer and its stack.
    assert!(allocations(|| Data::new(model.clone()).unwrap()).0 >= 3);
    assert!(allocations(|| Model::from_xml_str("<mujoco/>").unwrap()).0 > 100);
}

#[test]
fn the_pipeline_does_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    allocates_nothing("step", || data.step().unwrap());
    allocates_nothing("step1 and step2", || {
        data.step1().unwrap();
        data.step2().unwrap();
    });
    allocates_nothing("forward", || data.forward().unwrap());
    allocates_nothing("inverse", || data.inverse().unwrap());
    allocates_nothing("reset", || data.reset().unwrap());
    allocates_nothing("reset_to_key", || data.reset_to_key(1).unwrap());
    let mut random = RandomController::new(1);
    let (number, ()) = allocations(|| {
        for _ in 0..500 {
            random.control(&mut data).unwrap();
            data.step().unwrap();
        }
    });
    assert_eq!(number, 0, "a humanoid that tumbles");
}

#[test]
fn every_solver_and_integrator_does_not_allocate() {
    use mujoco_safe::enums::{Cone, Integrator, JacobianStorage, Solver};
    let _lock = lock_process();
    let mut data = squatting();
    for solver in [Solver::Pgs, Solver::Cg, Solver::Newton] {
        for integrator in [Integrator::Euler, Integrator::Rk4, Integrator::Implicit] {
            for (jacobian, cone) in
                [(JacobianStorage::Dense, Cone::Elliptic), (JacobianStorage::Sparse, Cone::Pyramidal)]
            {
                data.edit_model(|model| {
                    model.edit_options(|options| {
                        (options.solver, options.integrator) = (solver, integrator);
                        (options.jacobian, options.cone) = (jacobian, cone);
                    })
                })
                .unwrap();
                allocates_nothing("step", || data.step().unwrap());
            }
        }
    }
}

#[test]
fn reading_and_writing_does_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let model = data.model().clone();
    let (knee, torso) = (model.joint("left_knee").unwrap().id(), model.body("torso").unwrap().id());
    let mut sum = 0.0;
    allocates_nothing("arrays", || {
        sum += data.qpos()[0] + data.xpos()[1][2] + model.key_qpos()[(0, 0)] + data.efc_force().iter().sum::<f64>();
        sum += model.body_mass()[1] + model.nq() as f64 + data.time() + data.energy()[0];
        data.ctrl_mut().fill(0.1);
        data.xfrc_applied_mut()[1] = [0.0; 6];
    });
    let mut moment = Matrix::zeros(model.nu(), model.nv());
    allocates_nothing("actuator moments", || data.full_moment_into(&mut moment).unwrap());
    allocates_nothing("views", || {
        let joint = data.joint(knee);
        sum += joint.qpos()[0] + joint.qvel()[0] + model.joint(knee).range()[1] + data.body(torso).xpos()[2];
        sum += data.geoms().map(|geom| geom.xpos()[2]).sum::<f64>();
        data.joint_mut(knee).qvel_mut()[0] = 0.0;
        data.joint_mut(knee).qfrc_applied_mut()[0] = 0.0;
    });
    allocates_nothing("names", || {
        sum += data.joint(knee).name().map_or(0.0, |name| name.len() as f64);
    });
    assert!(sum.is_finite());
}

#[test]
fn views_of_every_kind_do_not_allocate() {
    let _lock = lock_process();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml");
    let mut data = Data::new(Model::from_xml_path(path).unwrap()).unwrap();
    data.forward().unwrap();
    let model = data.model().clone();
    let mut row = vec![0.0; model.nv()];
    let mut count = 0;
    allocates_nothing("assets", || {
        count += model.meshes().map(|mesh| mesh.vert().len() + mesh.graph().map_or(0, <[i32]>::len)).sum::<usize>();
        count += model.skins().flat_map(|skin| skin.bones()).map(|bone| bone.vertid.len()).sum::<usize>();
        count += model.textures().map(|texture| texture.rgb().len()).sum::<usize>();
        count += model.height_fields().map(|field| field.data().len()).sum::<usize>();
        count += model.geoms().filter(|geom| geom.material().is_some() || geom.mesh().is_some()).count();
    });
    allocates_nothing("custom fields", || {
        count += model.tuples().flat_map(|tuple| tuple.objects()).map(|object| object.index()).sum::<usize>();
        count += model.texts().map(|text| text.data().len()).sum::<usize>();
        count += model.numerics().map(|numeric| numeric.data().len()).sum::<usize>();
    });
    allocates_nothing("tendons, actuators and sensors", || {
        for tendon in data.tendons() {
            tendon.J().unwrap().write_into(&mut row).unwrap();
            count += tendon.wrap_points().len() + tendon.in_model().path().count();
        }
        count += data.actuators().filter(|actuator| actuator.act().is_some()).count();
        count += model.sensors().filter(|sensor| sensor.reference().is_some()).count();
    });
    assert!(count > 0);
}

#[test]
fn contacts_and_their_forces_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    data.step().unwrap();
    assert!(data.contacts().len() > 0);
    let mut sum = 0.0;
    allocates_nothing("contacts", || {
        for contact in data.contacts() {
            sum += contact.force().unwrap().force[0] + contact.force_in_world().unwrap()[2] + contact.dist();
            sum += contact.geoms().unwrap()[0].index() as f64 + contact.normal()[2];
        }
    });
    assert!(sum.is_finite());
}

#[test]
fn jacobians_and_inertia_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let model = data.model().clone();
    let (torso, geom) = (model.body("torso").unwrap().id(), model.geom(1).unwrap().id());
    let nv = model.nv();
    let (mut first, mut second) = (Matrix::zeros(3, nv), Matrix::zeros(3, nv));
    allocates_nothing("Jacobians", || {
        data.jac_into([0.0; 3], torso, Some(&mut first), Some(&mut second)).unwrap();
        data.jac_body_into(torso, Some(&mut first), Some(&mut second)).unwrap();
        data.jac_body_com_into(torso, Some(&mut first), None).unwrap();
        data.jac_geom_into(geom, None, Some(&mut second)).unwrap();
        data.jac_subtree_com_into(torso, &mut first).unwrap();
    });
    let (mut full, mut result, vector) = (Matrix::zeros(nv, nv), vec![0.0; nv], vec![1.0; nv]);
    allocates_nothing("inertia", || {
        data.full_m_into(&mut full).unwrap();
        data.mul_m_into(&vector, &mut result).unwrap();
        data.solve_m_into(&vector, &mut result).unwrap();
    });
    let (from, mut to) = (model.qpos0().to_vec(), model.qpos0().to_vec());
    allocates_nothing("positions", || {
        model.integrate_pos(&mut to, &vector, 0.1).unwrap();
        model.differentiate_pos_into(0.1, &from, &to, &mut result).unwrap();
    });
}

#[test]
fn scenes_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let model = data.model().clone();
    let mut scene = Scene::new(&model, 5000).unwrap();
    let mut camera = Camera::free(&model);
    let options = SceneOptions::default().with_flags(VisualFlags::all());
    let mut perturbation = Perturbation::default();
    perturbation.select = Some(model.body("torso").unwrap().id());
    perturbation.active = PerturbationFlags::all();
    allocates_nothing("a scene", || {
        perturbation.apply_force(&mut data).unwrap();
        data.step().unwrap();
        scene.update(&mut data, &options, Some(&perturbation), &mut camera, Categories::all()).unwrap();
        scene.add_geoms(&mut data, &options, None, Categories::DYNAMIC).unwrap();
        scene.add_geom(&NewGeom::text("here").unwrap()).unwrap();
        camera.move_by(&model, MouseAction::RotateV, [0.1, 0.0], &scene).unwrap();
        perturbation.start(&mut data, &scene).unwrap();
        perturbation.move_by(&data, MouseAction::MoveV, [0.1, 0.0], &scene).unwrap();
        scene.select(&data, &options, 1.0, [0.5; 2]).unwrap();
        assert!(scene.geoms().filter(|geom| geom.object().is_some()).count() > 10);
        assert!(scene.lights().len() > 0 && scene.skins().len() == 0);
    });
}

#[cfg(feature = "renderer")]
#[test]
fn snapshots_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let mut renderer = mujoco_safe::render::Renderer::new(data.model(), 8, 8).unwrap();
    let side = data.model().camera("side").unwrap().id();
    let mut free = Camera::free(data.model());
    allocates_nothing("a snapshot", || {
        data.step().unwrap();
        renderer.snapshot(&mut data, side).unwrap();
        renderer.snapshot(&mut data, &mut free).unwrap();
    });
}

/// Fills a trajectory with capacity for 100 records.
fn record_without_allocation(data: &mut Data, mut trajectory: Trajectory) {
    allocates_nothing("push", || trajectory.push(data).unwrap());
    let mut random = RandomController::new(1);
    let (number, result) = allocations(|| trajectory.record(data, &mut random, 94));
    result.unwrap();
    assert_eq!((number, trajectory.len()), (0, 100), "record within the capacity");
    allocates_nothing("apply", || trajectory.apply(3, data).unwrap());
}

#[test]
fn states_and_trajectories_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let mut state = vec![0.0; data.model().state_size(StateSpec::INTEGRATION)];
    allocates_nothing("states", || {
        data.state_into(StateSpec::INTEGRATION, &mut state).unwrap();
        data.set_state(StateSpec::INTEGRATION, &state).unwrap();
    });
    record_without_allocation(&mut data, Trajectory::with_capacity(&sample::humanoid(), 100));
    let mut cartpole = Data::new(sample::cartpole()).unwrap();
    cartpole.forward().unwrap();
    let mut trajectory = Trajectory::with_sensordata(cartpole.model());
    trajectory.reserve(100);
    record_without_allocation(&mut cartpole, trajectory);
}

#[test]
fn recorded_steps_do_not_allocate() {
    let _lock = lock_process();
    let mut data = squatting();
    let Ok(recorder) = FlightRecorder::new(&data) else { return };
    // The oldest calls are replaced many times.
    let mut recorder = recorder.with_memory(0);
    let mut random = RandomController::new(1);
    let mut steps = |data: &mut Data| {
        for _ in 0..1000 {
            random.control(data).unwrap();
            recorder.step(data).unwrap();
        }
    };
    steps(&mut data);
    assert_eq!(allocations(|| steps(&mut data)).0, 0);
}

#[test]
fn copying_into_existing_objects_does_not_allocate() {
    let _lock = lock_process();
    let source = squatting();
    let mut copy = source.clone();
    allocates_nothing("copy_from", || copy.copy_from(&source).unwrap());
    allocates_nothing("clone_from", || copy.clone_from(&source));
    // The first edit copies the shared model; later edits write to the copy.
    allocates_nothing("edit_model", || {
        copy.edit_model(|model| {
            model.set_timestep(0.002).unwrap();
            model.body_mass_mut()[1] = 1.0;
        })
        .unwrap();
    });
}

#[test]
fn settings_and_statistics_do_not_allocate() {
    let _lock = lock_process();
    let mut model = sample::humanoid();
    allocates_nothing("settings", || {
        model.edit().edit_options(|options| options.gravity[0] += 0.1).unwrap();
        model.edit().edit_visual(|visual| visual.global.azimuth += 1.0).unwrap();
        model.edit().edit_statistics(|statistics| statistics.center[0] += 0.1).unwrap();
        std::hint::black_box((model.options(), model.visual(), model.statistics()));
    });
    let data = squatting();
    allocates_nothing("timers and iterations", || {
        for timer in Timer::ALL {
            std::hint::black_box(data.timer(timer));
        }
        for iteration in data.solver() {
            std::hint::black_box(iteration);
        }
    });
}

#[test]
fn mathematical_functions_do_not_allocate() {
    let _lock = lock_process();
    let data = squatting();
    let mass = data.full_m().unwrap();
    let nv = mass.nrows();
    let (mut factor, mut product) = (mass.clone(), Matrix::zeros(nv, nv));
    let (mut x, mut res, bound) = (vec![0.5; nv], vec![0.0; nv], vec![0.1; nv]);
    allocates_nothing("products and factors", || {
        factor.as_mut_slice().copy_from_slice(mass.as_slice());
        math::chol_factor(&mut factor, 1e-15).unwrap();
        math::chol_solve(&mut res, &factor, data.qfrc_bias()).unwrap();
        math::mul_mat_mat(&mut product, &mass, &factor).unwrap();
        math::sqr_mat_td(&mut product, &mass, Some(&x)).unwrap();
    });
    let mut solver = BoxQp::new(nv);
    allocates_nothing("BoxQp::solve", || {
        x.fill(0.0);
        let solution = solver.solve(&mut x, &mass, data.qfrc_bias(), None, Some(&bound)).unwrap();
        assert_eq!(solution.status, BoxQpStatus::Solved);
    });
    let shape = BandShape::new(nv, 3, 2).unwrap();
    let mut band = vec![0.0; shape.len()];
    allocates_nothing("band matrices", || {
        math::dense2band(&mut band, &mass, shape).unwrap();
        math::chol_factor_band(&mut band, shape, 100.0, 0.0).unwrap().unwrap();
        math::chol_solve_band_in_place(&band, &mut res, shape).unwrap();
    });
}
