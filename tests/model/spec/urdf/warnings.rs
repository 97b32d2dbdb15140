//! What a spec does not have of a URDF.

use mujoco_safe::spec::{Spec, UrdfWarning};

use super::{joint, link, read, robot, warnings};

#[test]
fn mass_that_fuses_with_the_world_is_a_warning() {
    let links = link("base", "") + &link("head", "") + &link("leg", "");
    let joints = joint("i", "fixed", "base", "head", "") + &joint("j", "revolute", "head", "leg", "");
    let urdf = robot(&(links.clone() + &joints));
    let mut spec = read(&urdf);
    assert_eq!(spec.urdf_warnings(), [UrdfWarning::FixedMass { link: "base".to_owned(), mass: 3.0 }]);
    assert_eq!(spec.clone().urdf_warnings(), spec.urdf_warnings());
    let mass = |spec: &Spec| spec.compile().unwrap().body_mass().iter().sum::<f64>();
    assert_eq!(mass(&spec), 1.5);

    spec.add_free_base().unwrap().set_name("root");
    assert!(spec.urdf_warnings().is_empty());
    let model = spec.compile().unwrap();
    assert_eq!((model.nv(), mass(&spec)), (7, 4.5));
    assert_eq!(model.joint("root").unwrap().body(), model.body("base").unwrap().id());
    assert!(spec.add_free_base().unwrap_err().to_string().contains("joint 'root'"));

    // A base without mass, as many robots have.
    let urdf = robot(
        &("<link name='footprint'/>".to_owned() + &links + &joint("h", "fixed", "footprint", "base", "") + &joints),
    );
    let mut spec = read(&urdf);
    assert_eq!(spec.urdf_warnings(), [UrdfWarning::FixedMass { link: "footprint".to_owned(), mass: 3.0 }]);
    spec.add_free_base().unwrap();
    assert_eq!((spec.compile().unwrap().nv(), mass(&spec)), (7, 4.5));

    let kept = urdf.replace("<robot name='robot'>", "<robot><mujoco><compiler fusestatic='false'/></mujoco>");
    let spec = read(&kept);
    assert!(spec.urdf_warnings().is_empty());
    assert_eq!(mass(&spec), 4.5);
}

/// A joint that fixes the robot to the world is a statement.
#[test]
fn mass_that_a_joint_fixes_is_no_warning() {
    let links = "<link name='world'/>".to_owned() + &link("a", "") + &link("b", "");
    let spec = read(&robot(&(links + &joint("i", "fixed", "world", "a", "") + &joint("j", "revolute", "a", "b", ""))));
    assert_eq!(spec.urdf_warnings(), []);
}

#[test]
fn a_mass_by_density_is_a_warning() {
    let sphere = "<collision><geometry><sphere radius='1'/></geometry></collision>";
    let visual = sphere.replace("collision", "visual");
    let links = format!("<link name='a'>{sphere}</link><link name='b'>{sphere}</link><link name='c'>{visual}</link>");
    let found = |kind: &str| {
        let text = links.clone() + &joint("j", kind, "a", "b", "") + &joint("k", "fixed", "b", "c", "");
        let spec = read(&robot(&text));
        spec.urdf_warnings()
            .iter()
            .filter(|warning| matches!(warning, UrdfWarning::Density { .. }))
            .cloned()
            .collect::<Vec<_>>()
    };
    assert_eq!(found("revolute"), [UrdfWarning::Density { link: "b".to_owned() }]);
    assert_eq!(found("fixed"), []);
}

#[test]
fn a_mimic_can_name_a_joint_of_which_a_fixed_one_has_the_name() {
    let links = link("a", "") + &link("b", "") + &link("c", "") + &link("d", "");
    let joints = joint("k", "prismatic", "a", "b", "")
        + &joint("k", "fixed", "a", "c", "")
        + &joint("j", "revolute", "a", "d", "<mimic joint='k'/>");
    assert_eq!(super::compiled(&robot(&(links + &joints))).neq(), 1);
}

#[test]
fn numbers_in_messages_are_short() {
    let limit = "<limit lower='1e300' upper='-1e300' effort='1e308' velocity='1e308'/>";
    let urdf = robot(&(link("a", "") + &link("b", "") + &joint("j", "planar", "a", "b", limit)));
    let spec = read(&urdf);
    assert!(warnings(&urdf).iter().all(|text| text.len() < 100), "{:?}", warnings(&urdf));
    for warning in spec.urdf_warnings() {
        if let UrdfWarning::EffortLimit { joint, .. } = warning {
            assert!(spec.joint(&joint[..]).is_ok(), "{joint}");
        }
    }
}

#[test]
fn a_mass_without_moments_is_a_warning() {
    let b = "<link name='b'><inertial><mass value='2'/></inertial></link>";
    let text = |kind: &str| robot(&(link("a", "") + b + &joint("j", kind, "a", "b", "")));
    let mut spec = read(&text("fixed"));
    assert!(spec.urdf_warnings().contains(&UrdfWarning::NoInertia { link: "b".to_owned() }));
    spec.add_free_base().unwrap();
    assert_eq!(spec.compile().unwrap().body_mass()[1], 3.5);
    let moving = read(&text("revolute"));
    assert!(moving.compile().unwrap_err().to_string().contains("inertia"));
}

