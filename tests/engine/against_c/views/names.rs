//! Names of every kind against `mj_id2name` and `mj_name2id`.

use std::ffi::{CStr, CString};

use mujoco_safe::kind::Kind;
use mujoco_safe::sys;

use super::models;

/// The kinds and their `mjtObj`, from the header.
const OBJECTS: [(Kind, u32); 23] = [
    (Kind::Body, sys::mjOBJ_BODY),
    (Kind::Joint, sys::mjOBJ_JOINT),
    (Kind::Geom, sys::mjOBJ_GEOM),
    (Kind::Site, sys::mjOBJ_SITE),
    (Kind::Camera, sys::mjOBJ_CAMERA),
    (Kind::Light, sys::mjOBJ_LIGHT),
    (Kind::Mesh, sys::mjOBJ_MESH),
    (Kind::Skin, sys::mjOBJ_SKIN),
    (Kind::HeightField, sys::mjOBJ_HFIELD),
    (Kind::Texture, sys::mjOBJ_TEXTURE),
    (Kind::Material, sys::mjOBJ_MATERIAL),
    (Kind::Pair, sys::mjOBJ_PAIR),
    (Kind::Exclude, sys::mjOBJ_EXCLUDE),
    (Kind::Equality, sys::mjOBJ_EQUALITY),
    (Kind::Tendon, sys::mjOBJ_TENDON),
    (Kind::Actuator, sys::mjOBJ_ACTUATOR),
    (Kind::Sensor, sys::mjOBJ_SENSOR),
    (Kind::Numeric, sys::mjOBJ_NUMERIC),
    (Kind::Text, sys::mjOBJ_TEXT),
    (Kind::Tuple, sys::mjOBJ_TUPLE),
    (Kind::Keyframe, sys::mjOBJ_KEY),
    (Kind::Flex, sys::mjOBJ_FLEX),
    (Kind::Plugin, sys::mjOBJ_PLUGIN),
];

#[test]
fn every_kind_has_the_engines_constant() {
    assert!(OBJECTS.iter().map(|(kind, _)| *kind).eq(Kind::ALL.iter().copied()));
}

#[test]
fn names_of_every_kind_equal_c() {
    for subject in models() {
        for (kind, object) in OBJECTS {
            let m = subject.model.as_ptr();
            let name = |index: usize| {
                // SAFETY: a valid model, and a type and an index that the engine checks; a name is
                // a C string or NULL.
                let name = unsafe { sys::mj_id2name(m, object as i32, index as i32) };
                // SAFETY: as above.
                (!name.is_null()).then(|| unsafe { CStr::from_ptr(name) }.to_str().unwrap())
            };
            let count = subject.model.count(kind);
            // The engine has no name after the last element that the model lists.
            assert_eq!(name(count), None, "{}: {kind}", subject.name);
            let theirs: Vec<&str> = (0..count).filter_map(name).filter(|name| !name.is_empty()).collect();
            assert!(subject.model.names(kind).eq(theirs.iter().copied()), "{}: {kind}", subject.name);
        }
    }
}

#[test]
fn lookups_of_every_kind_equal_c() {
    macro_rules! check {
        ($subject:ident: $($one:ident, $many:ident, $object:ident;)*) => {$(
            for element in $subject.model.$many() {
                let Some(name) = element.name() else { continue };
                let name_c = CString::new(name).unwrap();
                // SAFETY: a valid model and string.
                let index = unsafe { sys::mj_name2id($subject.model.as_ptr(), sys::$object as i32, name_c.as_ptr()) };
                let found = $subject.model.$one(name).unwrap();
                assert_eq!(found.index() as i32, index, "{}: {element:?}", $subject.name);
                assert_eq!(found.id(), element.id(), "{}: {element:?}", $subject.name);
            }
        )*};
    }
    for subject in models() {
        check!(subject: body, bodies, mjOBJ_BODY; joint, joints, mjOBJ_JOINT; geom, geoms, mjOBJ_GEOM; site, sites, mjOBJ_SITE;
            camera, cameras, mjOBJ_CAMERA; light, lights, mjOBJ_LIGHT; mesh, meshes, mjOBJ_MESH; skin, skins, mjOBJ_SKIN;
            height_field, height_fields, mjOBJ_HFIELD; texture, textures, mjOBJ_TEXTURE;
            material, materials, mjOBJ_MATERIAL; pair, pairs, mjOBJ_PAIR; exclude, excludes, mjOBJ_EXCLUDE;
            equality, equalities, mjOBJ_EQUALITY; tendon, tendons, mjOBJ_TENDON; actuator, actuators, mjOBJ_ACTUATOR;
            sensor, sensors, mjOBJ_SENSOR; numeric, numerics, mjOBJ_NUMERIC; text, texts, mjOBJ_TEXT;
            tuple, tuples, mjOBJ_TUPLE; keyframe, keyframes, mjOBJ_KEY;);
    }
}
