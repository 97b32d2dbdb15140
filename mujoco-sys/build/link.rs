//! How does a program come to the engine, at link time and at run time?

use std::path::Path;

use crate::find::Engine;

/// Tells Cargo what to link, and dependants (`DEP_MUJOCO_*`) what was found.
pub(crate) fn announce(engine: &Engine, out: &Path) {
    if engine.on_loader_path {
        println!("cargo::rustc-link-search=native={}", engine.library_dir.display());
    } else {
        // Cargo puts a search path on the loader's path of `cargo run` and `cargo test` only if it lies inside `target`, so
        // the foreign library is linked to from there. An installed program still has to find it by itself.
        stage(engine, out);
        println!("cargo::rustc-link-search=native={}", out.display());
        println!("cargo::rustc-link-arg=-Wl,-rpath,{}", engine.library_dir.display());
        println!("cargo::metadata=rpath={}", engine.library_dir.display());
    }
    println!("cargo::rustc-link-lib=dylib=mujoco");
    println!("cargo::metadata=include={}", engine.include.display());
    println!("cargo::metadata=libdir={}", engine.library_dir.display());
    println!("cargo::metadata=version={}", engine.version);
    // For this crate's own tests, which compare the bindings with the header.
    println!("cargo::rustc-env=MUJOCO_SYS_INCLUDE={}", engine.include.display());
    println!("cargo::rustc-env=MUJOCO_SYS_TARGET={}", std::env::var("TARGET").expect("Cargo sets TARGET"));
}

/// Links `libmujoco.so` and the library's own name (which is what the loader asks for) into `out`.
fn stage(engine: &Engine, out: &Path) {
    let library = engine.library_dir.join(&engine.library);
    for name in ["libmujoco.so", &engine.library] {
        let link = out.join(name);
        // A link of an earlier build may point elsewhere by now.
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
