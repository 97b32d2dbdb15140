//! Finds the engine, chooses its bindings, compiles the C shim and links the library. On failure it
//! prints the places that it searched, the package to install and the variable to set.

mod absent;
#[cfg(feature = "bindgen")]
mod bindgen;
mod bindings;
mod c_checks;
mod cache;
mod compatible;
#[cfg(feature = "download")]
mod download;
mod engines;
mod fields;
mod find;
mod headers;
mod help;
#[cfg(feature = "bindgen")]
mod libclang;
mod link;
mod programs;
mod rust_items;
mod shim;
mod target;

use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=build");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("Cargo sets OUT_DIR"));
    build(&out);
    let bindings = std::fs::read_to_string(out.join("bindings.rs")).expect("the bindings were written above");
    std::fs::write(out.join("absent.rs"), absent::definitions(&bindings)).expect("OUT_DIR is writable");
    link::name_library(&out, &bindings);
}

fn build(out: &Path) {
    let found = find::engine();
    #[cfg(feature = "download")]
    let found = found.or_else(download::engine);
    match found {
        Ok(engine) => {
            println!("cargo::rerun-if-changed={}", engine.include.join("mujoco").display());
            bindings::choose(&engine, out);
            shim::compile(&engine);
            link::announce(&engine, out);
            cache::suggest(&engine);
        }
        // A documentation build links nothing, so the committed bindings suffice.
        Err(_) if std::env::var_os("DOCS_RS").is_some() => {
            bindings::choose_committed(bindings::DEFAULT, out);
            link::announce_fields(out);
        }
        Err(missing) => help::fail(&missing),
    }
}
