//! Attachment of specs, compared with texts of the joined models.

use mujoco_safe::spec::{ActuatorElement, Mount, Spec};
use mujoco_safe::{Data, Error, LoadOptions, Model};

use super::super::assets;
use super::{parse, same};

const CHILD: &str = "<mujoco model='arm'>
  <default><geom size='.1' rgba='1 0 0 1'/><default class='thin'><geom size='.05'/></default></default>
  <asset><material name='red' rgba='1 0 0 1'/></asset>
  <worldbody>
    <geom name='base' material='red'/>
    <body name='arm' pos='0 0 1'>
      <joint name='hinge'/><geom name='link' class='thin'/><site name='tip'/>
      <body name='hand' childclass='thin'><geom/></body>
    </body>
  </worldbody>
  <contact><exclude body1='world' body2='arm'/></contact>
  <equality><weld body1='hand'/></equality>
  <actuator><motor name='torque' joint='hinge'/></actuator>
  <sensor><framepos objtype='site' objname='tip' reftype='body' refname='arm'/></sensor>
  <keyframe><key qpos='1'/></keyframe>
</mujoco>";

#[test]
fn attaching_equals_the_joined_text() {
    let mut spec = parse(
        "<mujoco><default><geom type='box' size='.3 .3 .3'/></default>
         <worldbody><geom name='base'/><body name='stand'><freejoint/><geom/></body></worldbody></mujoco>",
    );
    let stand = spec.body("stand").unwrap().id();
    let bodies = spec.attach(&parse(CHILD), Mount::body(stand).with_pos([0.0, 0.0, 2.0]), "left_").unwrap();
    assert_eq!(spec.body(bodies[0]).name(), Some("left_arm"));
    same(
        &spec,
        "<mujoco>
           <default>
             <default class='ours'><geom type='box' size='.3 .3 .3'/></default>
             <default class='theirs'>
               <geom size='.1' rgba='1 0 0 1'/><default class='thin'><geom size='.05'/></default>
             </default>
           </default>
           <asset><material name='left_red' rgba='1 0 0 1'/></asset>
           <worldbody>
             <geom name='base' class='ours'/>
             <body name='stand' childclass='ours'>
               <freejoint/><geom/>
               <geom name='left_base' class='theirs' pos='0 0 2' material='left_red'/>
               <body name='left_arm' childclass='theirs' pos='0 0 3'>
                 <joint name='left_hinge'/><geom name='left_link' class='thin'/><site name='left_tip'/>
                 <body name='left_hand' childclass='thin'><geom/></body>
               </body>
             </body>
           </worldbody>
           <contact><exclude body1='stand' body2='left_arm'/></contact>
           <equality><weld body1='left_hand' body2='stand' anchor='0 0 2'/></equality>
           <actuator><motor name='left_torque' joint='left_hinge'/></actuator>
           <sensor><framepos objtype='site' objname='left_tip' reftype='body' refname='left_arm'/></sensor>
           <keyframe><key qpos='0 0 0 1 0 0 0 1'/></keyframe>
         </mujoco>",
    );
}

/// The class with the defaults of the spec has another name after an attachment.
#[test]
fn elements_that_are_added_after_an_attachment_have_the_defaults_of_the_spec() {
    let mut spec = Spec::new("scene");
    spec.default_mut("main", "geom").unwrap().set("rgba", [0.0, 1.0, 0.0, 1.0]).unwrap();
    spec.default_mut("main", "motor").unwrap().set("gear", 7.0).unwrap();
    let mount = Mount::body(spec.world());
    spec.attach(&parse(CHILD), mount, "c_").unwrap();
    spec.default_mut("main", "geom").unwrap().set("size", 0.2).unwrap();
    let world = spec.world();
    spec.add_geom(world).set_name("in_world");
    let body = spec.add_body(world).id();
    spec.add_joint(body).set_name("joint");
    spec.add_geom(body).set_name("in_body");
    spec.add_actuator(ActuatorElement::Motor).set_name("motor").set_joint("joint");
    let model = spec.compile().unwrap();
    for name in ["in_world", "in_body"] {
        let geom = model.geom(name).unwrap();
        assert_eq!((geom.rgba(), geom.size()[0]), (&[0.0, 1.0, 0.0, 1.0], 0.2), "{name}");
    }
    assert_eq!(model.actuator("motor").unwrap().gear()[0], 7.0);
    assert_eq!(model.actuator("c_torque").unwrap().gear()[0], 1.0);
    assert_eq!(model.geom("c_base").unwrap().size()[0], 0.1);
}

