//! Attachment of specs whose settings of `compiler` differ. The attached bodies are those of their
//! own spec, compiled alone, as with `mjSpec` of 4.0.1.

use mujoco_safe::Model;
use mujoco_safe::spec::Mount;
#[cfg(engine_since = "3.2.0")]
use mujoco_safe::spec::Spec;

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

/// Inertias of geoms, with bounds, groups and elements without mass, as in the spec alone.
#[test]
fn attached_bodies_keep_the_inertias_that_the_compiler_computes() {
    let child = |settings: &str| {
        format!(
            "<mujoco><compiler angle='radian' {settings}/><default><geom density='500'/></default>
               <worldbody><body name='b' pos='0 0 1' euler='.1 .2 .3'><joint name='j'/><geom size='.02'/>
                 <geom type='box' size='.1 .2 .3' pos='.1 .2 0' euler='.1 .2 .3' group='1'/>
                 <body name='c'><joint/><inertial pos='0 0 .1' mass='.01' diaginertia='.001 .0005 .0006'/><geom size='.1'/></body>
                 <body name='d' pos='1 0 0' quat='0 1 0 0'><geom type='capsule' size='.01' fromto='0 0 0 1 1 0'/></body>
                 <body name='e' pos='1 0 0' quat='0 1 0 0'/><body name='f'><geom type='box' size='1 .001 .001'/></body></body></worldbody>
               <actuator><motor joint='j'/></actuator></mujoco>"
        )
    };
    for (ours, theirs) in [
        ("", "boundmass='.02'"),
        ("", "boundinertia='.0008'"),
        ("", "boundmass='.02' boundinertia='.0008' balanceinertia='true'"),
        ("", "inertiagrouprange='1 1'"),
        ("", "inertiagrouprange='0 0' inertiafromgeom='true'"),
        ("boundmass='.001' boundinertia='1e-9'", "boundmass='.02' boundinertia='.0008'"),
        ("inertiafromgeom='false'", ""),
        ("inertiafromgeom='false'", "inertiafromgeom='true' boundmass='.02' boundinertia='.0008' fusestatic='true'"),
    ] {
        let host = text(ours, "h", "mass='7' diaginertia='5 5 5'");
        let child = child(theirs);
        let mut spec = parse(&host);
        let mount = Mount::body(spec.world());
        spec.attach(&parse(&child), mount, "p_").unwrap_or_else(|error| panic!("{error}: {ours} {theirs}"));
        let model = spec.compile().unwrap_or_else(|error| panic!("{error}\n{}", spec.to_xml()));
        let alone = Model::from_xml_str(&child.replace("fusestatic='true'", "")).unwrap();
        for body in 1..alone.nbody() {
            let values = |model: &Model, body: usize| {
                let (pos, quat) = (model.body_ipos()[body], model.body_iquat()[body]);
                [&[model.body_mass()[body]][..], &model.body_inertia()[body], &pos, &quat].concat()
            };
            let [found, expected] = [values(&model, body + 2), values(&alone, body)];
            let is_same = found.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-14 * b.abs().max(1.0));
            assert!(is_same, "body {body} with {ours:?} and {theirs:?}: {found:?}, {expected:?}\n{}", spec.to_xml());
        }
        #[cfg(engine_since = "3.2.0")]
        {
            use super::engine_spec::{RawSpec, Source};
            let [outer, inner] = [&host, &child].map(|text| RawSpec::parse(&Source::Text(text.clone())).unwrap());
            assert!(outer.attach(&inner, "p_", ([0.0; 3], [1.0, 0.0, 0.0, 0.0])));
            let expected = outer.compile().unwrap_or_else(|| panic!("{}", outer.error()));
            let differences = expected.differences(&model, 1e-12, &super::operations::CORRECTED);
            assert!(differences.is_empty(), "{ours:?} and {theirs:?}: {differences:?}");
        }
    }
}

/// Inertias that a text cannot express are errors.
#[test]
fn inertias_that_only_the_compiler_knows_are_errors() {
    let small = "mass='.5' diaginertia='.5 .1 .5'";
    for (ours, child) in [
        ("boundmass='1'", text("", "", small)),
        ("inertiafromgeom='true'", text("", "", small)),
        ("", text("settotalmass='3'", "", small)),
        ("", text("boundinertia='1'", "", "mass='1' fullinertia='1 1 1 2 0 0'")),
        ("", text("boundmass='1'", "", small).replace("<geom", "<composite/><geom")),
    ] {
        let mut spec = parse(&text(ours, "h", "mass='7' diaginertia='5 5 5'"));
        let before = spec.to_xml();
        let mount = Mount::body(spec.world());
        let error = spec.attach(&parse(&child), mount, "p_").unwrap_err().to_string();
        assert!(error.contains("of <compiler> in the attached spec"), "{error}");
        assert_eq!(spec.to_xml(), before);
    }
}

