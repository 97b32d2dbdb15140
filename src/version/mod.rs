//! Version of the engine.

mod number;

use mujoco_sys::mjVERSION_HEADER;

pub use self::number::Version;

/// Returns the version of the headers that this crate was built against.
pub const fn built_against() -> Version {
    Version::from_number(mjVERSION_HEADER)
}
