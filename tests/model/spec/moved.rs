//! Attachment at poses of elements in the frame of the world. The expected values are those of the
//! attached model alone, moved as a rigid body, or of a text with the moved values.

use mujoco_safe::spec::{Mount, Spec};
use mujoco_safe::{Data, Error, Model};

use super::{parse, same};

const POS: [f64; 3] = [5.0, 0.0, 0.0];
#[cfg(engine_since = "3.5.0")]
const QUAT: [f64; 4] = [0.6, 0.0, 0.0, 0.8];

fn near(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
}

/// Attaches a child to the world at a position.
fn attached(child: &str) -> mujoco_safe::Result<Spec> {
    let mut spec = Spec::new("moved");
    let mount = Mount::body(spec.world()).with_pos(POS);
    spec.attach(&parse(child), mount, "p_")?;
    Ok(spec)
}

#[track_caller]
fn assert_unsupported(child: &str, part: &str) {
    let error = attached(child).unwrap_err();
    assert!(matches!(error, Error::Unsupported(_)) && error.to_string().contains(part), "{error}\n{child}");
}

/// Engines before 4.0.0 ignore frames around a `flexcomp`, also those of the child.
#[cfg(engine_since = "3.5.0")]
#[test]
fn flexcomps_move_with_the_pose() {
    use mujoco_safe::math::{Pose, trn_vec_pose};

    let vertices = |model: Model| {
        let mut data = Data::new(model).unwrap();
        data.forward().unwrap();
        data.flexvert_xpos().to_vec()
    };
    let flex = |attributes: &str, inner: &str| {
        format!(
            "<flexcomp name='f' type='grid' count='3 3 2' spacing='.1 .1 .1' dim='3' mass='1' radius='.01' pos='0 1 0' {attributes}>
               <contact selfcollide='none'/>{inner}</flexcomp>"
        )
    };
    let child = |world: &str| parse(&format!("<mujoco><worldbody>{world}</worldbody></mujoco>"));
    let edges = flex("", "<edge equality='true'/>");
    let turned = flex("euler='10 20 30'", "<edge equality='true'/><pin id='0 1'/>");
    let rigid = flex("xyaxes='0 1 0 -1 0 0' rigid='true' dof='radial'", "");
    let mut worlds = vec![
        edges.clone(),
        turned.clone(),
        rigid,
        format!("<frame pos='0 0 1' euler='0 90 0'>{edges}</frame>"),
        format!("<frame pos='0 0 1'><frame quat='1 2 3 4'>{turned}</frame><geom size='.1'/></frame>"),
        format!("<body name='b' pos='0 0 1'>{edges}</body>"),
    ];
    if cfg!(engine_since = "3.17.0") {
        worlds.push(flex("dof='trilinear' zaxis='1 1 0'", ""));
    }
    for world in worlds {
        let child = child(&world);
        let alone = vertices(child.compile().unwrap());
        for stand in [Pose::default(), Pose { pos: [0.0, 0.0, 3.0], quat: [0.5, 0.5, -0.5, 0.5] }] {
            let mut spec = parse(
                "<mujoco><worldbody><body name='stand' pos='0 0 3' quat='.5 .5 -.5 .5'><geom size='.1'/></body></worldbody></mujoco>",
            );
            let body = if stand == Pose::default() { spec.world() } else { spec.body("stand").unwrap().id() };
            spec.attach(&child, Mount::body(body).with_pos(POS).with_quat(QUAT), "p_").unwrap();
            let moved = vertices(spec.compile().unwrap());
            for (alone, moved) in alone.iter().zip(&moved) {
                let expected = trn_vec_pose(&stand, &trn_vec_pose(&Pose { pos: POS, quat: QUAT }, alone));
                assert!(near(moved, &expected), "{moved:?} instead of {expected:?}: {world}");
            }
        }
    }
    // The joints of these would have other axes.
    for flex in [flex("dof='radial'", ""), format!("<frame>{}</frame>", flex("dof='radial'", ""))] {
        assert_unsupported(&format!("<mujoco><worldbody>{flex}</worldbody></mujoco>"), "flexcomp");
    }
    let child = child(&flex("dof='trilinear'", "<pin id='0'/>"));
    assert!(attached(&child.to_xml()).is_ok());
    let mut spec = Spec::new("turned");
    let mount = Mount::body(spec.world()).with_quat(QUAT);
    assert!(matches!(spec.attach(&child, mount, ""), Err(Error::Unsupported(_))));
}

