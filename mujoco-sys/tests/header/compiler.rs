//! The engine of this build, and the compiler for its headers.

pub(crate) const INCLUDE: &str = env!("MUJOCO_SYS_INCLUDE");

/// The build script's C compiler. A build script gets target, host and optimisation level from the
/// environment; a test must set them.
pub(crate) fn compiler() -> cc::Build {
    let mut build = cc::Build::new();
    build.target(env!("MUJOCO_SYS_TARGET")).host(env!("MUJOCO_SYS_TARGET")).opt_level(0).cargo_metadata(false);
    build
}
