//! Models and specs of the engine, without the library.

#![allow(clippy::disallowed_methods, reason = "the engine's arrays are read without the library")]

use std::ffi::{CStr, CString, c_char};
#[cfg(not(engine_since = "3.2.0"))]
use std::path::Path;
use std::path::PathBuf;
use std::ptr;

use mujoco_safe::spec::Spec;
use mujoco_safe::sys::{self, mjModel};
use mujoco_safe::{Model, Result};

use super::super::same_models::differences;

/// Model of the engine.
pub(super) struct RawModel(*mut mjModel);

impl Drop for RawModel {
    fn drop(&mut self) {
        // SAFETY: the model is freed once.
        unsafe { sys::mj_deleteModel(self.0) };
    }
}

impl RawModel {
    /// Returns the differences from a model.
    pub(super) fn differences(&self, ours: &Model, tolerance: f64, except: &[&str]) -> Vec<String> {
        // SAFETY: a valid model.
        unsafe { differences(ours, self.0, tolerance, except) }
    }

    /// Returns the first name of an element that differs from the expected one.
    pub(super) fn different_name(&self, ours: &Model, expected: impl Fn(&str) -> String) -> Option<String> {
        // SAFETY: valid models.
        let [theirs, ours] = unsafe { [names(self.0), names(ours.as_ptr())] };
        let expected = theirs.iter().map(|(kind, id, name)| (*kind, *id, expected(name)));
        let expected: Vec<(i32, i32, String)> = expected.collect();
        let differs = |(a, b): &(&(i32, i32, String), &(i32, i32, String))| a != b;
        match ours.iter().zip(&expected).find(differs) {
            Some((ours, expected)) => Some(format!("name {ours:?} instead of {expected:?}")),
            None if ours.len() == expected.len() => None,
            None => Some(format!("{} names instead of {}", ours.len(), expected.len())),
        }
    }

    pub(super) fn names(&self) -> Vec<u8> {
        // SAFETY: a valid model, whose names have this length.
        unsafe { std::slice::from_raw_parts((*self.0).names.cast::<u8>(), (*self.0).nnames as usize) }.to_vec()
    }
}

/// Returns the types, ids and names of all elements except keyframes.
///
/// # Safety
///
/// The model is valid.
unsafe fn names(model: *const mjModel) -> Vec<(i32, i32, String)> {
    // Larger than the largest type of each engine.
    const MOST_TYPES: i32 = 40;
    let mut found = Vec::new();
    for kind in (1..MOST_TYPES).filter(|kind| *kind != sys::mjOBJ_KEY as i32) {
        // SAFETY: a valid model. Each element has at least the end of its name in the names. Other
        // types and ids have no name.
        unsafe {
            for id in 0..(*model).nnames {
                let name = sys::mj_id2name(model, kind, id as _);
                if !name.is_null() {
                    found.push((kind, id as _, CStr::from_ptr(name).to_string_lossy().into_owned()));
                }
            }
        }
    }
    found
}

/// Text or file of a model.
pub(super) enum Source {
    Text(String),
    File(PathBuf),
}

impl Source {
    pub(super) fn spec(&self) -> Result<Spec> {
        match self {
            Self::Text(text) => Spec::from_xml_str(text),
            Self::File(path) => Spec::from_xml_path(path),
        }
    }

    pub(super) fn name(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::File(path) => path.display().to_string(),
        }
    }

    /// Compiles another text with the same files, with the engine.
    pub(super) fn compile_other(&self, text: &str) -> Option<RawModel> {
        match self {
            Self::Text(_) => compile(&Self::Text(text.to_owned())),
            Self::File(path) => {
                let file = tempfile::Builder::new().prefix("other-").suffix(".xml").tempfile_in(path.parent()?).ok()?;
                std::fs::write(file.path(), text).ok()?;
                compile(&Self::File(file.path().to_owned()))
            }
        }
    }
}

