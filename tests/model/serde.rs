//! Options, visual settings and statistics as plain data. Values are checked when they are applied
//! to a model.

#![forbid(unsafe_code)]

use mujoco_safe::enums::{Cone, Integrator, Solver};
use mujoco_safe::model::{DisableFlags, EnableFlags, Statistics, Visual};
use mujoco_safe::{Error, Options, sample};
use serde::Serialize;
use serde::de::DeserializeOwned;

fn round_trip<T: Serialize + DeserializeOwned>(value: &T) -> T {
    serde_json::from_str(&serde_json::to_string_pretty(value).unwrap()).unwrap()
}

#[test]
fn settings_round_trip_bit_for_bit() {
    let mut model = sample::humanoid();
    model
        .edit()
        .edit_options(|options| {
            (options.timestep, options.gravity) = (1.0 / 3.0, [0.1, -0.2, -9.81]);
            (options.integrator, options.cone, options.solver) = (Integrator::Implicit, Cone::Elliptic, Solver::Cg);
            options.disable = DisableFlags::CONTACT | DisableFlags::REFSAFE;
            options.enable = EnableFlags::ENERGY;
            options.iterations = 7;
        })
        .unwrap();
    model.edit().edit_visual(|visual| (visual.map.haze, visual.headlight.active) = (0.1, false)).unwrap();
    assert_eq!(round_trip(&model.options()), model.options());
    assert_eq!(round_trip(&model.visual()), model.visual());
    assert_eq!(round_trip(&model.statistics()), model.statistics());
}

#[test]
fn serialised_names_are_those_of_fields_flags_and_variants() {
    let options: Options =
        serde_json::from_str(r#"{"cone": "Elliptic", "disable": "GRAVITY | CONTACT", "o_solref": [0.01, 1]}"#).unwrap();
    assert_eq!((options.cone, options.o_solref), (Cone::Elliptic, [0.01, 1.0]));
    assert_eq!(options.disable, DisableFlags::GRAVITY | DisableFlags::CONTACT);
    let visual: Visual = serde_json::from_str(r#"{"global": {"fovy": 30}}"#).unwrap();
    assert_eq!(visual.global.fovy, 30.0);
}

#[test]
fn missing_fields_have_their_defaults() {
    assert_eq!(serde_json::from_str::<Options>("{}").unwrap(), Options::default());
    assert_eq!(serde_json::from_str::<Visual>(r#"{"map": {}}"#).unwrap(), Visual::default());
    assert_eq!(serde_json::from_str::<Statistics>("{}").unwrap(), Statistics::default());
}

#[test]
fn unknown_fields_and_invalid_values_are_errors() {
    assert!(serde_json::from_str::<Options>(r#"{"time_step": 0.1}"#).is_err());
    assert!(serde_json::from_str::<Options>(r#"{"integrator": "Euler2"}"#).is_err());
    assert!(serde_json::from_str::<Options>(r#"{"iterations": -1}"#).is_err());
    assert!(serde_json::from_str::<Options>(r#"{"disable": "GRAVITIES"}"#).is_err());
    assert!(serde_json::from_str::<Visual>(r#"{"global": {"fov": 30}}"#).is_err());
}

#[test]
fn applying_settings_checks_their_values() {
    let mut model = sample::cartpole();
    let before = model.options();
    for text in [r#"{"timestep": -1}"#, r#"{"iterations": 2000000000}"#, r#"{"disable": "0x80000000"}"#] {
        let options: Options = serde_json::from_str(text).unwrap();
        let error = model.edit().edit_options(|model| *model = options).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{text}: {error}");
    }
    assert_eq!(model.options(), before);
    let visual: Visual = serde_json::from_str(r#"{"quality": {"numslices": 1000000}}"#).unwrap();
    assert!(model.edit().edit_visual(|model| *model = visual).is_err());
    let statistics: Statistics = serde_json::from_str(r#"{"meaninertia": 0}"#).unwrap();
    assert!(model.edit().edit_statistics(|model| *model = statistics).is_err());
}

#[test]
fn untrusted_settings_are_errors_or_are_checked_when_applied() {
    let deep = "[".repeat(100_000);
    let long = format!(r#"{{"gravity": [{}]}}"#, "0,".repeat(100_000) + "0");
    for text in [
        "",
        "null",
        "1",
        "\"Euler\"",
        deep.as_str(),
        long.as_str(),
        r#"{"timestep": null}"#,
        r#"{"timestep": 1e400}"#,
        r#"{"iterations": 18446744073709551616}"#,
        r#"{"iterations": 1.5}"#,
        r#"{"solver": 3}"#,
        r#"{"solver": {"Newton": 1}}"#,
        r#"{"disable": 4294967295}"#,
        r#"{"gravity": [0, 0]}"#,
        r#"{"timestep": 1, "timestep": 2}"#,
    ] {
        assert!(serde_json::from_str::<Options>(text).is_err(), "{}", &text[..text.len().min(40)]);
    }
    // Numbers that JSON allows and a model does not.
    for text in [
        r#"{"timestep": -1}"#,
        r#"{"timestep": 0}"#,
        r#"{"timestep": 1e-400}"#,
        r#"{"impratio": 0}"#,
        r#"{"iterations": 18446744073709551615}"#,
        r#"{"mpr_iterations": 4294967296}"#,
        r#"{"tolerance": -1e300}"#,
    ] {
        let options: Options = serde_json::from_str(text).unwrap();
        let mut model = sample::cartpole();
        let before = model.options();
        let result = model.edit().edit_options(|own| *own = options);
        assert!(matches!(result, Err(Error::Invalid { .. })), "{text}");
        assert_eq!(model.options(), before, "{text}");
    }
    for text in [
        r#"{"global": {"offwidth": 18446744073709551615}}"#,
        r#"{"quality": {"numslices": 1000000000}}"#,
        r#"{"map": {"znear": -1}}"#,
        r#"{"quality": {"shadowsize": 2147483648}}"#,
    ] {
        let visual: Visual = serde_json::from_str(text).unwrap();
        let result = sample::cartpole().edit().edit_visual(|own| *own = visual);
        assert!(matches!(result, Err(Error::Invalid { .. })), "{text}");
    }
}
