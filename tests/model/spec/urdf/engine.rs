//! Features of URDF, one by one.

use super::{check, compiled, joint, link, read, robot, same};
use mujoco_safe::{Data, Model};

#[test]
fn joints_of_all_types_equal_the_engines() {
    let content =
        "<origin xyz='.1 -.2 .3' rpy='.4 .5 -.6'/><axis xyz='.6 0 .8'/><dynamics damping='.7' friction='.2'/>";
    for kind in ["revolute", "continuous", "prismatic", "fixed", "floating", "planar"] {
        for content in ["", content, "<axis xyz='0 0 -1'/>", "<axis xyz='-1 2 -3'/><dynamics damping='1'/>"] {
            let urdf = robot(&(link("a", "") + &link("b", "") + &joint("j", kind, "a", "b", content)));
            // A joint that is not below the world.
            let below = urdf.replace("</robot>", &(link("c", "") + &joint("k", "revolute", "c", "a", "") + "</robot>"));
            // The engine has free joints in the world only.
            for urdf in if kind == "floating" { vec![urdf] } else { vec![urdf, below] } {
                let model = same(&urdf);
                Data::new(model).unwrap().step().unwrap();
            }
        }
    }
}

#[test]
fn limits_equal_the_engines() {
    for kind in ["revolute", "prismatic", "planar"] {
        for limit in [
            "",
            "lower='-1' upper='2'",
            "lower='-1'",
            "lower='1'",
            "upper='1'",
            "lower='1' upper='-1'",
            "lower='1' upper='1'",
            "lower='0' upper='0' effort='0' velocity='0'",
            "lower='-1e300' upper='1e300'",
            "lower='-inf' upper='inf'",
        ] {
            let content = format!("<axis xyz='0 1 0'/><limit {limit}/>");
            same(&robot(&(link("a", "") + &link("b", "") + &joint("j", kind, "a", "b", &content))));
        }
    }
}

/// The engine has the attribute since 3.0, and its reader of URDF uses it since 3.1.5.
#[test]
#[cfg(engine_since = "3.2.0")]
fn efforts_equal_the_engines() {
    for kind in ["revolute", "continuous", "prismatic", "planar"] {
        for limit in ["effort='3'", "lower='-1' upper='2' effort='5'", "effort='-3'", "effort='inf'"] {
            let limit =
                if kind == "continuous" { limit.replace("lower='-1' upper='2' ", "") } else { limit.to_owned() };
            let content = format!("<limit {limit}/>");
            let model = same(&robot(&(link("a", "") + &link("b", "") + &joint("j", kind, "a", "b", &content))));
            assert!(model.jnt_actfrclimited()[0] != 0);
        }
    }
}

#[test]
fn continuous_joints_have_no_range() {
    let content = "<limit lower='-1' upper='1' effort='2' velocity='3'/>";
    let urdf = robot(&(link("a", "") + &link("b", "") + &joint("j", "continuous", "a", "b", content)));
    let model = compiled(&urdf);
    assert_eq!((model.jnt_limited()[0], model.jnt_range()[0]), (0, [0.0; 2]));
}

#[test]
fn inertias_equal_the_engines() {
    let inertial = |mass: &str, moments: [&str; 6]| {
        let [xx, yy, zz, xy, xz, yz] = moments;
        format!("<mass value='{mass}'/><inertia ixx='{xx}' iyy='{yy}' izz='{zz}' ixy='{xy}' ixz='{xz}' iyz='{yz}'/>")
    };
    for content in [
        inertial("1", ["1", "1", "1", "0", "0", "0"]),
        inertial("2.5", [".1", ".2", ".25", "0", "0", "0"]),
        inertial("2.5", [".3", ".2", ".25", ".01", "-.02", ".03"]),
        inertial("1e-3", ["1e-8", "2e-8", "2.5e-8", "1e-10", "0", "0"]),
        "<origin xyz='1 2 3'/>".to_owned() + &inertial("1", [".1", ".1", ".1", "0", "0", "0"]),
    ] {
        let b = format!("<link name='b'><inertial>{content}</inertial></link>");
        same(&robot(&("<link name='a'/>".to_owned() + &b + &joint("j", "revolute", "a", "b", ""))));
    }
}

