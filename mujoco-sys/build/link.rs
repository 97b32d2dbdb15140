//! Links the engine, at link time and at run time.

use std::path::Path;

use crate::find::Engine;

/// Prints Cargo's link instructions and the metadata for dependants (`DEP_MUJOCO_*`).
pub(crate) fn announce(engine: &Engine, out: &Path) {
    // The linker searches `out` for the shim, and must not find the engine of an earlier build
    // there.
    let _ = std::fs::remove_file(out.join("libmujoco.so"));
    if engine.on_loader_path {
        println!("cargo::rustc-link-search=native={}", engine.library_dir.display());
    } else {
        // `cargo run` and `cargo test` add a search path to the loader's path only if it lies
        // inside `target`, so a link to the library is placed there. An installed program needs
        // LD_LIBRARY_PATH or an rpath.
        stage(engine, out);
        if crate::headers::requested().is_none() {
            println!("cargo::warning=linking the MuJoCo engine in {}", engine.library_dir.display());
        }
        println!("cargo::rustc-link-search=native={}", out.display());
        println!("cargo::rustc-link-arg=-Wl,-rpath,{}", engine.library_dir.display());
        println!("cargo::metadata=rpath={}", engine.library_dir.display());
    }
    println!("cargo::rustc-link-lib=dylib=mujoco");
    println!("cargo::metadata=include={}", engine.include.display());
    println!("cargo::metadata=libdir={}", engine.library_dir.display());
    println!("cargo::metadata=version={}", engine.version);
    println!("cargo::metadata=tests={}", crate::engines::tests(engine.version).name());
    announce_fields(out);
    println!("cargo::metadata=default_fields={}", crate::bindings::default_fields().display());
    // For this crate's tests, which compare the bindings with the headers.
    println!("cargo::rustc-env=MUJOCO_SYS_NAME={}", crate::engines::file_name(engine.version));
    println!("cargo::rustc-env=MUJOCO_SYS_INCLUDE={}", engine.include.display());
    println!("cargo::rustc-env=MUJOCO_SYS_TARGET={}", std::env::var("TARGET").expect("Cargo sets TARGET"));
}

/// Passes the field table in `out` to the build script of `mujoco-safe`.
pub(crate) fn announce_fields(out: &Path) {
    println!("cargo::metadata=fields={}", out.join("fields.tsv").display());
}

/// Creates links to the library in `out`: `libmujoco.so` for the linker and the library's file name
/// for the loader.
fn stage(engine: &Engine, out: &Path) {
    let library = engine.library_dir.join(&engine.library);
    for name in ["libmujoco.so", &engine.library] {
        let link = out.join(name);
        // A link from an earlier build may be outdated.
        let _ = std::fs::remove_file(&link);
        #[cfg(unix)]
        let made = std::os::unix::fs::symlink(&library, &link);
        #[cfg(not(unix))]
        let made = std::fs::copy(&library, &link).map(|_| ());
        if let Err(error) = made {
            crate::help::end(&[format!("{} could not be linked to {}: {error}", link.display(), library.display())]);
        }
    }
}