/// The anchor of a weld is in the frame of the second body, that of `connect` in that of the first
/// one.
#[test]
fn anchors_in_the_world_move_with_the_pose() {
    let model = |prefix: &str, x: &str, equality: &str| {
        format!(
            "<mujoco><worldbody><body name='{prefix}b' pos='{x} 0 1'><freejoint/><geom size='.1'/></body></worldbody>
             <equality>{equality}</equality></mujoco>"
        )
    };
    let height = |model: Model| {
        let mut data = Data::new(model).unwrap();
        data.step_n(300).unwrap();
        data.qpos()[2]
    };
    for (alone, joined) in [
        ("<weld body1='b' anchor='1 0 0'/>", "<weld body1='p_b' anchor='6 0 0'/>"),
        ("<weld body1='b'/>", "<weld body1='p_b' anchor='5 0 0'/>"),
        ("<weld body1='b' body2='world' anchor='0 1 0'/>", "<weld body1='p_b' anchor='5 1 0'/>"),
        ("<weld body1='world' body2='b' anchor='0 1 0'/>", "<weld body1='world' body2='p_b' anchor='0 1 0'/>"),
        ("<connect body1='b' anchor='1 0 0'/>", "<connect body1='p_b' anchor='1 0 0'/>"),
        ("<connect body1='world' body2='b' anchor='1 0 0'/>", "<connect body1='world' body2='p_b' anchor='6 0 0'/>"),
    ] {
        let child = model("", "0", alone);
        let spec = attached(&child).unwrap();
        let text = model("p_", "5", joined).replace("<mujoco>", "<mujoco model='moved'>");
        same(&spec, &text);
        // The place of a model in the world has no effect on its motion.
        let [ours, expected] = [spec.compile().unwrap(), Model::from_xml_str(&child).unwrap()].map(height);
        assert!((ours - expected).abs() < 1e-9, "{ours} instead of {expected}: {alone}");
    }
    assert_unsupported(&model("", "0", "<weld body1='b' relpose='1 0 0 1 0 0 0'/>"), "relpose");

    let mut spec = parse("<mujoco><worldbody><body name='stand'/></worldbody></mujoco>");
    let mount = Mount::body(spec.body("stand").unwrap().id());
    let child = "<mujoco><worldbody><body name='b' pos='0 0 1'><joint/><geom size='.1'/></body></worldbody>
        <equality><weld body1='b'/></equality></mujoco>";
    spec.attach(&parse(child), mount.with_pos(POS).with_quat([0.0, 0.0, 0.0, 1.0]), "p_").unwrap();
    let model = spec.compile().unwrap();
    assert!(near(&model.eq_data()[0][..3], &POS), "{:?}", model.eq_data());
}

/// A body has no frame at a pose. At its own frame, these keep their meaning.
#[test]
fn references_to_the_frame_of_the_world_at_a_pose_are_rejected() {
    let model = |world: &str, rest: &str| {
        format!(
            "<mujoco><worldbody><body name='v' pos='1 0 0'><joint type='slide' axis='0 0 1'/><geom size='.1'/><site name='s'/></body>
             {world}</worldbody>{rest}</mujoco>"
        )
    };
    let skin = |bone: &str| {
        format!(
            "<asset><skin name='k' vertex='0 0 0 1 0 0 0 1 0' face='0 1 2'>
               <bone body='{bone}' bindpos='0 0 0' bindquat='1 0 0 0' vertid='0 1 2' vertweight='1 1 1'/></skin></asset>"
        )
    };
    let sensor = |attributes: &str| format!("<sensor><framepos {attributes}/></sensor>");
    let mut cases = vec![
        (model("", &sensor("objtype='site' objname='s' reftype='body' refname='world'")), "refname"),
        (model("", &sensor("objtype='xbody' objname='world'")), "objname"),
        (model("<body pos='0 -1 0'><camera mode='targetbody' target='world'/></body>", ""), "target"),
        (model("<body pos='0 -1 1'><light mode='targetbody' target='world'/></body>", ""), "target"),
    ];
    if cfg!(engine_since = "3.5.0") {
        let flex =
            "<deformable><flex name='f' dim='1' body='world v' vertex='0 0 0 0 0 0' element='0 1'/></deformable>";
        cases.push((model("", flex), "body"));
    }
    // Older compilers have skins in another section, and all of them accept this one.
    cases.push((model("", &skin("world")), "body"));
    for (child, attribute) in &cases {
        assert_unsupported(child, attribute);
        let mut spec = Spec::new("same");
        let world = Mount::body(spec.world());
        spec.attach(&parse(child), world, "").unwrap();
        same(&spec, &child.replace("<mujoco>", "<mujoco model='same'>"));
    }
    attached(&model("", &skin("v"))).unwrap().compile().unwrap();
    // These refer to the elements of the world.
    attached(&model(
        "",
        "<contact><exclude body1='world' body2='v'/></contact><sensor><subtreecom body='world'/></sensor>",
    ))
    .unwrap();
}

/// The frame of the world becomes the frame of the body, not that of its inertia.
#[test]
fn sensors_in_the_frame_of_the_world_keep_their_values_in_a_body() {
    let child = parse(
        "<mujoco><worldbody><site name='s' pos='1 2 3'/></worldbody>
         <sensor><framepos objtype='site' objname='s' reftype='body' refname='world'/></sensor></mujoco>",
    );
    let mut spec = parse(
        "<mujoco><worldbody><body name='stand' pos='1 1 1' euler='10 20 30'><freejoint/><geom size='.1' pos='.3 .2 .1'/></body></worldbody></mujoco>",
    );
    let mount = Mount::body(spec.body("stand").unwrap().id());
    spec.attach(&child, mount, "p_").unwrap();
    let mut data = Data::new(spec.compile().unwrap()).unwrap();
    data.forward().unwrap();
    assert!(near(data.sensordata(), &[1.0, 2.0, 3.0]), "{:?}", data.sensordata());
}
