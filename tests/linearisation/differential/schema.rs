//! Each attribute of the linked engine's schema, with each integrator and cone, at ordinary and
//! special states.

use std::ops::Range;

use mujoco_safe::enums::{Cone, Integrator, JointType};
use mujoco_safe::{Data, Model, Options, math};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Tally, compare_inverse, compare_model};
use crate::cases::cases;
use crate::schema_models::{Effect, attributes, case, combination, is_only_stored, load};
use crate::transition::special_states;

/// Integrators, of which older engines lack the last ones.
const INTEGRATORS: [Integrator; 5] =
    [Integrator::Euler, Integrator::Implicit, Integrator::Rk4, Integrator::ImplicitFast, Integrator::Discrete];

const CONES: [Cone; 2] = [Cone::Pyramidal, Cone::Elliptic];

/// Largest numbers of degrees of freedom of a model that is compared by the short test and by the
/// campaign. Flexes have many.
const MOST_DOFS: [usize; 2] = [30, 100];

/// Controls and activations at special states: rest, ends of ranges, saturation.
const INPUTS: [f64; 6] = [0.0, 0.5, 1.0, -1.0, 1.7, -0.3];

fn load_plugins() {
    #[cfg(engine_since = "2.3.0")]
    if let Some(directory) = option_env!("MUJOCO_DIR").map(|directory| std::path::Path::new(directory).join("plugin"))
        && directory.is_dir()
    {
        // SAFETY: the plugins of the wheel that contains the engine.
        unsafe { mujoco_safe::load_plugins(directory) }.unwrap();
    }
}

/// Moves to a special state: joints at the ends of their ranges, contacts that touch, controls at
/// the ends of their ranges or beyond, activations that equal their controls.
fn make_special(data: &mut Data, random: &mut Xoshiro256PlusPlus) {
    data.reset().unwrap();
    let model = data.model().clone();
    for (index, joint) in model.joints().enumerate() {
        let is_limited = model.jnt_limited()[index] != 0;
        let range = model.jnt_range()[index];
        let end = range[random.random_range(0..2)];
        let qpos = &mut data.qpos_mut()[joint.qpos_range()];
        match joint.joint_type() {
            JointType::Hinge | JointType::Slide if is_limited && random.random_bool(0.6) => qpos[0] = end,
            JointType::Ball if is_limited && random.random_bool(0.3) => {
                qpos.copy_from_slice(&math::axis_angle2quat(&[0.6, 0.0, 0.8], range[1]));
            }
            // The crate of the rig then touches the floor.
            JointType::Free if joint.name() == Some("free") && random.random_bool(0.3) => qpos[2] = 0.1,
            _ => {}
        }
    }
    if random.random_bool(0.3) {
        data.qvel_mut().iter_mut().for_each(|value| *value = random.random_range(-0.6..0.6));
    }
    for control in 0..model.nu() {
        let [low, high] = model.actuator_ctrlrange()[control];
        let inputs = [low, high, INPUTS[random.random_range(0..INPUTS.len())]];
        data.ctrl_mut()[control] = inputs[random.random_range(0..3)];
    }
    for activation in 0..model.na() {
        let is_steady = random.random_bool(0.5) && activation < model.nu();
        // Activations often belong to the last controls.
        let control = model.nu().saturating_sub(model.na()) + activation;
        let steady = data.ctrl().get(control).copied().unwrap_or_default();
        data.act_mut()[activation] = if is_steady { steady } else { INPUTS[random.random_range(0..INPUTS.len())] };
    }
}

/// Compares the models of every `stride`th attribute, each with this number of combinations of
/// integrator and cone, at ordinary and special states.
fn compare_schema(
    stride: usize,
    range: Range<usize>,
    combinations: usize,
    states: usize,
    most_dofs: usize,
) -> [Tally; 2] {
    load_plugins();
    let (mut total, mut special) = (Tally::default(), Tally::default());
    let all: Vec<_> = INTEGRATORS.into_iter().flat_map(|integrator| CONES.map(|cone| (integrator, cone))).collect();
    let mut models = 0;
    for (number, attribute) in attributes().into_iter().enumerate().take(range.end).skip(range.start).step_by(stride) {
        let Ok(case) = case(&attribute, Effect::Acts) else { continue };
        if case.effect != Effect::Acts {
            continue;
        }
        let first = number / stride;
        for (integrator, cone) in (0..combinations).map(|offset| all[(first + offset) % all.len()]) {
            let what = format!("{attribute}={:?}", case.value);
            let tallies = [&mut total, &mut special];
            models += usize::from(compare_text(
                &what,
                &case.text,
                (integrator, cone),
                (number as u64, states, most_dofs),
                tallies,
            ));
        }
    }
    report(models, [total, special])
}

/// Compares a model with an integrator and a cone, unless it has too many degrees of freedom or the
/// engine cannot step it with the integrator. Returns whether it has been compared.
fn compare_text(
    what: &str,
    text: &str,
    (integrator, cone): (Integrator, Cone),
    (seed, states, most_dofs): (u64, usize, usize),
    [total, special]: [&mut Tally; 2],
) -> bool {
    let mut model = load(text).expect("the engine has compiled the text");
    // The solver converges, so that differences of steps are as accurate as the estimates.
    let set = |options: &mut Options| {
        (options.integrator, options.cone) = (integrator, cone);
        (options.tolerance, options.iterations) = (0.0, options.iterations.max(200));
    };
    if model.nv() > most_dofs || model.edit().edit_options(set).is_err() {
        return false;
    }
    // The integrator `discrete` rejects some flexes.
    if Data::new(model.clone()).unwrap().step().is_err() {
        return false;
    }
    let what = format!("{what} {integrator:?} {cone:?}");
    for (tally, compare) in [(total, compare_ordinary as Compare), (special, compare_special)] {
        let mut found = Tally::default();
        compare(&model, seed, states, &mut found);
        tally.compared += found.compared;
        tally.noisy += found.noisy;
        tally.reported += found.reported;
        tally.failures.extend(found.failures.iter().map(|failure| format!("{what}: {failure}")));
        if std::env::var_os("SHOW").is_some() {
            found.failures.iter().for_each(|failure| println!("{what}: {failure}"));
        }
    }
    true
}

