//! Saving as a binary model.

use std::io::Write;
use std::path::Path;

use mujoco_sys::{self as sys, guard};

use super::{Model, mjb};
use crate::error::{Error, Result};
use crate::{ffi, file};

impl Model {
    /// Writes the model in the engine's binary form (MJB), which loads faster than XML and fits this engine version only.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written; one that was there before is as it was.
    #[doc(alias = "mj_saveModel")]
    pub fn save_binary(&self, path: impl AsRef<Path>) -> Result<()> {
        let bytes = self.to_binary()?;
        file::replace(path.as_ref(), |out| out.write_all(&bytes))
    }

    /// The model in the engine's binary form.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if the engine cannot write it.
    #[doc(alias = "mj_sizeModel")]
    pub fn to_binary(&self) -> Result<Vec<u8>> {
        // SAFETY: a valid model; only adds sizes up.
        let bound = unsafe { sys::mj_sizeModel(self.as_ptr()) };
        let size =
            usize::try_from(bound).map_err(|_| Error::Unsupported("a binary model of more than 2 GiB".to_owned()))?;
        let mut bytes = vec![0; size];
        // SAFETY: the buffer has the size that is passed, and it is no smaller than the engine asked for.
        let status = unsafe { guard::mj_save_model(self.as_ptr(), std::ptr::null(), bytes.as_mut_ptr().cast(), bound) };
        ffi::check_without_data("mj_saveModel", status)?;
        // The engine asks for room for the padding between its arrays, which it does not write.
        let length = mjb::length(&bytes).map_err(|error| {
            Error::Unsupported(format!("Bug: the engine wrote a binary model that is not one: {error}"))
        })?;
        bytes.truncate(length);
        Ok(bytes)
    }
}
