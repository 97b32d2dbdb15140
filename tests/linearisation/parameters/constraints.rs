//! Solver parameters of constraints: `solref`, `solimp`, friction and weights, of contacts, limits,
//! dry friction and equality constraints.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use mujoco_safe::derivative::{DifferencedTerms, Kinks, ModelParameter, TransitionMethod, TransitionOptions};
use mujoco_safe::model::EnableFlags;
use mujoco_safe::{Data, Lineariser, Model};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Agreement, Oracle, compare, compare_all, field, of_constraints};
use crate::cases::cases;
use crate::transition::analytic::random_models::xml;
use crate::transition::analytic::randomise;

/// Returns attributes with random solver parameters, in standard or direct format.
fn attributes(random: &mut Xoshiro256PlusPlus, reference: &str, impedance: &str) -> String {
    let mut number = |low: f64, high: f64| random.random_range(low..high);
    let standard = [number(0.015, 0.05), number(0.6, 1.4)];
    let direct = [number(-900.0, -200.0), number(-40.0, -5.0)];
    let [first, second] = if number(0.0, 1.0) < 0.7 { standard } else { direct };
    let (start, end, width) = (number(0.6, 0.9), number(0.8, 0.97), number(0.001, 0.3));
    let (midpoint, power) = (number(0.2, 0.8), number(1.2, 4.0));
    format!(
        r#" {reference}="{first:.4} {second:.4}" {impedance}="{start:.4} {end:.4} {width:.4} {midpoint:.3} {power:.3}""#
    )
}

/// Returns a random model whose constraints have random solver parameters, and explicit pairs.
fn with_solver_parameters(seed: u64) -> String {
    let text = xml(seed);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x5eed);
    let mut geoms = 0;
    let mut result = String::new();
    let (head, tail) = text.split_once("</default>").unwrap();
    for element in tail.split_inclusive('>') {
        let at = element.find(['/', '>']).filter(|&at| at > 1).unwrap_or(0);
        let has = |start: &str| element.starts_with(start);
        let mut more = String::new();
        if has("<geom ") {
            write!(more, r#" name="g{geoms}""#).unwrap();
            geoms += 1;
            let [slide, spin, roll] = [1.0, 0.02, 0.01].map(|size| size * random.random_range(0.3..1.5));
            write!(more, r#" friction="{slide:.4} {spin:.5} {roll:.5}""#).unwrap();
            more += &attributes(&mut random, "solref", "solimp");
            write!(more, r#" solmix="{:.3}""#, random.random_range(0.2..3.0)).unwrap();
            if random.random_bool(0.3) {
                more += r#" priority="1""#;
            }
        } else if ["<joint name", "<joint type", "<fixed "].into_iter().any(has) {
            more += &attributes(&mut random, "solreflimit", "solimplimit");
            more += &attributes(&mut random, "solreffriction", "solimpfriction");
        } else if has("<connect ") || has("<weld ") || has("<joint joint1") {
            more += &attributes(&mut random, "solref", "solimp");
        }
        let at = if more.is_empty() { element.len() } else { at };
        let (start, end) = element.split_at(at);
        write!(result, "{start}{more}{end}").unwrap();
    }
    let mut pairs = String::new();
    for geom in (1..geoms).filter(|geom| geom % 3 == 0) {
        let dim = [1, 3, 4, 6][random.random_range(0..4)];
        let friction = [1.0, 0.8, 0.02, 0.01, 0.03].map(|size| (size * random.random_range(0.3..1.5)).to_string());
        let more = attributes(&mut random, "solref", "solimp");
        write!(pairs, r#"<pair geom1="g0" geom2="g{geom}" condim="{dim}" friction="{}"{more}/>"#, friction.join(" "))
            .unwrap();
    }
    format!("{head}</default>{result}").replace("</mujoco>", &format!("<contact>{pairs}</contact></mujoco>"))
}

fn compare_models(seed: u64, models: u64) {
    let (mut compared, mut close, mut noisy, mut failures) = (0, 0, 0, Vec::new());
    for seed in seed..seed + models {
        let text = with_solver_parameters(seed);
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut data = Data::new(Model::from_xml_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))).unwrap();
        randomise(&mut data, &mut random);
        // Random constraints can be too stiff for the time step.
        if seed % 2 == 1 && (0..30).any(|_| data.step().is_err()) || data.clone().step().is_err() {
            continue;
        }
        let all = of_constraints(data.model());
        let parameters: Vec<_> = (0..16).map(|_| all[random.random_range(0..all.len())]).collect();
        let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
        let (_, report) = lineariser.parameter_jacobian(&mut data, &parameters).unwrap();
        if report.method != TransitionMethod::Analytic {
            continue;
        }
        assert!(!report.differenced.contains(DifferencedTerms::PARAMETERS));
        compared += 1;
        println!("model {seed}: {compared} compared, {} failures", failures.len());
        match compare_all(&mut data, &parameters) {
            Ok([more, some]) => (close, noisy) = (close + more, noisy + some),
            Err(failure) => failures.push(format!("model {seed}, {failure}")),
        }
    }
    println!("{compared} of {models} models, {close} columns, {noisy} noisy ones");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(2 * compared > models && 20 * noisy <= close, "{compared} models, {noisy} of {close} columns are noisy");
}

#[test]
fn random_models_agree_with_differences() {
    compare_models(8000, cases(12, 40));
}

#[test]
#[ignore = "takes minutes"]
fn many_models_agree_with_differences_by_solver_parameters() {
    compare_models(8000, 510);
}

/// Returns a body with some geoms on a floor, in another state of its contacts for each velocity.
fn sliding(option: &str, floor: &str, geom: &str, more: &str) -> Data {
    let text = format!(
        r#"<mujoco><option {option} timestep=".004"/><worldbody><geom name="floor" type="plane" size="1 1 1" euler="1 2 0" {floor}/>
             <body name="b" pos="0 0 .093"><freejoint/><geom name="g" type="sphere" size=".1" {geom}/>
               <geom name="h" type="capsule" size=".05 .1" pos=".2 .05 -.045" euler="0 80 10" {geom}/></body></worldbody>{more}</mujoco>"#
    );
    Data::new(Model::from_xml_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))).unwrap()
}

