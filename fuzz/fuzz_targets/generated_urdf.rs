//! Generated and mutated URDF models.

#![no_main]

#[path = "../../tests/common/fuzz/mod.rs"]
mod fuzz;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    fuzz::Target::Urdf.run(bytes, &mut |_| ());
});
