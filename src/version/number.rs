//! Version numbers. `xtask` includes this file.

/// Version of the engine.
///
/// ```
/// let version = mujoco_safe::engine_version();
/// assert_eq!(version, mujoco_safe::built_against());
/// println!("MuJoCo {version}");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Version {
    /// Major version: the 2 of 2.1.0.
    pub major: u32,
    /// Minor version: the 1 of 2.1.0.
    pub minor: u32,
    /// Patch version: the 0 of 2.1.0.
    pub patch: u32,
}

impl Version {
    /// Decodes the version number of the engine: one digit for each part up to 3.4 (`222`), three
    /// digits for each minor and patch version from 3.5 (`3005000`).
    pub(crate) const fn from_number(number: u32) -> Self {
        let base = if number < 1_000_000 { 10 } else { 1000 };
        Self { major: number / (base * base), minor: number / base % base, patch: number % base }
    }
}

impl std::fmt::Display for Version {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}
