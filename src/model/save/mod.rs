//! Saving of models in the binary format and as XML.
//!
//! The engine does not write a model as XML. It copies some values of the model into the XML tree
//! of the last model that was loaded, and writes that tree. It does not copy all values, and the
//! tree cannot represent some of them: in XML, a body whose inertia comes from its geoms has no
//! separate mass. [`Model::save_xml`] therefore loads the text before it writes the file, and
//! compares the two models.

mod arrays;
mod compare;
mod order;
mod xml_text;

use std::fs::File;
use std::io::Write;
use std::path::Path;

use mujoco_sys::{self as sys, guard};

pub(crate) use self::arrays::{Arrays, decode, sizes};
pub(crate) use self::compare::settings;
use super::Model;
use crate::error::{Error, Result, UnsavedField};
use crate::{ffi, file};

/// Check that [`Model::save_xml_with`] performs before it writes a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum XmlCheck {
    /// Loads the text, and writes the file only if the loaded model equals the saved model.
    #[default]
    Require,
    /// Loads the text, writes the file even if the loaded model differs, and returns the fields
    /// that differ.
    Report,
    /// Writes the file without loading the text, for example before the meshes that it names exist.
    Skip,
}

/// Options of [`Model::save_xml_with`].
///
/// ```
/// use mujoco_safe::model::{SaveXmlOptions, XmlCheck};
///
/// let options = SaveXmlOptions::default().with_check(XmlCheck::Report);
/// assert_eq!(options.check, XmlCheck::Report);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct SaveXmlOptions {
    /// Check before the file is written. By default [`XmlCheck::Require`].
    pub check: XmlCheck,
    /// Names and contents of files in memory. In the check, they take precedence over files on
    /// disk. By default none.
    pub files: Vec<(String, Vec<u8>)>,
}

impl SaveXmlOptions {
    /// Sets the check before the file is written.
    #[must_use]
    pub fn with_check(mut self, check: XmlCheck) -> Self {
        self.check = check;
        self
    }

    /// Sets the files in memory that the check uses, for a model that was loaded with
    /// [`LoadOptions::with_files`](crate::LoadOptions::with_files). The saved text names them; it
    /// does not contain them.
    #[must_use]
    pub fn with_files(mut self, files: &[(&str, &[u8])]) -> Self {
        self.files = files.iter().map(|&(name, content)| (name.to_owned(), content.to_vec())).collect();
        self
    }
}

/// # Saving
impl Model {
    /// Writes the sizes, the options and every array of the model to a text file, in the engine's
    /// format, which is meant for human readers.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written, [`Error::Invalid`] for a path with a NUL
    /// byte.
    ///
    /// ```no_run
    /// mujoco_safe::sample::humanoid().print_to("humanoid.txt")?;
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_printModel")]
    pub fn print_to(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let name = ffi::c_string("the path of print_to", path.as_os_str().as_encoded_bytes())?;
        // The engine only raises a warning if it cannot open the file.
        File::create(path).map_err(Error::file(path))?;
        // SAFETY: a model that was compiled or validated, and a NUL-terminated path. The function
        // raises no error.
        unsafe { sys::mj_printModel(self.as_ptr(), name.as_ptr()) };
        Ok(())
    }

    /// Writes the model in the engine's binary form (MJB), which loads faster than XML and is
    /// specific to this engine version.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written, and the errors of
    /// [`to_binary`](Self::to_binary). An existing file is then unchanged.
    #[doc(alias = "mj_saveModel")]
    pub fn save_binary(&self, path: impl AsRef<Path>) -> Result<()> {
        let bytes = self.to_binary()?;
        file::replace(path.as_ref(), |out| out.write_all(&bytes))
    }

