//! Generates bindings with bindgen. Used by the build script (feature `bindgen`) and by `xtask`.

use std::panic::AssertUnwindSafe;
use std::path::Path;
use std::process::Command;

/// Returns the bindings of the headers in `include`. `compiler` is a C compiler, whose own headers
/// libclang reads, because that of PyPI has none.
pub(crate) fn bindings(include: &Path, mut compiler: Command) -> Result<String, String> {
    super::libclang::select();
    let own = compiler.arg("-print-file-name=include").output().ok();
    let own = own.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    let builder = bindgen::Builder::default()
        .clang_args(own.filter(|own| Path::new(own).is_absolute()).map(|own| format!("-idirafter{own}")))
        .header_contents("engine.h", "#include <mujoco/mujoco.h>")
        .clang_arg(format!("-I{}", include.display()))
        // The headers use plain comments, not Doxygen's.
        .clang_arg("-fparse-all-comments")
        // The headers of an installed engine count as system headers.
        .clang_arg("-fretain-comments-from-system-headers")
        .allowlist_item("(_?mj|MJ).*")
        // Enums become constants with the engine's names: a C int is never converted to a Rust enum
        // without a check.
        .default_enum_style(bindgen::EnumVariation::Consts)
        .prepend_enum_name(false)
        .use_core()
        .blocklist_type("mjtBool");
    // bindgen panics if it cannot load libclang.
    std::panic::catch_unwind(AssertUnwindSafe(|| builder.generate()))
        .map_err(|_| super::libclang::MISSING.to_owned())?
        .map(|bindings| bindings.to_string())
        // A file or a program may store any byte in a flag, but a Rust `bool` is 0 or 1.
        .map(|text| if text.contains("mjtBool") { text + "pub type mjtBool = u8;\n" } else { text })
        .map_err(|error| format!("bindgen could not read the engine's headers: {error}"))
}
