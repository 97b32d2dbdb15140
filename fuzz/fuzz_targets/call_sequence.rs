//! Random sequences of safe calls.

#![no_main]

#[path = "../../tests/common/fuzz/mod.rs"]
mod fuzz;

libfuzzer_sys::fuzz_target!(
    // Removes libFuzzer's panic hook, which aborts even on panics that a sequence provokes and
    // catches. Other panics still abort.
    init: drop(std::panic::take_hook()),
    |bytes: &[u8]| {
        fuzz::Target::Sequences.run(bytes, &mut |_| ());
    }
);
