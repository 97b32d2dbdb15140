//! The elements that the compiler creates have ids in an expanded spec.

use std::sync::atomic::{AtomicBool, Ordering};

use mujoco_safe::kind::Kind;
use mujoco_safe::spec::Spec;
use mujoco_safe::{Error, LoadOptions, Model};

use super::parse;
use crate::assets;

/// Returns the names of bodies, joints and geoms. The engine names those that it creates.
fn names(model: &Model) -> Vec<Vec<String>> {
    let of = |kind| model.names(kind).map(str::to_owned).collect();
    [Kind::Body, Kind::Joint, Kind::Geom].map(of).to_vec()
}

/// Checks that the spec has an element with each name that the compiled model has, and that it
/// compiles to the same state.
fn check(spec: &Spec) -> Spec {
    let expected = spec.compile().unwrap();
    let expanded = spec.expanded().unwrap();
    for name in expected.names(Kind::Body) {
        assert!(name == "world" || expanded.body(name).is_ok(), "{name}: {}", expanded.to_xml());
    }
    for name in expected.names(Kind::Joint) {
        assert!(expanded.joint(name).is_ok(), "{name}: {}", expanded.to_xml());
    }
    let model = expanded.compile().unwrap();
    assert_eq!(names(&model), names(&expected));
    assert_eq!((model.nq(), model.nv(), model.ngeom()), (expected.nq(), expected.nv(), expected.ngeom()));
    for (found, expected) in model.qpos0().iter().zip(expected.qpos0()) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    expanded
}

#[cfg(engine_since = "3.1.3")]
#[test]
fn copies_and_flexes_become_elements() {
    let spec = parse(
        "<mujoco><worldbody>
           <replicate count='3' offset='1 0 0'><body name='post'><joint name='hinge'/><geom size='.1'/></body></replicate>
           <flexcomp name='cloth' type='grid' count='3 3 1' spacing='.1 .1 .1' mass='1' radius='.01' pos='0 0 1'/>
         </worldbody></mujoco>",
    );
    let mut expanded = check(&spec);
    let middle = expanded.body("post1").unwrap().id();
    let corner = expanded.body("cloth_0").unwrap().id();
    expanded.add_site(corner).set_name("corner");
    expanded.remove(middle).unwrap();
    let model = expanded.compile().unwrap();
    assert_eq!(model.nbody(), spec.compile().unwrap().nbody() - 1);
    assert!(model.site("corner").is_ok() && model.joint("hinge1").is_err());
}

#[cfg(not(engine_since = "3.0.0"))]
#[test]
fn composites_become_elements() {
    let spec = parse(
        "<mujoco><worldbody><body name='rB2' pos='0 0 1'><freejoint/>
           <composite type='rope' count='5 1 1' spacing='.1' prefix='r'>
             <joint kind='main' damping='.1'/><geom type='capsule' size='.01 .02'/></composite>
           <geom size='.01'/></body></worldbody></mujoco>",
    );
    check(&spec);
}

#[test]
fn files_in_memory_and_errors_are_those_of_the_compiler() {
    let files = assets::all();
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, content)| (*name, content.as_slice())).collect();
    let options = LoadOptions::default().with_files(&files);
    let spec = Spec::from_xml_str_with(assets::MODEL, &options).unwrap();
    let expanded = spec.expanded_with(&options).unwrap();
    assert_eq!(expanded.compile_with(&options).unwrap().nmesh(), spec.compile_with(&options).unwrap().nmesh());
    assert!(spec.expanded().unwrap_err().to_string().contains("solid"));
    let error = parse("<mujoco><worldbody><geom type='mesh'/></worldbody></mujoco>").expanded().unwrap_err();
    assert!(error.to_string().contains("mesh"), "{error}");
}

/// The engine saves the text that it has loaded last. Another thread may load in between.
#[test]
fn an_expanded_spec_is_never_that_of_another_thread() {
    let done = AtomicBool::new(false);
    let spec =
        parse("<mujoco><worldbody><body name='own'><joint name='hinge'/><geom size='.1'/></body></worldbody></mujoco>");
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                Model::from_xml_str("<mujoco><worldbody><geom name='other' size='.1'/></worldbody></mujoco>").unwrap();
            }
        });
        for _ in 0..20 {
            match spec.expanded() {
                Ok(expanded) => assert!(expanded.body("own").is_ok() && expanded.geom("other").is_err()),
                Err(error) => assert!(matches!(error, Error::XmlReplaced), "{error}"),
            }
        }
        done.store(true, Ordering::Relaxed);
    });
    assert!(spec.expanded().unwrap().joint("hinge").is_ok());
}
