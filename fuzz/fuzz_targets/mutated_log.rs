//! Mutated logs and ROS 2 bags.

#![no_main]

#[path = "../../tests/common/fuzz/mod.rs"]
mod fuzz;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    fuzz::Target::Logs.run(bytes, &mut |_| ());
});
