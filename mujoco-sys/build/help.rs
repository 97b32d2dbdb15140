//! Error messages of the build script.

use crate::find::Missing;
use crate::headers::MUJOCO_DIR;

/// Ends the build with the searched places, the package to install and the variable to set.
pub(crate) fn fail(missing: &Missing) -> ! {
    let mut lines = vec!["The MuJoCo physics engine was not found.".to_owned()];
    if let Some(dir) = &missing.requested {
        lines.push(format!("{MUJOCO_DIR} is set to {}, so only that directory was searched:", dir.display()));
    } else {
        lines.push("Searched:".to_owned());
    }
    lines.extend(missing.tried.iter().map(|tried| format!("  - {tried}")));
    lines.push("To install it on Debian 12:  apt-get install libmujoco-dev".to_owned());
    if cfg!(not(feature = "download")) {
        lines.push(
            "To let the build install it from PyPI:  the feature `download` of mujoco-safe or mujoco-safe-sys"
                .to_owned(),
        );
    }
    lines.push("To install it from PyPI yourself:".to_owned());
    lines.push(
        "  pip install --target DIR --python-version 3.10 --only-binary :all: --no-deps mujoco==2.2.2".to_owned(),
    );
    lines.push(format!("  export {MUJOCO_DIR}=DIR/mujoco"));
    lines.push(format!("{MUJOCO_DIR} can name any directory that contains include/mujoco/mujoco.h and the library."));
    lines.push("In a bug report, please paste this message and the output of `rustc -vV`.".to_owned());
    end(&lines)
}

/// Returns the last line of a text that is not empty.
#[cfg(feature = "download")]
pub(crate) fn last_line(text: &str) -> &str {
    text.lines().map(str::trim).rfind(|line| !line.is_empty()).unwrap_or("no output")
}

/// Ends the build with an error of these lines.
pub(crate) fn end(lines: &[String]) -> ! {
    for line in lines {
        println!("cargo::error={line}");
    }
    std::process::exit(1);
}