/// Some engines forget the orientation of an inertia (2.2.2 and 4.0.1 do not), and 2.2.2 has other
/// signs of the principal axes. The inertia of the body about its own axes is `R I Rᵀ`.
#[test]
fn the_orientation_of_an_inertia_counts() {
    for [roll, pitch, yaw] in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.3, -1.2, 2.5]] {
        let inertial = format!(
            "<inertial><origin xyz='.1 0 0' rpy='{roll} {pitch} {yaw}'/><mass value='1'/>
               <inertia ixx='.3' iyy='.2' izz='.25' ixy='.01' ixz='-.02' iyz='.03'/></inertial>"
        );
        let b = format!("<link name='b'>{inertial}</link>");
        let urdf = robot(&("<link name='a'/>".to_owned() + &b + &joint("j", "revolute", "a", "b", "")));
        let model = compiled(&urdf);
        if cfg!(engine_since = "3.17.0") {
            check(&model, &Model::from_xml_str(&urdf).unwrap(), &urdf);
        }
        let moments = nalgebra::Matrix3::new(0.3, 0.01, -0.02, 0.01, 0.2, 0.03, -0.02, 0.03, 0.25);
        let turn = nalgebra::Rotation3::from_euler_angles(roll, pitch, yaw);
        let expected = turn * moments * turn.inverse();
        let found = inertia(&model);
        // The engine's eigenvalues are rounded to about 1e-7 of the largest.
        assert!((found - expected).norm() < 1e-6, "{found} {expected}");
        if !cfg!(engine_since = "3.1.3") {
            let theirs = inertia(&Model::from_xml_str(&urdf).unwrap());
            assert!((theirs - expected).norm() < 1e-6, "{theirs} {expected}");
        }
    }
}

/// Returns the inertia of the last body about its own axes.
fn inertia(model: &Model) -> nalgebra::Matrix3<f64> {
    let [w, x, y, z] = *model.body_iquat().last().unwrap();
    let axes = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z)).to_rotation_matrix();
    let moments = (*model.body_inertia().last().unwrap()).into();
    axes * nalgebra::Matrix3::from_diagonal(&moments) * axes.inverse()
}

/// The compiler rejects a moving body without moments, and accepts it with a bound.
#[test]
fn zero_inertias_are_zero() {
    let b = "<link name='b'><inertial><mass value='1'/>
        <inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/></inertial></link>";
    let text = "<link name='a'/>".to_owned() + b + &joint("j", "revolute", "a", "b", "");
    assert!(read(&robot(&text)).compile().unwrap_err().to_string().contains("inertia"));
    let text = text + "<mujoco><compiler boundinertia='.01'/></mujoco>";
    assert_eq!(compiled(&robot(&text)).body_inertia()[1], [0.01; 3]);
}

#[test]
fn geometry_equals_the_engines() {
    let shapes = [
        "<box size='.1 .2 .3'/>",
        "<cylinder radius='.1' length='.5'/>",
        "<sphere radius='.1'/>",
        // The engine's reader has capsules since 2.3.1.
        if cfg!(engine_since = "2.3.3") { "<capsule radius='.1' length='.5'/>" } else { "<sphere radius='.3'/>" },
    ];
    for visuals in ["true", "false"] {
        let geometry: Vec<String> = shapes
            .iter()
            .enumerate()
            .map(|(number, shape)| {
                let colour = ["", "<material name='red'/>", "<material name='x'><color rgba='0 1 0 .5'/></material>"];
                let material = colour[number % 3];
                format!(
                    "<visual name='v{number}'><origin xyz='1 2 3' rpy='.1 .2 .3'/><geometry>{shape}</geometry>{material}</visual>
                     <collision name='c'><origin rpy='0 0 {number}'/><geometry>{shape}</geometry></collision>"
                )
            })
            .collect();
        let geometry = geometry.concat();
        let urdf = robot(&format!(
            "<mujoco><compiler discardvisual='{visuals}'/></mujoco>
             <material name='red'><color rgba='1 0 0 1'/></material><material name='red'><color rgba='0 0 1 1'/></material>
             <link name='a'>{geometry}</link>{}{}",
            link("b", &geometry),
            joint("j", "revolute", "a", "b", "<origin xyz='1 0 0' rpy='0 1 0'/>")
        ));
        let model = same(&urdf);
        assert_eq!(model.ngeom(), if visuals == "true" { 8 } else { 16 });
    }
    let capsule = "<collision><geometry><capsule radius='.1' length='.5'/></geometry></collision>";
    assert_eq!(compiled(&robot(&format!("<link name='a'>{capsule}</link>"))).geom_size()[0][..2], [0.1, 0.25]);
}