#[cfg(not(engine_since = "3.2.0"))]
/// Compiles a source with the engine.
pub(super) fn compile(source: &Source) -> Option<RawModel> {
    let mut message = [0 as c_char; 1000];
    // SAFETY: the names and texts end with NUL, and the buffer has its length. Only a text of the
    // tests is loaded from a file.
    let load = |path: &Path| unsafe {
        let name = CString::new(path.to_str()?).ok()?;
        let model = sys::mj_loadXML(name.as_ptr(), ptr::null(), message.as_mut_ptr(), 1000);
        (!model.is_null()).then_some(RawModel(model))
    };
    let mut load = load;
    match source {
        Source::File(path) => load(path),
        Source::Text(text) => {
            let folder = tempfile::tempdir().ok()?;
            let path = folder.path().join("model.xml");
            std::fs::write(&path, text).ok()?;
            load(&path)
        }
    }
}

#[cfg(engine_since = "3.2.0")]
pub(super) struct RawSpec(*mut sys::mjSpec);

#[cfg(engine_since = "3.2.0")]
impl Drop for RawSpec {
    fn drop(&mut self) {
        // SAFETY: the spec is freed once.
        unsafe { sys::mj_deleteSpec(self.0) };
    }
}

#[cfg(engine_since = "3.2.0")]
impl RawSpec {
    pub(super) fn parse(source: &Source) -> Option<Self> {
        let mut message = [0 as c_char; 1000];
        let (buffer, length) = (message.as_mut_ptr(), 1000);
        // SAFETY: the names and texts end with NUL, and the buffer has its length.
        let spec = unsafe {
            match source {
                Source::File(path) => {
                    let name = CString::new(path.to_str()?).ok()?;
                    sys::mj_parseXML(name.as_ptr(), ptr::null(), buffer, length)
                }
                Source::Text(text) => {
                    let text = CString::new(&text[..]).ok()?;
                    sys::mj_parseXMLString(text.as_ptr(), ptr::null(), buffer, length)
                }
            }
        };
        (!spec.is_null()).then_some(Self(spec))
    }

    pub(super) fn compile(&self) -> Option<RawModel> {
        // SAFETY: a valid spec.
        let model = unsafe { sys::mj_compile(self.0, ptr::null()) };
        (!model.is_null()).then_some(RawModel(model))
    }

    pub(super) fn error(&self) -> String {
        // SAFETY: a valid spec, whose message ends with NUL.
        unsafe { CStr::from_ptr(sys::mjs_getError(self.0)) }.to_string_lossy().replace('\n', " ")
    }

    /// Removes all keyframes, which attachments and removals treat differently.
    pub(super) fn without_keyframes(self) -> Self {
        // SAFETY: a valid spec and its elements.
        unsafe {
            loop {
                let key = sys::mjs_firstElement(self.0, sys::mjOBJ_KEY as _);
                if key.is_null() || sys::mjs_delete(self.0, key) != 0 {
                    return self;
                }
            }
        }
    }

    /// Attaches another spec to a frame in the world.
    pub(super) fn attach(&self, child: &Self, prefix: &str, (pos, quat): ([f64; 3], [f64; 4])) -> bool {
        let prefix = CString::new(prefix).unwrap();
        // SAFETY: valid specs, and names that end with NUL.
        unsafe {
            let world = sys::mjs_findBody(self.0, c"world".as_ptr());
            let frame = sys::mjs_addFrame(world, ptr::null_mut());
            (*frame).pos = pos;
            (*frame).quat = quat;
            !sys::mjs_attach((*frame).element, (*child.0).element, prefix.as_ptr(), c"".as_ptr()).is_null()
        }
    }

    /// Attaches another spec to a site.
    pub(super) fn attach_to_site(&self, child: &Self, prefix: &str, site: &CStr) -> bool {
        let prefix = CString::new(prefix).unwrap();
        // SAFETY: valid specs, an element of one, and names that end with NUL.
        unsafe {
            let site = sys::mjs_findElement(self.0, sys::mjOBJ_SITE as _, site.as_ptr());
            !sys::mjs_attach(site, (*child.0).element, prefix.as_ptr(), c"".as_ptr()).is_null()
        }
    }

    /// Removes the element of a type with a name.
    pub(super) fn remove(&self, kind: u32, name: &str) -> bool {
        let name = CString::new(name).unwrap();
        // SAFETY: a valid spec and its element.
        unsafe {
            let element = sys::mjs_findElement(self.0, kind as _, name.as_ptr());
            !element.is_null() && sys::mjs_delete(self.0, element) == 0
        }
    }
}

#[cfg(engine_since = "3.2.0")]
pub(super) fn compile(source: &Source) -> Option<RawModel> {
    RawSpec::parse(source)?.compile()
}
