//! Damaged binary models, whatever the damage, are accepted or refused by the loader's check, which never panics. (Under
//! `cargo test`, integer overflow and reads past a slice panic.) The check is private to the crate, hence the path.

#[path = "common/mutate.rs"]
mod mutate;

#[allow(dead_code, unreachable_pub, reason = "one function of the crate's own module is used here")]
#[path = "../src/model/mjb/mod.rs"]
mod mjb;

use std::ffi::CString;

use mujoco_sys::guard;
use mutate::{DAMAGES, Damage, Map};

const MUTANTS: u64 = 500;

#[test]
fn no_damage_to_a_model_of_every_element_makes_the_check_panic() {
    survives(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml"));
}

#[test]
fn no_damage_to_the_humanoid_makes_the_check_panic() {
    survives("/usr/share/mujoco/model/humanoid/humanoid.xml");
}

fn survives(path: &str) {
    if !std::fs::exists(path).unwrap() {
        return; // Debian's example models are a package of their own.
    }
    let file = compile(path);
    assert_eq!(mjb::check(&file), Ok(()));
    let map = Map::new(&file);
    for damage in DAMAGES {
        let mut refused = 0;
        for seed in 0..MUTANTS / DAMAGES.len() as u64 {
            let mutant = map.mutant(&file, damage, seed);
            let outcome = std::panic::catch_unwind(|| mjb::check(&mutant).is_err());
            let outcome = outcome.unwrap_or_else(|_| panic!("{path}: panicked on {damage:?}, seed {seed}"));
            refused += u64::from(outcome);
        }
        if matches!(damage, Damage::Truncation | Damage::Extension) {
            assert_eq!(refused, MUTANTS / DAMAGES.len() as u64, "{path}: {damage:?}");
        }
    }
}

/// What the engine saves after it has compiled the XML file.
fn compile(path: &str) -> Vec<u8> {
    let saved = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("mutations-{}.mjb", path.len()));
    let [from, to] = [path, saved.to_str().unwrap()].map(|path| CString::new(path).unwrap());
    let mut error = [0; 500];
    let mut model = std::ptr::null_mut();
    // SAFETY: the guards' handler is installed first; both strings end with a zero and the buffer has the size given; there is a
    // model where it is used, and it is deleted once.
    unsafe {
        guard::install(None);
        guard::mj_load_xml(from.as_ptr(), std::ptr::null(), error.as_mut_ptr(), 500, &raw mut model);
        assert!(!model.is_null(), "{path} does not compile");
        assert_eq!(guard::mj_save_model(model, to.as_ptr(), std::ptr::null_mut(), 0), guard::OK);
        mujoco_sys::mj_deleteModel(model);
    }
    std::fs::read(saved).unwrap()
}
