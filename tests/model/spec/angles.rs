//! Attachment of specs with another unit of angles. The compiler decides with the types of the
//! joints whether their positions are angles, so the attached elements equal those of their own
//! spec, compiled alone.

use mujoco_safe::enums::JointType;
use mujoco_safe::spec::Mount;
use mujoco_safe::{Error, Model};

use super::super::same_models::assert_same;
use super::parse;

/// The compiler settings of the two specs.
const UNITS: [[&str; 2]; 2] = [["degree", "radian"], ["radian", "degree"]];

/// Attaches a text, whose unit of angles is `UNIT`, to specs with the other unit, and compares the
/// models with that of the text alone.
#[track_caller]
fn attached_is_the_same(body: &str) {
    for [theirs, ours] in UNITS {
        let text = format!("<mujoco model='m'><compiler angle='{theirs}' autolimits='true'/>{body}</mujoco>");
        let child = parse(&text);
        let mut spec = parse(&format!("<mujoco model='m'><compiler angle='{ours}' autolimits='true'/></mujoco>"));
        let mount = Mount::body(spec.world());
        spec.attach(&child, mount, "").unwrap();
        let model = spec.compile().unwrap_or_else(|error| panic!("{error}\n{}", spec.to_xml()));
        assert_same(&model, &Model::from_xml_str(&text).unwrap(), 1e-14, &spec.to_xml());

        // The text has the same values, and so does a second attachment with the first unit.
        assert_same(&parse(&spec.to_xml()).compile().unwrap(), &model, 0.0, "text");
        let mut outer = parse(&format!("<mujoco model='m'><compiler angle='{theirs}' autolimits='true'/></mujoco>"));
        let mount = Mount::body(outer.world());
        outer.attach(&spec, mount, "").unwrap();
        assert_same(&outer.compile().unwrap(), &model, 1e-14, &outer.to_xml());
    }
}

/// A body for each joint.
fn bodies(joints: &[&str]) -> String {
    joints.iter().map(|joint| format!("<body>{joint}<geom size='.1'/></body>")).collect::<Vec<String>>().concat()
}

const JOINTS: [&str; 12] = [
    "<joint/>",
    "<joint type='slide'/>",
    "<joint type='hinge' range='-.7 .2'/>",
    "<joint type='slide' ref='.3' springref='.2'/>",
    "<joint type='ball' range='0 .5'/>",
    "<joint type='free' range='0 0'/>",
    "<joint limited='false'/>",
    "<joint limited='true'/>",
    "<joint limited='auto'/>",
    "<joint class='slider'/>",
    "<joint class='slider' type='hinge'/>",
    "<joint class='inner' springref='.1'/>",
];

#[test]
fn numbers_of_classes_have_the_unit_of_each_joint() {
    let numbers = "range='-1 1' ref='.5' springref='.25'";
    let defaults = [
        format!(
            "<default><joint {numbers}/><default class='slider'><joint type='slide'/><default class='inner'><joint type='hinge'/></default></default></default>"
        ),
        format!(
            "<default><joint {numbers} type='slide'/><default class='slider'><joint range='-2 2'/><default class='inner'><joint type='hinge' range='0 0'/></default></default></default>"
        ),
        format!(
            "<default><default class='slider'><joint type='slide'/><default class='inner'><joint {numbers} limited='false'/></default></default></default>"
        ),
    ];
    let compiles = |default: &str, body: &str| {
        let text = format!("<mujoco><compiler autolimits='true'/>{default}<worldbody>{body}</worldbody></mujoco>");
        Model::from_xml_str(&text).is_ok()
    };
    for default in &defaults {
        // The compiler rejects some combinations, such as a ball with a lower limit.
        let bodies: Vec<String> = JOINTS.iter().map(|joint| bodies(&[joint])).collect();
        let good: String = bodies.into_iter().filter(|body| compiles(default, body)).collect();
        attached_is_the_same(&format!("{default}<worldbody>{good}</worldbody>"));
        let in_class: String = good.replace("<body>", "<body childclass='inner'>");
        if compiles(default, &in_class) {
            attached_is_the_same(&format!("{default}<worldbody>{in_class}</worldbody>"));
        }
    }
}

/// The angle at which a spring yields is new in 4.0.
#[cfg(engine_since = "4.0.0")]
#[test]
fn yield_positions_of_springs_are_converted() {
    let joints = [
        "<joint stiffness='2'/>",
        "<joint type='slide' stiffness='2'/>",
        "<joint type='ball' stiffness='2'/>",
        "<joint springyield='.7' stiffness='2'/>",
        "<joint type='slide' springyield='.7' stiffness='2'/>",
    ];
    attached_is_the_same(&format!("<worldbody>{}</worldbody>", bodies(&joints[3..])));
    attached_is_the_same(&format!(
        "<default><joint springyield='.3'/></default><worldbody>{}</worldbody>",
        bodies(&joints)
    ));
}

#[test]
fn rotations_are_converted_where_they_are() {
    let frame = if cfg!(engine_since = "2.3.7") {
        "<frame euler='10 20 30'><geom size='.1' euler='3 4 5'/></frame><frame axisangle='0 1 0 .7'><geom size='.1'/></frame>"
    } else {
        ""
    };
    attached_is_the_same(&format!(
        "<default><geom type='box' size='.1 .2 .3' euler='10 20 30'/><site axisangle='0 1 1 .4'/>
           <default class='axis'><geom axisangle='1 0 0 .3'/><camera euler='1 2 3'/></default></default>
         <worldbody>{frame}
           <geom/><geom euler='1 2 3'/><geom zaxis='1 1 0'/><geom quat='1 2 3 4'/><geom axisangle='1 1 1 40'/><geom class='axis'/>
           <site/><site xyaxes='0 1 0 1 0 0'/><camera class='axis'/><camera class='axis' axisangle='1 2 3 5'/><camera fovy='30'/>
           <light cutoff='30'/>
           <body euler='30 20 10'><inertial pos='0 0 0' mass='1' diaginertia='1 2 2.5' euler='1 2 3'/><joint/></body>
         </worldbody>"
    ));
}

