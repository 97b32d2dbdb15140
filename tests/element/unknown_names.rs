//! Errors of unknown names.

use mujoco_safe::kind::Kind;
use mujoco_safe::{Error, sample};

use crate::{every_element, simulation, unknown, zoo};

#[test]
fn the_error_suggests_the_nearest_name_and_lists_all_names() {
    let text = unknown(zoo().joint("elbwo"));
    assert_eq!(
        text,
        "there is no joint named 'elbwo', did you mean 'elbow'? (known names: crate, rail, shoulder, elbow)"
    );
    let text = unknown(zoo().actuator("no such thing"));
    assert!(!text.contains("did you mean"), "{text}");
    assert!(text.contains("rail, turn, filter, winch, biceps"), "{text}");
}

#[test]
fn the_error_variant_has_the_names() {
    let Err(Error::NoSuchName { kind, name, known, .. }) = sample::humanoid().keyframe("handstand").map(|_| ()) else {
        panic!("expected NoSuchName")
    };
    assert_eq!((kind, name.as_str()), (Kind::Keyframe, "handstand"));
    assert_eq!(known, ["squat", "stand_on_left_leg", "stand"]);
}

#[test]
fn the_error_names_the_elements_of_other_kinds() {
    let model = sample::humanoid();
    let error = model.geom("left_knee").unwrap_err();
    assert!(error.to_string().starts_with("there is no geom named 'left_knee' (there is joint 'left_knee'"), "{error}");
    let Error::NoSuchName { others, .. } = error else { panic!("{error}") };
    assert_eq!(others, [Kind::Joint, Kind::Actuator]); // in `models/humanoid.xml`
    assert_eq!(unknown(zoo().joint("no such thing")).matches("there is").count(), 1);
}

#[test]
fn the_error_of_a_kind_without_names_says_so() {
    let text = unknown(sample::cartpole().tendon("rope"));
    assert_eq!(text, "there is no tendon named 'rope' (none of this kind has a name)");
}

#[test]
fn the_empty_name_finds_nothing() {
    // The engine itself would return the first unnamed element.
    unknown(zoo().joint(""));
    unknown(zoo().geom(""));
    unknown(simulation().light(""));
}

#[test]
fn a_name_is_not_truncated_at_a_nul_character() {
    unknown(zoo().joint("elbow\0"));
    unknown(zoo().joint("elbow\0x"));
}

#[test]
fn names_are_compared_exactly() {
    for name in ["Elbow", "elbow ", "elbo", "elbows", "ellenbogen ‐ coude"] {
        unknown(zoo().joint(name));
    }
}

#[test]
fn a_mutable_lookup_gives_the_same_error() {
    let mut data = simulation();
    assert!(unknown(data.joint_mut("elbwo")).contains("'elbow'"));
    assert!(data.sensor_mut(99).is_err());
    let text = data.edit_model(|model| Ok(unknown(model.geom_mut("grund")))).unwrap();
    assert!(text.contains("'ground'"), "{text}");
}

#[test]
fn every_kind_suggests_its_own_names() {
    let model = every_element();
    for (text, kind, near) in [
        (unknown(model.equality("gearde")), "equality", "geared"),
        (unknown(model.numeric("gain")), "numeric", "gains"),
        (unknown(model.text("notes")), "text", "note"),
        (unknown(model.tuple("part")), "tuple", "parts"),
        (unknown(model.mesh("wegde")), "mesh", "wedge"),
        (unknown(model.skin("sheets")), "skin", "sheet"),
        (unknown(model.height_field("grund")), "height field", "ground"),
        (unknown(model.texture("check")), "texture", "checks"),
        (unknown(model.material("paint")), "material", "painted"),
        (unknown(model.pair("pad_and_flor")), "pair", "pad_and_floor"),
        (unknown(model.exclude("branch_and_ends")), "exclude", "branch_and_end"),
    ] {
        assert!(text.starts_with(&format!("there is no {kind} named '")), "{text}");
        assert!(text.contains(&format!("did you mean '{near}'")), "{text}");
    }
}
