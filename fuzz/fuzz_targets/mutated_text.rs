//! Mutated model texts and the files that they reference.

#![no_main]

#[path = "../../tests/common/fuzz/mod.rs"]
mod fuzz;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    fuzz::Target::Texts.run(bytes, &mut |_| ());
});
