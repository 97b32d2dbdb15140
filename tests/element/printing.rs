//! Printed views.

use mujoco_safe::{Data, sample};

use crate::{simulation, zoo};

/// Returns the text after a field's name in a listing.
fn field<'t>(listing: &'t str, name: &str) -> &'t str {
    listing
        .lines()
        .find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))
        .unwrap_or_else(|| panic!("no field {name} in\n{listing}"))
        .trim()
}

#[test]
fn a_view_lists_its_kind_index_name_and_every_field_of_mujoco_jl() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.step().unwrap();
    for name in ["subtree_linvel", "subtree_angmom", "cacc", "cfrc_int", "cfrc_ext"] {
        let listing = data.body("torso").unwrap().to_string();
        assert_eq!(field(&listing, name), "(not computed)", "a step does not compute {name}");
    }
    data.subtree_vel().unwrap();
    data.rne_post_constraint().unwrap();
    let torso = data.body("torso").unwrap();
    let listing = torso.to_string();
    assert!(listing.starts_with("Body:\nindex: "), "{listing}");
    assert_eq!(field(&listing, "name"), "\"torso\"");
    assert_eq!(field(&listing, "index"), "1");
    // The reference's applied, com, linvel, angmom, int and ext have the engine's names here.
    for (name, count) in [
        ("xfrc_applied", 6),
        ("xpos", 3),
        ("xquat", 4),
        ("xmat", 9),
        ("xipos", 3),
        ("ximat", 9),
        ("subtree_com", 3),
        ("cinert", 10),
        ("crb", 10),
        ("cvel", 6),
        ("subtree_linvel", 3),
        ("subtree_angmom", 3),
        ("cacc", 6),
        ("cfrc_int", 6),
        ("cfrc_ext", 6),
    ] {
        let values = field(&listing, name).trim_matches(['[', ']']);
        assert_eq!(values.split(", ").count(), count, "{name}: {values}");
    }
    assert_eq!(field(&listing, "xpos"), "[0.0, 0.0, 1.28]");
    assert_eq!(field(&listing, "xquat"), "[1.0, 0.0, 0.0, 0.0]");
}

#[test]
fn numbers_are_listed_with_four_significant_digits() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    data.step().unwrap();
    let torso = data.body("torso").unwrap();
    let listing = torso.to_string();
    for (name, values) in [("subtree_com", &torso.subtree_com()[..]), ("cinert", torso.cinert()), ("crb", torso.crb())]
    {
        let listed = field(&listing, name).trim_matches(['[', ']']).split(", ").collect::<Vec<_>>();
        assert_eq!(listed.len(), values.len());
        for (text, value) in listed.into_iter().zip(values) {
            let digits = text.split('e').next().unwrap_or_default().trim_start_matches(['-', '0', '.']);
            assert!(digits.chars().filter(char::is_ascii_digit).count() <= 5, "{name}: {text} for {value}");
            let listed: f64 = text.parse().unwrap();
            assert!((listed - value).abs() <= 0.5e-3 * value.abs(), "{name}: {text} for {value}");
        }
    }
}

#[test]
fn missing_names_and_values_are_listed_as_such() {
    let model = sample::cartpole();
    let listing = model.joint("slider").unwrap().to_string();
    assert_eq!(field(&listing, "user"), "[]");
    assert_eq!(field(&listing, "joint_type"), "Slide");
    assert_eq!(field(&listing, "qpos_range"), "0..1");
    assert_eq!(field(&listing, "limited"), "true");
    assert_eq!(field(&listing, "range"), "[-1.0, 1.0]");
    let listing = zoo().joint(4).unwrap().to_string();
    assert_eq!(field(&listing, "name"), "(none)");
}

#[test]
fn views_and_ids_print_on_one_line_with_kind_index_and_name() {
    let model = zoo();
    let mut data = simulation();
    assert_eq!(format!("{:?}", model.joint("elbow").unwrap()), "joint 3 'elbow'");
    assert_eq!(format!("{:?}", model.joint(4).unwrap()), "joint 4");
    assert_eq!(format!("{:?}", model.joint("elbow").unwrap().id()), "joint 3");
    assert_eq!(format!("{}", model.joint("elbow").unwrap().id()), "joint 3");
    assert_eq!(format!("{:?}", data.camera("overview").unwrap()), "camera 0 'overview'");
    assert_eq!(format!("{:?}", data.sensor_mut("touch").unwrap()), "sensor 5 'touch'");
    assert_eq!(format!("{:?}", model.keyframe("lifted").unwrap()), "keyframe 0 'lifted'");
    assert_eq!(
        format!("{model:?}"),
        "Model: 7 bodies, 5 joints, 8 geoms, 6 actuators, 10 sensors, 3 tendons, 2 keyframes (nq 14, nv 12, nu 6)"
    );
    let text = format!("{data:?}");
    assert!(text.starts_with("Data: time 0 s, ") && text.ends_with("(nq 14, nv 12, nu 6)"), "{text}");
}
