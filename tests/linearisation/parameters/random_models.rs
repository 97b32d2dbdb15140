//! Random models: trees of all joints, with contacts, limits, friction loss, tendons and actuators.

use std::time::Instant;

use mujoco_safe::derivative::{Fallback, ModelParameter, TransitionMethod, TransitionOptions};
use mujoco_safe::{Data, Lineariser, Model};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{compare_all, vary_friction, with_formulas, without_formulas};
use crate::cases::cases;
use crate::transition::analytic::random_models::xml;
use crate::transition::analytic::randomise;

fn some(list: &[ModelParameter], count: usize, random: &mut Xoshiro256PlusPlus) -> Vec<ModelParameter> {
    (0..count.min(list.len())).map(|_| list[random.random_range(0..list.len())]).collect()
}

/// Compares `count` random parameters at a state of each random model.
fn compare_models(
    seed: u64,
    models: usize,
    count: usize,
    list: fn(&Model) -> Vec<ModelParameter>,
    option: fn(&mut Data),
) -> [usize; 3] {
    let mut sums = [0; 3];
    let mut failures = Vec::new();
    for number in 0..models as u64 {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed + number);
        let mut data = Data::new(Model::from_xml_str(&xml(seed + number)).unwrap()).unwrap();
        option(&mut data);
        vary_friction(&mut data);
        randomise(&mut data, &mut random);
        if number % 2 == 1 && (0..30).any(|_| data.step().is_err()) {
            continue;
        }
        let parameters = some(&list(data.model()), count, &mut random);
        let mut lineariser = Lineariser::new(data.model().clone(), TransitionOptions::default()).unwrap();
        let (_, report) = lineariser.parameter_jacobian(&mut data, &parameters).unwrap();
        if report.method != TransitionMethod::Analytic {
            assert_eq!(report.fallback, Some(Fallback::NotConverged), "model {number}");
            continue;
        }
        let what = format!("model {}", seed + number);
        let started = Instant::now();
        let compared = compare_all(&mut data, &parameters);
        println!("{what}: {:.1} s, {} {sums:?}", started.elapsed().as_secs_f64(), compared.is_ok());
        match compared {
            Ok([close, noisy]) => {
                sums[0] += 1;
                sums[1] += close;
                sums[2] += noisy;
            }
            Err(failure) => failures.push(format!("{what}, {failure}")),
        }
    }
    println!("{sums:?}");
    assert!(failures.is_empty(), "{} of {models} models:\n{}", failures.len(), failures.join("\n"));
    assert!(2 * sums[0] > models, "{sums:?}: too few models have converged");
    sums
}

fn formulas(models: usize) {
    let [_, close, noisy] = compare_models(2000, models, 12, with_formulas, |_| ());
    assert!(20 * noisy <= close, "{noisy} of {close} columns are noisy");
}

fn differences(models: usize) {
    let [_, close, noisy] = compare_models(3000, models, 8, without_formulas, |_| ());
    assert!(5 * noisy <= close, "{noisy} of {close} columns are noisy");
}

fn formulas_with_the_implicit_integrator(models: usize) {
    let implicit = |data: &mut Data| {
        data.edit_model(|model| {
            model.edit_options(|options| options.integrator = mujoco_safe::enums::Integrator::Implicit)
        })
        .unwrap();
    };
    let [_, close, noisy] = compare_models(4000, models, 12, with_formulas, implicit);
    assert!(20 * noisy <= close, "{noisy} of {close} columns are noisy");
}

#[test]
fn formulas_agree_with_differences() {
    formulas(cases(10, 20));
}

#[test]
fn differences_agree_with_differences_of_steps() {
    differences(cases(6, 15));
}

#[test]
fn formulas_with_the_implicit_integrator_agree_with_differences() {
    formulas_with_the_implicit_integrator(cases(6, 15));
}

#[test]
#[ignore = "takes minutes"]
fn many_models_agree_with_differences_by_parameters() {
    formulas(510);
    formulas_with_the_implicit_integrator(510);
    differences(510);
}