#[test]
fn settings_of_mujoco_equal_the_engines() {
    for settings in [
        "<compiler fusestatic='false'/>",
        "<compiler fusestatic='true' boundmass='2' boundinertia='.5'/>",
        "<compiler balanceinertia='true' settotalmass='3'/>",
        "<compiler inertiafromgeom='true'/>",
        "<compiler angle='degree' eulerseq='zyx' coordinate='local'/>",
        "<option timestep='.005' gravity='0 0 -1' cone='elliptic'><flag contact='disable'/></option>",
        "<size nuserdata='7'/>",
        "<compiler><lengthrange mode='none'/></compiler><option integrator='RK4'/>",
    ] {
        let geometry = "<collision><geometry><box size='.1 .2 .3'/></geometry></collision>";
        let text = link("a", geometry)
            + &link("b", geometry)
            + &link("c", geometry)
            + &joint("i", "fixed", "a", "b", "<origin xyz='1 0 0' rpy='0 1 0'/>")
            + &joint("j", "revolute", "b", "c", "<origin rpy='0 1 .5'/>");
        same(&robot(&format!("<mujoco>{settings}</mujoco>{text}")));
    }
}

#[test]
fn trees_equal_the_engines() {
    let links: String = ["f", "e", "d", "c", "b", "a"].map(|name| link(name, "")).concat();
    let tree = |joints: [(&str, &str); 5]| -> String {
        joints.iter().map(|(parent, child)| joint(&format!("{parent}{child}"), "revolute", parent, child, "")).collect()
    };
    for joints in [
        [("a", "b"), ("b", "c"), ("c", "d"), ("d", "e"), ("e", "f")],
        [("a", "f"), ("a", "e"), ("a", "d"), ("d", "b"), ("d", "c")],
        [("d", "e"), ("a", "d"), ("e", "f"), ("a", "b"), ("b", "c")],
    ] {
        let model = same(&robot(&(links.clone() + &tree(joints))));
        assert_eq!(model.nv(), 5);
    }
    // Several roots, of which one is the world.
    let joints = joint("i", "revolute", "world", "a", "") + &joint("j", "fixed", "b", "c", "");
    let world = "<link name='world'><collision><geometry><sphere radius='1'/></geometry></collision></link>";
    let text = links + world + &joints + "<mujoco><compiler fusestatic='false'/></mujoco>";
    let model = same(&robot(&text));
    assert_eq!((model.nbody(), model.geom_bodyid()), (7, &[0][..]));
    for root in ["ROBOT", "Robot"] {
        same(&robot(&link("a", "")).replace("robot", root));
    }
}

/// Bodies are in the order of their roots, also below a link that is the world.
#[test]
fn the_world_can_be_any_root() {
    let with = |world: &str| {
        let links = link("a", "") + world + &link("c", "") + &link("b", "") + &link("d", "");
        robot(&(links + &joint("wb", "revolute", "world", "b", "") + &joint("cd", "prismatic", "c", "d", "")))
    };
    let model = same(&with("<link name='world'/>"));
    assert_eq!(
        [0, 1].map(|joint| model.jnt_bodyid()[joint]),
        ["b", "d"].map(|name| model.body(name).unwrap().id().index() as i32)
    );
}

/// The engine's reader has them since 3.2.
#[test]
fn spherical_joints_are_balls() {
    for content in [
        "",
        "<axis xyz='0 1 0'/>",
        "<limit lower='0' upper='1'/>",
        "<dynamics damping='2' friction='1'/><origin xyz='1 2 3' rpy='1 0 0'/>",
    ] {
        let urdf = robot(&(link("a", "") + &link("b", "") + &joint("j", "spherical", "a", "b", content)));
        let model = compiled(&urdf);
        assert_eq!(model.jnt_type(), [mujoco_safe::enums::JointType::Ball as i32]);
        let theirs = Model::from_xml_str(&urdf);
        assert_eq!(theirs.is_ok(), cfg!(engine_since = "3.2.0"), "{theirs:?}");
        if let Ok(theirs) = theirs {
            check(&model, &theirs, &urdf);
        }
    }
    let limit = "<limit lower='-1' upper='1' effort='3'/>";
    let urdf = robot(&(link("a", "") + &link("b", "") + &joint("j", "spherical", "a", "b", limit)));
    assert_eq!(compiled(&urdf).jnt_limited()[0], 0);
    let found = super::warnings(&urdf);
    assert!(found.contains(&"joint 'j' has no limits: 'lower' of a spherical joint must be 0".to_owned()), "{found:?}");
    assert!(found.contains(&"joint 'j': the effort limit 3 is ignored".to_owned()), "{found:?}");
}

