//! Tests of the rules for newer engines, on the model with every kind of element and those that
//! 2.2.2 does not have.

use super::super::check;
use super::super::layout::{Field, Size, field, size};
use super::super::tests::{compile, each_integer_array, every_element_file};
use super::super::view::{SIZE_BYTES, SIZES_AT, View};
use super::is_absent;

/// Compiles the model with every element of 2.2.2, with newer elements.
pub(in super::super) fn every_element(text: &str) -> Vec<u8> {
    let text = INSERTIONS.iter().fold(text.to_owned(), |text, (before, inserted)| {
        assert!(text.contains(before), "every_element.xml has no {before}");
        text.replacen(before, &format!("{inserted}{before}"), 1)
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("every_element.xml");
    std::fs::write(&path, text).unwrap();
    std::fs::write(folder.path().join("grey.png"), include_bytes!("../../../../tests/models/grey.png")).unwrap();
    compile(&path).expect("every_element.xml compiles")
}

/// Texts in the model, and what is inserted before them.
const INSERTIONS: [(&str, &str); 6] = [
    (
        "<mesh name=\"wedge\"",
        "<texture name='grey' type='2d' file='grey.png' nchannel='1'/>
         <texture name='opaque' type='2d' file='grey.png' nchannel='4' colorspace='sRGB'/>
         <material name='layered'><layer role='rgb' texture='checks'/><layer role='normal' texture='dots'/></material>",
    ),
    (
        "</worldbody>",
        "<camera name='pixels' pos='0 -3 1' xyaxes='1 0 0 0 0 1' resolution='4 3' projection='orthographic' output='rgb depth'/>
         <light name='image' type='image' texture='sky'/>
         <body name='several' pos='4 4 1' gravcomp='.5' sleep='never'>
           <joint name='several_x' type='slide' axis='1 0 0' actuatorfrclimited='true' actuatorfrcrange='-1 1' actuatorgravcomp='true'/>
           <geom size='.1'/><geom size='.1' pos='.3 0 0'/><geom type='box' size='.1 .1 .1' pos='.6 0 0'/>
           <geom size='.1' pos='.9 0 0' contype='0' conaffinity='0'/><site name='several_site'/>
         </body>",
    ),
    (
        "<fixed name=\"other_coupling\"",
        "<fixed name='armed' armature='.1' actuatorfrclimited='true' actuatorfrcrange='-1 1'><joint joint='several_x' coef='1'/></fixed>",
    ),
    (
        "</equality>",
        "<connect site1='several_site' site2='anchor' active='false'/><weld site1='several_site' site2='anchor' active='false'/>",
    ),
    (
        "</actuator>",
        "<motor name='late' joint='several_x' nsample='4' delay='.005' interp='linear'/><motor joint='several_x' nsample='2'/>
         <general joint='several_x' dyntype='filterexact' dynprm='.1' actearly='true'/>",
    ),
    (
        "</sensor>",
        "<jointactuatorfrc joint='several_x'/><tendonactuatorfrc tendon='armed'/><camprojection site='tip' camera='pixels'/>
         <distance geom1='ball' geom2='floor' cutoff='1'/><normal geom1='floor' geom2='ball' cutoff='3'/>
         <fromto body1='several' geom2='ball' cutoff='3'/><e_potential/><e_kinetic/>
         <insidesite site='rail' objtype='geom' objname='ball'/>
         <contact geom1='floor' geom2='ball' num='2' data='found force dist normal tangent'/>
         <contact reduce='netforce' subtree1='several'/>
         <jointpos joint='several_x' nsample='3' delay='.004' interp='cubic'/>
         <accelerometer site='tip' nsample='2' interval='.01'/><user dim='2' needstage='pos'/>",
    ),
];

/// Integer arrays in which a neighbouring value can be valid: ids, types, masks, groups, numbers of
/// samples and the polygons of hulls. All other integers follow from the rest of the file.
#[rustfmt::skip]
const INDEPENDENT: [&str; 68] = [
    "actuator_biastype", "actuator_dyntype", "actuator_gaintype", "actuator_group", "actuator_history", "actuator_trnid",
    "actuator_trntype", "body_conaffinity", "body_contype", "bvh_nodeid", "cam_bodyid", "cam_mode", "cam_output",
    "cam_projection", "cam_resolution", "cam_targetbodyid", "eq_obj1id", "eq_obj2id", "eq_type", "exclude_signature",
    "geom_conaffinity", "geom_condim", "geom_contype", "geom_dataid", "geom_group", "geom_matid", "geom_priority", "geom_type",
    "jnt_group", "jnt_type", "light_bodyid", "light_mode", "light_targetbodyid", "light_texid", "light_type", "mat_texid",
    "mesh_face", "mesh_facenormal", "mesh_facetexcoord", "mesh_graph", "pair_dim", "pair_geom1", "sensor_datatype",
    "sensor_history", "sensor_intprm", "sensor_needstage", "sensor_objid", "sensor_objtype", "sensor_refid", "sensor_reftype",
    "sensor_type", "site_bodyid", "site_group", "site_matid", "site_type", "skin_bonebodyid", "skin_bonevertid", "skin_face",
    "skin_group", "skin_matid", "tendon_group", "tendon_matid", "tex_colorspace", "tex_type", "tree_sleep_policy",
    "tuple_objid", "tuple_objtype", "wrap_objid",
];

#[test]
fn integers_that_follow_from_others_are_compared() {
    let file = every_element_file();
    each_integer_array(|array, at, count| {
        if INDEPENDENT.contains(&array.name) {
            return;
        }
        assert!(count > 0 || array.rows.size.is_some_and(is_absent), "every_element.xml has no {}", array.name);
        for at in (at..).step_by(4).take(count) {
            for step in [-1, 1] {
                let mut changed = file.to_vec();
                let value = i32::from_ne_bytes(changed[at..at + 4].try_into().unwrap());
                changed[at..at + 4].copy_from_slice(&(value + step).to_ne_bytes());
                assert!(check(&changed).is_err(), "{} may be {} instead of {value}", array.name, value + step);
            }
        }
    });
}

/// Returns the error for a model with one value replaced, and whether it is about a missing
/// feature.
fn rejection(file: &[u8], at: usize, value: &[u8]) -> (String, bool) {
    let mut changed = file.to_vec();
    changed[at..at + value.len()].copy_from_slice(value);
    let error = check(&changed).expect_err("the check accepted the changed file");
    (error.to_string(), error.is_unsupported())
}

#[test]
fn files_of_another_version_are_rejected_by_their_header() {
    let file = every_element_file();
    for (i, (value, expected)) in [
        (7_i32, "the header's magic number is 7; MuJoCo 3.5.0 writes 54321"),
        (4, "the header's size of mjtNum is 4; MuJoCo 3.5.0 writes 8"),
        (58, "the header's number of sizes is 58; MuJoCo 3.5.0 writes 89"),
        (3_005_001, "the header's version is 3005001; MuJoCo 3.5.0 writes 3005000"),
        (273, "the header's number of arrays is 273; MuJoCo 3.5.0 writes 456"),
    ]
    .into_iter()
    .enumerate()
    {
        assert_eq!(rejection(file, 4 * i, &value.to_ne_bytes()).0, expected);
    }
}

#[test]
fn sizes_beyond_an_int_are_rejected() {
    let file = every_element_file();
    let with = |size: Size, value: i64| rejection(file, SIZES_AT + SIZE_BYTES * size.0, &value.to_ne_bytes()).0;
    assert_eq!(with(size::nq, 1 << 32), "nq is 4294967296; it must be at most 2147483647");
    assert_eq!(with(size::nq, -1), "nq is -1; a size must not be negative");
    assert_eq!(with(size::nconmax, -2), "nconmax is -2; a size must not be negative");
    assert_eq!(with(size::narena, i64::MAX), "narena is 9223372036854775807; it must be at most 281474976710656");
    assert_eq!(with(size::narena, 1 << 41), "narena is 2199023255552; it must be at most 1099511627776 bytes");
}

#[test]
fn features_without_rules_are_named() {
    let model = |world: &str| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.xml");
        std::fs::write(&path, format!("<mujoco>{world}</mujoco>")).unwrap();
        compile(&path).expect("the model compiles")
    };
    let flex = model(
        "<worldbody><flexcomp name='f' type='grid' count='3 3 1' spacing='.1 .1 .1' dim='2' radius='.01' mass='.1'/></worldbody>",
    );
    let error = check(&flex).unwrap_err();
    assert!(error.is_unsupported() && error.to_string() == "flexes", "{error}");
    // A mesh whose hull has a face of twelve vertices.
    let corners = (0..12).map(|i| f64::from(i) * std::f64::consts::TAU / 12.0);
    let ring: Vec<String> = corners.map(|angle| format!("{} {}", angle.cos(), angle.sin())).collect();
    let vertices: Vec<String> =
        ["0", "1"].iter().flat_map(|z| ring.iter().map(move |xy| format!("{xy} {z}"))).collect();
    let prism = |flag: &str| {
        model(&format!(
            "<option><flag multiccd='{flag}'/></option><asset><mesh name='m' vertex='{}'/></asset>
             <worldbody><body><freejoint/><geom type='mesh' mesh='m'/></body></worldbody>",
            vertices.join(" ")
        ))
    };
    assert_eq!(check(&prism("disable")), Ok(()));
    let error = check(&prism("enable")).unwrap_err();
    assert!(error.is_unsupported() && error.to_string().contains("multiccd"), "{error}");
}

#[test]
fn a_hierarchy_of_bounding_volumes_is_a_tree() {
    let file = every_element_file();
    let view = View::new(file).unwrap();
    // The three geoms of a body: the root, a leaf, and an inner node with two leaves.
    let body = view.values(field::body_bvhnum).position(|count| count == 5).unwrap();
    let root = view.get(field::body_bvhadr, body) as usize;
    let child = |i: usize, value: i32| rejection(file, view.position(field::bvh_child, i), &value.to_ne_bytes()).0;
    assert!(child(2 * root, 0).ends_with("it must be 1, the next node"));
    assert!(child(2 * root + 1, 1).ends_with("it must be 2, the node after those below the first child"));
    assert!(child(2 * (root + 1), 0).ends_with("it must be 2, the next node"));
    let leaf = rejection(file, view.position(field::bvh_nodeid, root + 1), &0_i32.to_ne_bytes()).0;
    assert!(leaf.starts_with(&format!("bvh_nodeid[{}] is 0; it must be from ", root + 1)), "{leaf}");
}

#[test]
fn activations_and_moments_follow_from_the_actuators() {
    let file = every_element_file();
    let view = View::new(file).unwrap();
    let stateful = view.values(field::actuator_actnum).position(|count| count == 1).unwrap();
    let with =
        |field: Field<i32>, i: usize, value: i32| rejection(file, view.position(field, i), &value.to_ne_bytes()).0;
    assert!(with(field::actuator_actnum, stateful, 2).ends_with("it must be 1, because of actuator_dyntype"));
    assert!(with(field::actuator_actadr, stateful, 1).contains("the end of the previous activation"));
    let moments = view.size(size::nJmom);
    let message = rejection(file, SIZES_AT + SIZE_BYTES * size::nJmom.0, &(moments as i64 - 1).to_ne_bytes()).0;
    assert_eq!(message, format!("nJmom is {}; it must be {moments}, the elements of all rows", moments - 1));
}

#[test]
fn many_names_of_one_hash_are_checked_in_linear_time() {
    let names: Vec<Vec<u8>> =
        (0..1 << 14_u32).map(|i| (0..14).flat_map(|bit| pair(i >> bit & 1 == 1)).collect()).collect();
    let table = super::name_map::table(names.iter().map(Vec::as_slice), 2 * names.len());
    let mut found: Vec<i64> = table.into_iter().filter(|&id| id != -1).collect();
    found.sort_unstable();
    assert!(found.into_iter().eq(0..names.len() as i64));
}

/// Returns one of two pairs of characters that change a hash in the same way.
fn pair(first: bool) -> [u8; 2] {
    if first { *b"00" } else { *b"2r" }
}
