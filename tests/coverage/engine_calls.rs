//! Calls on a simulation go through the functions of `src/data/call.rs`, which decide about
//! poisoning.

use std::fs;
use std::path::Path;

/// Engine functions with an `mjData` argument that are called without a simulation to poison, and
/// the reasons.
const EXEMPT: [(&str, &str); 3] = [
    ("mj_makeData", "no simulation exists before the call"),
    ("mj_setConst", "the data is temporary and dropped"),
    ("mjv_updateCamera", "a free camera needs no data: the argument is NULL"),
];

/// Returns the functions of the shim that take or create an `mjData`, by their names in C.
fn functions_of_data() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("mujoco-sys/src/guard.rs")).unwrap();
    let declarations = text.split("    mujoco_sys_").skip(1);
    let of_data = declarations.filter_map(|declaration| {
        let (name, rest) = declaration.split_once(" = ")?;
        rest.split_once(");")?.0.contains("mjData").then(|| name.to_owned())
    });
    of_data.collect()
}

/// Returns the text of each Rust file of a folder.
fn sources(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let texts = entries.flat_map(|path| match path.extension().and_then(|extension| extension.to_str()) {
        _ if path.is_dir() => sources(&path),
        Some("rs") => vec![fs::read_to_string(&path).unwrap()],
        _ => Vec::new(),
    });
    texts.collect()
}

#[test]
fn no_call_on_a_simulation_bypasses_poisoning() {
    const GATE: &str = "check_without_data(\"";
    let of_data = functions_of_data();
    assert!(of_data.len() > 50, "the declarations of the shim are not read: {of_data:?}");
    let mut found = 0;
    for text in sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")) {
        for rest in text.split(GATE).skip(1) {
            let function = rest.split('"').next().unwrap();
            let exempt = EXEMPT.iter().any(|(name, _)| *name == function);
            assert!(exempt || !of_data.iter().any(|name| name == function), "{function} bypasses the checks");
            found += 1;
        }
    }
    assert!(found >= 10, "the uses of the gate are not read: {found}");
}
