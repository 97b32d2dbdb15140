//! Fuzz targets: each maps bytes to a verdict. A case is reproducible because the bytes decide
//! everything.
//!
//! `tests/fuzz` derives the bytes from seeds; the targets of cargo-fuzz in `fuzz/` derive them from
//! the coverage of earlier bytes.

#![forbid(unsafe_code)]
#![allow(
    unreachable_pub,
    dead_code,
    unused_imports,
    reason = "included by several programs, each of which uses some of it"
)]

#[macro_use] // the lists of fields
#[path = "../touch_all.rs"]
mod touch_all;

mod archive;
mod assets;
mod binary;
mod bytes;
mod coverage;
mod log;
mod mjcf;
mod models;
mod newer_models;
mod plain;
mod recording;
mod schema;
mod sequence;
mod text;
mod token;
mod urdf;

#[path = "../schema_models/mod.rs"]
mod schema_models;

#[cfg(feature = "mcap")]
#[path = "../chunk_crc.rs"]
mod chunk_crc;
#[path = "../mutate.rs"]
mod mutate;
#[path = "../print_all.rs"]
mod print_all;

pub use self::bytes::Bytes;
pub use self::coverage::missing;

/// The result of a case without a finding. A finding is a crash, an exit, a hang, a panic, or a
/// read of standard input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The model was loaded and the calls were made. Calls may have returned errors.
    Worked,
    /// The model was rejected.
    Rejected,
}

/// A fuzz target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Sequences of safe calls.
    Sequences,
    /// Damaged binary models, and steps of accepted models.
    Binaries,
    /// Damaged texts and files named in them, and steps of accepted models.
    Texts,
    /// Generated and damaged URDF, and steps of accepted models.
    Urdf,
    /// Damaged NumPy files, and replays of accepted trajectories.
    Archives,
    /// Damaged plain data (JSON, CSV), and simulations with accepted data.
    Plain,
    /// Generated MJCF, saved and loaded again, and steps of accepted models.
    Mjcf,
    /// Texts with extreme values of all elements and attributes of the engine's schema, and calls
    /// with accepted models.
    Schema,
    /// Recordings of random calls, repeated bit for bit, and damaged recordings.
    Recordings,
    /// Damaged logs (MCAP) and ROS 2 bags, and replays of accepted trajectories.
    Logs,
}

impl Target {
    pub const ALL: [Self; 10] = [
        Self::Sequences,
        Self::Binaries,
        Self::Texts,
        Self::Urdf,
        Self::Archives,
        Self::Plain,
        Self::Mjcf,
        Self::Schema,
        Self::Recordings,
        Self::Logs,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Sequences => "sequences",
            Self::Binaries => "binaries",
            Self::Texts => "texts",
            Self::Urdf => "urdf",
            Self::Archives => "archives",
            Self::Plain => "plain",
            Self::Mjcf => "mjcf",
            Self::Schema => "schema",
            Self::Recordings => "recordings",
            Self::Logs => "logs",
        }
    }

    /// Returns the bytes of a seed.
    pub fn bytes(self, seed: u64) -> Vec<u8> {
        bytes::of_seed(seed, self as u64)
    }

    /// Runs a case. `log` is called with a description before each action.
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
            Self::Schema => schema::hostile_text(bytes, log),
            Self::Recordings => recording::recorded_calls(bytes, log),
            Self::Logs => log::mutated_log(bytes, log),
        }
    }
}

/// Loads a text and makes a sequence of calls with an accepted model.
pub fn use_text(text: &str, seed: u64, log: &mut dyn FnMut(&str)) -> Verdict {
    schema::load_and_call(text, 60, &mut Bytes::new(&bytes::of_seed(seed, 0)), log)
}
