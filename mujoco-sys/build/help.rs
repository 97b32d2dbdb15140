//! Error messages of the build script.

use crate::find::Missing;
use crate::headers::{DOWNLOAD, MUJOCO_DIR};

/// Ends the build with the searched places, the package to install and the variable to set.
pub(crate) fn fail(missing: &Missing) -> ! {
    let mut lines = vec!["The MuJoCo physics engine was not found.".to_owned()];
    match &missing.requested {
        Some(_) if missing.is_download() && cfg!(not(feature = "download")) => end(&[
            format!("{MUJOCO_DIR}={DOWNLOAD} needs the feature `download` of mujoco-safe or mujoco-safe-sys:"),
            "  cargo add mujoco-safe --features download".to_owned(),
        ]),
        Some(_) if missing.is_download() => lines.push(format!("{MUJOCO_DIR} is set to {DOWNLOAD}:")),
        Some(dir) if dir.is_relative() => lines.push(format!(
            "{MUJOCO_DIR} is set to the relative path {}, which was searched in the directories above Cargo's \
             build directory:",
            dir.display()
        )),
        Some(dir) => {
            lines.push(format!("{MUJOCO_DIR} is set to {}, so only that directory was searched:", dir.display()));
        }
        None => lines.push("Searched:".to_owned()),
    }
    lines.extend(missing.tried.iter().map(|tried| format!("  - {tried}")));
    if let Some(dir) = missing.requested.as_ref().filter(|dir| dir.is_relative() && !missing.is_download()) {
        lines.push(
            "Set an absolute path, or unset it and set in `.cargo/config.toml` of the workspace a path relative to it:"
                .to_owned(),
        );
        lines.push("  [env]".to_owned());
        lines.push(format!("  {MUJOCO_DIR} = {{ value = '{}', relative = true }}", dir.display()));
    }
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
    lines.push(format!("  export {MUJOCO_DIR}=DIR"));
    lines.push(format!(
        "{MUJOCO_DIR} can name any directory that contains include/mujoco/mujoco.h and the library, or whose \
         directory `mujoco` does."
    ));
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
    // Cargo fails after a script that has printed errors. After one that has failed itself, it
    // prints all output of the script too, with these lines again.
    std::process::exit(0);
}
