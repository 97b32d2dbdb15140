//! The engine's XML compiler: its process-wide state, its virtual file system, and the call itself.

use std::ffi::{CString, c_int};
use std::ops::{Deref, DerefMut};
use std::path::Path;
use std::ptr::{self, NonNull};
use std::sync::{Mutex, MutexGuard, PoisonError};

use mujoco_sys::{self as sys, guard, mjVFS, stderr};

use crate::engine;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::Lineage;
use crate::messages::{self, HeldBack, collecting_warnings};
use crate::model::{Model, xml_guard};

/// State of the engine's XML compiler, one per process: the XML tree of the last model, under a
/// lock.
pub(in crate::model) struct XmlState {
    /// The model to which the tree belongs.
    pub(in crate::model) last: Option<Lineage>,
    /// Engine error that left the compiler by a `longjmp`, with the compiler's lock still held.
    /// Another call would deadlock.
    locked: Option<String>,
}

impl XmlState {
    /// Waits for concurrent loads, as the engine does, and returns an error if the engine would
    /// deadlock.
    pub(in crate::model) fn enter() -> Result<XmlLock> {
        static STATE: Mutex<XmlState> = Mutex::new(XmlState { last: None, locked: None });
        let held = HeldBack::new();
        let state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
        match &state.locked {
            Some(cause) => Err(Error::LoaderLocked { cause: cause.clone() }),
            None => Ok(XmlLock { state, _held: held }),
        }
    }

    /// Converts the status of a call into the compiler, and records whether the engine's lock is
    /// still held: an engine error skips its release, a C++ exception does not.
    pub(in crate::model) fn leave(&mut self, function: &'static str, status: c_int) -> Result<()> {
        let result = ffi::check_without_data(function, status);
        if let Err(error) = &result
            && status == guard::ERROR
        {
            self.locked = Some(error.to_string());
        }
        result
    }
}

/// Exclusive access to the state of the compiler. A logger that loads a model would wait for it
/// forever, so messages are logged after it is released.
pub(in crate::model) struct XmlLock {
    state: MutexGuard<'static, XmlState>,
    /// Dropped after the lock, because the fields are dropped in the order of their declaration.
    _held: HeldBack,
}

impl Deref for XmlLock {
    type Target = XmlState;

    fn deref(&self) -> &XmlState {
        &self.state
    }
}

impl DerefMut for XmlLock {
    fn deref_mut(&mut self) -> &mut XmlState {
        &mut self.state
    }
}

/// Limit of the length of a file name in the engine's table, in bytes with the final NUL
/// (`mjMAXVFSNAME`, which newer engines do not have).
const MAX_NAME: usize = 1000;

/// Files in memory, which the engine finds by the last part of their path. The structure has 2 MB
/// of tables, so it is on the heap.
pub(in crate::model) struct VirtualFiles {
    raw: Box<mjVFS>,
}

impl VirtualFiles {
    pub(super) fn new() -> Self {
        let mut raw = Box::<mjVFS>::new_uninit();
        // SAFETY: the engine sets the whole structure to zero, which is a valid value for the ints,
        // chars and pointers in it.
        let raw = unsafe {
            sys::mj_defaultVFS(raw.as_mut_ptr());
            raw.assume_init()
        };
        Self { raw }
    }

    /// Adds a file. Rejects a file for which the engine would raise a fatal error, or whose errors
    /// it does not detect.
    pub(super) fn add(&mut self, name: &str, content: &[u8]) -> Result<()> {
        let invalid = |value: String, expected: &str| {
            Error::out_of_range(format!("the in-memory file '{name}'"), value, expected)
        };
        let base = name.rsplit(['/', '\\']).next().unwrap_or_default();
        if base.is_empty() || base.len() >= MAX_NAME {
            return Err(invalid(
                format!("named with {} bytes", base.len()),
                "named with 1 to 999 bytes after the last slash",
            ));
        }
        if content.is_empty() {
            return Err(invalid("empty".to_owned(), "at least one byte long"));
        }
        // The compiler reads the header of a Gmsh file as a C string.
        let terminated;
        let content = if content.starts_with(b"$MeshFormat") && !content.contains(&0) {
            terminated = [content, b"\0"].concat();
            &terminated
        } else {
            content
        };
        let size = i32::try_from(content.len())
            .map_err(|_| invalid(format!("{} bytes long", content.len()), "smaller than 2 GiB"))?;
        let name_c: CString = ffi::c_string("the name of an in-memory file", name)?;
        let mut outcome = 0;
        let (vfs, buffer) = (&raw mut *self.raw, content.as_ptr().cast());
        // SAFETY: a valid table, a valid string, `size` bytes, and a pointer for the result. If the
        // engine runs out of memory, it leaves at most a name after the last file.
        let status = unsafe { guard::mj_add_buffer_vfs(vfs, name_c.as_ptr(), buffer, size, &raw mut outcome) };
        ffi::check_without_data("mj_addBufferVFS", status)?;
        match outcome {
            0 => Ok(()),
            1 => Err(invalid("beyond the limit".to_owned(), "one of at most 1998")),
            2 => Err(invalid("given twice".to_owned(), "unique: the engine compares names without their path")),
            _ => Err(invalid("rejected by the engine".to_owned(), "a name and a content that the engine can store")),
        }
    }

