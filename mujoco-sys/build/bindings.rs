//! Chooses the bindings: the committed ones, or those generated from the installed headers.

use std::path::Path;

use crate::find::Engine;

/// The engine whose bindings are committed.
pub(crate) const COMMITTED: u32 = 222;

/// Writes `bindings.rs` and the field table, `fields.tsv`, into `out`: copies of the committed files, or files generated from the headers.
pub(crate) fn choose(engine: &Engine, out: &Path) {
    if cfg!(feature = "bindgen") {
        generate(engine, out);
    } else if engine.version == COMMITTED {
        choose_committed(out);
    } else {
        crate::help::end(&[
            format!("The engine in {} has mjVERSION_HEADER {}.", engine.include.display(), engine.version),
            format!("This crate comes with bindings for {COMMITTED} (2.2.2) only."),
            "Enable the feature `bindgen` of mujoco-safe-sys to generate bindings for this engine (it needs libclang:"
                .to_owned(),
            "apt-get install libclang-dev), or set MUJOCO_DIR to the directory of an engine 2.2.2.".to_owned(),
        ]);
    }
}

/// Copies the committed bindings and field table.
pub(crate) fn choose_committed(out: &Path) {
    let crate_root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (committed, name) in [("src/bindings/v2_2_2.rs", "bindings.rs"), ("fields/v2_2_2.tsv", "fields.tsv")] {
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
