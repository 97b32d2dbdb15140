//! A URDF in a scene: floor, motors, a second robot, saved and loaded again.

use mujoco_safe::enums::GeomType;
use mujoco_safe::kind::Joint;
use mujoco_safe::spec::{ActuatorElement, Mount, Spec};
use mujoco_safe::{Data, Model};

use super::{joint, link, read, robot};

/// Each robot keeps the inertias that its own settings give.
#[test]
fn robots_with_other_inertia_settings_share_a_scene() {
    let b = "<link name='b'><inertial><mass value='1'/>
        <inertia ixx='1e-5' iyy='1e-5' izz='1e-5' ixy='9e-6' ixz='0' iyz='0'/></inertial></link>";
    let text = |settings: &str, b: &str| {
        let settings = format!("<mujoco><compiler {settings}/></mujoco>");
        robot(&(settings + &link("a", "") + b + &joint("j", "revolute", "a", "b", "")))
    };
    let bounded = text("balanceinertia='true' boundinertia='3e-6'", b);
    let mut scene = Spec::new("scene");
    scene.attach(&read(&text("", &link("b", ""))), Mount::body(scene.world()), "plain/").unwrap();
    scene.attach(&read(&bounded), Mount::body(scene.world()), "bounded/").unwrap();
    let model = scene.compile().unwrap();
    // The principal moments are 1.9e-5, 1e-5 and 1e-6, of which the last one is bounded.
    let mean = (1.9e-5 + 1e-5 + 3e-6) / 3.0;
    let found = model.body("bounded/b").unwrap().inertia();
    assert!(found.iter().all(|moment| (moment - mean).abs() < 1e-11), "{found:?}");
    let alone = read(&bounded).compile().unwrap();
    let alone = alone.body("b").unwrap().inertia();
    assert!(found.iter().zip(alone).all(|(a, b)| (a - b).abs() < 1e-11), "{found:?} {alone:?}");
}

#[test]
fn robots_from_urdf_stand_in_a_scene() {
    let geometry = "<collision><geometry><box size='.2 .2 .2'/></geometry></collision>
        <visual><geometry><sphere radius='.2'/></geometry></visual>";
    let urdf = robot(
        &(link("base", geometry)
            + &link("arm", geometry)
            + &link("finger", geometry)
            + &link("tool", "")
            + &joint(
                "shoulder",
                "revolute",
                "base",
                "arm",
                "<origin xyz='0 0 .5' rpy='0 .5 0'/><limit lower='-1' upper='2' effort='30'/>",
            )
            + &joint(
                "grip",
                "prismatic",
                "arm",
                "finger",
                "<origin xyz='0 0 .5'/><mimic joint='shoulder' multiplier='.1'/>",
            )
            + &joint("mount", "fixed", "arm", "tool", "<origin xyz='0 .3 0'/>")),
    );
    let mut walker = read(&urdf);
    walker.add_free_base().unwrap().set_name("root");
    let mut scene = Spec::new("scene");
    let world = scene.world();
    scene.add_geom(world).set_type(GeomType::Plane).set_size(&[5.0, 5.0, 0.1]);
    scene.add_camera(world).set_name("eye").set_pos([0.0, -3.0, 2.0]);
    scene.attach(&walker, Mount::body(world).with_pos([0.0, 0.0, 1.0]), "left/").unwrap();
    scene.attach(&read(&urdf), Mount::body(world).with_pos([2.0, 0.0, 0.1]), "right/").unwrap();
    for hinge in ["left/shoulder", "right/shoulder"] {
        scene.add_actuator(ActuatorElement::Motor).set_name(hinge).set_joint(hinge);
    }
    let model = scene.compile().unwrap();
    // All links are bodies: the scene fuses none.
    assert_eq!((model.nbody(), model.nv(), model.nu()), (9, 10, 2));
    assert_eq!(model.body("left/tool").unwrap().mass(), 1.5);
    assert_eq!(scene.ids::<Joint>().len(), 5);

    let folder = tempfile::tempdir().unwrap();
    scene.save_xml(folder.path().join("scene.xml")).unwrap();
    let loaded = Model::from_xml_path(folder.path().join("scene.xml")).unwrap();
    let mut both = [model, loaded].map(|model| Data::new(model).unwrap());
    for data in &mut both {
        data.ctrl_mut().fill(1.0);
        (0..100).for_each(|_| data.step().unwrap());
    }
    assert_eq!(both[0].qpos(), both[1].qpos());
    // The attached robot falls as it does alone. (3.5.0 computes a wrong inertia of fused links.)
    let mut alone = read(&urdf);
    alone.section_mut("compiler").unwrap().set("fusestatic", false).unwrap();
    let mut alone = Data::new(alone.compile().unwrap()).unwrap();
    let mut attached = Data::new({
        let mut scene = Spec::new("scene");
        scene.attach(&read(&urdf), Mount::body(scene.world()), "a/").unwrap();
        scene.compile().unwrap()
    })
    .unwrap();
    for data in [&mut alone, &mut attached] {
        (0..100).for_each(|_| data.step().unwrap());
    }
    let [alone, attached] = [alone.qpos(), attached.qpos()];
    assert!(alone.iter().zip(attached).all(|(a, b)| (a - b).abs() < 1e-12), "{alone:?} {attached:?}");
}
