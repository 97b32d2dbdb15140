//! Poisoning by engine errors: which calls poison the data, and what a poisoned data still does.

use mujoco_sys::mjGEOM_BOX;

use crate::derivative::Differences;
use crate::scene::{Camera, Categories, MouseAction, Perturbation, Scene, SceneOptions};
use crate::{Axes, Data, Error, Frame, Matrix, Model, RayOptions, Result, Stage, StateSpec, sample};

type Call = (&'static str, fn(&mut Data) -> Result<()>);

/// The humanoid, squatting, with everything computed.
fn squatting() -> Data {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.reset_to_key("squat").unwrap();
    data.forward().unwrap();
    data.rne_post_constraint().unwrap();
    data
}

/// Leaves no room on the engine's stack, as after a failed allocation.
fn fill_stack(data: &mut Data) {
    data.raw_mut().pstack = data.raw().nstack;
}

fn body(data: &Data) -> crate::BodyId {
    data.model().body("foot_left").unwrap().id()
}

/// Calls that take `&mut Data` and fail without room on the stack.
const WRITING: [Call; 20] = [
    ("step", |data| data.step()),
    ("step1", |data| data.step1()),
    ("step2", |data| data.step2()),
    ("forward", |data| data.forward()),
    ("inverse", |data| data.inverse()),
    ("forward_skip", |data| data.forward_skip(Stage::Velocity, true)),
    ("inverse_skip", |data| data.inverse_skip(Stage::Velocity, true)),
    ("com_pos", |data| data.com_pos()),
    ("fwd_position", |data| data.fwd_position()),
    ("make_constraint", |data| data.make_constraint()),
    ("fwd_constraint", |data| data.fwd_constraint()),
    ("subtree_vel", |data| data.subtree_vel()),
    ("compute_qfrc_bias", |data| data.compute_qfrc_bias()),
    ("transition_fd", |data| data.transition_fd(1e-6, Differences::Forward).map(drop)),
    ("inverse_fd", |data| data.inverse_fd(1e-6, false).map(drop)),
    ("rne", |data| data.rne(true, &mut vec![0.0; data.model().nv()])),
    ("jac_subtree_com", |data| data.jac_subtree_com(body(data)).map(drop)),
    ("jac_point_axis", |data| data.jac_point_axis(body(data), [0.0; 3], [1.0, 0.0, 0.0]).map(drop)),
    ("apply_ft", |data| {
        let mut target = vec![0.0; data.model().nv()];
        data.apply_ft([1.0; 3], [0.0; 3], [0.0; 3], body(data), &mut target)
    }),
    ("print_to", |data| {
        let folder = tempfile::tempdir().unwrap();
        data.print_to(folder.path().join("data.txt"))
    }),
];

/// Calls that take `&Data`, with the numbers that they return.
fn readings(data: &Data) -> Vec<f64> {
    let body = body(data);
    let nv = data.model().nv();
    let mut product = vec![0.0; nv];
    data.mul_m(&mut product, data.qvel()).unwrap();
    let jacobian = data.jac_body_com(body).unwrap();
    let velocity = data.object_velocity(Frame::Body(body), Axes::World).unwrap();
    let acceleration = data.object_acceleration(Frame::Body(body), Axes::World).unwrap();
    let hit = data.ray([5.0, 5.0, 3.0], [0.0, 0.0, -1.0], &RayOptions::default()).unwrap();
    let copy = data.try_clone().unwrap();
    let force = data.contacts().next().unwrap().force().unwrap();
    [&product, jacobian.translation.as_slice(), &velocity.linear, &acceleration.linear, &force.force]
        .concat()
        .into_iter()
        .chain([hit.unwrap().distance])
        .chain(copy.state(StateSpec::INTEGRATION))
        .collect()
}

/// Checks that `error` is that of the engine, that the data refuses everything but a reset, and that a reset heals it.
#[track_caller]
fn assert_poisoned(name: &str, error: Option<&Error>, data: &mut Data, qpos: &[f64]) {
    assert!(matches!(error, Some(Error::Engine { .. })), "{name}: {error:?}");
    for (after, call) in WRITING {
        let error = call(data).unwrap_err();
        assert!(matches!(error, Error::Poisoned { .. }), "{after} after {name}: {error}");
    }
    let refused = [
        data.full_m().map(drop),
        data.ray([0.0; 3], [1.0; 3], &RayOptions::default()).map(drop),
        data.object_velocity(Frame::Body(body(data)), Axes::World).map(drop),
    ];
    assert!(refused.iter().all(|result| matches!(result, Err(Error::Poisoned { .. }))), "{name}: {refused:?}");
    assert_eq!(data.qpos(), qpos, "{name}: the state can still be read");
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
        assert_poisoned(name, error.as_ref(), &mut data, &qpos);
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
    // A box without an inside, from which the engine computes no distance.
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
    let data = squatting();
    let before = readings(&data);
    // The engine refuses a scene that was never updated.
    let scene = Scene::new(data.model(), 100).unwrap();
    let mut perturbation = Perturbation::default();
    perturbation.select = Some(body(&data));
    let failed = [
        perturbation.init(&data, &scene),
        perturbation.move_by(&data, &scene, MouseAction::MoveV, [0.1, 0.1]),
        scene.select(&data, &SceneOptions::default(), 1.0, [0.5, 0.5]).map(drop),
    ];
    for result in failed {
        assert!(matches!(result, Err(Error::Engine { .. })), "{result:?}");
        assert_eq!((data.stage(), readings(&data)), (Stage::Acceleration, before.clone()));
    }
}

#[test]
fn calls_that_only_read_need_no_room_on_the_stack() {
    let mut data = squatting();
    let before = readings(&data);
    fill_stack(&mut data);
    assert_eq!(readings(&data), before);
    let mut scene = Scene::new(data.model(), 1000).unwrap();
    let mut camera = Camera::free(data.model());
    scene.update_camera(&data, &mut camera).unwrap();
    scene.update(&mut data, &SceneOptions::default(), None, &mut camera, Categories::all()).unwrap();
    let mut sum = Matrix::zeros(data.model().nv(), data.model().nv());
    data.add_m(&mut sum).unwrap();
    assert_eq!(data.stage(), Stage::Acceleration);
}

#[test]
fn copies_take_over_whether_a_data_is_poisoned() {
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
