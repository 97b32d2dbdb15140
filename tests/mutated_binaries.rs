//! Damaged binary models are errors, or models that work: nothing in between.

#![forbid(unsafe_code)]

use std::panic::{AssertUnwindSafe, catch_unwind};

use mujoco_safe::{Data, Error, Model, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// What becomes of the bytes; whether they are still a model.
fn try_it(bytes: &[u8]) -> bool {
    let model = match Model::from_binary(bytes) {
        Ok(model) => model,
        Err(error) => {
            assert!(matches!(error, Error::InvalidBinary { .. } | Error::Unsupported(_)), "{error}");
            return false;
        }
    };
    // Numbers may have become anything, so a step may fail, as long as it comes back.
    let mut data = match Data::new(model.clone()) {
        Ok(data) => data,
        Err(error) => panic!("a model that was accepted has no simulation: {error}"),
    };
    for _ in 0..10 {
        if data.step().is_err() {
            data.reset().unwrap();
        }
    }
    let _ = data.model().options();
    drop(data.clone());
    drop(model.clone());
    assert!(model.to_binary().is_ok());
    true
}

fn mutations(model: &Model, count: usize, seed: u64) {
    let good = model.to_binary().unwrap();
    // Textures are most of a file, and of no consequence: aim before them as often as anywhere.
    let head = good.len().min(50_000);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut accepted = 0;
    for round in 0..count {
        let mut bytes = good.clone();
        if round % 5 == 0 {
            bytes.truncate(random.random_range(0..good.len()));
        } else {
            for _ in 0..random.random_range(1..=4) {
                let end = if round % 2 == 0 { head } else { good.len() };
                let at = random.random_range(0..end);
                bytes[at] = random.random();
            }
        }
        let outcome = catch_unwind(AssertUnwindSafe(|| try_it(&bytes)));
        accepted += usize::from(outcome.unwrap_or_else(|_| panic!("mutation {round} of seed {seed}")));
    }
    println!("{accepted} of {count} mutations were still models");
}

#[test]
fn mutated_models_are_errors_or_work() {
    mutations(&sample::cartpole(), 250, 1);
    mutations(&sample::humanoid(), 250, 2);
}

#[test]
fn every_short_beginning_of_a_file_is_an_error() {
    let good = sample::cartpole().to_binary().unwrap();
    for length in (0..1000).chain((1000..good.len()).step_by(997)) {
        assert!(!try_it(&good[..length]), "the first {length} bytes");
    }
    let long = [&good[..], b"x"].concat();
    assert!(!try_it(&long), "a byte too many");
}