#[test]
fn a_free_base_needs_one_body() {
    let error = |urdf: &str| read(urdf).add_free_base().unwrap_err().to_string();
    let none = error(&robot("<link name='world'/>"));
    assert!(none.contains("number of bodies in the world is 0"), "{none}");
    let two = error(&robot(&(link("a", "") + &link("b", ""))));
    assert!(two.contains("2 (body 'a', body 'b')") && two.contains("add_freejoint"), "{two}");
    let floating =
        robot(&("<link name='world'/>".to_owned() + &link("a", "") + &joint("j", "floating", "world", "a", "")));
    assert!(error(&floating).contains("joint 'j'"));
}

#[test]
fn what_is_ignored_is_a_warning() {
    let limit = "<limit lower='-1' upper='1' effort='2' velocity='3'/><safety_controller k_position='1'/>";
    let links = "<link name='a'/>".to_owned() + &link("b", "<visual><geometry/></visual><sensor/>") + &link("c", "");
    let text = |kind: &str, content: &str| {
        warnings(&robot(
            &(links.clone() + &joint("i", "revolute", "a", "c", "") + &joint("j", kind, "a", "b", content)),
        ))
    };
    let common = ["1 <visual> elements are left out", "<sensor> in <link> is ignored"].map(str::to_owned);
    let with = |more: &[&str]| {
        let mut all: Vec<String> = more.iter().map(|&text| text.to_owned()).chain(common.clone()).collect();
        all.sort();
        all
    };
    let sorted = |mut found: Vec<String>| {
        found.sort();
        found
    };
    let velocity = "joint 'j': the velocity limit 3 is ignored";
    let safety = "<safety_controller> in <joint> is ignored";
    let effort = "joint 'j': the effort limit 2 is ignored";
    let with_effort = |effort: &'static str, list: &[&'static str]| {
        let mut list = list.to_vec();
        if cfg!(not(engine_since = "3.0.0")) {
            list.push(effort);
        }
        list
    };
    let unlimited = |list: &[&'static str]| with_effort(effort, list);
    assert_eq!(sorted(text("revolute", "")), with(&[]));
    assert_eq!(sorted(text("revolute", limit)), with(&unlimited(&[velocity, safety])));
    let continuous = "joint 'j' has no limits: it is continuous";
    assert_eq!(sorted(text("continuous", limit)), with(&unlimited(&[velocity, safety, continuous])));
    let effort_of_planar = "joint 'j_TX': the effort limit 2 is ignored";
    let planar = [
        "joint 'j_TY' has no limits: the limits of a planar joint act along its first axis only",
        "joint 'j_RZ' has no limits: the limits of a planar joint act along its first axis only",
    ];
    assert_eq!(
        sorted(text("planar", limit)),
        with(&with_effort(effort_of_planar, &[velocity, safety, planar[0], planar[1]]))
    );
    let floating = "joint 'j' has no limits: it is floating";
    assert_eq!(sorted(text("floating", limit)), with(&[velocity, safety, floating, effort]));
    let empty = "joint 'j' has no limits: 'lower' is 1 and 'upper' is -1";
    assert_eq!(sorted(text("revolute", "<limit lower='1' upper='-1'/>")), with(&[empty]));
    let mimic = "joint 'j': <mimic> is ignored: there is no joint 'k'";
    assert_eq!(sorted(text("revolute", "<mimic joint='k'/>")), with(&[mimic]));
    let mimic = "joint 'j': <mimic> is ignored: both joints must have one degree of freedom";
    assert_eq!(sorted(text("floating", "<mimic joint='i'/>")), with(&[mimic]));

    let more = "<transmission/><gazebo reference='a'><material/></gazebo><gazebo/>
        <material name='m'><texture filename='m.png'/></material>
        <mujoco><compiler coordinate='global' old='1'/><worldbody/><option><new/></option></mujoco>";
    assert_eq!(
        warnings(&robot(more)),
        [
            "'coordinate' of <compiler> is ignored",
            "'old' of <compiler> is ignored",
            "<gazebo> is ignored (2 times)",
            "<new> in <mujoco> is ignored",
            "<texture> in <material> is ignored",
            "<transmission> is ignored",
            "<worldbody> in <mujoco> is ignored",
        ]
    );
}

/// A joint with these limits is limited by the engine, or the spec warns.
#[test]
fn limits_are_in_the_model_or_in_the_warnings() {
    let urdf = robot(&(link("a", "") + &link("b", "") + &joint("j", "revolute", "a", "b", "<limit lower='-1'/>")));
    let spec = read(&urdf);
    let is_limited = spec.compile().unwrap().jnt_limited()[0] != 0;
    let is_warned = spec.urdf_warnings().iter().any(|warning| matches!(warning, UrdfWarning::Range { .. }));
    assert_ne!(is_limited, is_warned);
}
