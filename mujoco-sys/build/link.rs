//! Links the engine, at link time and at run time.

use std::path::Path;

use crate::find::Engine;
use crate::programs;
use crate::target::{self, System};

/// Prints Cargo's link instructions and the metadata for dependants (`DEP_MUJOCO_*`).
pub(crate) fn announce(engine: &Engine, out: &Path) {
    let system = target::system();
    let library = engine.library_dir.join(&engine.library);
    let place = |names: &[String], folder: &Path| {
        programs::place(system, &library, names, folder)
            .map_err(|error| format!("{} was not linked in {}: {error}", library.display(), folder.display()))
    };
    // An engine on the loader's path needs no link, and those of an earlier build must not hide it.
    let (names, loader_names) = if engine.on_loader_path {
        (Vec::new(), Vec::new())
    } else {
        (programs::names(system, &library), programs::loader_names(system, &library))
    };
    // `cargo run` and `cargo test` add a search path to the loader's path only if it lies inside
    // `target`.
    if let Err(why) = place(&names, out) {
        crate::help::end(&[why]);
    }
    for folder in programs::folders(system, out) {
        if let Err(why) = place(&loader_names, &folder) {
            println!("cargo::warning={why}");
        }
    }
    if engine.on_loader_path {
        println!("cargo::rustc-link-search=native={}", engine.library_dir.display());
    } else {
        if crate::headers::requested().is_none() {
            println!("cargo::warning=linking the MuJoCo engine in {}", engine.library_dir.display());
        }
        println!("cargo::rustc-link-search=native={}", out.display());
        let rpath = match system {
            // The loader searches the program's directory and PATH.
            System::Windows => None,
            // The library records a path that only `out` has.
            System::MacOs => Some(out),
            System::Elf => Some(&*engine.library_dir),
        };
        if let Some(rpath) = rpath {
            println!("cargo::rustc-link-arg=-Wl,-rpath,{}", rpath.display());
            println!("cargo::metadata=rpath={}", rpath.display());
        }
    }
    // On Windows the bindings name the library.
    if system != System::Windows {
        println!("cargo::rustc-link-lib=dylib=mujoco");
    }
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

/// Writes the name of the library to each block of functions in the bindings for Windows. The
/// compiler then makes the import library, which the wheels lack. It also resolves the references
/// of the shim, and global variables need it with Microsoft's linker.
pub(crate) fn name_library(out: &Path, bindings: &str) {
    if target::system() == System::Windows {
        let block = "unsafe extern \"C\" {";
        let named = bindings.replace(block, &format!("#[link(name = \"mujoco\", kind = \"raw-dylib\")]\n{block}"));
        std::fs::write(out.join("bindings.rs"), named).expect("OUT_DIR is writable");
    }
}
