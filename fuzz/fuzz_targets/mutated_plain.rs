//! Mutated JSON and CSV data.

#![no_main]

#[path = "../../tests/common/fuzz/mod.rs"]
mod fuzz;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    fuzz::Target::Plain.run(bytes, &mut |_| ());
});
