//! XML text of a model as the engine writes it, with numbers in their shortest form, and the model
//! that is loaded from the text.
//!
//! The engine prints 17 significant digits, which preserve every double: 0.1 as
//! 0.10000000000000001, and 0.8 in single precision as 0.80000001192092896. The shortest forms that
//! load as the same values are 0.1 and 0.8.

use std::path::Path;

use mujoco_sys::guard;

use super::{SaveXmlOptions, XmlCheck, compare};
use crate::error::{Error, Result};
use crate::messages::collecting_warnings;
use crate::model::Model;
use crate::model::load::{TEXT, XmlState, path_c_string, with_sufficient_stack};
use crate::{ffi, file};

/// Parts of the shim's messages for the engine's own exceptions: their type is not a
/// `std::exception`, and it is known if the engine's library was made by another compiler.
const EXCEPTIONS_OF_ENGINE: [&str; 2] = ["an exception of unknown type", "mjCError"];

/// Known cause of such an exception: mujoco#561, in 2.2.2.
const MASS_IN_MESH_DEFAULTS: &str = "the engine's writer raised an exception. MuJoCo 2.2.2 cannot write a default class of \
    geoms with a mass and type='mesh' (mujoco#561): move type='mesh' from the class to its geoms, or save the model with \
    save_binary, or read its file as a Spec and save the text of Spec::to_xml";

/// Another way to save a model whose files are in other directories or packages.
const OF_SPEC: &str = "if it lacks files, read the model's file, MJCF or URDF, as a Spec: Spec::save_xml writes the paths of \
    all files, and Spec::save_xml_with_assets copies them";

/// Attributes that the engine stores in single precision, in every element that has them.
const SINGLE: [&str; 12] = [
    "rgba",
    "ambient",
    "diffuse",
    "specular",
    "attenuation",
    "exponent",
    "emission",
    "shininess",
    "reflectance",
    "texrepeat",
    "bindpos",
    "bindquat",
];
/// Elements whose real attributes are all in single precision: the elements of `<visual>`.
const SINGLE_ELEMENTS: [&str; 5] = ["global", "headlight", "map", "scale", "rgba"];

impl Model {
    /// Returns the text of the model. If the options require the check, also loads the text as if
    /// from `path` and returns the loaded model.
    ///
    /// Loading replaces the engine's tree with the tree of the text. The tree still fits this model
    /// if all numbers of elements agree, so the model can be saved again. One lock covers writing
    /// and loading, because another load in between would replace the tree.
    pub(super) fn written_xml(&self, path: &Path, options: &SaveXmlOptions) -> Result<(Vec<u8>, Option<Self>)> {
        let mut xml = XmlState::enter()?;
        if xml.last != Some(self.lineage) {
            return Err(Error::XmlReplaced);
        }
        let text = shorten(self.write_tree(path, &mut xml)?);
        if options.check == XmlCheck::Skip {
            return Ok((text, None));
        }
        let files: Vec<(&str, &[u8])> =
            options.files.iter().map(|(name, content)| (name.as_str(), content.as_slice())).collect();
        let name = path.display().to_string();
        let text_path = path.with_file_name(TEXT);
        let reloaded = Self::from_text_by(&name, &text_path, &text, &files, &mut |name, files, source_name| {
            let compiled = Self::compile_under(&mut xml, name, files, source_name);
            // If loading fails, the engine keeps its tree.
            if let Ok(model) = &compiled {
                let fits = compare::differing_sizes(self, model).all(compare::is_derived);
                xml.last = fits.then_some(self.lineage);
            }
            compiled
        });
        match reloaded {
            Ok(reloaded) => Ok((text, Some(reloaded))),
            Err(Error::Load { message, .. }) => Err(Error::Save {
                path: path.to_owned(),
                reason: format!("the text does not load from there: {message}; {OF_SPEC}"),
            }),
            Err(error) => Err(error),
        }
    }

    /// Makes the engine write its tree with the values of the model, to a temporary file. The
    /// engine does not check for write errors such as a full disk.
    fn write_tree(&self, path: &Path, xml: &mut XmlState) -> Result<Vec<u8>> {
        const MESSAGE: usize = 4096;
        let failed = |reason: String| Error::Save { path: path.to_owned(), reason };
        let file = file::temporary(path).map_err(|error| failed(error.to_string()))?;
        let name = path_c_string(file.path())?;
        let mut message = [0; MESSAGE];
        let mut saved = 0;
        let (status, warnings) = collecting_warnings(|| {
            self.with_compiled_sizes(|model| {
                // SAFETY: a valid name and model, a buffer of the given size, and a pointer for the
                // result.
                with_sufficient_stack(|| unsafe {
                    guard::mj_save_last_xml(name.as_ptr(), model, message.as_mut_ptr(), MESSAGE as i32, &raw mut saved)
                })
            })
        });
        xml.leave("mj_saveLastXML", status).map_err(|error| match error {
            Error::Engine { message, .. } if EXCEPTIONS_OF_ENGINE.iter().any(|part| message.contains(part)) => {
                failed(MASS_IN_MESH_DEFAULTS.to_owned())
            }
            error => error,
        })?;
        if saved == 1 {
            return match std::fs::read(file.path()) {
                Ok(text) if text.trim_ascii_end().ends_with(b"</mujoco>") => Ok(text),
                Ok(_) => Err(failed("the text that the engine wrote is truncated".to_owned())),
                Err(error) => Err(failed(error.to_string())),
            };
        }
        // SAFETY: the engine terminated the text in the buffer with NUL, or left it empty.
        let message = unsafe { ffi::text(message.as_ptr()) };
        let reason =
            std::iter::once(message).chain(warnings).filter(|text| !text.is_empty()).collect::<Vec<_>>().join("; ");
        Err(failed(if reason.is_empty() { "the engine could not write the text".to_owned() } else { reason }))
    }
}

