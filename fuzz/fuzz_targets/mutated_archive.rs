//! Mutated NumPy archives.

#![no_main]

#[path = "../../tests/common/fuzz/mod.rs"]
mod fuzz;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    fuzz::Target::Archives.run(bytes, &mut |_| ());
});
