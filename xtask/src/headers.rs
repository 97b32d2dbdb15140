//! Bindings and field table of an engine, generated from its headers.

#[path = "../../mujoco-sys/build/bindgen.rs"]
mod bindgen;
#[path = "../../mujoco-sys/build/fields.rs"]
mod fields;
#[path = "../../mujoco-sys/build/headers.rs"]
mod include;
#[allow(unsafe_code, reason = "the build script's module sets a variable")]
#[path = "../../mujoco-sys/build/libclang.rs"]
mod libclang;
#[path = "../../src/version/number.rs"]
mod version;

use std::path::Path;
use std::process::Command;

use crate::Generated;

/// Generates both files for the engine in `MUJOCO_DIR`, or else on the system. Their names contain
/// the engine's version.
pub(crate) fn generate(root: &Path) -> Result<Vec<Generated>, String> {
    let headers =
        include::roots().iter().map(|root| include::probe(root)).reduce(Result::or).ok_or("no place to search")??;
    let compiler = || Command::new(std::env::var_os("CC").unwrap_or_else(|| "cc".into()));
    let bindings = bindgen::bindings(&headers.include, compiler())?;
    let version = version::Version::from_number(headers.version).to_string().replace('.', "_");
    Ok(vec![
        Generated { path: format!("mujoco-sys/src/bindings/v{version}.rs"), text: bindings },
        Generated {
            path: format!("mujoco-sys/fields/v{version}.tsv"),
            text: fields::table(&headers.include, &root.join("mujoco-sys/build/fields.h"), compiler())?,
        },
    ])
}
