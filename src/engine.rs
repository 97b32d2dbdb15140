//! The engine itself: its version, and the handlers that must be in place before it is first called.

use std::cell::RefCell;
use std::ffi::c_char;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;

use mujoco_sys::{callback, guard, mj_version, mjVERSION_HEADER};

use crate::error::{Error, Result};
use crate::ffi;

/// The target under which the engine's messages are logged.
pub(crate) const LOG_TARGET: &str = "mujoco";

/// A version of the engine.
///
/// ```
/// let version = mujoco_safe::engine_version();
/// assert_eq!(version, mujoco_safe::built_against());
/// println!("MuJoCo {version}");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Version {
    /// The 2 of 2.2.1.
    pub major: u32,
    /// The first 2 behind the point.
    pub minor: u32,
    /// The last number.
    pub patch: u32,
}

impl Version {
    /// From the number that the engine uses: one digit each up to 3.4 (`222`), and three digits each from 3.5 (`3005000`).
    const fn from_number(number: u32) -> Self {
        let base = if number < 1_000_000 { 10 } else { 1000 };
        Self { major: number / (base * base), minor: number / base % base, patch: number % base }
    }
}

impl std::fmt::Display for Version {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

/// The version of the library that is running.
#[doc(alias = "mj_version")]
#[doc(alias = "mj_versionString")]
pub fn engine_version() -> Version {
    // SAFETY: takes nothing and returns a constant.
    Version::from_number(unsafe { mj_version() } as u32)
}

/// The version of the headers that this crate was built against.
#[doc(alias = "mjVERSION_HEADER")]
pub const fn built_against() -> Version {
    Version::from_number(mjVERSION_HEADER)
}

/// Installs the handlers, once, and refuses an engine of another version, whose structs have another layout. Whatever makes
/// a model calls it first, so no other engine call can come before it.
pub(crate) fn ready() -> Result<()> {
    static SAME_VERSION: OnceLock<bool> = OnceLock::new();
    let same = SAME_VERSION.get_or_init(|| {
        // SAFETY: the engine has not been called yet by this crate, so no other thread reads the handlers at this moment.
        unsafe { guard::install(Some(on_warning)) };
        engine_version() == built_against()
    });
    if *same { Ok(()) } else { Err(Error::EngineVersion { built: built_against(), running: engine_version() }) }
}

/// Gives the engine a clock, for the whole process: from then on each simulation sums up how long the parts of its steps take.
/// Without it the engine's timers count calls only. Reading the clock takes a step about 20 times 25 ns.
///
/// Call it before anything is simulated: a step that is under way in another thread would take the whole time since the
/// machine was started for its duration.
///
/// ```
/// mujoco_safe::enable_timers();
/// ```
#[doc(alias = "mjcb_time")]
pub fn enable_timers() {
    // SAFETY: the function that becomes the engine's clock looks at nothing but the system's.
    unsafe { callback::install_clock() };
}

thread_local! {
    /// The warnings of the load that this thread is in, if it is in one.
    static COLLECTED: RefCell<Option<Vec<String>>> = const { RefCell::new(None) };
}

/// Runs `load` and keeps the warnings that the engine raises in it, instead of logging them.
pub(crate) fn collecting_warnings<T>(load: impl FnOnce() -> T) -> (T, Vec<String>) {
    // A thread that is ending may still load a model, though it has no thread-locals any more: then the warnings are logged.
    let outer = COLLECTED.try_with(|collected| collected.replace(Some(Vec::new())));
    let result = load();
    let warnings = outer.and_then(|outer| COLLECTED.try_with(|collected| collected.replace(outer)));
    (result, warnings.ok().flatten().unwrap_or_default())
}

/// The engine's warning handler. Replacing the default one is what keeps the engine from printing and from writing
/// `MUJOCO_LOG.TXT` to the working directory.
unsafe extern "C" fn on_warning(message: *const c_char) {
    // A logger is the user's code: its panic must not cross the engine.
    let caught = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: the engine passes a NUL-terminated string.
        let message = unsafe { ffi::text(message) };
        // Neither access can fail for a reason but a thread that is ending.
        let kept = COLLECTED
            .try_with(|collected| match collected.try_borrow_mut().as_deref_mut() {
                Ok(Some(warnings)) => {
                    warnings.push(message.clone());
                    true
                }
                _ => false,
            })
            .unwrap_or(false);
        if !kept {
            log::warn!(target: LOG_TARGET, "{message}");
        }
    }));
    // What was thrown is the user's type too, and dropping it may panic again.
    if let Err(payload) = caught {
        std::mem::forget(payload);
    }
}

#[cfg(test)]
mod tests {
    use super::Version;

    #[test]
    fn version_numbers_of_both_encodings_are_read() {
        assert_eq!(Version::from_number(222).to_string(), "2.2.2");
        assert_eq!(Version::from_number(337).to_string(), "3.3.7");
        assert_eq!(Version::from_number(3_017_000).to_string(), "3.17.0");
    }
}