/// Everything else has the same unit in all specs, however its name looks.
#[test]
fn other_numbers_are_not_converted() {
    attached_is_the_same(
        "<default><tendon range='-1 1'/><general ctrlrange='-1 1'/></default>
         <worldbody><body name='b'><joint name='j' margin='.1' user='1 2' frictionloss='.3'/><joint name='s' type='slide' axis='1 0 0'/>
           <geom size='.1'/><site name='site'/></body></worldbody>
         <tendon><fixed name='t' springlength='.2' margin='.1'><joint joint='j' coef='2'/></fixed></tendon>
         <equality><joint joint1='j' joint2='s' polycoef='.1 1 .2 0 0' solref='.05 1'/></equality>
         <actuator><position joint='j' kp='3' ctrlrange='-.3 .3'/><general joint='s' gear='3'/><motor site='site' gear='1 2 3 .1 .2 .3'/>
           <muscle tendon='t' range='.7 1.1' lengthrange='.1 .2'/></actuator>
         <sensor><jointpos joint='j' cutoff='.3'/><gyro site='site' cutoff='2'/></sensor>",
    );
    #[cfg(engine_since = "3.2.0")]
    attached_is_the_same(
        "<worldbody><body><joint name='j' range='-.5 .5'/><geom size='.1'/></body>
           <body><joint name='s' type='slide' range='-.5 .5'/><geom size='.1'/></body></worldbody>
         <actuator><position joint='j' kp='3' inheritrange='.8'/><position joint='s' kp='3' inheritrange='.8'/></actuator>",
    );
}

/// The unit of a joint that is added to an attached spec depends on its type, as for the joints of
/// that spec.
#[test]
fn joints_that_are_added_later_have_the_positions_of_their_class() {
    for [theirs, ours] in UNITS {
        let header = |unit: &str| format!("<compiler angle='{unit}' autolimits='true'/>");
        let class = "<default><joint range='-1 1' ref='.5' springref='.25'/></default>";
        let body = |joints: &str| format!("<worldbody><body name='b'><geom size='.1'/>{joints}</body></worldbody>");
        let expected = format!(
            "<mujoco>{}{class}{}</mujoco>",
            header(theirs),
            body("<joint/><joint type='slide'/><joint type='slide'/>")
        );
        let child = parse(&format!("<mujoco>{}{class}{}</mujoco>", header(theirs), body("")));
        let mut spec = parse(&format!("<mujoco>{}</mujoco>", header(ours)));
        let mount = Mount::body(spec.world());
        let bodies = spec.attach(&child, mount, "c_").unwrap();
        spec.add_joint(bodies[0]);
        spec.add_joint(bodies[0]).set_type(JointType::Slide);
        let changed = spec.add_joint(bodies[0]).set_type(JointType::Hinge).id();
        spec.joint_mut(changed).set_type(JointType::Slide);
        let [model, expected] = [spec.compile().unwrap(), Model::from_xml_str(&expected).unwrap()];
        for (ours, theirs) in [
            (model.jnt_range().as_flattened(), expected.jnt_range().as_flattened()),
            (model.qpos0(), expected.qpos0()),
            (model.qpos_spring(), expected.qpos_spring()),
        ] {
            assert!(ours.iter().zip(theirs).all(|(a, b)| (a - b).abs() < 1e-15), "{ours:?} {theirs:?}");
        }

        // A number that is set after the attachment has the unit of the spec.
        spec.default_mut("c_main", "joint").unwrap().set("ref", 0.125).unwrap();
        let radians = if ours == "degree" { 0.125_f64.to_radians() } else { 0.125 };
        let qpos0 = spec.compile().unwrap().qpos0().to_vec();
        assert!((qpos0[0] - radians).abs() < 1e-15 && qpos0[1..] == [0.125; 2], "{qpos0:?}");
    }
}

/// Attributes of newer engines than those of this crate may be angles, names, limits or places.
#[test]
fn attributes_that_are_not_known_are_not_attached() {
    let child = parse(
        "<mujoco><compiler angle='radian'/><worldbody><body name='b'><joint name='j' warp='1'/></body></worldbody></mujoco>",
    );
    let mut spec = parse("<mujoco/>");
    let world = spec.world();
    for (angle, prefix, mount) in [
        ("degree", "", Mount::body(world)),
        ("radian", "p_", Mount::body(world)),
        ("radian", "", Mount::body(world).with_pos([1.0, 0.0, 0.0])),
    ] {
        spec.section_mut("compiler").unwrap().set("angle", angle).unwrap();
        let error = spec.attach(&child, mount, prefix).unwrap_err();
        assert!(matches!(error, Error::Unsupported(_)), "{error}");
        let message = error.to_string();
        assert!(message.contains("'warp'") && message.contains("joint 'j'"), "{message}");
    }
    // Nothing is converted, renamed or moved.
    spec.attach(&child, Mount::body(world), "").unwrap();
    assert!(spec.to_xml().contains("warp=\"1\""));

    let setting = parse("<mujoco><compiler angle='radian' twist='2'/><worldbody><body name='c'/></worldbody></mujoco>");
    let error = spec.attach(&setting, Mount::body(world), "").unwrap_err().to_string();
    assert!(error.contains("'twist' of <compiler>") && error.contains("absent"), "{error}");
}
