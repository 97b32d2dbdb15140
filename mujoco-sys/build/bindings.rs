//! Which bindings: those that are committed, or those of the headers at hand?

use std::path::Path;

use crate::find::Engine;

/// The engine whose bindings are committed.
const COMMITTED: u32 = 222;

/// Writes `bindings.rs` and the table of fields, `fields.tsv`, into `out`: copies of the committed ones, or what is made of the
/// headers.
pub(crate) fn choose(engine: &Engine, out: &Path) {
    if cfg!(feature = "bindgen") {
        generate(engine, out);
    } else if engine.version == COMMITTED {
        choose_committed(out);
    } else {
        crate::help::end(&[
            format!(
                "The engine in {} is version {}, as its header encodes it.",
                engine.include.display(),
                engine.version
            ),
            format!("The bindings that come with this crate are of version {COMMITTED} (2.2.2)."),
            "Enable the feature `bindgen` of mujoco-safe-sys to generate them for yours (it needs libclang:".to_owned(),
            "apt-get install libclang-dev), or point MUJOCO_DIR at an engine 2.2.2.".to_owned(),
        ]);
    }
}

/// Copies the committed bindings and table.
pub(crate) fn choose_committed(out: &Path) {
    let crate_root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (committed, name) in [("src/bindings/v2_2_2.rs", "bindings.rs"), ("fields/v2_2_2.tsv", "fields.tsv")] {
        let committed = crate_root.join(committed);
        println!("cargo::rerun-if-changed={}", committed.display());
        std::fs::copy(&committed, out.join(name)).expect("the committed files can be copied into OUT_DIR");
    }
}

#[cfg(not(feature = "bindgen"))]
fn generate(_: &Engine, _: &Path) {
    unreachable!("only called with the feature `bindgen`");
}

#[cfg(feature = "bindgen")]
fn generate(engine: &Engine, out: &Path) {
    let text = bindgen::Builder::default()
        .header_contents("engine.h", "#include <mujoco/mujoco.h>")
        .clang_arg(format!("-I{}", engine.include.display()))
        // The headers document with plain comments, not with Doxygen's.
        .clang_arg("-fparse-all-comments")
        // An installed engine's headers count as the system's.
        .clang_arg("-fretain-comments-from-system-headers")
        .allowlist_item("(_?mj|MJ).*")
        // A C int is never turned into a Rust enum unchecked: constants, with the engine's own names.
        .default_enum_style(bindgen::EnumVariation::Consts)
        .prepend_enum_name(false)
        .use_core()
        .generate()
        .unwrap_or_else(|error| crate::help::end(&[format!("bindgen could not read the engine's headers: {error}")]))
        .to_string();
    std::fs::write(out.join("bindings.rs"), text).expect("OUT_DIR can be written to");
    let fields =
        crate::fields::table(&engine.include, &mut cc::Build::new()).unwrap_or_else(|why| crate::help::end(&[why]));
    std::fs::write(out.join("fields.tsv"), fields).expect("OUT_DIR can be written to");
}
