//! Finds the engine, says how to link it, compiles the shim and chooses the bindings. One file answers one question:
//! `find` (where is the engine, and which version?), `link` (how does a program come to it?), `bindings` (committed or
//! generated?), `shim` (the C side of the guard), `fields` (the table of the engine's fields), `help` (what to tell whoever
//! has no engine).

mod bindings;
#[cfg_attr(not(feature = "bindgen"), allow(dead_code))]
mod fields;
mod find;
mod help;
mod link;
mod shim;

use std::path::PathBuf;

fn main() {
    println!("cargo::rerun-if-changed=build");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("Cargo sets OUT_DIR"));

    match find::engine() {
        Ok(engine) => {
            println!("cargo::rerun-if-changed={}", engine.include.join("mujoco").display());
            bindings::choose(&engine, &out);
            shim::compile(&engine);
            link::announce(&engine, &out);
        }
        // A documentation build links nothing and needs no engine: the committed bindings are enough for it.
        Err(_) if std::env::var_os("DOCS_RS").is_some() => bindings::choose_committed(&out),
        Err(missing) => help::fail(&missing),
    }
}
