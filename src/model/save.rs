//! Saving.

use std::io::Write;
use std::path::Path;

use mujoco_sys::{self as sys, guard};

use super::load::{XmlState, path_c_string};
use super::{Model, mjb};
use crate::engine::collecting_warnings;
use crate::error::{Error, Result};
use crate::{ffi, file};

impl Model {
    /// Writes the model as MJCF, with the numbers that it has now.
    ///
    /// The engine keeps one XML tree in the whole process, that of the model that was loaded last, and puts the numbers of
    /// whatever model it is given into that. So this works as long as no other XML was loaded since this model, or the model
    /// that it is a clone of.
    ///
    /// # Errors
    ///
    /// [`Error::XmlReplaced`] if another model was loaded since, [`Error::Save`] if the engine cannot write the model,
    /// [`Error::File`] if the file cannot be written; one that was there before is as it was.
    ///
    /// ```standalone_crate
    /// use mujoco_safe::Model;
    ///
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("ball.xml");
    /// let model = Model::from_xml_str(r#"<mujoco><worldbody><geom name="ball" size="0.1"/></worldbody></mujoco>"#)?;
    /// model.save_xml(&path)?;
    /// assert_eq!(Model::from_xml_path(&path)?.geom("ball")?.index(), 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "mj_saveLastXML")]
    pub fn save_xml(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let text = self.to_xml(path)?;
        file::replace(path, |out| out.write_all(&text))
    }

    /// The text, by way of a file of its own, since the engine looks at no error of writing, such as a full disk.
    fn to_xml(&self, path: &Path) -> Result<Vec<u8>> {
        const MESSAGE: usize = 4096;
        let failed = |reason: String| Error::Save { path: path.to_owned(), reason };
        let file = file::temporary(path).map_err(|error| failed(error.to_string()))?;
        let name = path_c_string(file.path())?;
        let mut xml = XmlState::enter()?;
        if xml.last != Some(self.lineage) {
            return Err(Error::XmlReplaced);
        }
        let mut message = [0; MESSAGE];
        let mut saved = 0;
        let (status, warnings) = collecting_warnings(|| {
            // SAFETY: a valid name and model, a buffer of the given size, a place for the result.
            unsafe {
                guard::mj_save_last_xml(
                    name.as_ptr(),
                    self.as_ptr(),
                    message.as_mut_ptr(),
                    MESSAGE as i32,
                    &raw mut saved,
                )
            }
        });
        xml.leave("mj_saveLastXML", status)?;
        if saved == 1 {
            return match std::fs::read(file.path()) {
                Ok(text) if text.trim_ascii_end().ends_with(b"</mujoco>") => Ok(text),
                Ok(_) => Err(failed("the engine did not write the text to its end".to_owned())),
                Err(error) => Err(failed(error.to_string())),
            };
        }
        // SAFETY: the engine ended the text in the buffer with NUL, or left it empty.
        let message = unsafe { ffi::text(message.as_ptr()) };
        let reason =
            std::iter::once(message).chain(warnings).filter(|text| !text.is_empty()).collect::<Vec<_>>().join("; ");
        Err(failed(if reason.is_empty() { "the engine could not write the text".to_owned() } else { reason }))
    }

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
