//! From bytes to a verdict: what the fuzzer runs. The bytes decide everything, so a case can be repeated.
//!
//! The same functions serve `tests/fuzz`, which makes the bytes from a seed, and the targets of cargo-fuzz in `fuzz/`, which
//! makes them from what earlier bytes have covered.

#![forbid(unsafe_code)]
#![allow(unreachable_pub, dead_code, reason = "included by several programs, each of which uses some of it")]

#[macro_use] // the lists of fields
#[path = "../touch_all.rs"]
mod touch_all;

mod archive;
mod assets;
mod binary;
mod bytes;
mod mjcf;
mod models;
mod plain;
mod sequence;
mod text;
mod token;
mod urdf;

#[path = "../mutate.rs"]
mod mutate;
#[path = "../print_all.rs"]
mod print_all;

pub use self::bytes::Bytes;

/// What became of a case that was no finding. A finding is a crash, an exit, a hang, a panic, or a read of standard input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The model was loaded, the calls were made. Calls may have been errors.
    Worked,
    /// The model was refused.
    Refused,
}

/// What is fuzzed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Sequences of calls without `unsafe`.
    Sequences,
    /// Damaged binary models, and steps of those that are accepted.
    Binaries,
    /// Damaged texts and the files that they name, and steps of those that are accepted.
    Texts,
    /// Generated and damaged URDF, and steps of those that are accepted.
    Urdf,
    /// Damaged files of NumPy, and replays of those that are accepted.
    Archives,
    /// Damaged plain data (JSON, CSV), and simulations with those that are accepted.
    Plain,
    /// Generated MJCF, saved and loaded again, and steps of those that are accepted.
    Mjcf,
}

impl Target {
    pub const ALL: [Self; 7] =
        [Self::Sequences, Self::Binaries, Self::Texts, Self::Urdf, Self::Archives, Self::Plain, Self::Mjcf];

    pub fn name(self) -> &'static str {
        match self {
            Self::Sequences => "sequences",
            Self::Binaries => "binaries",
            Self::Texts => "texts",
            Self::Urdf => "urdf",
            Self::Archives => "archives",
            Self::Plain => "plain",
            Self::Mjcf => "mjcf",
        }
    }

    /// The bytes that belong to a seed.
    pub fn bytes(self, seed: u64) -> Vec<u8> {
        bytes::of_seed(seed, self as u64)
    }

    /// Runs a case. `log` is told what is done before it is done.
    pub fn run(self, bytes: &[u8], log: &mut dyn FnMut(&str)) -> Verdict {
        let bytes = &mut Bytes::new(bytes);
        match self {
            Self::Sequences => sequence::call_sequence(bytes, log),
            Self::Binaries => binary::mutated_binary(bytes, log),
            Self::Texts => text::mutated_text(bytes, log),
            Self::Urdf => urdf::generated_urdf(bytes, log),
            Self::Archives => archive::mutated_archive(bytes, log),
            Self::Plain => plain::mutated_plain(bytes, log),
            Self::Mjcf => mjcf::generated_mjcf(bytes, log),
        }
    }
}
