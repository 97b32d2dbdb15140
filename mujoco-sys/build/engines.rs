//! The engines with committed bindings, and the tests that run with each. Used by the build script
//! and by the tests of the documentation.

/// An engine whose bindings and field table are committed.
pub(crate) struct Supported {
    /// `mjVERSION_HEADER`: one digit for each part of the version up to 3.4.0, three digits from
    /// 3.5.0.
    pub(crate) number: u32,
    pub(crate) version: &'static str,
    pub(crate) tests: Tests,
}

/// Tests that run with an engine before a release: most by `scripts/test --engine VERSION`, the
/// smallest set by `scripts/releases`.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tests {
    /// All tests.
    All,
    /// The unit tests and all programs except `coverage`, which checks the documentation.
    Most,
    /// The program `smoke`, and the tests of `mujoco-sys`.
    Smoke,
    None,
}

impl Tests {
    /// Returns the value of `DEP_MUJOCO_TESTS`.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Most => "most",
            Self::Smoke => "smoke",
            Self::None => "none",
        }
    }
}

/// The default engine, which a search prefers and whose bindings documentation builds use, then the
/// others in the order of their versions.
pub(crate) const ENGINES: [Supported; 4] = [
    engine(222, "2.2.2", Tests::All),
    engine(3_005_000, "3.5.0", Tests::Most),
    engine(3_017_000, "3.17.0", Tests::Most),
    engine(4_000_001, "4.0.1", Tests::Most),
];

const fn engine(number: u32, version: &'static str, tests: Tests) -> Supported {
    Supported { number, version, tests }
}

/// Returns the three numbers of the version with this `mjVERSION_HEADER`.
fn parts(number: u32) -> [u32; 3] {
    let base = if number < 1_000_000 { 10 } else { 1000 };
    [number / (base * base), number / base % base, number % base]
}

/// Returns the version in words of an engine with this `mjVERSION_HEADER`.
pub(crate) fn version(number: u32) -> String {
    parts(number).map(|part| part.to_string()).join(".")
}

/// Returns a number that grows with the version.
fn place(number: u32) -> u32 {
    parts(number).iter().fold(0, |place, part| 1000 * place + part)
}

/// Returns the tests that run with the engine with this `mjVERSION_HEADER`.
pub(crate) fn tests(number: u32) -> Tests {
    match supported(number) {
        Some(engine) => engine.tests,
        // All releases between the oldest and the newest.
        None if place(number) < place(ENGINES[ENGINES.len() - 1].number) => Tests::Smoke,
        None => Tests::None,
    }
}

/// Returns the name of the committed files of an engine, without directory and extension.
pub(crate) fn file_name(number: u32) -> String {
    format!("v{}", version(number).replace('.', "_"))
}

/// Returns the engines with committed bindings, the nearest version first.
pub(crate) fn nearest(number: u32) -> Vec<&'static Supported> {
    let mut engines: Vec<_> = ENGINES.iter().collect();
    engines.sort_by_key(|engine| place(engine.number).abs_diff(place(number)));
    engines
}

/// Returns what is wrong with the numbers of an engine.
pub(crate) fn defect(number: u32) -> Option<&'static str> {
    match number {
        4_000_000 => Some(
            "its Newton solver with sparse matrices may converge slowly, diverge or return wrong accelerations \
             (https://github.com/google-deepmind/mujoco/issues/3767), which 4.0.1 corrects",
        ),
        3_011_000 => Some("it crashed in a step for whose collisions <size memory> was too small"),
        _ => None,
    }
}

/// Returns the engine with this `mjVERSION_HEADER`, if its bindings are committed.
pub(crate) fn supported(number: u32) -> Option<&'static Supported> {
    ENGINES.iter().find(|engine| engine.number == number)
}
