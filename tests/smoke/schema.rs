//! Every element and attribute of the linked engine's schema.

use std::collections::BTreeMap;

use crate::schema_models::{self, Effect};

/// Loads the plugins of the wheel that contains the engine.
fn load_plugins() {
    #[cfg(engine_since = "2.3.0")]
    if let Some(directory) = crate::plugin::directory() {
        // SAFETY: the plugins of the wheel that contains the engine.
        unsafe { mujoco_safe::load_plugins(directory) }.unwrap();
    }
}

#[test]
#[ignore = "takes minutes"]
fn survey() {
    load_plugins();
    let start = std::time::Instant::now();
    let mut counts = BTreeMap::new();
    for attribute in schema_models::attributes() {
        let case = schema_models::case(&attribute, Effect::Acts);
        *counts.entry(case.as_ref().ok().map(|case| case.effect)).or_insert(0) += 1;
        match case {
            Ok(case) => println!("{:?} {attribute}={:?}", case.effect, case.value),
            Err(message) => println!("Rejected {attribute}: {message}"),
        }
    }
    println!("{counts:?}, {:?}", start.elapsed());
}
