//! A URDF in a scene: floor, motors, a second robot, saved and loaded again.

use mujoco_safe::enums::GeomType;
use mujoco_safe::kind::Joint;
use mujoco_safe::spec::{ActuatorElement, Mount, Spec, UrdfWarning};
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
    // The fingers follow the shoulders.
    assert_eq!(scene.add_motors().len(), 2);
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

#[test]
fn motors_have_the_limits_of_the_joints_that_they_drive() {
    let links: String = ["base", "a", "b", "c", "d", "e"].map(|name| link(name, "")).concat();
    let urdf = robot(
        &(links
            + &joint("turn", "continuous", "base", "a", "<limit effort='30' velocity='1'/>")
            + &joint("slide", "prismatic", "a", "b", "")
            + &joint("follow", "revolute", "a", "c", "<limit effort='5'/><mimic joint='turn'/>")
            + &joint("plane", "planar", "b", "d", "<limit effort='7' velocity='1'/>")
            + &joint("ball", "spherical", "c", "e", "<limit effort='9'/>")),
    );
    let mut spec = read(&urdf);
    spec.add_actuator(ActuatorElement::Position).set_name("slide").set_joint("plane_RZ");
    let motors = spec.add_motors();
    let names: Vec<Option<&str>> = motors.iter().map(|&motor| spec.actuator(motor).name()).collect();
    // An actuator has the name of the slide.
    assert_eq!(names, [Some("turn"), None, Some("plane_TX"), Some("plane_TY")]);
    let efforts: Vec<&str> = spec
        .urdf_warnings()
        .iter()
        .filter_map(|warning| match warning {
            UrdfWarning::EffortLimit { joint, .. } => Some(joint.as_str()),
            _ => None,
        })
        .filter(|joint| *joint != "follow") // since 3.0 it is limited
        .collect();
    assert_eq!(efforts, ["ball"]);
    assert_eq!(spec.add_motors(), []);

    let mut data = Data::new(spec.compile().unwrap()).unwrap();
    data.ctrl_mut().copy_from_slice(&[0.0, 100.0, 100.0, -100.0, 100.0]);
    data.forward().unwrap();
    assert_eq!(data.actuator_force(), [0.0, 30.0, 100.0, -7.0, 100.0]);
}

/// Limits of MJCF, also by a class of defaults.
#[test]
#[cfg(engine_since = "3.0.0")]
fn motors_have_the_limits_of_mjcf() {
    let mut spec = Spec::from_xml_str(
        "<mujoco><default>
           <default class='weak'><joint actuatorfrcrange='-2 3'/></default>
           <default class='off'><joint actuatorfrclimited='false' actuatorfrcrange='-2 3'/></default>
         </default><worldbody>
           <body><freejoint/><geom size='.1'/></body>
           <body><joint class='weak'/><geom size='.1'/></body>
           <body><joint class='off'/><geom size='.1'/></body>
         </worldbody></mujoco>",
    )
    .unwrap();
    spec.add_motors();
    let mut data = Data::new(spec.compile().unwrap()).unwrap();
    data.ctrl_mut().fill(10.0);
    data.forward().unwrap();
    assert_eq!(data.actuator_force(), [3.0, 10.0]);
}