/// Compares the derivatives by all solver parameters. Returns the names of those with an effect.
#[track_caller]
fn check(what: &str, data: &mut Data) -> BTreeSet<String> {
    let model = data.model().clone();
    let parameters = of_constraints(&model);
    let mut lineariser = Lineariser::new(model.clone(), TransitionOptions::default()).unwrap();
    assert_eq!(lineariser.differenced_parameters(&parameters).unwrap(), [], "{what}");
    let (jacobian, report) = lineariser.parameter_jacobian(data, &parameters).unwrap();
    assert_eq!(report.method, TransitionMethod::Analytic, "{what}: {report:?}");
    assert!(!report.differenced.contains(DifferencedTerms::PARAMETERS), "{what}");
    let agreement = compare_all(data, &parameters);
    assert!(agreement.is_ok(), "{what}: {agreement:?}");
    let has_effect = |index: &usize| jacobian.state.rows().any(|row| row[*index].abs() > 1e-9);
    (0..parameters.len()).filter(has_effect).map(|index| parameters[index].name(&model).unwrap()).collect()
}

/// Asserts that parameters have had an effect.
#[track_caller]
fn assert_effects(effects: &BTreeSet<String>, names: &[&str]) {
    for name in names {
        assert!(effects.iter().any(|effect| effect.starts_with(name)), "{name} has no effect: {effects:#?}");
    }
}

