//! Bodies pulled with the mouse.

use mujoco_safe::scene::{
    Camera, Categories, MouseAction, MovableBodies, Perturbation, PerturbationFlags, Scene, SceneOptions, Selection,
};
use mujoco_safe::sys::{mjvCamera, mjvPerturb};

use crate::raw::{RawScene, filled, raw_perturbation, scene_subjects};
use crate::twins::{Twins, assert_same, c};

#[track_caller]
fn assert_same_perturbation(what: &str, ours: &Perturbation, theirs: &mjvPerturb) {
    let numbers = |pos: [f64; 3], quat: [f64; 4], scale: f64| [&pos[..], &quat, &[scale]].concat();
    assert_same(
        what,
        &numbers(ours.refpos, ours.refquat, ours.scale),
        &numbers(theirs.refpos, theirs.refquat, theirs.scale),
    );
}

const FLAGS: [PerturbationFlags; 4] =
    [PerturbationFlags::empty(), PerturbationFlags::TRANSLATE, PerturbationFlags::ROTATE, PerturbationFlags::all()];

#[test]
fn perturbations_equal_c() {
    let mut posed = 0;
    for subject in scene_subjects() {
        let mut twins = Twins::in_motion(&subject);
        let model = twins.model.clone();
        let mut scene = Scene::new(&model, 20_000).unwrap();
        let mut theirs = RawScene::new(&twins.raw, 20_000);
        let mut camera = Camera::free(&model);
        let mut raw_camera: mjvCamera = filled(|camera| c!(mjv_defaultFreeCamera(model.as_ptr(), camera)));
        let options = SceneOptions::default();
        scene.update(&mut twins.ours, &options, None, &mut camera, Categories::all()).unwrap();
        theirs.update(&twins.raw, &options, None, &mut raw_camera);
        for body in model.bodies().skip(1).take(40) {
            let what = format!("{}, {body:?}", subject.name);
            let mut ours = Perturbation::default();
            ours.select = Some(body.id());
            let mut raw = raw_perturbation(&ours);
            ours.start(&mut twins.ours, &scene).unwrap();
            c!(mjv_initPerturb(model.as_ptr(), twins.raw.d, &raw const *theirs.0, &raw mut raw));
            assert_same_perturbation(&what, &ours, &raw);
            for (number, action) in [MouseAction::RotateV, MouseAction::RotateH, MouseAction::MoveV, MouseAction::MoveH]
                .into_iter()
                .enumerate()
            {
                let motion = twins.numbers(2);
                ours.move_by(&twins.ours, action, [motion[0], motion[1]], &scene).unwrap();
                let (m, d, number) = (model.as_ptr(), twins.raw.d, number as i32 + 1);
                c!(mjv_movePerturb(m, d, number, motion[0], motion[1], &raw const *theirs.0, &raw mut raw));
                assert_same_perturbation(&what, &ours, &raw);
            }
            for (active, active2) in FLAGS.into_iter().flat_map(|one| FLAGS.map(|other| (one, other))) {
                (ours.active, ours.active2) = (active, active2);
                (raw.active, raw.active2) = (active.bits() as i32, active2.bits() as i32);
                twins.raw.write(|d| d.xfrc_applied, &vec![0.0; 6 * model.nbody()]);
                c!(mjv_applyPerturbForce(model.as_ptr(), twins.raw.d, &raw const raw));
                let force = ours.force(&mut twins.ours).unwrap();
                let applied = twins.raw.values(|d| d.xfrc_applied, 6 * model.nbody());
                assert_same(&what, &force, &applied[6 * body.index()..][..6]);
                assert!(twins.ours.xfrc_applied().as_flattened().iter().all(|&force| force == 0.0));
                for (bodies, paused) in [(MovableBodies::Mocap, 0), (MovableBodies::MocapAndFree, 1)] {
                    let before = twins.ours.qpos().to_vec();
                    ours.apply_pose(&mut twins.ours, bodies).unwrap();
                    c!(mjv_applyPerturbPose(model.as_ptr(), twins.raw.d, &raw const raw, paused));
                    assert_same(&what, twins.ours.qpos(), &twins.raw.values(|d| d.qpos, model.nq()));
                    let mocap = twins.raw.values(|d| d.mocap_pos, 3 * model.nmocap());
                    assert_same(&what, twins.ours.mocap_pos().as_flattened(), &mocap);
                    let mocap = twins.raw.values(|d| d.mocap_quat, 4 * model.nmocap());
                    assert_same(&what, twins.ours.mocap_quat().as_flattened(), &mocap);
                    posed += usize::from(before != twins.ours.qpos());
                }
            }
        }
    }
    assert!(posed > 10, "{posed} poses were changed");
}