/// Shortens the numbers in all attributes.
fn shorten(text: Vec<u8>) -> Vec<u8> {
    // The engine's text is UTF-8 if the names in it are.
    let text = match String::from_utf8(text) {
        Ok(text) => text,
        Err(error) => return error.into_bytes(),
    };
    let mut out = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some(start) = rest.find('<') {
        let end = match rest[start..].strip_prefix("<!--") {
            Some(comment) => comment.find("-->").map(|length| start + 4 + length),
            None => rest[start..].find('>').map(|length| start + length),
        };
        let Some(end) = end else { break };
        out.push_str(&rest[..start]);
        shorten_tag(&rest[start..end], &mut out);
        rest = &rest[end..];
    }
    out.push_str(rest);
    out.into_bytes()
}

/// Shortens the numbers of a tag. Leaves comments and custom texts unchanged.
fn shorten_tag(tag: &str, out: &mut String) {
    let element = tag[1..].split([' ', '/']).next().unwrap_or_default();
    if element.starts_with('!') || element == "text" {
        out.push_str(tag);
        return;
    }
    // Split at the quotes: parts with an odd index are values, and each previous part ends with the
    // attribute.
    let mut attribute = "";
    for (index, part) in tag.split('"').enumerate() {
        if index > 0 {
            out.push('"');
        }
        if index % 2 == 0 {
            attribute = part.trim_matches([' ', '=']).rsplit(' ').next().unwrap_or_default();
            out.push_str(part);
            continue;
        }
        let single = SINGLE.contains(&attribute)
            || SINGLE_ELEMENTS.contains(&element)
            || (element, attribute) == ("light", "cutoff");
        for (index, token) in part.split(' ').enumerate() {
            if index > 0 {
                out.push(' ');
            }
            match shortest(token, single) {
                Some(short) => out.push_str(&short),
                None => out.push_str(token),
            }
        }
    }
}

/// Returns a shorter form of a number, if it has enough digits to be the result of 17-digit
/// printing.
fn shortest(token: &str, single: bool) -> Option<String> {
    const LEAST_DIGITS: usize = 9;
    let digits = token.split('e').next()?.bytes().filter(u8::is_ascii_digit).count();
    if digits < LEAST_DIGITS || !token.contains(['.', 'e']) {
        return None;
    }
    let value: f64 = token.parse().ok().filter(|value: &f64| value.is_finite())?;
    let rounded = value as f32;
    let (plain, scientific) = if single && f64::from(rounded) == value {
        (format!("{rounded}"), format!("{rounded:e}"))
    } else {
        (format!("{value}"), format!("{value:e}"))
    };
    let short = if scientific.len() < plain.len() { scientific } else { plain };
    (short.len() < token.len()).then_some(short)
}

#[cfg(test)]
mod tests {
    use super::shorten;

    #[test]
    fn only_digits_of_numbers_are_removed() {
        for (text, expected) in [
            (r#"<a pos="0.10000000000000001 -3"/>"#, r#"<a pos="0.1 -3"/>"#),
            (r#"<a pos="1.0000000000000001e-09"/>"#, r#"<a pos="1e-9"/>"#),
            (r#"<a pos="0.80000001192092896"/>"#, r#"<a pos="0.800000011920929"/>"#),
            (r#"<geom name="b 1" rgba="0.80000001192092896 1"/>"#, r#"<geom name="b 1" rgba="0.8 1"/>"#),
            (r#"<light cutoff="0.80000001192092896"/>"#, r#"<light cutoff="0.8"/>"#),
            (r#"<text data="0.10000000000000001"/>"#, r#"<text data="0.10000000000000001"/>"#),
            (r#"<!-- <a b="0.10000000000000001"/> --><c/>"#, r#"<!-- <a b="0.10000000000000001"/> --><c/>"#),
            ("<a b=\"-2147483648 1234567890\"", "<a b=\"-2147483648 1234567890\""),
            ("", ""),
        ] {
            assert_eq!(String::from_utf8(shorten(text.as_bytes().to_vec())).unwrap(), expected);
        }
        let bytes = b"<a b=\"0.10000000000000001 \xff\"/>".to_vec();
        assert_eq!(shorten(bytes.clone()), bytes);
    }
}
