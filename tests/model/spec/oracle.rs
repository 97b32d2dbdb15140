//! Campaigns of [operations](super::operations) on models.

use std::path::Path;

use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::counts::Counts;
use super::engine_spec::{self as raw, Source};
use super::generated;
use super::operations::check;
use super::reading::files;

use crate::cases::cases;

/// Generated models: joints, orientations, limits and references with all combinations of classes.
#[test]
fn operations_on_generated_models_agree_with_the_engine() {
    let part = |name: &str, default: u64| std::env::var(name).map_or(default, |number| number.parse().unwrap());
    let (first, count) = (part("SKIP", 0), part("SPECS", cases(5, 25)));
    let mut counts = Counts::default();
    for seed in first..first + count {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        // The compiler rejects some combinations.
        let texts = std::iter::repeat_with(|| Source::Text(generated::text(&mut rng))).take(20);
        let Some(source) = texts.into_iter().find(|source| raw::compile(source).is_some()) else { continue };
        check(&source, &mut rng, &mut counts);
    }
    assert!(counts.operations as u64 > 4 * count, "{} operations", counts.operations);
    counts.finish(count as usize);
}

/// A model for each attribute of the engine's schema, in which the attribute has another value than
/// by default.
#[test]
#[ignore = "a campaign"]
fn operations_on_models_of_the_schema_agree_with_the_engine() {
    use super::super::schema_models::{Effect, attributes, case, files};

    load_plugins();
    let part = |name: &str, default: usize| std::env::var(name).map_or(default, |number| number.parse().unwrap());
    let (skip, take) = (part("SKIP", 0), part("SPECS", usize::MAX));
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files() {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
    let mut counts = Counts::default();
    let mut models = 0;
    for attribute in attributes().into_iter().skip(skip).take(take) {
        let Ok(found) = case(&attribute, Effect::Stored) else { continue };
        let path = folder.path().join(format!("{}_{}.xml", attribute.element, attribute.name).replace('/', "-"));
        std::fs::write(&path, &found.text).unwrap();
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(models);
        let before = counts.operations;
        check(&Source::File(path), &mut rng, &mut counts);
        models += u64::from(counts.operations > before);
    }
    counts.finish(models as usize);
}

fn load_plugins() {
    #[cfg(engine_since = "2.3.0")]
    if let Some(plugins) = std::env::var_os("MUJOCO_SAFE_PLUGINS") {
        // SAFETY: the plugins of the wheel that contains the engine.
        unsafe { mujoco_safe::load_plugins(Path::new(&plugins)) }.unwrap();
    }
}

/// Models in a directory.
#[test]
#[ignore = "needs a directory of models"]
fn real_specs_agree_with_the_engine() {
    let path = std::env::var_os("MUJOCO_SAFE_MODELS").expect("MUJOCO_SAFE_MODELS is a directory");
    load_plugins();
    let mut counts = Counts::default();
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut models = 0;
    for path in files(Path::new(&path)) {
        let before = counts.operations;
        check(&Source::File(path), &mut rng, &mut counts);
        models += usize::from(counts.operations > before);
    }
    assert!(models > 0);
    counts.finish(models);
}
