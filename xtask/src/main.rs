//! Generates the committed source files that follow from the engine's headers, and checks rules of
//! the repository.
//!
//! ```text
//! cargo xtask generate              bindings and field table from the installed headers, then the accessors
//! cargo xtask generate --accessors  only the accessors, from the committed field table; needs no libclang
//! cargo xtask generate --check      writes nothing, and fails if a committed file is out of date
//! cargo xtask lint                  checks lines, calls of the engine and the chapter of promises
//! cargo xtask doc-programs          compiles the programs of the documentation in a new crate
//! ```
//!
//! The headers are those in `MUJOCO_DIR`, else those of the system, as for the build script of
//! `mujoco-sys`. The tool does not depend on the library, so it also works while the library does
//! not compile against a new engine.

#![deny(unsafe_code)]

#[path = "../../build/accessors.rs"]
mod accessors;
#[path = "../../build/arena.rs"]
mod arena;
#[path = "../../build/computed_by.rs"]
mod computed_by;
#[path = "../../build/derived.rs"]
mod derived;
mod doc_programs;
#[allow(dead_code, reason = "the build script uses all of it")]
#[path = "../../mujoco-sys/build/engines.rs"]
mod engines;
#[path = "../../build/facts.rs"]
mod facts;
#[cfg(feature = "bindgen")]
mod headers;
mod lint;
#[path = "../../build/notes.rs"]
mod notes;
#[path = "../../build/numbers.rs"]
mod numbers;
#[path = "../../build/writable.rs"]
mod writable;

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

/// A generated file: its path in the repository and its text.
struct Generated {
    path: String,
    text: String,
}

/// The field table that the committed accessors are generated from. The build script generates
/// those of other versions.
const FIELD_TABLE: &str = "mujoco-sys/fields/v2_2_2.tsv";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["generate"] => generate(false, false),
        ["generate", "--accessors"] => generate(true, false),
        ["generate", "--check"] => generate(false, true),
        ["generate", "--accessors", "--check"] | ["generate", "--check", "--accessors"] => generate(true, true),
        ["lint"] => lint::run(root()),
        ["doc-programs"] => doc_programs::check(root()),
        _ => Err("usage: cargo xtask generate [--accessors] [--check] | lint | doc-programs".to_owned()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn generate(only_accessors: bool, check: bool) -> Result<(), String> {
    if !only_accessors {
        settle(&from_headers()?, check)?;
    }
    settle(&accessors()?, check)
}

#[cfg(feature = "bindgen")]
fn from_headers() -> Result<Vec<Generated>, String> {
    headers::generate(root())
}

#[cfg(not(feature = "bindgen"))]
fn from_headers() -> Result<Vec<Generated>, String> {
    Err("The bindings need the feature `bindgen`: cargo xtask generate (an alias in .cargo/config.toml)".to_owned())
}

/// Generates the accessors from the committed field table.
fn accessors() -> Result<Vec<Generated>, String> {
    let path = root().join(FIELD_TABLE);
    let table = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let format = |(path, source): (&str, String)| Ok(Generated { path: path.to_owned(), text: formatted(&source)? });
    accessors::generate(&table, &table, 222).into_iter().map(format).collect()
}

/// Writes the files, or returns an error that names those that differ from the committed ones.
fn settle(files: &[Generated], check: bool) -> Result<(), String> {
    let mut outdated = Vec::new();
    for Generated { path, text } in files {
        let absolute = root().join(path);
        if std::fs::read_to_string(&absolute).is_ok_and(|committed| committed == *text) {
            continue;
        }
        if check {
            outdated.push(path.as_str());
        } else {
            std::fs::write(&absolute, text).map_err(|error| format!("{}: {error}", absolute.display()))?;
            println!("wrote {path}");
        }
    }
    if outdated.is_empty() {
        Ok(())
    } else {
        Err(format!("out of date: {}; run cargo xtask generate", outdated.join(", ")))
    }
}

/// Formats Rust source with rustfmt and the repository's settings.
fn formatted(source: &str) -> Result<String, String> {
    let mut rustfmt = Command::new("rustfmt")
        .args(["--edition", "2024", "--config-path"])
        .arg(root())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| format!("rustfmt does not start: {error}; install it by: rustup component add rustfmt"))?;
    let mut input = rustfmt.stdin.take().ok_or("rustfmt has no standard input")?;
    input.write_all(source.as_bytes()).map_err(|error| format!("rustfmt does not read: {error}"))?;
    drop(input);
    let output = rustfmt.wait_with_output().map_err(|error| format!("rustfmt: {error}"))?;
    if !output.status.success() {
        return Err("rustfmt rejects the generated source".to_owned());
    }
    String::from_utf8(output.stdout).map_err(|error| format!("rustfmt: {error}"))
}

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

#[cfg(test)]
mod tests {
    #[test]
    fn an_array_without_decisions_is_read_only() {
        let table = "owner\tkind\ttype\tname\trows\tcolumns\tcomment\nModel\tarray\tmjtNum\tinvented\tnbody\t1\tinvention\n\
                     Model\tarray\tmjtNum\tbody_mass\tnbody\t1\tmass\n";
        let [(_, _), (_, writers), ..] = super::accessors::generate(table, table, 222);
        assert!(writers.contains("body_mass_mut") && !writers.contains("invented_mut"), "{writers}");
    }

    #[test]
    fn committed_accessors_are_those_of_the_field_table() {
        super::generate(true, true).unwrap();
    }
}
