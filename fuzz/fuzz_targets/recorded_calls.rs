//! Recordings of random calls, and damaged recordings.

#![no_main]

#[path = "../../tests/common/fuzz/mod.rs"]
mod fuzz;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    fuzz::Target::Recordings.run(bytes, &mut |_| ());
});
