//! The schema of MJCF.

use std::collections::HashMap;
use std::ffi::{c_char, c_int};
use std::ptr;
use std::sync::OnceLock;

use mujoco_sys::guard;

use super::load::XmlState;
use crate::engine;
use crate::error::{Error, Result};
use crate::ffi;

/// Returns the elements and attributes of MJCF that the engine's compiler supports, as indented
/// text. Each element has its attributes and the number of times that it may occur: `!` once, `?`
/// at most once, `*` any number of times, `R` any number of times and recursively.
///
/// # Errors
///
/// [`Error::LoaderLocked`] if the compiler is locked by an earlier error, [`Error::OutOfMemory`].
///
/// ```
/// let schema = mujoco_safe::model::schema()?;
/// assert!(schema.lines().any(|line| line.trim_start().starts_with("freejoint (*)")));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn schema() -> Result<String> {
    print(false)
}

/// Returns the schema of MJCF as an HTML table. Otherwise the same as [`schema`].
///
/// # Errors
///
/// As for [`schema`].
///
/// ```
/// assert!(mujoco_safe::model::schema_html()?.starts_with("<table"));
/// # Ok::<(), mujoco_safe::Error>(())
/// ```
pub fn schema_html() -> Result<String> {
    print(true)
}

fn print(html: bool) -> Result<String> {
    engine::ready()?;
    let mut xml = XmlState::enter()?;
    let mut call = |buffer: *mut c_char, size: c_int| {
        let mut length = 0;
        // SAFETY: no file, NULL or a buffer of the given size, and a pointer for the result.
        let status = unsafe {
            guard::mj_print_schema(ptr::null(), buffer, size, c_int::from(html), c_int::from(true), &raw mut length)
        };
        xml.leave("mj_printSchema", status).map(|()| length)
    };
    // Without a buffer, the engine only returns the length.
    let size = call(ptr::null_mut(), 0)?
        .checked_add(1)
        .ok_or_else(|| Error::Unsupported("a schema of more than 2 GiB".to_owned()))?;
    let mut buffer = vec![0; ffi::size(size)];
    call(buffer.as_mut_ptr(), size)?;
    // SAFETY: the engine terminates the text with NUL inside the buffer.
    Ok(unsafe { ffi::text(buffer.as_ptr()) })
}

/// Attributes of each element, by the path of the element from the root.
pub(crate) struct Schema(HashMap<String, Vec<String>>);

impl Schema {
    /// Returns the schema of the engine.
    pub(crate) fn of_engine() -> Result<&'static Self> {
        static SCHEMA: OnceLock<Schema> = OnceLock::new();
        if let Some(schema) = SCHEMA.get() {
            return Ok(schema);
        }
        let text = schema()?;
        Ok(SCHEMA.get_or_init(|| Self::parse(&text)))
    }

    /// Parses the engine's text: each element is indented by three spaces per level and followed by
    /// its attributes, in this line and in the next ones.
    fn parse(text: &str) -> Self {
        const INDENT: usize = 3;
        let mut elements: HashMap<String, Vec<String>> = HashMap::new();
        let mut path: Vec<&str> = Vec::new();
        for line in text.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let is_element = words.get(1).is_some_and(|word| word.starts_with('(') && word.ends_with(')'));
            let attributes = if is_element {
                path.truncate((line.len() - line.trim_start().len()) / INDENT);
                path.push(words[0]);
                &words[2..]
            } else {
                &words
            };
            elements.entry(path.join("/")).or_default().extend(attributes.iter().map(|&word| word.to_owned()));
        }
        Self(elements)
    }

    /// Returns the attributes of the element with a path.
    pub(crate) fn get(&self, path: &str) -> Option<&[String]> {
        self.0.get(path).map(Vec::as_slice)
    }

    /// Returns the paths of all elements, and their attributes.
    pub(crate) fn elements(&self) -> impl Iterator<Item = (&str, &[String])> {
        self.0.iter().map(|(path, attributes)| (&path[..], &attributes[..]))
    }
}
