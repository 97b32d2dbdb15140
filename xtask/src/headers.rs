//! Bindings and field table of an engine, generated from its headers.

#[path = "../../mujoco-sys/build/bindgen.rs"]
mod bindgen;
#[path = "../../mujoco-sys/build/fields.rs"]
mod fields;
#[path = "../../mujoco-sys/build/headers.rs"]
mod include;

use std::path::Path;
use std::process::Command;

use crate::Generated;

/// Generates both files for the engine in `MUJOCO_DIR`, or else on the system. Their names contain the engine's version.
pub(crate) fn generate(root: &Path) -> Result<Vec<Generated>, String> {
    let headers =
        include::roots().iter().map(|root| include::probe(root)).reduce(Result::or).ok_or("no place to search")??;
    // bindgen panics if it cannot load libclang.
    let bindings = std::panic::catch_unwind(|| bindgen::bindings(&headers.include))
        .map_err(|_| "bindgen failed; it needs libclang: apt-get install libclang-dev")??;
    let version = dotted(headers.version).replace('.', "_");
    let compiler = Command::new(std::env::var_os("CC").unwrap_or_else(|| "cc".into()));
    Ok(vec![
        Generated { path: format!("mujoco-sys/src/bindings/v{version}.rs"), text: bindings },
        Generated {
            path: format!("mujoco-sys/fields/v{version}.tsv"),
            text: fields::table(&headers.include, &root.join("mujoco-sys/build/fields.h"), compiler)?,
        },
    ])
}

/// The version as text. `mjVERSION_HEADER` has one decimal digit per part up to 3.4.0 and is `major · 1,000,000 + minor · 1,000 + patch` since.
fn dotted(version: u32) -> String {
    let base = if version < 1000 { 10 } else { 1000 };
    format!("{}.{}.{}", version / base / base, version / base % base, version % base)
}

#[cfg(test)]
mod tests {
    #[test]
    fn both_encodings_of_the_version_are_decoded() {
        assert_eq!(super::dotted(222), "2.2.2");
        assert_eq!(super::dotted(3_005_000), "3.5.0");
    }
}
