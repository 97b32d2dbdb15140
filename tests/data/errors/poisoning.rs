//! Poisoning by engine errors: calls that poison the data, and the behaviour of poisoned data.

use mujoco_safe::data::{Accelerations, Axes, FrameId, RayOptions, SensorUpdate};
use mujoco_safe::derivative::InverseForce;
use mujoco_safe::id::BodyId;
use mujoco_safe::scene::{Camera, Categories, MouseAction, Perturbation, Scene, SceneOptions};
use mujoco_safe::sys::mjGEOM_BOX;
use mujoco_safe::{Data, Differences, Error, Matrix, Model, Result, Stage, StateSpec, sample};

type Call = (&'static str, fn(&mut Data) -> Result<()>);

/// Returns the humanoid in a squat, with all quantities computed.
fn squatting() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data.forward().unwrap();
    data.rne_post_constraint().unwrap();
    data
}

/// Marks the whole stack of the engine as used, so that every allocation fails.
#[allow(unsafe_code, reason = "no safe call fills the stack")]
fn fill_stack(data: &mut Data) {
    let raw = data.as_mut_ptr();
    // SAFETY: the pointer is valid, and the data is borrowed exclusively. Engine calls can leave
    // the stack full as well.
    unsafe {
        #[cfg(not(engine_since = "2.3.0"))]
        ((*raw).pstack = (*raw).nstack);
        // The stack is the end of an arena, in bytes. Contacts and constraints are its beginning,
        // and remain readable. A collision would release their memory, so it is not counted as
        // used.
        #[cfg(engine_since = "2.3.0")]
        (((*raw).parena, (*raw).pstack) = (0, (*raw).narena as usize));
    }
}

fn body(data: &Data) -> BodyId {
    data.model().body("foot_left").unwrap().id()
}

/// Calls that take `&mut Data` and fail if the stack is full.
const WRITING: [Call; 20] = [
    ("step", |data| data.step()),
    ("step1", |data| data.step1()),
    ("step2", |data| data.step2()),
    ("forward", |data| data.forward()),
    ("inverse", |data| data.inverse()),
    ("forward_skip", |data| data.forward_skip(Stage::Velocity, SensorUpdate::Skip)),
    ("inverse_skip", |data| data.inverse_skip(Stage::Velocity, SensorUpdate::Skip)),
    ("com_pos", |data| data.com_pos()),
    ("fwd_position", |data| data.fwd_position()),
    ("make_constraint", |data| data.make_constraint()),
    ("fwd_constraint", |data| data.fwd_constraint()),
    ("subtree_vel", |data| data.subtree_vel()),
    ("compute_qfrc_bias", |data| data.compute_qfrc_bias()),
    ("transition_fd", |data| data.transition_fd(1e-6, Differences::Forward).map(drop)),
    ("inverse_fd", |data| data.inverse_fd(1e-6, InverseForce::Total).map(drop)),
    ("rne", |data| data.rne_into(Accelerations::Present, &mut vec![0.0; data.model().nv()])),
    ("jac_subtree_com", |data| data.jac_subtree_com(body(data)).map(drop)),
    ("jac_point_axis", |data| data.jac_point_axis([0.0; 3], [1.0, 0.0, 0.0], body(data)).map(drop)),
    ("apply_ft", |data| {
        let mut target = vec![0.0; data.model().nv()];
        data.apply_ft([1.0; 3], [0.0; 3], [0.0; 3], body(data), &mut target)
    }),
    ("print_to", |data| {
        let folder = tempfile::tempdir().unwrap();
        data.print_to(folder.path().join("data.txt"))
    }),
];

/// Those of the calls that do not use the stack of the engine under test.
const WITHOUT_STACK: &[&str] = if cfg!(engine_since = "3.5.0") { &["com_pos"] } else { &[] };

/// Makes calls that take `&Data`, and returns their results.
fn readings(data: &Data) -> Vec<f64> {
    let body = body(data);
    let nv = data.model().nv();
    let mut product = vec![0.0; nv];
    data.mul_m_into(data.qvel(), &mut product).unwrap();
    let jacobian = data.jac_body_com(body).unwrap();
    let velocity = data.object_velocity(FrameId::Body(body), Axes::World).unwrap();
    let acceleration = data.object_acceleration(FrameId::Body(body), Axes::World).unwrap();
    let hit = data.ray([5.0, 5.0, 3.0], [0.0, 0.0, -1.0], &RayOptions::default()).unwrap();
    let copy = data.try_clone().unwrap();
    let force = data.contacts().next().unwrap().force().unwrap();
    [&product, jacobian.linear.as_slice(), &velocity.linear, &acceleration.linear, &force.force]
        .concat()
        .into_iter()
        .chain([hit.unwrap().distance])
        .chain(copy.state(StateSpec::INTEGRATION))
        .collect()
}

