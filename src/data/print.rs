//! All quantities as text.

use std::fs::File;
use std::path::Path;

use mujoco_sys::guard;

use super::{Data, Stage};
use crate::error::{Error, Result};
use crate::ffi;

impl Data {
    /// Writes all quantities to a text file, for people to read. An existing file is overwritten.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before positions were computed, [`Error::File`] if the file cannot be written, [`Error::Invalid`]
    /// for a path with a NUL byte, [`Error::Engine`], which poisons the data, if the engine's stack has no room for the full inertia
    /// matrix.
    ///
    /// ```no_run
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.forward()?;
    /// data.print_to("humanoid.txt")?;
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_printData")]
    pub fn print_to(&mut self, path: impl AsRef<Path>) -> Result<()> {
        self.check_computed("print_to", Stage::Position)?;
        let path = path.as_ref();
        let name = ffi::c_string("the path of print_to", path.as_os_str().as_encoded_bytes())?;
        // The engine only warns of a file that it cannot open.
        File::create(path).map_err(Error::file(path))?;
        self.call_mut("mj_printData", |m, d| {
            // SAFETY: a NUL-terminated path. The rows of tendons and constraints were computed for this model.
            unsafe { guard::mj_print_data(m, d, name.as_ptr()) }
        })
    }
}
