//! Compiles the C and C++ shim.

use crate::find::Engine;

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
    // Calls the engine without PLT indirection.
    .flag_if_supported("-fno-plt");
    c.compile("mujoco_sys_guard");

    // The engine's loaders throw C++ exceptions, such as std::bad_alloc, which only C++ can catch.
    let mut cpp = cc::Build::new();
    cpp.cpp(true).file("shim/load.cc").include(&engine.include).warnings(true).extra_warnings(true).std("c++17");
    cpp.compile("mujoco_sys_load");
}
