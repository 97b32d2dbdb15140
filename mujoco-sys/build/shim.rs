//! Compiles the C and C++ shim.

use crate::find::Engine;
use crate::target::{self, System};

/// Compiles `shim/` against the engine's headers.
pub(crate) fn compile(engine: &Engine) {
    println!("cargo::rerun-if-changed=shim");
    let mut c = cc::Build::new();
    c.files(
        ["guard", "exception", "callbacks", "collision", "interpose", "stderr", "adapted", "adapted_scene"]
            .map(|name| format!("shim/{name}.c")),
    )
    .include(&engine.include)
    .warnings(true)
    .extra_warnings(true)
    .std("c11")
    // Microsoft's headers call C's functions of strings deprecated.
    .define("_CRT_SECURE_NO_WARNINGS", None)
    // Calls the engine without PLT indirection.
    .flag_if_supported("-fno-plt");
    c.compile("mujoco_sys_guard");

    // The engine's loaders throw C++ exceptions, such as std::bad_alloc, which only C++ can catch.
    let mut cpp = cc::Build::new();
    cpp.cpp(true).file("shim/load.cc").include(&engine.include).warnings(true).extra_warnings(true).std("c++17");
    match (target::system(), cpp.get_compiler().is_like_msvc()) {
        // Handles exceptions, also those of functions with the linkage of C.
        (System::Windows, true) => drop(cpp.flag("/EHs")),
        // GNU's compiler cannot catch the exceptions of engines for Windows. Without C++'s library,
        // programs need no other file than the engine.
        (System::Windows, false) => drop(cpp.flag("-fno-exceptions").cpp_link_stdlib(None)),
        _ => {}
    }
    cpp.compile("mujoco_sys_load");
}
