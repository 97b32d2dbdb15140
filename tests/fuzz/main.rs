//! Fuzzing of safe calls, binary models and texts in child processes, so that a crash is a finding
//! and does not end the campaign.
//!
//! `cargo test` runs a bounded number of fixed cases. `scripts/fuzz` runs as many as requested. A
//! finding is reproduced, with a list of its calls, by
//!
//! ```text
//! cargo test --test fuzz -- case sequences 123
//! ```
//!
//! the calls of other seeds with the models of files are made by
//!
//! ```text
//! cargo test --test fuzz -- use 0 100 first.xml second.xml
//! ```
//!
//! and the time that the models and the calls of cases take is listed by
//!
//! ```text
//! cargo test --release --test fuzz -- profile sequences 0 10000
//! ```

#![deny(unsafe_code)]

mod campaign;
#[path = "../common/cases.rs"]
mod cases;
mod report;
mod worker;

#[path = "../common/fuzz/mod.rs"]
mod fuzz;

use std::process::ExitCode;

use campaign::Campaign;
use cases::cases;
use fuzz::Target;

/// Loads the plugins of the wheel that contains the engine, if it is from a wheel. They are used in
/// sequences of calls only: the sensor `touch_grid` of 3.5 and 3.17 crashes on a damaged text.
#[allow(unsafe_code, reason = "plugins are code")]
fn load_plugins() {
    let directory = option_env!("MUJOCO_DIR").map(|directory| std::path::Path::new(directory).join("plugin"));
    if let Some(directory) = directory.filter(|directory| directory.is_dir()) {
        // SAFETY: the plugins of the wheel that contains the engine.
        unsafe { mujoco_safe::load_plugins(directory) }.expect("the plugins do not load");
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let target = |name: &str| Target::ALL.into_iter().find(|target| target.name() == name);
    let number = |text: &str| text.parse::<u64>().unwrap_or_else(|error| panic!("{text}: {error}"));
    let is_text = Target::ALL.iter().any(|target| *target != Target::Sequences && words.get(1) == Some(&target.name()));
    if !is_text {
        load_plugins();
    }
    match words[..] {
        ["worker", worker::MISBEHAVE, first, end] => {
            worker::misbehave(number(first)..number(end));
            ExitCode::SUCCESS
        }
        ["worker", name, first, end] => {
            worker::work(target(name).expect("an unknown target"), number(first)..number(end));
            ExitCode::SUCCESS
        }
        ["profile", name, first, end] => {
            worker::profile(target(name).expect("an unknown target"), number(first)..number(end));
            ExitCode::SUCCESS
        }
        ["case", name, seed] => {
            worker::show(target(name).expect("an unknown target"), number(seed));
            ExitCode::SUCCESS
        }
        ["use", first, end, ref paths @ ..] => {
            worker::use_files(paths, number(first)..number(end));
            ExitCode::SUCCESS
        }
        ["campaign", ref options @ ..] => match Campaign::from_options(options) {
            Ok(campaign) => campaign.run(),
            Err(message) => {
                eprintln!("{message}");
                ExitCode::from(2)
            }
        },
        _ => bounded(&words),
    }
}

/// Runs what `cargo test` runs, with the options that it passes to every test program.
fn bounded(words: &[&str]) -> ExitCode {
    if words.contains(&"--list") {
        println!("fuzz: test");
        return ExitCode::SUCCESS;
    }
    // A filter, unless it is the value of an option.
    let filter = words
        .iter()
        .enumerate()
        .find(|(at, word)| !word.starts_with('-') && (*at == 0 || *words[at - 1] != *"--test-threads"));
    if words.contains(&"--ignored") || filter.is_some_and(|(_, filter)| !"fuzz".contains(filter)) {
        println!("fuzz: nothing to run");
        return ExitCode::SUCCESS;
    }
    // Loads each model of the corpus.
    let missing = if cases(false, true) { fuzz::missing() } else { Vec::new() };
    if !missing.is_empty() {
        eprintln!("no model of the corpus has {}", missing.join(", "));
        return ExitCode::FAILURE;
    }
    if !Campaign::detects_misbehaviour() {
        return ExitCode::FAILURE;
    }
    Campaign::bounded().run()
}
