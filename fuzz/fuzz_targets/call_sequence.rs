//! Sequences of safe calls.

#![no_main]

#[path = "../../tests/common/fuzz/mod.rs"]
mod fuzz;

libfuzzer_sys::fuzz_target!(
    // The hook that is there aborts at every panic, also at those that the sequences ask for and catch. What they do not catch
    // aborts all the same.
    init: drop(std::panic::take_hook()),
    |bytes: &[u8]| {
        fuzz::Target::Sequences.run(bytes, &mut |_| ());
    }
);