    /// Returns the model in the engine's binary form.
    ///
    /// # Errors
    ///
    /// [`Error::Engine`] if the engine cannot write the model, [`Error::Unsupported`] if the result
    /// exceeds 2 GiB.
    #[doc(alias = "mj_sizeModel")]
    #[doc(alias = "mj_saveModel")]
    pub fn to_binary(&self) -> Result<Vec<u8>> {
        if self.has_loose_bounds {
            let mut copy = self.try_clone()?;
            copy.edit().update_bounds();
            return copy.to_binary();
        }
        // SAFETY: a valid model; the function only adds up sizes.
        let bound = unsafe { sys::mj_sizeModel(self.as_ptr()) };
        let size =
            usize::try_from(bound).map_err(|_| Error::Unsupported("a binary model of more than 2 GiB".to_owned()))?;
        #[allow(clippy::useless_conversion, reason = "a 64-bit integer in newer engines")]
        let bound =
            i32::try_from(bound).map_err(|_| Error::Unsupported("a binary model of more than 2 GiB".to_owned()))?;
        let write = |filler: u8| {
            let mut bytes = vec![filler; size];
            let buffer = bytes.as_mut_ptr().cast();
            // SAFETY: the buffer has the size that is passed, which is the size that the engine
            // requires.
            let status = unsafe { guard::mj_save_model(self.as_ptr(), std::ptr::null(), buffer, bound) };
            ffi::check_without_data("mj_saveModel", status).map(|()| bytes)
        };
        // The size includes padding for the alignment of the arrays. The engine does not write it,
        // so the end of the buffer keeps the filler.
        let (mut bytes, other) = (write(0)?, write(u8::MAX)?);
        let padding = bytes.iter().zip(&other).rev().take_while(|(one, other)| one != other).count();
        bytes.truncate(size - padding);
        Ok(bytes)
    }

    /// Writes the model as MJCF, unless the text would load as a different model. Equivalent to
    /// [`save_xml_with`](Self::save_xml_with) with the default options.
    ///
    /// # Errors
    ///
    /// As for [`save_xml_with`](Self::save_xml_with).
    ///
    /// ```standalone_crate
    /// use mujoco_safe::{Error, Model};
    ///
    /// let folder = tempfile::tempdir()?; // cargo add tempfile
    /// let path = folder.path().join("ball.xml");
    /// let model = Model::from_xml_str(
    ///     r#"<mujoco><worldbody><body name="ball"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>"#,
    /// )?;
    ///
    /// // The engine does not copy contact bits into its XML tree.
    /// let mut filtered = model.clone();
    /// filtered.edit().geom_mut(0)?.set_contype(2);
    /// let error = filtered.save_xml(&path).unwrap_err();
    /// let Error::XmlLosesEdits { fields, .. } = &error else { panic!("{error}") };
    /// assert!(fields.iter().any(|lost| lost.field == "geom_contype"), "{error}");
    ///
    /// model.save_xml(&path)?;
    /// assert_eq!(Model::from_xml_path(&path)?.body("ball")?.index(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "mj_saveLastXML")]
    pub fn save_xml(&self, path: impl AsRef<Path>) -> Result<()> {
        self.save_xml_with(path, &SaveXmlOptions::default()).map(drop)
    }

    /// Writes the model as MJCF after a check of the text.
    ///
    /// The engine keeps one XML tree per process, for the model that was loaded last, and copies
    /// values of the given model into that tree. This function therefore works only if no other XML
    /// was loaded after this model, or after the model from which it was cloned. The text is the
    /// compiled tree: includes, composites and fused bodies are expanded, and meshes, textures,
    /// height fields and skins remain references to their files.
    ///
    /// The tree cannot represent some values, for example the mass of a body whose mass comes from
    /// its geoms, or the vertices of a mesh. The check finds these values: it loads the text as if
    /// from `path`, with files from `options.files` or relative to `path`, and compares every size,
    /// option and array with this model.
    ///
    /// Floating-point values agree if they differ by at most 1e-8 of the largest value of their row
    /// plus 1e-12 (1e-15 for masses and moments of inertia, of which the engine treats smaller
    /// values as zero). The text has all digits of a value, with two exceptions. The engine writes
    /// values within 1e-12 of an integer as that integer, and writes the vertices of skins and
    /// meshes without a file with six digits. Therefore the tolerance is 1e-5 for the arrays of
    /// skins, and 1e-4 for all values if the vertices of a mesh are rounded. The comparison skips
    /// flags of the compiler that do not change results (`body_sameframe`, `geom_sameframe` and
    /// `site_sameframe`, and with 2.2.2 also `body_simple` and `dof_simplenum`), and the paths of
    /// the files of meshes, textures, height fields and skins, but not the contents of these files.
    /// Pairs and exclusions of contacts are compared as sets, because each load sorts them, and
    /// some builds of 2.2.2 change the order of entries for the same bodies.
    ///
    /// The comparison includes derived fields. After an edit that they depend on, call
    /// [`update_constants`](super::ModelMut::update_constants) first. Otherwise the check reports
    /// fields such as `body_invweight0`, because the compiler computes them from the edited values.
    ///
    /// Returns the fields that the text cannot represent. The list is empty unless `options.check`
    /// is [`XmlCheck::Report`].
    ///
    /// # Errors
    ///
    /// [`Error::XmlLosesEdits`] with the fields and elements that differ in the loaded model,
    /// [`Error::XmlReplaced`] if another model was loaded in the meantime, [`Error::Save`] if the
    /// engine cannot write the model, or if the text does not load from `path`, [`Error::File`] if
    /// the file cannot be written. An existing file is then unchanged.
    #[doc(alias = "mj_saveLastXML")]
    pub fn save_xml_with(&self, path: impl AsRef<Path>, options: &SaveXmlOptions) -> Result<Vec<UnsavedField>> {
        let path = path.as_ref();
        let (text, lost) = self.checked_xml(path, options)?;
        file::replace(path, |out| out.write_all(&text))?;
        Ok(lost)
    }

