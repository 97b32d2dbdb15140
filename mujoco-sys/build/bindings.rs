//! Chooses the bindings: the committed ones, or those generated from the installed headers.

use std::path::{Path, PathBuf};

use crate::engines::{ENGINES, supported, version};
use crate::find::Engine;

/// The `mjVERSION_HEADER` of the engine that a search prefers, and whose bindings documentation
/// builds use.
pub(crate) const DEFAULT: u32 = ENGINES[0].number;

/// Returns the name of the committed files of an engine, without directory and extension.
pub(crate) fn committed(number: u32) -> Option<String> {
    supported(number).map(|engine| format!("v{}", engine.version.replace('.', "_")))
}

/// Returns the field table of the default engine.
pub(crate) fn default_fields() -> PathBuf {
    let name = committed(DEFAULT).expect("the default engine is in the list");
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fields").join(name).with_extension("tsv")
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
    } else {
        let known = ENGINES.map(|engine| engine.version).join(", ");
        crate::help::end(&[
            format!("The engine in {} is MuJoCo {}.", engine.include.display(), version(engine.version)),
            format!("This crate comes with bindings for {known}."),
            "Enable the feature `bindgen` of mujoco-safe or mujoco-safe-sys to generate bindings for this engine, with which no".to_owned(),
            "test runs (it needs libclang: apt-get install libclang-dev), or set MUJOCO_DIR to the directory of an engine with".to_owned(),
            "bindings.".to_owned(),
        ]);
    }
}

/// Copies the committed bindings and field table of a version.
pub(crate) fn choose_committed(version: u32, out: &Path) {
    let crate_root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let name = committed(version).expect("the caller has checked that the version is in the list");
    let files = [
        (PathBuf::from("src/bindings").join(&name).with_extension("rs"), "bindings.rs"),
        (PathBuf::from("fields").join(name).with_extension("tsv"), "fields.tsv"),
    ];
    for (committed, name) in files {
        let committed = crate_root.join(committed);
        println!("cargo::rerun-if-changed={}", committed.display());
        std::fs::copy(&committed, out.join(name)).expect("OUT_DIR is writable");
    }
}

#[cfg(not(feature = "bindgen"))]
fn generate(_: &Engine, _: &Path) {
    unreachable!("only called with the feature `bindgen`");
}

#[cfg(feature = "bindgen")]
fn generate(engine: &Engine, out: &Path) {
    let fields_h = Path::new(env!("CARGO_MANIFEST_DIR")).join("build/fields.h");
    let compiler = cc::Build::new().get_compiler().to_command();
    let generated = [
        ("bindings.rs", crate::bindgen::bindings(&engine.include)),
        ("fields.tsv", crate::fields::table(&engine.include, &fields_h, compiler)),
    ];
    for (name, text) in generated {
        let text = text.unwrap_or_else(|error| crate::help::end(&[error]));
        std::fs::write(out.join(name), text).expect("OUT_DIR is writable");
    }
}
