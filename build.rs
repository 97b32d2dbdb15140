//! Reads the results of the build script of `mujoco-sys` (`DEP_MUJOCO_*`): sets
//! `cfg(engine_since = "X.Y.Z")` for the thresholds that the version has reached, and generates the
//! accessors of versions other than 2.2.2, whose accessors are committed in `src/generated`, and
//! the fields of the views that 2.2.2 does not have. For engines whose binary models can be
//! validated it sets `cfg(validates_binaries)` and generates the table of their files, and for those
//! with which all tests run `cfg(tested_in_full)`.

#[path = "build/accessors.rs"]
mod accessors;
#[path = "build/arena.rs"]
mod arena;
#[path = "build/binary_table.rs"]
mod binary_table;
#[path = "build/computed_by.rs"]
mod computed_by;
#[path = "build/derived.rs"]
mod derived;
#[path = "build/drawn.rs"]
mod drawn;
#[path = "build/facts.rs"]
mod facts;
#[path = "build/notes.rs"]
mod notes;
#[path = "build/numbers.rs"]
mod numbers;
#[path = "build/support.rs"]
mod support;
#[path = "build/views.rs"]
mod views;
#[path = "build/writable.rs"]
mod writable;

use std::path::{Path, PathBuf};

/// Versions of the engine at which the source changes.
const THRESHOLDS: [&str; 31] = [
    "2.3.0", "2.3.1", "2.3.3", "2.3.6", "2.3.7", "3.0.0", "3.0.1", "3.1.2", "3.1.3", "3.1.5", "3.2.0", "3.2.1",
    "3.2.3", "3.2.5", "3.3.0", "3.3.1", "3.3.3", "3.3.4", "3.3.6", "3.5.0", "3.6.0", "3.7.0", "3.8.0", "3.8.1",
    "3.10.0", "3.11.0", "3.12.0", "3.14.0", "3.15.0", "3.17.0", "4.0.0",
];

/// Source of the views, whose names the generated fields do not take.
const VIEWS: &str = concat!(
    include_str!("src/element/actuator.rs"),
    include_str!("src/element/asset.rs"),
    include_str!("src/element/attachment.rs"),
    include_str!("src/element/common.rs"),
    include_str!("src/element/constraint.rs"),
    include_str!("src/element/custom.rs"),
    include_str!("src/element/deformable.rs"),
    include_str!("src/element/fields.rs"),
    include_str!("src/element/kinematics.rs"),
    include_str!("src/element/mesh.rs"),
    include_str!("src/element/mod.rs"),
    include_str!("src/element/sensor.rs"),
    include_str!("src/element/tendon.rs"),
);

fn main() {
    // Otherwise it depends on its own files only, for which it is compiled again.
    println!("cargo::rerun-if-env-changed=DEP_MUJOCO_VERSION");

    // Absent in a documentation build without an engine, which uses the bindings of 2.2.2.
    let version: u32 =
        variable("DEP_MUJOCO_VERSION").map_or(222, |text| text.parse().expect("the header has a number"));
    match variable("DEP_MUJOCO_TESTS").as_deref() {
        Some("none") => println!(
            "cargo::warning=no test of mujoco-safe runs with this version of MuJoCo: its promises may not hold, and memory safety may fail"
        ),
        Some("smoke") => println!(
            "cargo::warning=at most the smoke tests of mujoco-safe run with this version of MuJoCo: its promises may not hold, and memory safety may fail"
        ),
        _ => {}
    }
    let thresholds = THRESHOLDS.map(|threshold| format!("\"{threshold}\"")).join(", ");
    println!("cargo::rustc-check-cfg=cfg(engine_since, values({thresholds}))");
    for threshold in THRESHOLDS.into_iter().filter(|threshold| number(threshold) <= version) {
        println!("cargo::rustc-cfg=engine_since=\"{threshold}\"");
    }
    let fields = PathBuf::from(variable("DEP_MUJOCO_FIELDS").expect("mujoco-sys passes its field table"));
    if version > 222 {
        generate(&fields, version);
    }
    let [views, view_fields] = views::generate(&read(&fields), &read(&default_fields()), version, VIEWS);
    write("views.rs", &views);
    write("view_fields.rs", &view_fields);
    let is_proved = matches!(variable("DEP_MUJOCO_TESTS").as_deref(), Some("all" | "most") | None);
    println!("cargo::rustc-check-cfg=cfg(tested_in_full)");
    if is_proved {
        println!("cargo::rustc-cfg=tested_in_full");
    }
    let checks = support::generate(&read(&fields), include_str!("build/knowledge/derivative.tsv"), version);
    write(
        "support.rs",
        &format!(
            "/// `true` if the formulas were verified with this engine.\nconst IS_PROVED: bool = {is_proved};\n{checks}"
        ),
    );
    let include = variable("DEP_MUJOCO_INCLUDE").map(|folder| PathBuf::from(folder).join("mujoco"));
    write("drawn.rs", &drawn::generate(include.as_deref()));
    println!("cargo::rustc-check-cfg=cfg(validates_binaries)");
    if binary_table::VALIDATED.contains(&version) {
        println!("cargo::rustc-cfg=validates_binaries");
        write("binary_table.rs", &binary_table::generate(&read(&fields)));
    }
    // Lets the tests, examples and benches of this crate load an engine outside the directories of
    // the system's loader. Cargo does not pass link arguments on to dependants: their installed
    // programs need LD_LIBRARY_PATH or an rpath.
    if let Some(rpath) = variable("DEP_MUJOCO_RPATH") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{rpath}");
    }
}

fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok()
}

/// Returns the `mjVERSION_HEADER` of a version: one digit for each part up to 3.4.0, three for
/// minor and patch version from 3.5.0.
fn number(version: &str) -> u32 {
    let parts: Vec<u32> = version.split('.').map(|part| part.parse().expect("a version has three numbers")).collect();
    let base = if (parts[0], parts[1]) >= (3, 5) { 1000 } else { 10 };
    (parts[0] * base + parts[1]) * base + parts[2]
}

/// Writes the accessors of a field table and the tests' lists into `OUT_DIR`, for `include!`.
fn generate(table: &Path, version: u32) {
    for (path, text) in accessors::generate(&read(table), &read(&default_fields()), version) {
        // An included file has no inner attributes and documentation.
        let lines = text.lines().filter(|line| !line.starts_with("//!") && !line.starts_with("#!["));
        let text: String = lines.flat_map(|line| [line, "\n"]).collect();
        let name = Path::new(path).file_name().expect("the path of a file");
        write(name.to_str().expect("a name in ASCII"), &text);
    }
}

/// Returns the path of the field table of 2.2.2.
fn default_fields() -> PathBuf {
    PathBuf::from(variable("DEP_MUJOCO_DEFAULT_FIELDS").expect("mujoco-sys passes the table of 2.2.2"))
}

/// Returns the contents of a table.
fn read(table: &Path) -> String {
    std::fs::read_to_string(table).unwrap_or_else(|error| panic!("{}: {error}", table.display()))
}

/// Writes a file into `OUT_DIR`.
fn write(name: &str, text: &str) {
    let out = PathBuf::from(variable("OUT_DIR").expect("Cargo sets OUT_DIR"));
    std::fs::write(out.join(name), text).expect("OUT_DIR is writable");
}