/// Every element of a world at a pose has the same place as in a body with this pose.
#[test]
fn all_elements_move_with_the_pose() {
    let world = "
        <geom name='euler' size='.1' pos='1 2 3' euler='10 20 30'/>
        <geom name='ends' type='capsule' size='.1' fromto='0 0 0 1 2 3'/>
        <geom name='class' class='turned'/>
        <site name='axes' pos='1 0 0' xyaxes='0 1 0 -1 1 0'/>
        <site name='z' zaxis='1 1 1'/>
        <camera name='camera' pos='0 1 0' axisangle='1 1 0 40'/>
        <light name='light' pos='0 0 3'/>
        <light name='spot' pos='0 0 3' dir='1 0 -1'/>
        <body name='body' pos='0 0 1' quat='1 2 3 4'><geom size='.1'/><joint name='hinge'/></body>";
    let default = "<default><default class='turned'><geom size='.1' pos='3 2 1' quat='1 2 3 4'/></default></default>";
    let child = parse(&format!("<mujoco>{default}<worldbody>{world}</worldbody></mujoco>"));
    let (pos, quat) = ([0.1, -0.2, 0.3], [0.8, 0.0, 0.36, -0.48]);
    let mut spec = Spec::new("moved");
    let world_body = spec.world();
    spec.attach(&child, Mount::body(world_body).with_pos(pos).with_quat(quat), "").unwrap();
    let frame = "<body pos='.1 -.2 .3' quat='.8 0 .36 -.48'>";
    let expected =
        Model::from_xml_str(&format!("<mujoco>{default}<worldbody>{frame}{world}</body></worldbody></mujoco>"));
    let [mut ours, mut theirs] = [spec.compile().unwrap(), expected.unwrap()].map(|model| Data::new(model).unwrap());
    for data in [&mut ours, &mut theirs] {
        data.joint_mut("hinge").unwrap().qpos_mut()[0] = 0.7;
        data.forward().unwrap();
    }
    let near = |name: &str, a: &[f64], b: &[f64]| {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{name}: {a:?}, {b:?}");
    };
    for name in ["euler", "ends", "class"] {
        let [a, b] = [&ours, &theirs].map(|data| data.geom(name).unwrap());
        near(name, a.xpos(), b.xpos());
        near(name, a.xmat(), b.xmat());
    }
    for name in ["axes", "z"] {
        let [a, b] = [&ours, &theirs].map(|data| data.site(name).unwrap());
        near(name, a.xpos(), b.xpos());
        near(name, a.xmat(), b.xmat());
    }
    let [a, b] = [&ours, &theirs].map(|data| data.camera("camera").unwrap());
    near("camera", a.xmat(), b.xmat());
    for name in ["light", "spot"] {
        let [a, b] = [&ours, &theirs].map(|data| data.light(name).unwrap());
        near(name, a.xpos(), b.xpos());
        near(name, a.xdir(), b.xdir());
    }
    let [a, b] = [&ours, &theirs].map(|data| data.body("body").unwrap());
    near("body", a.xpos(), b.xpos());
    near("body", a.xquat(), b.xquat());
}

