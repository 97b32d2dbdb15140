//! Reads what `mujoco-sys` found (`DEP_MUJOCO_*`).

fn main() {
    println!("cargo::rerun-if-changed=build.rs");

    // Absent in a documentation build without an engine, which uses the bindings of 2.2.2.
    let version = std::env::var("DEP_MUJOCO_VERSION").unwrap_or_else(|_| "222".to_owned());
    if version != "222" {
        println!(
            "cargo::error=The engine that was found is version {version}; this release of mujoco-safe supports 222 (2.2.2)."
        );
        println!("cargo::error=Install Debian's libmujoco-dev, or point MUJOCO_DIR at an engine 2.2.2.");
    }
    // An engine that the loader does not find by itself: for our own tests, examples and benches. Cargo does not hand a link
    // argument on to dependants, who need LD_LIBRARY_PATH or an rpath of their own for an installed program.
    if let Ok(rpath) = std::env::var("DEP_MUJOCO_RPATH") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{rpath}");
    }
}