#[test]
fn perturbations_keep_the_callers_forces() {
    let mut data = mujoco_safe::Data::new(mujoco_safe::sample::humanoid()).unwrap();
    data.forward().unwrap();
    let [torso, head] = ["torso", "head"].map(|name| data.model().body(name).unwrap().id());
    let own = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
    data.xfrc_applied_mut()[torso.index()] = own;
    data.xfrc_applied_mut()[head.index()] = own;

    let mut perturbation = Perturbation::default();
    perturbation.select = Some(torso);
    perturbation.active = PerturbationFlags::all();
    (perturbation.refpos, perturbation.refquat) = ([0.1, 0.2, 1.0], [0.5, 0.1, 0.7, 0.5]);
    let force = perturbation.force(&mut data).unwrap();
    assert!(force.iter().all(|&force| force != 0.0));
    let sum: [f64; 6] = std::array::from_fn(|i| own[i] + force[i]);
    // Applying it repeatedly has the effect of applying it once.
    for _ in 0..3 {
        perturbation.apply_force(&mut data).unwrap();
        assert_eq!(data.xfrc_applied()[torso.index()], sum);
        assert_eq!(data.xfrc_applied()[head.index()], own);
    }
    // Another body is selected.
    perturbation.select = Some(head);
    perturbation.apply_force(&mut data).unwrap();
    assert_eq!(data.xfrc_applied()[torso.index()], own);
    assert_ne!(data.xfrc_applied()[head.index()], own);
    // The caller sets another force.
    data.xfrc_applied_mut()[head.index()] = [0.0; 6];
    let force = perturbation.force(&mut data).unwrap();
    perturbation.apply_force(&mut data).unwrap();
    assert_eq!(data.xfrc_applied()[head.index()], force);
    // The perturbation ends.
    perturbation.stop();
    perturbation.apply_force(&mut data).unwrap();
    assert_eq!(data.xfrc_applied()[head.index()], [0.0; 6]);
    // The force that the caller set is not cleared by the perturbation.
    perturbation.active = PerturbationFlags::TRANSLATE;
    perturbation.apply_force(&mut data).unwrap();
    data.xfrc_applied_mut()[head.index()] = own;
    perturbation.remove_force(&mut data);
    assert_eq!(data.xfrc_applied()[head.index()], own);
    // The world cannot be pulled.
    perturbation.select = Some(data.model().body(0).unwrap().id());
    perturbation.apply_force(&mut data).unwrap();
    assert_eq!(data.xfrc_applied()[0], [0.0; 6]);
}

/// The engine divides by the inertia that such a body shows, which is nearly zero.
#[test]
fn bodies_that_cannot_move_get_no_force() {
    let model = mujoco_safe::Model::from_xml_str(
        r#"<mujoco>
             <worldbody>
               <body name="hand" mocap="true"><geom size=".1"/><body name="finger"><geom size=".1"/></body></body>
               <body name="post" pos="1 0 0"><geom size=".1"/></body>
               <body name="ball" pos="2 0 0"><freejoint/><geom size=".1"/></body>
             </worldbody>
           </mujoco>"#,
    )
    .unwrap();
    let mut data = mujoco_safe::Data::new(model).unwrap();
    data.forward().unwrap();
    for (name, is_movable) in [("hand", false), ("finger", false), ("post", false), ("ball", true)] {
        let body = data.model().body(name).unwrap().id();
        let mut perturbation = Perturbation::default();
        perturbation.select = Some(body);
        perturbation.active = PerturbationFlags::TRANSLATE;
        (perturbation.refpos, perturbation.scale) = ([0.0, 0.0, 1.0], 1.0);
        perturbation.apply_force(&mut data).unwrap();
        assert_eq!(data.xfrc_applied()[body.index()] != [0.0; 6], is_movable, "{name}");
        perturbation.remove_force(&mut data);
    }
}

#[test]
fn the_selected_point_stays_on_the_body() {
    let mut data = mujoco_safe::Data::new(mujoco_safe::sample::humanoid()).unwrap();
    data.qpos_mut()[3..7].copy_from_slice(&[0.5, 0.5, 0.5, 0.5]);
    data.forward().unwrap();
    let body = data.model().body("torso").unwrap().id();
    let point = [0.1, 0.2, 1.4];
    let mut perturbation = Perturbation::default();
    perturbation.active = PerturbationFlags::TRANSLATE;
    perturbation.select(&data, &Selection { body, geom: None, skin: None, flex: None, point }).unwrap();
    assert!(perturbation.active.is_empty());
    let (xpos, xmat) = (data.xpos()[body.index()], data.xmat()[body.index()]);
    let turned = mujoco_safe::math::rot_vec_mat(&perturbation.localpos, &xmat);
    for axis in 0..3 {
        assert!((turned[axis] + xpos[axis] - point[axis]).abs() < 1e-12);
    }
    perturbation.unselect();
    assert_eq!(perturbation.select, None);
}
