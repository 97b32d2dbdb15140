//! URDF is untrusted text.

use std::time::{Duration, Instant};

use mujoco_safe::Error;
use mujoco_safe::spec::Spec;

use super::{joint, link, robot};
use crate::cases::cases;

#[track_caller]
fn error(urdf: &str) -> String {
    match Spec::from_xml_str(urdf) {
        Err(error @ Error::Load { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_error_names_the_element_and_what_is_right() {
    let links = link("a", "") + &link("b", "");
    let with = |content: &str| robot(&(links.clone() + &joint("j", "revolute", "a", "b", content)));
    let geometry = |shape: &str| robot(&link("a", &format!("<collision><geometry>{shape}</geometry></collision>")));
    for (urdf, parts) in [
        (robot(&(links.clone() + &link("a", ""))), &["two links 'a'", "unique"][..]),
        (robot("<link/>"), &["<link>", "no attribute 'name'"]),
        (robot(&(links.clone() + &joint("j", "ball", "a", "b", ""))), &["joint 'j'", "'ball'", "revolute, continuous"]),
        (robot(&(links.clone() + "<joint name='j'/>")), &["joint 'j'", "no attribute 'type'"]),
        (robot(&(links.clone() + "<joint name='j' type='fixed'/>")), &["joint 'j'", "no <parent>"]),
        (robot(&(links.clone() + &joint("j", "fixed", "a", "c", ""))), &["child of joint 'j' is 'c'", "no such link"]),
        (robot(&(links.clone() + &joint("j", "fixed", "c", "a", ""))), &["parent of joint 'j' is 'c'"]),
        (
            robot(&(links.clone() + &joint("j", "fixed", "a", "b", "") + &joint("k", "fixed", "a", "b", ""))),
            &["link 'b'", "'j' and 'k'", "at most one parent"],
        ),
        (
            robot(&(links.clone() + &joint("j", "fixed", "a", "b", "") + &joint("k", "fixed", "b", "a", ""))),
            &["is its own ancestor", "tree"],
        ),
        (robot(&(links.clone() + &joint("j", "fixed", "a", "a", ""))), &["link 'a' is its own ancestor"]),
        (
            robot(&(links.clone() + "<link name='world'/>" + &joint("j", "fixed", "a", "world", ""))),
            &["'world'", "child of joint 'j'"],
        ),
        (
            robot(
                &(links.clone()
                    + &link("c", "")
                    + &joint("j", "revolute", "a", "b", "")
                    + &joint("j", "planar", "a", "c", "")),
            ),
            &["two joints 'j'", "unique"],
        ),
        (with("<axis/>"), &["<axis> of joint 'j'", "'xyz'"]),
        (with("<axis xyz='1 0'/>"), &["'xyz' of <axis> of joint 'j' is '1 0'", "3 finite numbers"]),
        (with("<axis xyz='0 0 1'/><axis xyz='0 0 1'/>"), &["joint 'j' has more than one <axis>"]),
        (with("<origin xyz='nan 0 0'/>"), &["<origin> of joint 'j'", "'nan 0 0'"]),
        (with("<origin rpy='1,2,3'/>"), &["'1,2,3'"]),
        (with("<limit lower='x' upper='1'/>"), &["'lower' of <limit> of joint 'j' is 'x'", "a number"]),
        (with("<limit effort='nan'/>"), &["'effort'"]),
        (with("<dynamics damping='inf'/>"), &["'damping'", "finite"]),
        (with("<mimic/>"), &["<mimic> of joint 'j'", "'joint'"]),
        (with("<mimic joint='j'/>"), &["itself"]),
        (with("<mimic joint='k' offset=''/>"), &["'offset'"]),
        (geometry(""), &["<geometry> of <collision> of link 'a'", "<box>, <cylinder>"]),
        (geometry("<box/>"), &["<box>", "'size'"]),
        (geometry("<box size='1'/>"), &["3 finite numbers"]),
        (geometry("<cylinder radius='1'/>"), &["'length'"]),
        (geometry("<mesh/>"), &["'filename'"]),
        (geometry("<mesh filename='a.stl' scale='1 1'/>"), &["'scale'"]),
        (robot(&link("a", "<collision/>")), &["no <geometry>"]),
        (robot(&link("a", "<inertial/>")), &["more than one <inertial>"]),
        (robot("<link name='a'><inertial/></link>"), &["<inertial> of link 'a'", "no <mass>"]),
        (
            robot("<link name='a'><inertial><mass value='1'/><inertia ixx='1'/></inertial></link>"),
            &["<inertia> of <inertial> of link 'a'", "'iyy'"],
        ),
        (
            robot("<link name='a'><visual><material name='m'><color/></material></visual></link>"),
            &["<color> of <material> of <visual> of link 'a'", "'rgba'"],
        ),
        (robot("<mujoco/><mujoco/>"), &["more than one <mujoco>"]),
        (robot("<mujoco><compiler strippath='maybe'/></mujoco>"), &["'strippath'", "'maybe' instead of false or true"]),
        (robot("<mujoco><compiler angle='foo'/></mujoco>"), &["'angle'", "degree or radian"]),
        (robot("<mujoco><compiler coordinate='foo'/></mujoco>"), &["'coordinate'", "local or global"]),
        (robot("<xacro:if value='0'/>"), &["template with <xacro:if>", "xacro"]),
        (robot("<mujoco><option/><option/></mujoco>"), &["more than one <option>"]),
    ] {
        let message = error(&urdf);
        for part in parts {
            assert!(message.contains(part), "'{part}' in '{message}'\n{urdf}");
        }
    }
    let long = "x".repeat(100_000);
    assert!(error(&robot(&(link(&long, "") + &link(&long, "")))).len() < 1000);
    assert!(error(&robot("<link name='\0'/>")).contains("the given XML"));
}

/// A name with a NUL character, which a reference can write.
#[test]
fn a_name_with_nul_is_an_error() {
    let urdf = robot(&link("a&#0;b", ""));
    if let Ok(spec) = Spec::from_xml_str(&urdf) {
        spec.compile().unwrap_err();
        spec.save_xml(tempfile::tempdir().unwrap().path().join("robot.xml")).unwrap_err();
    }
}

#[test]
fn a_text_in_another_encoding_is_an_error() {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), b"<?xml version='1.0' encoding='ISO-8859-1'?><!-- \xfc --><robot name='r'/>").unwrap();
    let error = Spec::from_xml_path(file.path()).unwrap_err().to_string();
    assert!(error.contains("not UTF-8: convert it"), "{error}");
}

/// The compiler rejects a matrix with negative moments, and bounds do not hide this.
#[test]
fn negative_moments_are_an_error() {
    for moments in ["ixx='-1' iyy='-1' izz='-1' ixy='0'", "ixx='1' iyy='1' izz='1' ixy='2'"] {
        let b =
            format!("<link name='b'><inertial><mass value='1'/><inertia {moments} ixz='0' iyz='0'/></inertial></link>");
        let settings = "<mujoco><compiler boundinertia='.001'/></mujoco>";
        let text = settings.to_owned() + &link("a", "") + &b + &joint("j", "revolute", "a", "b", "");
        let error = Spec::from_xml_str(&robot(&text)).unwrap().compile().unwrap_err().to_string();
        assert!(error.contains("inertia"), "{error}");
    }
}

fn repeat(count: usize, text: impl Fn(usize) -> String) -> String {
    (0..count).map(text).collect::<Vec<_>>().concat()
}

/// Reading takes a time in proportion to the size, and the compiler's limits are errors.
#[test]
fn huge_robots_are_errors() {
    let count = cases(33_000, 50_000);
    let links = repeat(count, |i| format!("<link name='l{i}'/>"));
    let tree = |parent: &dyn Fn(usize) -> usize| {
        let joints: String = (1..count)
            .map(|i| joint(&format!("j{i}"), "fixed", &format!("l{}", parent(i)), &format!("l{i}"), ""))
            .collect();
        robot(&(links.clone() + &joints))
    };
    for urdf in [tree(&|i| i - 1), tree(&|_| 0), tree(&|i| (i - 1) / 2), robot(&links)] {
        let start = Instant::now();
        let spec = Spec::from_xml_str(&urdf).unwrap();
        spec.compile().unwrap_err();
        assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
    }
    let cycle = joint("j0", "fixed", &format!("l{}", count - 1), "l0", "");
    assert!(error(&tree(&|i| i - 1).replace("</robot>", &format!("{cycle}</robot>"))).contains("its own ancestor"));
    let visuals = repeat(count, |i| format!("<t{i}/><visual/>"));
    let spec = Spec::from_xml_str(&robot(&link("a", &visuals))).unwrap();
    assert_eq!(spec.urdf_warnings().len(), count + 2);
    let unknown = repeat(count, |_| "<x/>".to_owned());
    let start = Instant::now();
    Spec::from_xml_str(&robot(&format!("<mujoco><option>{unknown}</option></mujoco>"))).unwrap();
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
    let mesh = "<collision><geometry><mesh filename='a.stl' scale='1 1 ";
    let meshes = repeat(count / 5, |i| format!("{mesh}{i}'/></geometry></collision>"));
    Spec::from_xml_str(&robot(&link("a", &meshes))).unwrap();
    assert!(error(&robot(&("<a>".repeat(500) + &"</a>".repeat(500)))).contains("400"));
}
