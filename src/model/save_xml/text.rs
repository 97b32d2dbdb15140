//! The engine's text of a model, and the model that the text loads as.

use std::path::Path;

use mujoco_sys::guard;

use super::{SaveXmlOptions, XmlCheck, compare, digits};
use crate::engine::collecting_warnings;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::load::{TEXT, XmlState, path_c_string};
use crate::{ffi, file};

impl Model {
    /// Returns the text of the model, and the model that it loads as from `path` if the options ask for the check.
    ///
    /// Loading replaces the engine's tree with that of the text. The tree still fits this model if all sizes agree, so the model
    /// can be saved again. One lock covers writing and loading, since another load in between would replace the tree.
    pub(super) fn to_xml(&self, path: &Path, options: &SaveXmlOptions) -> Result<(Vec<u8>, Option<Self>)> {
        let mut xml = XmlState::enter()?;
        if xml.last != Some(self.lineage) {
            return Err(Error::XmlReplaced);
        }
        let text = digits::shorten(self.write_tree(path, &mut xml)?);
        if options.check == XmlCheck::Skip {
            return Ok((text, None));
        }
        let files: Vec<(&str, &[u8])> =
            options.files.iter().map(|(name, content)| (name.as_str(), content.as_slice())).collect();
        let name = path.display().to_string();
        let place = path.with_file_name(TEXT);
        let reloaded = Self::from_text_by(&name, &place, &text, &files, &mut |name, files, source_name| {
            let compiled = Self::compile_under(&mut xml, name, files, source_name);
            // Without a new model the engine keeps its tree.
            if let Ok(model) = &compiled {
                xml.last = compare::have_same_sizes(self, model).then_some(self.lineage);
            }
            compiled
        });
        match reloaded {
            Ok(reloaded) => Ok((text, Some(reloaded))),
            Err(Error::Load { message, .. }) => Err(Error::Save {
                path: path.to_owned(),
                reason: format!("the text that was to be written does not load from there: {message}"),
            }),
            Err(error) => Err(error),
        }
    }

    /// Lets the engine write its tree with the model's numbers. It writes to a temporary file, because it does not check for
    /// errors of writing, such as a full disk.
    fn write_tree(&self, path: &Path, xml: &mut XmlState) -> Result<Vec<u8>> {
        const MESSAGE: usize = 4096;
        let failed = |reason: String| Error::Save { path: path.to_owned(), reason };
        let file = file::temporary(path).map_err(|error| failed(error.to_string()))?;
        let name = path_c_string(file.path())?;
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
}