/// Checks that `error` is an engine error, that all calls except a reset fail, and that a reset
/// makes the data usable.
#[track_caller]
fn assert_poisoned(name: &str, error: Option<&Error>, data: &mut Data, qpos: &[f64]) {
    assert!(matches!(error, Some(Error::Engine { .. })), "{name}: {error:?}");
    for (after, call) in WRITING {
        let error = call(data).unwrap_err();
        assert!(matches!(error, Error::Poisoned { .. }), "{after} after {name}: {error}");
    }
    let rejected = [
        data.full_m().map(drop),
        data.ray([0.0; 3], [1.0; 3], &RayOptions::default()).map(drop),
        data.object_velocity(FrameId::Body(body(data)), Axes::World).map(drop),
    ];
    assert!(rejected.iter().all(|result| matches!(result, Err(Error::Poisoned { .. }))), "{name}: {rejected:?}");
    assert_eq!(data.qpos(), qpos, "{name}: the state is readable");
    data.reset().unwrap();
    data.step().unwrap();
}

#[test]
fn an_engine_error_in_a_call_that_writes_poisons_the_data_until_a_reset() {
    let base = squatting();
    for (name, call) in WRITING {
        let mut data = base.clone();
        let before = if name == "step2" { data.step1() } else { Ok(()) };
        before.unwrap();
        let qpos = data.qpos().to_vec();
        fill_stack(&mut data);
        let error = call(&mut data).err();
        if WITHOUT_STACK.contains(&name) {
            assert!(error.is_none(), "{name}: {error:?}");
        } else {
            assert_poisoned(name, error.as_ref(), &mut data, &qpos);
        }
    }
}

#[test]
fn the_same_calls_leave_the_data_usable_when_they_succeed() {
    for (name, call) in WRITING {
        let mut data = squatting();
        call(&mut data).unwrap_or_else(|error| panic!("{name}: {error}"));
        data.step().unwrap();
    }
}

#[test]
fn a_distance_that_the_engine_cannot_compute_poisons_the_data() {
    let mut model = Model::from_xml_str(
        r#"<mujoco><worldbody>
             <geom name="a" size="0.5"/>
             <body pos="2 0 0"><freejoint/><geom name="b" type="box" size=".1 .1 .1"/></body>
           </worldbody></mujoco>"#,
    )
    .unwrap();
    let [a, b] = ["a", "b"].map(|name| model.geom(name).unwrap().id());
    assert_eq!(model.geom_type()[b.index()], mjGEOM_BOX as i32);
    // The engine cannot compute a distance from a box of size zero.
    model.edit().geom_size_mut()[b.index()] = [0.0; 3];
    let mut data = Data::new(model).unwrap();
    data.kinematics().unwrap();
    let error = data.geom_distance(a, b, 10.0).unwrap_err();
    assert!(matches!(error, Error::Engine { .. }), "{error}");
    assert!(matches!(data.kinematics(), Err(Error::Poisoned { .. })));
    data.reset().unwrap();
    data.kinematics().unwrap();
}

#[test]
fn an_engine_error_in_a_call_that_only_reads_leaves_the_data_usable_and_unchanged() {
    let mut data = squatting();
    let before = readings(&data);
    // The engine rejects a scene that was never updated.
    let scene = Scene::new(data.model(), 100).unwrap();
    let mut perturbation = Perturbation::default();
    perturbation.select = Some(body(&data));
    let failed = [
        perturbation.start(&mut data, &scene),
        perturbation.move_by(&data, MouseAction::MoveV, [0.1, 0.1], &scene),
        scene.select(&data, &SceneOptions::default(), 1.0, [0.5, 0.5]).map(drop),
    ];
    for result in failed {
        assert!(matches!(result, Err(Error::Engine { .. })), "{result:?}");
        assert_eq!((data.stage(), readings(&data)), (Stage::Acceleration, before.clone()));
    }
}

#[test]
fn calls_that_only_read_do_not_use_the_stack() {
    let mut data = squatting();
    let before = readings(&data);
    fill_stack(&mut data);
    assert_eq!(readings(&data), before);
    let mut sum = Matrix::zeros(data.model().nv(), data.model().nv());
    data.add_m(&mut sum).unwrap();
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    let mut camera = Camera::free(data.model());
    scene.update_camera(&data, &mut camera).unwrap();
    assert_eq!(data.stage(), Stage::Acceleration);
    let updated = scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all());
    if cfg!(engine_since = "4.0.0") {
        // This engine uses the stack in the call, which takes `&mut Data`.
        assert!(matches!(updated, Err(Error::Engine { .. })), "{updated:?}");
        assert!(matches!(data.step(), Err(Error::Poisoned { .. })));
        data.reset().unwrap();
        data.step().unwrap();
    } else {
        updated.unwrap();
        assert_eq!(data.stage(), Stage::Acceleration);
    }
}

#[test]
fn copies_of_poisoned_data_are_poisoned() {
    let usable = squatting();
    let mut poisoned = usable.clone();
    fill_stack(&mut poisoned);
    assert!(matches!(poisoned.step(), Err(Error::Engine { .. })));
    assert!(matches!(poisoned.clone().step(), Err(Error::Poisoned { .. })));
    let mut copy = usable.clone();
    copy.copy_from(&poisoned).unwrap();
    assert!(matches!(copy.step(), Err(Error::Poisoned { .. })));
    copy.copy_from(&usable).unwrap();
    copy.step().unwrap();
}