#[test]
fn a_site_is_a_mount() {
    let mut spec = parse(
        "<mujoco><worldbody><body name='link'><geom size='.1'/>
         <site name='flange' pos='1 0 0' euler='0 0 90'/></body></worldbody></mujoco>",
    );
    let tool = parse("<mujoco><worldbody><body name='tool' pos='2 0 0'><geom size='.1'/></body></worldbody></mujoco>");
    let flange = spec.site("flange").unwrap().id();
    spec.attach(&tool, Mount::site(flange), "t_").unwrap();
    let mut data = Data::new(spec.compile().unwrap()).unwrap();
    data.forward().unwrap();
    let body = data.body("t_tool").unwrap();
    assert!(body.xpos().iter().zip([1.0, 2.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{:?}", body.xpos());
    assert_eq!(data.model().body_parentid()[body.id().index()], 1);
}

#[test]
fn angles_are_converted_to_the_unit_of_the_spec() {
    let child = parse(
        "<mujoco><compiler angle='radian' eulerseq='ZYX'/>
         <default><joint range='-1 0.5' limited='true'/><default class='s'><joint type='slide' range='-3 3'/></default></default>
         <worldbody><body name='b' euler='.1 .2 .3'><joint name='h' springref='.5'/><geom size='.1'/>
           <body><joint name='l' class='s'/><geom size='.1'/></body></body></worldbody></mujoco>",
    );
    let mut spec = Spec::new("degrees");
    let mount = Mount::body(spec.world());
    spec.attach(&child, mount, "c_").unwrap();
    let [ours, theirs] = [spec.compile().unwrap(), child.compile().unwrap()];
    for (hinge, ranged) in [("h", [-1.0, 0.5]), ("l", [-3.0, 3.0])] {
        let joint = ours.joint(&format!("c_{hinge}")[..]).unwrap();
        assert!(joint.range().iter().zip(ranged).all(|(a, b)| (a - b).abs() < 1e-15), "{:?}", joint.range());
    }
    assert!((ours.qpos_spring()[0] - 0.5).abs() < 1e-15);
    let near = ours.body_quat()[1].iter().zip(theirs.body_quat()[1]).all(|(a, b)| (a - b).abs() < 1e-15);
    assert!(near, "{:?} {:?}", ours.body_quat()[1], theirs.body_quat()[1]);
}

#[test]
fn limits_and_inertias_keep_their_meaning() {
    let robot = |settings: &str, name: &str| {
        format!(
            "<mujoco><compiler {settings}/>
             <default><motor ctrlrange='-2 2'/><default class='free'><joint limited='false'/></default>
               <default class='bound'><joint limited='true'/><default class='range'><joint range='-1 2'/></default></default></default>
             <worldbody><body><inertial pos='0 0 0' mass='7' diaginertia='1 1 1'/><geom size='.1'/>
               <joint name='{name}1' range='-1 1'/><joint name='{name}2' class='free' range='-1 1'/><joint name='{name}3'/><joint name='{name}4' class='range'/></body></worldbody>
             <tendon><fixed name='{name}t' range='0 1'><joint joint='{name}1' coef='1'/></fixed></tendon>
             <actuator><motor name='{name}m' joint='{name}1' forcerange='0 3'/><position name='{name}p' joint='{name}3'/></actuator></mujoco>"
        )
    };
    for (ours, theirs) in [("true", "false"), ("false", "true")] {
        let theirs = format!("autolimits='{theirs}' inertiafromgeom='true'");
        // Newer compilers reject a range without a limit unless ranges are limits.
        let Ok(expected) = Model::from_xml_str(&robot(&theirs, "c_")) else { continue };
        let mut spec =
            parse(&format!("<mujoco><compiler autolimits='{ours}'/><worldbody><body/></worldbody></mujoco>"));
        let mount = Mount::body(spec.world());
        spec.attach(&parse(&robot(&theirs, "")), mount, "c_").unwrap();
        let model = spec.compile().unwrap();
        assert_eq!(model.jnt_limited(), expected.jnt_limited());
        assert_eq!(model.jnt_range(), expected.jnt_range());
        assert_eq!(model.tendon_limited(), expected.tendon_limited());
        assert_eq!(model.actuator_ctrllimited(), expected.actuator_ctrllimited());
        assert_eq!(model.actuator_forcelimited(), expected.actuator_forcelimited());
        assert_eq!(model.body_mass()[2], expected.body_mass()[1]);
    }
}

#[test]
fn assets_are_found_in_the_directory_of_their_spec() {
    let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    for (folder, scale) in folders.iter().zip(["1 1 1", "2 2 2"]) {
        std::fs::create_dir(folder.path().join("meshes")).unwrap();
        std::fs::write(folder.path().join("meshes/solid.obj"), assets::obj()).unwrap();
        let text = format!(
            "<mujoco><compiler meshdir='meshes'/><asset><mesh file='solid.obj' scale='{scale}'/></asset>
             <worldbody><geom type='mesh' mesh='solid'/></worldbody></mujoco>"
        );
        std::fs::write(folder.path().join("model.xml"), text).unwrap();
    }
    let [mut one, two] = folders.each_ref().map(|folder| Spec::from_xml_path(folder.path().join("model.xml")).unwrap());
    let mount = Mount::body(one.world());
    one.attach(&two, mount, "two_").unwrap();
    let model = one.compile().unwrap();
    assert_eq!(model.nmesh(), 2);
    assert!(model.mesh("solid").is_ok() && model.mesh("two_solid").is_ok());

    // Files in memory keep their names.
    let solid = assets::obj();
    let files: [(&str, &[u8]); 1] = [("solid.obj", &solid)];
    let child = parse(
        "<mujoco><asset><mesh file='solid.obj'/></asset><worldbody><geom type='mesh' mesh='solid'/></worldbody></mujoco>",
    );
    let mut spec = Spec::new("memory");
    let mount = Mount::body(spec.world());
    spec.attach(&child, mount, "m_").unwrap();
    assert_eq!(spec.compile_with(&LoadOptions::default().with_files(&files)).unwrap().nmesh(), 1);
}

/// A later section of `compiler` overrides an earlier one, whichever attribute it has.
#[cfg(engine_since = "3.5.0")]
#[test]
fn the_last_section_determines_the_directory_of_an_asset() {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in [("a", assets::obj()), ("b", assets::obj())] {
        std::fs::create_dir(folder.path().join(name)).unwrap();
        let text = String::from_utf8(content).unwrap();
        // The mesh in `b` is larger.
        let text = if name == "b" { text.replace("v 0.3", "v 0.6") } else { text };
        std::fs::write(folder.path().join(name).join("m.obj"), text).unwrap();
    }
    for sections in [
        "<compiler meshdir='a'/><compiler assetdir='b'/>",
        "<compiler assetdir='b'/><compiler meshdir='a'/>",
        "<compiler assetdir='a' meshdir='b'/>",
        "<compiler meshdir='b' assetdir='a'/><compiler texturedir='a'/>",
    ] {
        let path = folder.path().join("model.xml");
        let text = format!(
            "<mujoco model='m'>{sections}<asset><mesh file='m.obj'/></asset>
             <worldbody><geom type='mesh' mesh='m'/></worldbody></mujoco>"
        );
        std::fs::write(&path, text).unwrap();
        let expected = Model::from_xml_path(&path).unwrap();
        let mut spec = Spec::new("m");
        let mount = Mount::body(spec.world());
        spec.attach(&Spec::from_xml_path(&path).unwrap(), mount, "p_").unwrap();
        let model = spec.compile().unwrap();
        assert_eq!(model.mesh_vert(), expected.mesh_vert(), "{sections}");
    }
}

#[test]
fn conflicts_are_errors_and_change_nothing() {
    let mut spec = parse(CHILD);
    let before = spec.to_xml();
    let mount = Mount::body(spec.world());
    let mut error = |text: &str, mount: Mount, prefix: &str| {
        let error = spec.attach(&parse(text), mount, prefix).unwrap_err();
        assert_eq!(spec.to_xml(), before);
        error
    };
    let repeated = error(CHILD, mount, "").to_string();
    assert!(repeated.contains("exists"), "{repeated}");
    let settings = error("<mujoco><compiler settotalmass='3'/></mujoco>", mount, "a_").to_string();
    assert!(settings.contains("settotalmass") && settings.contains("absent"), "{settings}");
    let numbers = "<mujoco><worldbody><geom pos='1 2'/></worldbody></mujoco>";
    let invalid = error(numbers, mount.with_pos([1.0, 0.0, 0.0]), "a_");
    assert!(matches!(invalid, Error::Invalid { .. }), "{invalid}");
    let weld = "<mujoco><worldbody><body name='b'><geom size='1'/></body></worldbody>
        <equality><weld body1='b' relpose='1 0 0 1 0 0 0'/></equality></mujoco>";
    let unsupported = error(weld, mount.with_pos([1.0, 0.0, 0.0]), "a_");
    assert!(matches!(unsupported, Error::Unsupported(_)), "{unsupported}");
}

/// The compiler decides the orientation of some elements. Since 3.2 it has frames, which turn all
/// elements.
#[test]
fn elements_that_only_the_compiler_can_turn_are_put_into_frames_or_rejected() {
    for world in [
        "<geom name='a_slab' type='box' size='.1' fromto='0 0 0 1 0 0'/>",
        "<geom name='a_slab' type='box' size='1 2 3' class='turned'/>",
        "<geom name='a_slab' type='box' size='1 2 3' class='turned' quat='1 0 1 0'/>",
        "<geom name='a_slab' type='box' size='1 2 3' class='turned' euler='30 0 0'/>",
    ] {
        let default = "<default><default class='turned'><geom euler='10 20 30'/></default></default>";
        let mut spec = parse("<mujoco/>");
        let mount = Mount::body(spec.world()).with_pos([1.0, 2.0, 3.0]).with_quat([0.6, 0.8, 0.0, 0.0]);
        let child = parse(&format!("<mujoco>{default}<worldbody>{}</worldbody></mujoco>", world.replace("a_", "")));
        let result = spec.attach(&child, mount, "a_");
        if cfg!(engine_since = "3.2.0") {
            result.unwrap();
            let frame = format!("<frame pos='1 2 3' quat='.6 .8 0 0'>{world}</frame>");
            same(&spec, &format!("<mujoco>{default}<worldbody>{frame}</worldbody></mujoco>"));
        } else {
            let error = result.unwrap_err();
            assert!(matches!(error, Error::Unsupported(_)) && error.to_string().contains("geom 'a_slab'"), "{error}");
        }
    }
}

/// The same robot many times, as in a scene with a crowd.
#[test]
fn a_spec_can_be_attached_many_times() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/models/humanoid.xml");
    let humanoid = Spec::from_xml_path(path).unwrap();
    let one = humanoid.compile().unwrap();
    let mut crowd = Spec::new("crowd");
    let world = crowd.world();
    for index in 0..3 {
        let mount = Mount::body(world).with_pos([0.0, f64::from(index), 0.0]);
        crowd.attach(&humanoid, mount, &format!("h{index}_")).unwrap();
    }
    let model = crowd.compile().unwrap();
    assert_eq!((model.nv(), model.nu()), (3 * one.nv(), 3 * one.nu()));
    assert_eq!(model.body_mass()[1..one.nbody()], one.body_mass()[1..]);
    assert_eq!(model.jnt_range()[1..one.njnt()], one.jnt_range()[1..]);
}
