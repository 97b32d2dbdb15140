//! Calls on a simulation go through the functions of `src/data/call.rs`, which decide about
//! poisoning.

use std::path::Path;

use super::{read, sources};

/// Engine functions with an `mjData` argument that are called without a simulation to poison, and
/// the reasons.
const EXEMPT: [(&str, &str); 3] = [
    ("mj_makeData", "no simulation exists before the call"),
    ("mj_setConst", "the data is temporary and dropped"),
    ("mjv_updateCamera", "a free camera needs no data: the argument is NULL"),
];

/// Returns the functions of the shim that take or create an `mjData`, by their names in C.
fn functions_of_data(root: &Path) -> Vec<String> {
    let text = read(&root.join("mujoco-sys/src/guard.rs"));
    let declarations = text.split("    mujoco_sys_").skip(1);
    let of_data = declarations.filter_map(|declaration| {
        let (name, rest) = declaration.split_once(" = ")?;
        rest.split_once(");")?.0.contains("mjData").then(|| name.to_owned())
    });
    of_data.collect()
}

pub fn check(root: &Path) -> Vec<String> {
    const GATE: &str = "check_without_data(\"";
    let of_data = functions_of_data(root);
    assert!(of_data.len() > 50, "the declarations of the shim are not read: {of_data:?}");
    let (mut found, mut uses) = (Vec::new(), 0);
    for path in sources(&root.join("src")) {
        for rest in read(&path).split(GATE).skip(1) {
            let function = rest.split('"').next().unwrap_or_default();
            let exempt = EXEMPT.iter().any(|(name, _)| *name == function);
            if !exempt && of_data.iter().any(|name| name == function) {
                found.push(format!("{}: {function} bypasses the checks of data/call.rs", path.display()));
            }
            uses += 1;
        }
    }
    assert!(uses >= 10, "the uses of the gate are not read: {uses}");
    found
}
