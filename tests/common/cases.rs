//! The number of cases of tests that have many.

/// Returns `all`, the cases of `scripts/test --slow`, or the `part` of them that other runs have.
pub(crate) fn cases<T>(part: T, all: T) -> T {
    if std::env::var_os("MUJOCO_SAFE_ALL_CASES").is_some() { all } else { part }
}
