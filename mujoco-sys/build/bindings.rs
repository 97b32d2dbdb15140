//! Chooses the bindings: the committed ones of the version, those of a version whose headers
//! declare the same, or those generated from the installed headers.

use std::path::{Path, PathBuf};

use crate::compatible::{self, Bindings, Committed, Refusal};
use crate::engines::{self, ENGINES, supported, version};
use crate::find::Engine;

/// The `mjVERSION_HEADER` of the engine that a search prefers, and whose bindings documentation
/// builds use.
pub(crate) const DEFAULT: u32 = ENGINES[0].number;

/// Returns the field table of the default engine.
pub(crate) fn default_fields() -> PathBuf {
    let [_, fields] = committed_files(DEFAULT);
    fields
}

/// Writes `bindings.rs` and the field table, `fields.tsv`, into `out`: copies of the committed
/// files, or files generated from the headers.
pub(crate) fn choose(engine: &Engine, out: &Path) {
    if engine.version < DEFAULT {
        crate::help::end(&[format!(
            "The engine in {} is MuJoCo {}. The oldest supported version is {}.",
            engine.include.display(),
            version(engine.version),
            version(DEFAULT)
        )]);
    } else if cfg!(feature = "bindgen") {
        generate(engine, out);
    } else if supported(engine.version).is_some() {
        choose_committed(engine.version, out);
    } else if let Err(why) = choose_compatible(engine, out) {
        let found = format!("The engine in {} is MuJoCo {}.", engine.include.display(), version(engine.version));
        let advice = [
            "To generate bindings for this engine, enable the feature `bindgen`, which needs libclang:".to_owned(),
            "  pip install libclang && cargo build --features mujoco-safe/bindgen".to_owned(),
            "Without pip, or if pip refuses (Python of Debian and Ubuntu): apt-get install libclang-dev. In a program that uses only mujoco-safe-sys, that is its feature.".to_owned(),
            format!("Or set MUJOCO_DIR to the directory of one of the engines {}.", ENGINES.map(|engine| engine.version).join(", ")),
        ];
        let lines = [vec![found], why, advice.into()];
        crate::help::end(&lines.concat());
    }
    if let Some(defect) = engines::defect(engine.version) {
        println!("cargo::warning=MuJoCo {}: {defect}", version(engine.version));
    }
}

/// Writes the files of the nearest version whose headers declare the same as those of the engine.
///
/// # Errors
///
/// Returns why there is none, with the first difference from each of the two nearest versions.
fn choose_compatible(engine: &Engine, out: &Path) -> Result<(), Vec<String>> {
    let unchecked = |what: String| {
        let first = "Its headers could not be compared with those of the versions with committed bindings:";
        vec![first.to_owned(), what]
    };
    let compiler = || cc::Build::new().get_compiler().to_command();
    let headers = compatible::Headers {
        include: &engine.include,
        version: engine.version,
        compiler: &compiler,
        fields: &crate::fields::table(&engine.include, &fields_h(), compiler()).map_err(unchecked)?,
        scratch: &out.join("declarations.c"),
    };
    let mut why =
        vec!["Its headers differ from those of all versions with committed bindings, for example:".to_owned()];
    for known in engines::nearest(engine.version) {
        let [bindings, fields] = committed_files(known.number);
        let read = |path: &Path| std::fs::read_to_string(path).expect("a committed file can be read");
        let files = Committed { bindings: read(&bindings), fields: read(&fields) };
        match compatible::bindings(&headers, &files) {
            Ok(Bindings { text, absent }) => {
                let lacks = if absent.is_empty() { String::new() } else { format!(", but lack {}", absent.join(", ")) };
                println!(
                    "cargo::warning=MuJoCo {} is used with the bindings of {}: its headers declare the same{lacks}",
                    version(engine.version),
                    known.version
                );
                std::fs::write(out.join("bindings.rs"), text).expect("OUT_DIR is writable");
                std::fs::write(out.join("fields.tsv"), files.fields).expect("OUT_DIR is writable");
                return Ok(());
            }
            Err(Refusal::Different(what)) => why.push(format!("  - {}: {what}", known.version)),
            Err(Refusal::Unchecked(what)) => return Err(unchecked(what)),
        }
    }
    why.truncate(3);
    Err(why)
}

/// Returns the paths of the committed bindings and field table of a version.
fn committed_files(version: u32) -> [PathBuf; 2] {
    let crate_root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let name = engines::file_name(version);
    let files = [
        crate_root.join("src/bindings").join(&name).with_extension("rs"),
        crate_root.join("fields").join(name).with_extension("tsv"),
    ];
    for file in &files {
        println!("cargo::rerun-if-changed={}", file.display());
    }
    files
}

fn fields_h() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("build/fields.h")
}

/// Copies the committed bindings and field table of a version.
pub(crate) fn choose_committed(version: u32, out: &Path) {
    for (committed, name) in committed_files(version).iter().zip(["bindings.rs", "fields.tsv"]) {
        std::fs::copy(committed, out.join(name)).expect("OUT_DIR is writable");
    }
}

#[cfg(not(feature = "bindgen"))]
fn generate(_: &Engine, _: &Path) {
    unreachable!("only called with the feature `bindgen`");
}

#[cfg(feature = "bindgen")]
fn generate(engine: &Engine, out: &Path) {
    let compiler = || cc::Build::new().get_compiler().to_command();
    let generated = [
        ("bindings.rs", crate::bindgen::bindings(&engine.include, compiler())),
        ("fields.tsv", crate::fields::table(&engine.include, &fields_h(), compiler())),
    ];
    for (name, text) in generated {
        let text = text.unwrap_or_else(|error| crate::help::end(&[error]));
        std::fs::write(out.join(name), text).expect("OUT_DIR is writable");
    }
}