    /// Returns the model as MJCF, unless the text would load as a different model. Equivalent to
    /// [`to_xml_with`](Self::to_xml_with) with the default options.
    ///
    /// # Errors
    ///
    /// As for [`to_xml_with`](Self::to_xml_with).
    ///
    /// ```standalone_crate
    /// use mujoco_safe::Model;
    ///
    /// let mut model = Model::from_xml_str(
    ///     r#"<mujoco><worldbody><body name="ball"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>"#,
    /// )?;
    /// model.edit().set_timestep(0.001)?;
    /// assert!(model.to_xml()?.contains(r#"<option timestep="0.001"/>"#));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_saveLastXML")]
    pub fn to_xml(&self) -> Result<String> {
        self.to_xml_with(&SaveXmlOptions::default()).map(|(text, _)| text)
    }

    /// Returns the model as MJCF after a check of the text, as
    /// [`save_xml_with`](Self::save_xml_with) writes it, and the fields that the text cannot
    /// represent. The text names files of assets. The check loads it as
    /// [`from_xml_str`](Self::from_xml_str) does, with files from `options.files` or relative to
    /// the current directory.
    ///
    /// # Errors
    ///
    /// As for [`save_xml_with`](Self::save_xml_with), with the path `a text`, and [`Error::Save`]
    /// if a name in the model is not UTF-8.
    #[doc(alias = "mj_saveLastXML")]
    #[doc(alias = "mj_saveXMLString")]
    pub fn to_xml_with(&self, options: &SaveXmlOptions) -> Result<(String, Vec<UnsavedField>)> {
        // Its folder is the current directory.
        self.checked_text(Path::new("a text"), options)
    }

    /// As [`to_xml_with`](Self::to_xml_with), for a text that is loaded from `path`.
    pub(crate) fn checked_text(&self, path: &Path, options: &SaveXmlOptions) -> Result<(String, Vec<UnsavedField>)> {
        let (text, lost) = self.checked_xml(path, options)?;
        let text = String::from_utf8(text).map_err(|_| Error::Save {
            path: path.to_owned(),
            reason: "a name in the model is not UTF-8".to_owned(),
        })?;
        Ok((text, lost))
    }

    /// Returns the text of the model, and the fields that it cannot represent.
    fn checked_xml(&self, path: &Path, options: &SaveXmlOptions) -> Result<(Vec<u8>, Vec<UnsavedField>)> {
        let (text, reloaded) = self.written_xml(path, options)?;
        let lost = reloaded.map_or(Ok(Vec::new()), |reloaded| compare::lost(self, &reloaded))?;
        if !lost.is_empty() && options.check == XmlCheck::Require {
            return Err(Error::XmlLosesEdits { path: path.to_owned(), fields: lost });
        }
        Ok((text, lost))
    }
}
