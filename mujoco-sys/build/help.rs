//! What to tell whoever has no engine.

use crate::find::{MUJOCO_DIR, Missing};

/// Ends the build with what was sought, what to install and what to set.
pub(crate) fn fail(missing: &Missing) -> ! {
    let mut lines = vec!["The MuJoCo physics engine was not found.".to_owned()];
    if let Some(dir) = &missing.requested {
        lines.push(format!("{MUJOCO_DIR} is set to {}, so only that place was searched:", dir.display()));
    } else {
        lines.push("Searched:".to_owned());
    }
    lines.extend(missing.tried.iter().map(|tried| format!("  - {tried}")));
    lines.push("To install it on Debian or Ubuntu:  apt-get install libmujoco-dev".to_owned());
    lines.push(format!(
        "To use one that is elsewhere:  set {MUJOCO_DIR} to the directory that holds include/mujoco/mujoco.h and the library"
    ));
    lines.push("In a bug report, please paste this message and the output of `rustc -vV`.".to_owned());
    end(&lines)
}

/// Ends the build with these lines.
pub(crate) fn end(lines: &[String]) -> ! {
    for line in lines {
        println!("cargo::error={line}");
    }
    std::process::exit(1);
}
