//! The engine's library on the target: its names and its processor.

use std::env;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Operating systems whose libraries have different names.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum System {
    Windows,
    MacOs,
    /// Linux and other systems with ELF libraries.
    Elf,
}

pub(crate) fn system() -> System {
    match env::var("CARGO_CFG_TARGET_OS").unwrap_or_default().as_str() {
        "windows" => System::Windows,
        "macos" => System::MacOs,
        _ => System::Elf,
    }
}

impl System {
    /// Returns `true` for a file name of the engine's library.
    pub(crate) fn is_library(self, name: &str) -> bool {
        match self {
            Self::Windows => name.eq_ignore_ascii_case("mujoco.dll"),
            // The wheels have `libmujoco.2.2.2.dylib`.
            Self::MacOs => {
                name.strip_prefix("libmujoco.").is_some_and(|rest| rest.split('.').next_back() == Some("dylib"))
            }
            // The wheels have `libmujoco.so.2.2.2`.
            Self::Elf => name == "libmujoco.so" || name.starts_with("libmujoco.so."),
        }
    }

    /// Returns the paths below a search path by which the linker and the loader find a library with
    /// this file name.
    pub(crate) fn search_names(self, library: &str) -> Vec<String> {
        let framework = format!("mujoco.framework/Versions/A/{library}");
        let mut names = match self {
            Self::Windows => vec!["mujoco.dll"],
            // The official library records the path in the framework.
            Self::MacOs => vec!["libmujoco.dylib", library, &framework],
            Self::Elf => vec!["libmujoco.so", library],
        };
        names.dedup();
        names.into_iter().map(str::to_owned).collect()
    }
}

/// Returns Debian's multiarch directory name of the target: `x86_64-linux-gnu` for
/// `x86_64-unknown-linux-gnu`.
pub(crate) fn triplet() -> String {
    let part = |name: &str| env::var(format!("CARGO_CFG_TARGET_{name}")).unwrap_or_default();
    format!("{}-{}-{}", part("ARCH"), part("OS"), part("ENV"))
}

/// Returns `true` for an ELF library for another processor than the target's, such as the host's in
/// its Python environment.
pub(crate) fn is_foreign(library: &Path) -> bool {
    let machine: u16 = match env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default().as_str() {
        "x86_64" => 62,
        "aarch64" => 183,
        _ => return false,
    };
    let mut head = [0; 20];
    File::open(library).and_then(|mut file| file.read_exact(&mut head)).is_ok()
        && head.starts_with(b"\x7fELF")
        && head[18..] != machine.to_le_bytes()
}
