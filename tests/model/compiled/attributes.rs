//! Edits of models with all elements of the engine's schema.

use mujoco_safe::Model;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Report, compare, part, texts};
use crate::schema_models::{Effect, attributes, case, combination, load};

/// Adds some of the attributes to a model and removes them, and changes other numbers of the model.
fn campaign(numbers: impl Iterator<Item = usize>, changes: usize) -> Report {
    let mut report = Report::default();
    let attributes = attributes();
    for number in numbers {
        let Some(attribute) = attributes.get(number) else { break };
        // `mj_setConst` of older engines overwrites the user's statistics.
        if !cfg!(engine_since = "3.17.0") && attribute.to_string().starts_with("statistic ") {
            continue;
        }
        let mut random = Xoshiro256PlusPlus::seed_from_u64(number as u64);
        let Ok(case) = case(attribute, Effect::Stored) else { continue };
        let (Ok(with), Ok(without)) = (load(&case.text), load(&case.without)) else { continue };
        let what = format!("{attribute}={}", case.value);
        report.add(compare(&without, &with, random.random()), &what);
        report.add(compare(&with, &without, random.random()), &format!("without {what}"));
        for _ in 0..changes {
            let (change, text) = texts::perturb(&case.text, &mut random);
            let Ok(changed) = load(&text) else { continue };
            report.add(compare(&with, &changed, random.random()), &format!("{what}, {change}"));
        }
    }
    report
}

/// Changes numbers of models with several random attributes.
fn campaign_of_combinations(seeds: std::ops::Range<u64>, changes: usize) -> Report {
    let mut report = Report::default();
    let mut all = attributes();
    // `mj_setConst` of older engines overwrites the user's statistics.
    all.retain(|attribute| cfg!(engine_since = "3.17.0") || !attribute.to_string().starts_with("statistic "));
    for seed in seeds {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let (_, text) = combination(&all, &mut random);
        let model = load(&text).expect("the engine has compiled the text");
        for _ in 0..changes {
            let (change, text) = texts::perturb(&text, &mut random);
            let Ok(changed) = load(&text) else { continue };
            report.add(compare(&model, &changed, random.random()), &format!("seed {seed}, {change}"));
        }
    }
    report
}

#[test]
fn edits_of_attributes_equal_the_model_compiled_with_the_values() {
    let report = campaign((0..).step_by(40), 3);
    report.check();
    assert!(report.equal > 20);
}

#[test]
#[cfg_attr(not(engine_since = "3.17.0"), ignore = "mj_setConst of older engines overwrites the statistics")]
fn an_edit_keeps_the_statistics_of_the_user() {
    let compiled = |statistic: &str, mass: &str| {
        let text = format!(
            "<mujoco>{statistic}<worldbody><body><joint/><geom size='.1' mass='{mass}' pos='.2 0 0'/></body></worldbody></mujoco>"
        );
        Model::from_xml_str(&text).unwrap()
    };
    for statistic in ["", "<statistic meanmass='3'/>", "<statistic meaninertia='5'/>"] {
        let mut edited = compiled(statistic, "1");
        edited.edit().body_mut(1).unwrap().scale_mass(4.0).unwrap();
        edited.edit().update_constants().unwrap();
        let means = |model: &Model| [model.statistics().meanmass, model.statistics().meaninertia];
        let (found, expected) = (means(&edited), means(&compiled(statistic, "4")));
        assert!(found.iter().zip(expected).all(|(left, right)| (left - right).abs() < 1e-12), "{statistic}: {found:?}");
    }
}

#[test]
#[ignore = "takes minutes"]
fn many_edits_of_attributes_equal_the_model_compiled_with_the_values() {
    let report = campaign(part("FROM", 0)..part("TO", usize::MAX), part("CHANGES", 10));
    report.check();
}

#[test]
#[ignore = "takes minutes"]
fn many_edits_of_combinations_equal_the_model_compiled_with_the_values() {
    let first = part("SEED", 0) as u64;
    let report = campaign_of_combinations(first..first + part("SEEDS", 300) as u64, part("CHANGES", 20));
    report.check();
}