const OPTIONS: [&str; 3] = ["", r#"cone="elliptic" impratio="3""#, r#"cone="elliptic" jacobian="sparse""#];
const SOLVER: &str = r#"solref=".03 .8" solimp=".7 .9 .06 .4 2.5""#;

#[test]
fn contacts_with_all_dimensions_and_cones() {
    let mut zones = BTreeSet::new();
    for option in OPTIONS {
        for dim in [1, 3, 4, 6] {
            let mut effects = BTreeSet::new();
            for velocity in
                [[0.0, 0.0, -0.2, 0.0, 0.0, 0.0], [0.4, 0.9, -0.3, 3.0, -2.0, 5.0], [0.3, 0.01, 0.05, 0.0, 0.2, 9.0]]
            {
                let geom = format!(r#"condim="{dim}" friction=".6 .03 .02" {SOLVER}"#);
                let mut data = sliding(option, r#"friction=".2 .001 .001" condim="1""#, &geom, "");
                data.qvel_mut().copy_from_slice(&velocity);
                effects.append(&mut check(&format!("{option} {dim} {velocity:?}"), &mut data));
                data.forward().unwrap();
                zones.extend(data.efc_type().iter().copied().zip(data.efc_state().iter().copied()));
            }
            assert_effects(&effects, &["geom_solref[0]", "geom_solref[1]", "geom_solmix"]);
            assert_effects(
                &effects,
                &[0, 1, 2, 3, 4].map(|at| format!("geom_solimp[{at}]")).each_ref().map(|name| &name[..]),
            );
            let frictions = ["geom_friction[0]", "geom_friction[1]", "geom_friction[2]"];
            assert_effects(&effects, &frictions[..[0, 0, 0, 1, 2, 2, 3][dim]]);
        }
    }
    // Frictionless, pyramidal and elliptic contacts: satisfied, quadratic, and in the middle zone.
    assert!(zones.is_superset(&BTreeSet::from([(5, 1), (6, 0), (6, 1), (7, 1), (7, 4)])), "{zones:?}");
}

#[test]
fn priorities_weights_and_direct_formats() {
    let direct = r#"solref="-900 -30" solimp=".7 .9 .06 .4 2.5""#;
    let other = r#"friction=".7 .02 .01" solref=".05 1.2" solimp=".6 .95 .03 .6 3""#;
    for option in OPTIONS {
        for (floor, geom) in [
            // The larger priority, with less friction.
            (format!(r#"priority="2" {other}"#), format!(r#"priority="1" friction=".9 .01 .02" {SOLVER}"#)),
            (format!(r#"solmix="2" {other}"#), format!(r#"solmix=".5" friction=".9 .01 .02" {SOLVER}"#)),
            // Direct formats: the smaller numbers.
            (other.to_owned(), format!(r#"friction=".9 .01 .02" {direct}"#)),
            (r#"solref="-400 -60""#.to_owned(), format!(r#"friction=".9 .01 .02" {direct}"#)),
        ] {
            let mut data = sliding(option, &floor, &format!(r#"condim="6" {geom}"#), "");
            data.qvel_mut().copy_from_slice(&[0.4, 0.9, -0.3, 3.0, -2.0, 5.0]);
            check(&format!("{option} {floor} {geom}"), &mut data);
            data.qvel_mut().fill(0.0);
            check(&format!("{option} {floor} {geom} at rest"), &mut data);
        }
    }
}

#[test]
fn explicit_pairs() {
    let pair = format!(
        r#"<contact><pair geom1="h" geom2="floor" condim="6" friction=".8 .4 .03 .02 .01" {SOLVER}/></contact>"#
    );
    let mut effects = BTreeSet::new();
    for option in OPTIONS {
        let mut data = sliding(option, r#"friction=".3 .01 .01""#, r#"friction=".5 .02 .03""#, &pair);
        data.qvel_mut().copy_from_slice(&[0.4, 0.9, -0.3, 3.0, -2.0, 5.0]);
        effects.append(&mut check(option, &mut data));
        // The parameters of the geom of the pair have no effect.
        let model = data.model().clone();
        let parameters = field(&model, "geom_friction", 3);
        let mut lineariser = Lineariser::new(model, TransitionOptions::default()).unwrap();
        let (jacobian, _) = lineariser.parameter_jacobian(&mut data, &parameters).unwrap();
        assert!(jacobian.state.rows().all(|row| row[6..] == [0.0; 3]));
        assert!(jacobian.state.rows().any(|row| row[3] != 0.0));
    }
    let frictions = [0, 1, 2, 3, 4].map(|at| format!("pair_friction[{at}]"));
    assert_effects(&effects, &frictions.each_ref().map(|name| &name[..]));
    assert_effects(&effects, &["pair_solref[0]", "pair_solref[1]", "pair_solimp[2]"]);
}

#[test]
fn overridden_parameters_have_no_effect() {
    for option in OPTIONS {
        let mut data = sliding(option, r#"friction=".3 .01 .01""#, r#"friction=".5 .02 .03" condim="4""#, "");
        data.edit_model(|model| {
            model.edit_options(|options| {
                options.enable |= EnableFlags::OVERRIDE;
                (options.o_solref, options.o_solimp) = ([0.04, 0.9], [0.8, 0.9, 0.01, 0.5, 2.0]);
            })
        })
        .unwrap();
        data.qvel_mut().copy_from_slice(&[0.4, 0.9, -0.3, 3.0, -2.0, 5.0]);
        check(option, &mut data);
        let model = data.model().clone();
        let parameters = field(&model, "geom_solref", 2);
        let mut lineariser = Lineariser::new(model, TransitionOptions::default()).unwrap();
        let (jacobian, _) = lineariser.parameter_jacobian(&mut data, &parameters).unwrap();
        assert!(jacobian.state.as_slice().iter().all(|&value| value == 0.0));
    }
}

#[test]
fn limits_friction_and_equalities() {
    let equalities = if cfg!(engine_since = "3.7.0") {
        ""
    } else {
        r#"<connect body1="d" body2="e" anchor=".1 .02 .03" solref=".05 1.2" solimp=".7 .9 5 .4 2.5"/>
           <weld body1="f" body2="b" torquescale=".4" solref=".06 .9" solimp=".6 .9 8 .6 3"/>"#
    };
    let text = format!(
        r#"<mujoco><option timestep=".004"/><default><geom contype="0" conaffinity="0"/></default><worldbody>
             <body name="b"><joint name="i" axis="0 1 0" range="-30 20" limited="true" solreflimit=".04 .8" solimplimit=".6 .9 .3 .4 2.5"
               frictionloss=".7" solreffriction=".02 .7" solimpfriction=".8 .9 .1 .4 2"/><geom size=".1" pos=".3 0 0"/>
             <body name="c" pos=".5 0 0"><joint name="j" type="ball" range="0 20" limited="true" solreflimit="-300 -20" solimplimit=".7 .95 2 .4 3"/>
               <geom type="box" size=".1 .05 .03" pos=".1 .02 0"/>
             <body name="d" pos=".2 0 0"><joint name="k" axis="0 0 1" frictionloss="3" solreffriction=".03 1" solimpfriction=".6 .9 .1 .4 2"/><geom size=".05" pos=".1 0 0"/></body></body></body>
             <body name="e" pos="1 0 .1"><freejoint/><geom size=".1"/></body><body name="f" pos="2 0 .1"><freejoint/><geom size=".1"/></body>
             <body name="p" pos="3 0 0"><joint name="p" type="slide"/><geom size=".1"/></body><body name="q" pos="3 1 0"><joint name="q" type="slide"/><geom size=".1"/></body>
           </worldbody>
           <tendon><fixed name="t" limited="true" range="-.1 .1" solreflimit=".05 1.1" solimplimit=".7 .9 .4 .3 2.2" frictionloss="2"
             solreffriction=".04 .9" solimpfriction=".75 .9 .1 .4 2"><joint joint="i" coef="1"/><joint joint="k" coef="-.7"/></fixed></tendon>
           <equality><joint joint1="p" joint2="q" polycoef=".1 .7 .3 0 0" solref="-500 -30" solimp=".6 .9 4 .4 2.5"/>
             <tendon tendon1="t" polycoef=".3 0 0 0 0" solref=".05 1.3" solimp=".7 .92 4 .4 2.5"/>{equalities}</equality></mujoco>"#
    );
    let mut data = Data::new(Model::from_xml_str(&text).unwrap()).unwrap();
    let mut effects = BTreeSet::new();
    for seed in 0..2 {
        randomise(&mut data, &mut Xoshiro256PlusPlus::seed_from_u64(seed));
        effects.append(&mut check(&format!("state {seed}"), &mut data));
    }
    // Friction that does not slip.
    randomise(&mut data, &mut Xoshiro256PlusPlus::seed_from_u64(9));
    data.qvel_mut().fill(0.0);
    data.qvel_mut()[4] = 0.3;
    data.edit_model(|model| {
        model.dof_frictionloss_mut().iter_mut().filter(|loss| **loss > 0.0).for_each(|loss| *loss = 1e4);
        model.tendon_frictionloss_mut()[0] = 1e4;
    })
    .unwrap();
    effects.append(&mut check("sticking", &mut data));
    assert_effects(
        &effects,
        &[
            "eq_solref[1] of equality 0",
            "eq_solimp[2] of equality 1",
            "jnt_solref[0] of joint 'j'",
            "jnt_solimp[3] of joint 'i'",
            "tendon_solref_lim[1]",
            "tendon_solimp_lim[2]",
        ],
    );
    if !equalities.is_empty() {
        assert_effects(
            &effects,
            &["eq_solref[0] of equality 2", "eq_solimp[2] of equality 2", "eq_solimp[2] of equality 3"],
        );
    }
    assert_effects(&effects, &["dof_solref[4][0]", "dof_solimp[4][0]", "tendon_solref_fri[0]", "tendon_solimp_fri[0]"]);
}

/// Compares the derivative by one number.
#[track_caller]
fn check_one(data: &mut Data, (array, row, column): (&str, usize, usize)) -> f64 {
    let model = data.model().clone();
    let parameter = ModelParameter::field(&model, array, row, column).unwrap();
    let mut lineariser = Lineariser::new(model, TransitionOptions::default()).unwrap();
    let (jacobian, report) = lineariser.parameter_jacobian(data, &[parameter]).unwrap();
    assert_eq!((report.method, report.kinks), (TransitionMethod::Analytic, Kinks::empty()), "{report:?}");
    let column: Vec<f64> = jacobian.state.rows().map(|row| row[0]).collect();
    let agreement = compare(&Oracle::new(data), parameter, &column, false);
    assert_eq!(agreement, Agreement::Close, "{array} {row}");
    column.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

#[test]
fn numbers_beyond_the_engines_limits_have_no_effect() {
    let set = |change: fn(&mut mujoco_safe::model::ModelMut<'_>)| {
        let mut data = sliding("", "", &format!(r#"priority="1" friction=".6 .03 .02" {SOLVER}"#), "");
        data.qvel_mut().copy_from_slice(&[0.4, 0.9, -0.3, 3.0, -2.0, 5.0]);
        data.edit_model(change).unwrap();
        data
    };
    // A time constant of less than two time steps.
    let mut data = set(|model| (1..3).for_each(|geom| model.geom_solref_mut()[geom][0] = 0.004));
    assert_eq!(check_one(&mut data, ("geom_solref", 2, 0)), 0.0);
    assert!(check_one(&mut data, ("geom_solref", 2, 1)) > 0.0);
    // Mixed formats, of which the engine takes none.
    let mut data = set(|model| (1..3).for_each(|geom| model.geom_solref_mut()[geom] = [-100.0, 1.0]));
    assert_eq!(check_one(&mut data, ("geom_solref", 2, 0)), 0.0);
    let mut data = set(|model| (1..3).for_each(|geom| model.geom_solimp_mut()[geom][0] = -0.5));
    assert_eq!(check_one(&mut data, ("geom_solimp", 2, 0)), 0.0);
    let mut data = set(|model| (1..3).for_each(|geom| model.geom_solimp_mut()[geom][1] = 1.5));
    assert_eq!(check_one(&mut data, ("geom_solimp", 2, 1)), 0.0);
    let mut data = set(|model| (1..3).for_each(|geom| model.geom_solimp_mut()[geom][4] = 0.5));
    assert_eq!(check_one(&mut data, ("geom_solimp", 2, 4)), 0.0);
    let mut data = set(|model| (1..3).for_each(|geom| model.geom_friction_mut()[geom][0] = 1e-6));
    assert_eq!(check_one(&mut data, ("geom_friction", 2, 0)), 0.0);
    // The impedance is the same everywhere.
    let mut data = set(|model| (1..3).for_each(|geom| model.geom_solimp_mut()[geom][1] = 0.7));
    assert!(check_one(&mut data, ("geom_solimp", 2, 0)) > 0.0);
    assert!(check_one(&mut data, ("geom_solimp", 2, 1)) > 0.0);
    assert_eq!(check_one(&mut data, ("geom_solimp", 2, 2)), 0.0);
    // No width.
    let mut data = set(|model| (1..3).for_each(|geom| model.geom_solimp_mut()[geom][2] = 0.0));
    assert!(check_one(&mut data, ("geom_solimp", 2, 1)) > 0.0);
}

#[test]
fn equal_numbers_of_two_geoms_are_a_kink_with_the_mean_slope() {
    for (option, attributes, array, at) in [
        ("", r#"friction=".6 .03 .02" condim="6""#, "geom_friction", 0),
        (r#"cone="elliptic""#, r#"friction=".6 .03 .02" condim="6""#, "geom_friction", 1),
        ("", r#"solref="-900 -30""#, "geom_solref", 1),
    ] {
        let mut data = sliding(option, attributes, attributes, "");
        data.qvel_mut().copy_from_slice(&[0.4, 0.9, -0.3, 3.0, -2.0, 5.0]);
        let slope = |value: Option<f64>| {
            let mut data = data.clone();
            let sign = if array == "geom_solref" { -1.0 } else { 1.0 };
            data.edit_model(|model| {
                let parameter = ModelParameter::field(model, array, 1, at).unwrap();
                let base = parameter.value(model).unwrap();
                parameter.set(model, value.map_or(base, |by| base + sign * by)).unwrap();
            })
            .unwrap();
            let model = data.model().clone();
            let parameter = ModelParameter::field(&model, array, 1, at).unwrap();
            let mut lineariser = Lineariser::new(model, TransitionOptions::default()).unwrap();
            let (jacobian, report) = lineariser.parameter_jacobian(&mut data, &[parameter]).unwrap();
            assert_eq!(report.kinks.contains(Kinks::CONSTRAINTS), value.is_none(), "{report:?}");
            jacobian.state.as_slice().to_vec()
        };
        let (below, at, above) = (slope(Some(-1e-9)), slope(None), slope(Some(1e-9)));
        assert!(below.iter().all(|&value| value == 0.0));
        assert!(above.iter().any(|value| value.abs() > 1e-6));
        assert!(at.iter().zip(&above).all(|(at, above)| (at - 0.5 * above).abs() < 1e-6 * above.abs().max(1e-3)));
    }
}