/// Prints the figures of a campaign.
fn report(models: usize, tallies: [Tally; 2]) -> [Tally; 2] {
    for (states, tally) in ["ordinary", "special"].into_iter().zip(&tallies) {
        let Tally { compared, noisy, reported, failures, .. } = tally;
        let wrong = failures.len();
        println!(
            "{models} models at {states} states: {compared} entries compared, {noisy} noisy, {reported} reported, {wrong} wrong"
        );
    }
    tallies
}

/// Compares models with several random attributes, until `enough` have been compared.
fn compare_combinations(seeds: Range<u64>, enough: usize, most_dofs: usize) -> [Tally; 2] {
    load_plugins();
    let (mut total, mut special) = (Tally::default(), Tally::default());
    let mut all = attributes();
    all.retain(|attribute| !is_only_stored(attribute));
    let mut models = 0;
    for seed in seeds {
        if models == enough {
            break;
        }
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let (names, text) = combination(&all, &mut random);
        let integrator = INTEGRATORS[random.random_range(0..INTEGRATORS.len())];
        let cone = CONES[random.random_range(0..2)];
        let what = format!("seed {seed}, {names}");
        // Older engines lack some of the integrators.
        let is_compared = [integrator, Integrator::Euler].into_iter().any(|integrator| {
            let tallies = [&mut total, &mut special];
            compare_text(&what, &text, (integrator, cone), (seed, 1, most_dofs), tallies)
        });
        models += usize::from(is_compared);
        if let Some(file) = std::env::var_os("TEXT") {
            std::fs::write(file, text).unwrap();
        }
    }
    report(models, [total, special])
}

type Compare = fn(&Model, u64, usize, &mut Tally);

fn compare_ordinary(model: &Model, seed: u64, states: usize, tally: &mut Tally) {
    compare_model(model.clone(), seed, states, tally);
}

fn compare_special(model: &Model, seed: u64, states: usize, tally: &mut Tally) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut data = Data::new(model.clone()).unwrap();
    for _ in 0..states {
        make_special(&mut data, &mut random);
        if data.clone().step().is_err() {
            continue;
        }
        let state =
            format!("qpos {:?} qvel {:?} ctrl {:?} act {:?}", data.qpos(), data.qvel(), data.ctrl(), data.act());
        let mut steps = special_states::Tally::default();
        special_states::compare(&state, &mut data, &mut steps);
        tally.compared += steps.compared;
        tally.noisy += steps.noisy;
        tally.failures.extend(steps.failures);
        let mut inverse = Tally::default();
        compare_inverse(&mut data, &mut random, &mut inverse);
        tally.compared += inverse.compared;
        // At a kink that the report names, differences to the right have another side.
        if inverse.reports.iter().all(|report| report.kinks.is_empty()) {
            tally.failures.extend(inverse.failures.into_iter().map(|failure| format!("{failure}: {state}")));
        }
    }
}

fn check(tallies: &[Tally]) {
    let failures: Vec<_> = tallies.iter().flat_map(|tally| &tally.failures).collect();
    assert!(failures.is_empty(), "{} failures: {:#?}", failures.len(), &failures[..failures.len().min(40)]);
}

#[test]
fn some_attributes_of_the_schema_are_linearised() {
    let tallies = compare_schema(cases(90, 20), 0..usize::MAX, 1, 1, MOST_DOFS[0]);
    assert!(tallies.iter().all(|tally| tally.compared > cases(900, 5000)), "{:?}", tallies.map(|tally| tally.compared));
    check(&tallies);
}

#[test]
fn some_combinations_of_attributes_are_linearised() {
    let tallies = compare_combinations(3..cases(30, 60), 1, cases(18, MOST_DOFS[0]));
    assert!(tallies.iter().all(|tally| tally.compared > cases(100, 1000)), "{:?}", tallies.map(|tally| tally.compared));
    check(&tallies);
}

/// `SEED` is the first seed, and `SEEDS` their number. `SHOW` prints failures at once, and `TEXT`
/// is a file to which the last model is written.
///
/// `cargo test --test linearisation -- --ignored --nocapture many_combinations`
#[test]
#[ignore = "a campaign"]
fn many_combinations_of_attributes_are_linearised() {
    let first = number("SEED", 1000) as u64;
    check(&compare_combinations(first..first + number("SEEDS", 1000) as u64, usize::MAX, MOST_DOFS[0]));
}

/// Returns a number from the environment.
fn number(name: &str, default: usize) -> usize {
    std::env::var(name).map_or(default, |text| text.parse().expect("the variable is a number"))
}

/// `FROM` and `TO` select attributes. `STATES` is the number of states of each kind, `COMBINATIONS`
/// the number of integrators with a cone for each attribute, instead of all. `SHOW` prints failures
/// at once.
///
/// `cargo test --test linearisation -- --ignored --nocapture each_attribute_is_linearised`
#[test]
#[ignore = "a campaign"]
fn each_attribute_is_linearised() {
    let range = number("FROM", 0)..number("TO", usize::MAX);
    let combinations = number("COMBINATIONS", INTEGRATORS.len() * CONES.len());
    check(&compare_schema(1, range, combinations, number("STATES", 1), MOST_DOFS[1]));
}