    pub(super) fn as_ptr(&self) -> *const mjVFS {
        &raw const *self.raw
    }
}

impl Drop for VirtualFiles {
    fn drop(&mut self) {
        // SAFETY: frees the contents of the files, which this value owns; cannot raise an error.
        unsafe { sys::mj_deleteVFS(&raw mut *self.raw) }
    }
}

/// Calls a function of the compiler, which recurses over nested elements, with enough stack for the
/// deepest ones that the checks of texts admit. On Windows the main thread has a stack of 1 MiB,
/// and the official library takes 6.6 KiB for each of up to 400 nested bodies.
#[cfg(windows)]
pub(in crate::model) fn with_sufficient_stack<T>(call: impl FnOnce() -> T) -> T {
    const NEEDED: usize = 4 << 20;
    stacker::maybe_grow(NEEDED, 2 * NEEDED, call)
}

/// Calls a function of the compiler. Two MiB, the stack of Rust's threads, suffice for the deepest
/// elements that the checks of texts admit.
#[cfg(not(windows))]
pub(in crate::model) fn with_sufficient_stack<T>(call: impl FnOnce() -> T) -> T {
    call()
}

impl Model {
    /// Runs the compiler. The caller holds the lock of [`XmlState`].
    pub(in crate::model) fn compile_under(
        xml: &mut XmlState,
        name: &CString,
        files: &VirtualFiles,
        source_name: &str,
    ) -> Result<Self> {
        const MESSAGE: usize = 4096;
        // The engine replaces its tree before it returns a model, which may still be rejected
        // below.
        let last = xml.last.take();
        let mut message = [0; MESSAGE];
        let mut loaded = ptr::null_mut();
        let compile = || {
            // SAFETY: a valid name and table, a buffer of the given size, and a pointer for the
            // result.
            unsafe {
                let (message, loaded) = (message.as_mut_ptr(), &raw mut loaded);
                guard::mj_load_xml(name.as_ptr(), files.as_ptr(), message, MESSAGE as i32, loaded)
            }
        };
        let ((status, printed), mut warnings) =
            collecting_warnings(|| stderr::captured(|| with_sufficient_stack(compile)));
        warnings.extend(messages::of_other_threads());
        xml.leave("mj_loadXML", status)?;
        // The convex hull library prints the reason first, and then pages of numbers.
        warnings.extend(printed.lines().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned));
        // SAFETY: the engine terminated the text in the buffer with NUL, or left it empty.
        let message = unsafe { ffi::text(message.as_ptr()) };
        let Some(raw) = NonNull::new(loaded) else {
            // If compilation fails, the engine deletes the new tree and keeps the previous one.
            xml.last = last;
            warnings.insert(0, message);
            return Err(Error::Load { source_name: source_name.to_owned(), message: warnings.join("; ") });
        };
        // On success the buffer may contain a warning of the compiler.
        if !message.is_empty() && !warnings.contains(&message) {
            warnings.push(message);
        }
        let lineage = Lineage::new();
        // SAFETY: the engine compiled the model, and nothing else owns it.
        let model = unsafe { Self::from_raw(raw, lineage, warnings) };
        model.validate().map_err(|reason| Error::Load {
            source_name: source_name.to_owned(),
            message: format!("the compiled model is invalid: {reason}"),
        })?;
        xml.last = Some(lineage);
        Ok(model)
    }

    /// Runs the compiler under the lock of [`XmlState`].
    pub(super) fn compile(name: &CString, files: &VirtualFiles, source_name: &str) -> Result<Self> {
        engine::ready()?;
        Self::compile_under(&mut *XmlState::enter()?, name, files, source_name)
    }
}

/// Converts a path to a C string.
pub(in crate::model) fn path_c_string(path: &Path) -> Result<CString> {
    ffi::c_string("the path", xml_guard::path_bytes(path))
}