/// As for the engine's reader, the prefix of a name is a part of it, and need not be declared.
#[test]
fn prefixes_are_parts_of_names() {
    let links = link("a", "") + &link("b", "");
    let joints = "<drake:joint name='k' type='ball'/>
        <joint name='j' d:type='fixed' type='revolute' d:name='k'><parent d:link='b' link='a'/><child link='b'/>
        <limit d:lower='-2' lower='-1' upper='1'/></joint>
        <gazebo><sensor:camera x:y='&lt;:'/></gazebo>";
    for declarations in
        ["", " xmlns:drake='u' xmlns:d='v'", " xmlns:drake='u' xmlns:d='v' xmlns:sensor='w' xmlns:x='w'"]
    {
        let urdf = robot(&(links.clone() + joints)).replace(" name='robot'", declarations);
        let model = same(&urdf);
        assert!(model.joint("j").is_ok());
        assert_eq!(model.jnt_range(), [[-1.0, 1.0]]);
    }
    assert!(super::warnings(&robot("<drake:joint/>")).contains(&"<drake:joint> is ignored".to_owned()));
}

#[test]
fn declarations_are_ignored() {
    let urdf = robot(&link("a", ""));
    for declaration in [
        "<?xml version='1.0'?><!DOCTYPE robot>",
        "<!DOCTYPE robot [<!ENTITY m '1'>]>",
        "<!DOCTYPE robot [\n<!ENTITY m '1'>\n<!ENTITY n '1'>\n]>",
    ] {
        same(&(declaration.to_owned() + &urdf));
    }
}

/// A colour with a negative number is none, also for the elements that follow.
#[test]
fn a_negative_colour_is_none() {
    let visual = |colour: &str| {
        format!(
            "<visual><geometry><box size='1 1 1'/></geometry><material name='x'><color rgba='{colour}'/></material></visual>"
        )
    };
    let collision = "<collision><geometry><box size='1 1 1'/></geometry></collision>";
    let settings = "<mujoco><compiler discardvisual='false'/></mujoco>";
    same(&robot(&(settings.to_owned() + &link("a", &(visual("1 0 0 1") + &visual("-1 0 0 1") + collision)))));
}

/// A mimic joint is an equality with every engine. The engine's reader drops it before 3.13.
#[test]
fn mimic_is_an_equality() {
    let text = |mimic: &str| {
        link("a", "")
            + &link("b", "")
            + &link("c", "")
            + &joint("k", "prismatic", "a", "c", mimic)
            + &joint("j", "revolute", "a", "b", "")
    };
    for (mimic, expected) in
        [("<mimic joint='j'/>", [0.0, 1.0]), ("<mimic joint='j' multiplier='-2' offset='.3'/>", [0.3, -2.0])]
    {
        let urdf = robot(&text(mimic));
        let model = compiled(&urdf);
        assert_eq!(model.eq_data()[0][..5], [expected[0], expected[1], 0.0, 0.0, 0.0]);
        let [k, j] = ["k", "j"].map(|name| model.joint(name).unwrap().id().index() as i32);
        assert_eq!((model.eq_obj1id()[0], model.eq_obj2id()[0]), (k, j));
        if cfg!(engine_since = "3.14.0") {
            check(&model, &Model::from_xml_str(&urdf).unwrap(), &urdf);
        }
    }
    for mimic in ["<mimic joint='nobody'/>", "<mimic joint=''/>"] {
        same(&robot(&text(mimic)));
    }
}

/// The values of the text, not of the engine's reader: names of geoms and bodies.
#[test]
fn elements_have_their_names() {
    let geometry =
        |name: &str| format!("<collision name='{name}'><geometry><sphere radius='1'/></geometry></collision>");
    let b = link("b", &(geometry("tip") + &geometry("tip") + &geometry("")));
    let spec = read(&robot(&(link("a", "") + &b + &joint("elbow", "revolute", "a", "b", ""))));
    assert_eq!(spec.name(), "robot");
    let geoms: Vec<Option<&str>> =
        spec.ids::<mujoco_safe::kind::Geom>().into_iter().map(|id| spec.element(id).name()).collect();
    assert_eq!(geoms, [Some("tip"), None, None]);
    assert!(spec.body("b").is_ok() && spec.joint("elbow").is_ok());
    let planar = read(&robot(&(link("a", "") + &link("b", "") + &joint("p", "planar", "a", "b", ""))));
    assert!(["p_TX", "p_TY", "p_RZ"].into_iter().all(|name| planar.joint(name).is_ok()));
}
