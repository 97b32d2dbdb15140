//! Every element and attribute of the linked engine's schema.

use std::collections::BTreeMap;

use mujoco_safe::{Data, sys};

use crate::Raw;
use crate::cases::cases;
use crate::schema_models::{self, Case, Effect};

/// Loads the plugins of the wheel that contains the engine.
fn load_plugins() {
    #[cfg(engine_since = "2.3.3")]
    if let Some(directory) = crate::plugin::directory() {
        // SAFETY: the plugins of the wheel that contains the engine.
        unsafe { mujoco_safe::load_plugins(directory) }.unwrap();
    }
}

/// Number of steps in which a model must equal that of the C functions.
const STEPS: usize = 20;

/// Largest part of attributes for which the compiler rejects all values: plugins that the wheels
/// lack, and in 2.2.2 an equality that it has removed and prints nevertheless.
const MOST_REJECTED: f64 = 0.05;

/// Steps a model with the library and with the C functions, and returns the first difference.
fn difference(case: &Case) -> Option<String> {
    let model = schema_models::load(&case.text).unwrap();
    let mut data = Data::new(model).unwrap();
    let model = data.model().clone();
    let raw = Raw(c!(mj_makeData(model.as_ptr())));
    schema_models::excite(&mut data);
    // SAFETY: the arrays have the model's sizes.
    let read = |pointer: *const f64, length| unsafe { bits(pointer, length) };
    // SAFETY: as above.
    unsafe {
        std::ptr::copy_nonoverlapping(data.qvel().as_ptr(), (*raw.0).qvel, model.nv());
        std::ptr::copy_nonoverlapping(data.ctrl().as_ptr(), (*raw.0).ctrl, data.ctrl().len());
    }
    for step in 0..STEPS {
        data.step().unwrap();
        c!(mj_step(model.as_ptr(), raw.0));
        // SAFETY: a valid simulation.
        let c = unsafe { &*raw.0 };
        let arrays = [
            ("qpos", data.qpos(), c.qpos),
            ("qvel", data.qvel(), c.qvel),
            ("act", data.act(), c.act),
            ("sensordata", data.sensordata(), c.sensordata),
        ];
        for (name, ours, theirs) in arrays {
            if bits_of(ours) != read(theirs, ours.len()) {
                return Some(format!("{}: {name} differs in step {step}\n{}", case.attribute, case.text));
            }
        }
    }
    None
}

fn bits_of(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// Returns the bits of an array.
///
/// # Safety
///
/// The array has this length.
unsafe fn bits(pointer: *const f64, length: usize) -> Vec<u64> {
    // SAFETY: the caller's promise.
    if length == 0 { Vec::new() } else { bits_of(unsafe { std::slice::from_raw_parts(pointer, length) }) }
}

/// Compares the models of every `stride`th attribute of the schema with C, and prints their values
/// and effects.
fn check(stride: usize, enough: Effect) {
    load_plugins();
    let start = std::time::Instant::now();
    let (mut counts, mut failures, mut all, mut rejected) = (BTreeMap::new(), Vec::new(), 0, 0);
    for attribute in schema_models::attributes().into_iter().step_by(stride) {
        let case = schema_models::case(&attribute, enough);
        *counts.entry(case.as_ref().ok().map(|case| case.effect)).or_insert(0) += 1;
        match case {
            Ok(case) => {
                println!("{:?} {attribute}={:?}", case.effect, case.value);
                // Noise is drawn from the C library's random numbers.
                if attribute.name != "sensornoise" {
                    failures.extend(difference(&case));
                }
            }
            Err(message) => {
                println!("Rejected {attribute}: {message}");
                rejected += 1;
            }
        }
        all += 1;
    }
    println!("{counts:?}, {:?}", start.elapsed());
    assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
    assert!(f64::from(rejected) <= MOST_REJECTED * f64::from(all), "{rejected} of {all} attributes have no value");
}

#[test]
fn models_with_an_attribute_of_the_schema_move_as_in_c() {
    check(cases(93, 31), Effect::Stored);
}

#[test]
#[ignore = "takes minutes"]
fn models_with_every_attribute_of_the_schema_move_as_in_c() {
    check(1, Effect::Acts);
}