/// The copies of an element turn about the same axes in every sequence of Euler angles that has
/// them in this order. The compiler multiplies the angles, so that no other ones are equal.
#[cfg(engine_since = "3.5.0")]
#[test]
fn copies_keep_their_rotation() {
    let child = |sequence: &str, euler: &str| {
        format!(
            "<mujoco><compiler eulerseq='{sequence}' angle='radian'/><worldbody><replicate count='3' euler='{euler}' sep='_'>
               <body name='b' pos='1 2 3'><geom size='.1'/></body></replicate></worldbody></mujoco>"
        )
    };
    for (sequence, euler) in [
        ("zYx", "0 0 .5"),
        ("zYx", ".5 0 0"),
        ("zYx", "0 -.3 0"),
        ("zYx", "0 0 0"),
        ("ZYX", ".1 .2 .3"),
        ("Yxz", "0 .2 .3"),
        ("xzy", ".1 0 .3"),
        ("yXy", "0 .1 .3"),
    ] {
        let child = child(sequence, euler);
        let mut spec = parse("<mujoco><compiler angle='degree' eulerseq='xyz'/></mujoco>");
        let mount = Mount::body(spec.world());
        let attached = spec.attach(&parse(&child), mount, "");
        attached.unwrap_or_else(|error| panic!("{error}: {sequence} {euler}"));
        let [ours, alone] = [spec.compile().unwrap(), Model::from_xml_str(&child).unwrap()];
        let poses = |model: &Model| [model.body_pos().as_flattened(), model.body_quat().as_flattened()].concat();
        let is_same = poses(&ours).iter().zip(poses(&alone)).all(|(a, b)| (a - b).abs() < 1e-14);
        assert!(is_same, "{sequence} {euler}: {:?}, {:?}", poses(&ours), poses(&alone));
    }
    for (sequence, euler) in [("zyx", "1 2 0"), ("yxz", "1 2 0"), ("xyx", "1 0 2")] {
        let mut spec = parse("<mujoco/>");
        let mount = Mount::body(spec.world());
        let error = spec.attach(&parse(&child(sequence, euler)), mount, "").unwrap_err().to_string();
        assert!(error.contains("axes in another order"), "{error}");
    }
}

/// The engine gives the joints of the bodies of a `flexcomp` the defaults of the body around it.
#[cfg(engine_since = "3.2.0")]
#[test]
fn flexes_in_the_world_beside_defaults_are_those_of_the_engine() {
    use super::engine_spec::{RawSpec, Source};
    let flex = |prefix: &str| {
        format!(
            "<geom size='.1'/><flexcomp name='{prefix}cloth' type='grid' count='3 3 1' spacing='.1 .1 .1' mass='1' radius='.01' pos='0 0 1'/>
             <frame pos='1 0 0'><flexcomp name='{prefix}rope' type='grid' dim='1' count='4 1 1' spacing='.1 .1 .1' mass='1' radius='.01'/></frame>"
        )
    };
    let text = |defaults: &str, world: &str| {
        format!("<mujoco><default>{defaults}</default><worldbody>{world}</worldbody></mujoco>")
    };
    let defaults = "<geom rgba='1 0 0 1' size='.3'/><site size='.2'/>";
    let damped = "<geom rgba='1 0 0 1'/><joint damping='3' armature='2'/>";
    for (ours, theirs) in [(defaults, ""), ("", defaults), (defaults, "<geom friction='.3'/>"), (damped, defaults)] {
        let host = text(ours, &if ours == damped { String::new() } else { flex("h") });
        let child = text(theirs, &flex(""));
        let mut spec = parse(&host);
        let mount = Mount::body(spec.world());
        spec.attach(&parse(&child), mount, "p_").unwrap();
        let [outer, inner] = [host, child].map(|text| RawSpec::parse(&Source::Text(text)).unwrap());
        assert!(outer.attach(&inner, "p_", ([0.0; 3], [1.0, 0.0, 0.0, 0.0])));
        let expected = outer.compile().unwrap_or_else(|| panic!("{}", outer.error()));
        let differences = expected.differences(&spec.compile().unwrap(), 1e-12, &super::operations::CORRECTED);
        assert!(differences.is_empty(), "{ours} {theirs}: {differences:?}");
    }
    // Joint defaults that would be lost, also later ones.
    let error = |mut spec: Spec, child: &str| {
        let mount = Mount::body(spec.world());
        spec.attach(&parse(child), mount, "p_").unwrap_err().to_string()
    };
    for (ours, theirs) in [(damped, defaults), (defaults, damped)] {
        let error = error(parse(&text(ours, &flex("h"))), &text(theirs, &flex("")));
        assert!(error.contains("cannot separate the defaults of flexcomp"), "{error}");
    }
    let mut spec = parse(&text(defaults, &flex("h")));
    let mount = Mount::body(spec.world());
    spec.attach(&parse("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>"), mount, "").unwrap();
    let error = spec.default_mut("main", "joint").unwrap_err().to_string();
    assert!(error.contains("cannot separate the defaults of flexcomp"), "{error}");
}
