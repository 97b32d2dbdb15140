//! With the feature `serde`, options, settings of the visualiser and statistics go to a file and back; what the file says is
//! checked where it is applied.

#![forbid(unsafe_code)]

use mujoco_safe::{Cone, DisableFlags, EnableFlags, Error, Integrator, Options, Solver, Statistics, Visual, sample};
use serde::Serialize;
use serde::de::DeserializeOwned;

fn round_trip<T: Serialize + DeserializeOwned>(value: &T) -> T {
    serde_json::from_str(&serde_json::to_string_pretty(value).unwrap()).unwrap()
}

#[test]
fn what_is_written_is_read_back_bit_for_bit() {
    let mut model = sample::humanoid();
    model
        .edit()
        .options(|options| {
            (options.timestep, options.gravity) = (1.0 / 3.0, [0.1, -0.2, -9.81]);
            (options.integrator, options.cone, options.solver) = (Integrator::Implicit, Cone::Elliptic, Solver::Cg);
            options.disable = DisableFlags::CONTACT | DisableFlags::REFSAFE;
            options.enable = EnableFlags::ENERGY;
            options.iterations = 7;
        })
        .unwrap();
    model.edit().visual(|visual| (visual.map.haze, visual.headlight.active) = (0.1, false)).unwrap();
    assert_eq!(round_trip(&model.options()), model.options());
    assert_eq!(round_trip(&model.visual()), model.visual());
    assert_eq!(round_trip(&model.statistics()), model.statistics());
}

#[test]
fn names_are_those_of_the_fields_and_flags_and_variants() {
    let options: Options =
        serde_json::from_str(r#"{"cone": "Elliptic", "disable": "GRAVITY | CONTACT", "o_solref": [0.01, 1]}"#).unwrap();
    assert_eq!((options.cone, options.o_solref), (Cone::Elliptic, [0.01, 1.0]));
    assert_eq!(options.disable, DisableFlags::GRAVITY | DisableFlags::CONTACT);
    let visual: Visual = serde_json::from_str(r#"{"global": {"fovy": 30}}"#).unwrap();
    assert_eq!(visual.global.fovy, 30.0);
}

#[test]
fn what_a_file_leaves_out_has_its_default() {
    assert_eq!(serde_json::from_str::<Options>("{}").unwrap(), Options::default());
    assert_eq!(serde_json::from_str::<Visual>(r#"{"map": {}}"#).unwrap(), Visual::default());
    assert_eq!(serde_json::from_str::<Statistics>("{}").unwrap(), Statistics::default());
}

#[test]
fn what_a_file_has_too_much_or_wrong_is_an_error() {
    assert!(serde_json::from_str::<Options>(r#"{"time_step": 0.1}"#).is_err());
    assert!(serde_json::from_str::<Options>(r#"{"integrator": "Euler2"}"#).is_err());
    assert!(serde_json::from_str::<Options>(r#"{"iterations": -1}"#).is_err());
    assert!(serde_json::from_str::<Options>(r#"{"disable": "GRAVITIES"}"#).is_err());
    assert!(serde_json::from_str::<Visual>(r#"{"global": {"fov": 30}}"#).is_err());
}

#[test]
fn what_a_file_says_is_checked_where_it_is_applied() {
    let mut model = sample::cartpole();
    let before = model.options();
    for text in [r#"{"timestep": -1}"#, r#"{"iterations": 2000000000}"#, r#"{"disable": "0x80000000"}"#] {
        let options: Options = serde_json::from_str(text).unwrap();
        let error = model.edit().options(|model| *model = options).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{text}: {error}");
    }
    assert_eq!(model.options(), before);
    let visual: Visual = serde_json::from_str(r#"{"quality": {"numslices": 1000000}}"#).unwrap();
    assert!(model.edit().visual(|model| *model = visual).is_err());
    let statistics: Statistics = serde_json::from_str(r#"{"meaninertia": 0}"#).unwrap();
    assert!(model.edit().statistics(|model| *model = statistics).is_err());
}
