//! Gets the engine from its wheel on PyPI if no engine was found or `MUJOCO_DIR` is `download`: the
//! feature `download`.
//!
//! pip or uv installs the wheel of the target in a folder of the user's cache, which all projects
//! share, and compares it with the hashes in `wheels.txt`.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::cache::{self, VERSION};
use crate::find::{self, Engine, Missing};
use crate::help;

/// Python version of the wheels. The library in them does not depend on it.
const PYTHON: &str = "3.10";

/// Returns the engine in the cache, after installing it there if necessary. A directory in
/// `MUJOCO_DIR` is never replaced.
///
/// # Errors
///
/// Adds the reason to the failed search.
pub(crate) fn engine(mut missing: Missing) -> Result<Engine, Missing> {
    if missing.requested.is_some() && !missing.is_download() || env::var_os("DOCS_RS").is_some() {
        return Err(missing);
    }
    cached().and_then(|root| find::probe(&root)).map_err(|why| {
        missing.tried.push(format!("PyPI, by the feature `download`: {why}"));
        missing
    })
}

/// Returns the directory of the engine for the target.
fn cached() -> Result<PathBuf, String> {
    let target = env::var("TARGET").expect("Cargo sets TARGET");
    let platform = platform(&target).ok_or_else(|| format!("it has no wheel for {target}"))?;
    let folder = cache::folder()?;
    let root = folder.join("mujoco");
    if !root.is_dir() {
        // A folder of this build, so that the folder is complete or absent also if several builds
        // run at the same time, or in containers that share the cache.
        let time = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let new = folder.with_file_name(format!("{VERSION}-{}-{}", std::process::id(), time.as_nanos()));
        let installed =
            install(&new, &target, platform).and_then(|()| find::probe(&new.join("mujoco"))).and_then(|_| {
                // Without its engine it is incomplete.
                let _ = std::fs::remove_dir_all(&folder);
                let moved = std::fs::rename(&new, &folder);
                if root.is_dir() { Ok(()) } else { moved.map_err(|error| format!("{}: {error}", folder.display())) }
            });
        let _ = std::fs::remove_dir_all(&new);
        installed?;
        println!("cargo::warning=installed MuJoCo {VERSION} from PyPI in {}", folder.display());
    }
    Ok(root)
}

/// Installs the wheel by the first program that succeeds.
fn install(folder: &Path, target: &str, platform: &str) -> Result<(), String> {
    let mut why = Vec::new();
    for program in ["python3 -m pip", "python -m pip", "uv pip"] {
        let mut words = program.split(' ');
        let mut command = Command::new(words.next().expect("a program"));
        command.args(words).args(["install", "--quiet", "--no-deps", "--require-hashes", "--only-binary", ":all:"]);
        command.args(["--python-version", PYTHON, "--target"]).arg(folder);
        command.arg("-r").arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("build/wheels.txt"));
        if program.starts_with("uv") {
            // uv does not know the other name of this platform.
            command.args(["--python-platform", &target.replace("windows-gnu", "windows-msvc")]);
        } else {
            command.args(["--disable-pip-version-check", "--platform", platform]);
        }
        match command.output() {
            Ok(output) if output.status.success() => return Ok(()),
            Ok(output) => {
                let errors = String::from_utf8_lossy(&output.stderr);
                why.push(format!("{program}: {}", help::last_line(&errors)));
            }
            Err(error) => why.push(format!("{program}: {error}")),
        }
    }
    Err(format!("it needs pip or uv, and a network for the first build: {}", why.join("; ")))
}

/// Returns pip's name of a target that has a wheel.
fn platform(target: &str) -> Option<&'static str> {
    Some(match target {
        "x86_64-unknown-linux-gnu" => "manylinux2014_x86_64",
        "aarch64-unknown-linux-gnu" => "manylinux2014_aarch64",
        "aarch64-apple-darwin" => "macosx_11_0_arm64",
        "x86_64-apple-darwin" => "macosx_10_16_x86_64",
        "x86_64-pc-windows-gnu" | "x86_64-pc-windows-msvc" => "win_amd64",
        _ => return None,
    })
}
