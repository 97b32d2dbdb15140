//! Attachment of specs whose settings of `compiler` differ. The attached bodies are those of their
//! own spec, compiled alone, as with `mjSpec` of 4.0.1.

use mujoco_safe::Model;
use mujoco_safe::spec::Mount;

use super::parse;

fn text(settings: &str, prefix: &str, inertial: &str) -> String {
    format!(
        "<mujoco><compiler {settings}/><worldbody><body name='{prefix}b'><joint/><inertial pos='.1 0 0' {inertial}/>
           <geom size='.1' mass='3'/><body name='{prefix}c'><inertial pos='0 0 0' mass='4' diaginertia='3 3 3'/></body></body>
         </worldbody></mujoco>"
    )
}

/// Attaches a text to one with other settings. Returns the result and the masses and inertias of
/// both alone.
#[track_caller]
fn check(ours: &str, theirs: &str, inertial: &str) {
    let host = text(ours, "h", "mass='7' diaginertia='5 5 5'");
    let child = text(theirs, "", inertial);
    let mut spec = parse(&host);
    let mount = Mount::body(spec.world());
    spec.attach(&parse(&child), mount, "p_").unwrap();
    let model = spec.compile().unwrap_or_else(|error| panic!("{error}\n{}", spec.to_xml()));
    for (text, prefix) in [(&host, ""), (&child, "p_")] {
        let alone = Model::from_xml_str(text).unwrap();
        let names = if prefix.is_empty() { ["hb", "hc"] } else { ["b", "c"] };
        for name in names {
            let [found, expected] =
                [(&model, format!("{prefix}{name}")), (&alone, name.to_owned())].map(|(model, name)| {
                    let id = model.body(&name[..]).unwrap().id().index();
                    (model.body_mass()[id], model.body_inertia()[id], model.body_ipos()[id])
                });
            assert_eq!(found, expected, "{name} with {ours:?} and {theirs:?}");
        }
    }
}

#[test]
fn attached_bodies_keep_the_inertia_of_their_own_settings() {
    let small = "mass='.5' diaginertia='.5 .1 .5'";
    let [inferred, fixed] = ["inertiafromgeom='auto'", "inertiafromgeom='false'"];
    check(inferred, fixed, small);
    check(fixed, inferred, small);
    check("", "inertiafromgeom='true'", small);
    check("", "inertiagrouprange='1 2'", small);
    check("inertiagrouprange='1 2'", "", small);
    check("", "boundmass='1'", small);
    check("", "boundinertia='.3'", small);
    check("boundmass='.2' boundinertia='.05'", "boundmass='.6'", small);
    check("", "balanceinertia='true'", "mass='.5' diaginertia='.1 .5 .1'");
    check("", "balanceinertia='true' boundinertia='.2'", "mass='.5' diaginertia='.1 .5 .1'");
    check("boundinertia='.2'", "balanceinertia='true' boundinertia='.2'", "mass='.5' diaginertia='.1 .5 .1'");
    check("balanceinertia='true'", "", small);
    check("fitaabb='true'", "", small);
    check("", "inertiafromgeom='false' boundmass='.01' boundinertia='.01' balanceinertia='true'", small);
}

/// Inertias that a text cannot express are errors.
#[test]
fn inertias_that_only_the_compiler_knows_are_errors() {
    let small = "mass='.5' diaginertia='.5 .1 .5'";
    let from_geoms = "<mujoco><compiler boundmass='1'/><worldbody><body><geom size='.1'/></body></worldbody></mujoco>";
    for (ours, child) in [
        ("boundmass='1'", text("", "", small)),
        ("inertiafromgeom='true'", text("", "", small)),
        ("", text("settotalmass='3'", "", small)),
        ("", text("boundinertia='1'", "", "mass='1' fullinertia='1 1 1 2 0 0'")),
        ("", from_geoms.to_owned()),
    ] {
        let mut spec = parse(&text(ours, "h", "mass='7' diaginertia='5 5 5'"));
        let before = spec.to_xml();
        let mount = Mount::body(spec.world());
        let error = spec.attach(&parse(&child), mount, "p_").unwrap_err().to_string();
        assert!(error.contains("of <compiler> in the attached spec"), "{error}");
        assert_eq!(spec.to_xml(), before);
    }
}

/// The copies of an element turn about one axis in every order of Euler angles.
#[cfg(engine_since = "3.5.0")]
#[test]
fn copies_keep_their_rotation() {
    for euler in ["0 0 .5", ".5 0 0", "0 -.3 0", "0 0 0"] {
        let child = format!(
            "<mujoco><compiler eulerseq='zYx' angle='radian'/><worldbody><replicate count='3' euler='{euler}' sep='_'>
               <body name='b' pos='1 2 3'><geom size='.1'/></body></replicate></worldbody></mujoco>"
        );
        let mut spec = parse("<mujoco><compiler angle='degree' eulerseq='xyz'/></mujoco>");
        let mount = Mount::body(spec.world());
        spec.attach(&parse(&child), mount, "").unwrap();
        let [ours, alone] = [spec.compile().unwrap(), Model::from_xml_str(&child).unwrap()];
        let poses = |model: &Model| [model.body_pos().as_flattened(), model.body_quat().as_flattened()].concat();
        let is_same = poses(&ours).iter().zip(poses(&alone)).all(|(a, b)| (a - b).abs() < 1e-14);
        assert!(is_same, "{euler}: {:?}, {:?}", poses(&ours), poses(&alone));
    }
    let mut spec = parse("<mujoco/>");
    let mount = Mount::body(spec.world());
    let child = "<mujoco><compiler eulerseq='zyx'/><worldbody><replicate count='2' euler='1 2 0'><geom size='.1'/></replicate></worldbody></mujoco>";
    let error = spec.attach(&parse(child), mount, "").unwrap_err().to_string();
    assert!(error.contains("several axes"), "{error}");
}
