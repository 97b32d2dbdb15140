//! The engine's virtual file system: files in memory, found by their name without a path.

use std::ffi::CString;
use std::ptr;

use mujoco_sys::{self as sys, guard, mjVFS};

use crate::error::{Error, Result};
use crate::ffi;

/// Files in memory. The structure is 2 MB of tables, so it lives on the heap.
pub(super) struct VirtualFiles {
    raw: Box<mjVFS>,
}

impl VirtualFiles {
    pub(super) fn new() -> Self {
        let mut raw = Box::<mjVFS>::new_uninit();
        // SAFETY: the engine sets the whole structure to zero, which is a valid value for the ints, chars and pointers that it
        // is made of.
        let raw = unsafe {
            sys::mj_defaultVFS(raw.as_mut_ptr());
            raw.assume_init()
        };
        Self { raw }
    }

    /// Adds a file. The checks are those that the engine makes with a fatal error, or not at all.
    pub(super) fn add(&mut self, name: &str, content: &[u8]) -> Result<()> {
        let invalid = |value: String, expected: &str| Error::Invalid {
            what: format!("the in-memory file '{name}'"),
            value,
            expected: expected.to_owned(),
        };
        let base = name.rsplit(['/', '\\']).next().unwrap_or_default();
        if base.is_empty() || base.len() >= sys::mjMAXVFSNAME as usize {
            return Err(invalid(
                format!("named with {} bytes", base.len()),
                "named with 1 to 999 bytes behind the last slash",
            ));
        }
        if content.is_empty() {
            return Err(invalid("empty".to_owned(), "at least one byte long"));
        }
        let size = i32::try_from(content.len())
            .map_err(|_| invalid(format!("{} bytes long", content.len()), "below 2 GiB"))?;
        let name_c: CString = ffi::c_string("the name of an in-memory file", name)?;
        let mut outcome = 0;
        // SAFETY: a valid table, a valid string, a positive size, a place for the result. An error, when memory runs out, leaves
        // no more than a name behind the last file.
        let status =
            unsafe { guard::mj_make_empty_file_vfs(&raw mut *self.raw, name_c.as_ptr(), size, &raw mut outcome) };
        ffi::check_without_data("mj_makeEmptyFileVFS", status)?;
        match outcome {
            0 => {}
            1 => return Err(invalid("one too many".to_owned(), "one of at most 1998")),
            _ => return Err(invalid("given twice".to_owned(), "unique: the engine looks files up without their path")),
        }
        // SAFETY: as above, and the file is there.
        let index = unsafe { sys::mj_findFileVFS(&raw const *self.raw, name_c.as_ptr()) };
        let index = usize::try_from(index).expect("Bug: a file that was just added is not found");
        // SAFETY: the engine allocated `size` bytes there, and nothing else refers to them.
        unsafe { ptr::copy_nonoverlapping(content.as_ptr(), self.raw.filedata[index].cast::<u8>(), content.len()) };
        Ok(())
    }

    pub(super) fn as_ptr(&self) -> *const mjVFS {
        &raw const *self.raw
    }
}

impl Drop for VirtualFiles {
    fn drop(&mut self) {
        // SAFETY: frees the contents of the files, which are ours; cannot raise an error.
        unsafe { sys::mj_deleteVFS(&raw mut *self.raw) }
    }
}
