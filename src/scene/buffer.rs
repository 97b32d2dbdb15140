//! Memory for the geoms of a scene.

use std::alloc::{Layout, alloc_zeroed, dealloc};
use std::ffi::c_int;
use std::ptr::{self, NonNull};

use mujoco_sys::mjvGeom;

/// What is a value of its type when all of its bytes are zero, and needs no drop.
///
/// # Safety
///
/// Both must be so.
pub(super) unsafe trait Plain {}

// SAFETY: numbers and arrays of numbers.
unsafe impl Plain for mjvGeom {}
// SAFETY: a number.
unsafe impl Plain for c_int {}

/// An array that is zero to begin with. The engine leaves its own as `malloc` gives it, writes labels without their end into it,
/// and never sets what only its renderer does. Zeroed pages cost nothing until they are used, so a large scene is cheap too.
pub(super) struct Buffer<T: Plain> {
    start: NonNull<T>,
    layout: Layout,
}

impl<T: Plain> Buffer<T> {
    /// Room for so many, if there is memory.
    pub(super) fn zeroed(length: usize) -> Option<Self> {
        let layout = Layout::array::<T>(length).ok()?;
        if layout.size() == 0 {
            return Some(Self { start: NonNull::dangling(), layout });
        }
        // SAFETY: the size is not zero.
        let start = unsafe { alloc_zeroed(layout) };
        Some(Self { start: NonNull::new(start.cast())?, layout })
    }

    /// As the engine has it: NULL if it is empty.
    pub(super) fn as_ptr(&self) -> *mut T {
        if self.layout.size() == 0 { ptr::null_mut() } else { self.start.as_ptr() }
    }
}

impl<T: Plain> Drop for Buffer<T> {
    fn drop(&mut self) {
        if self.layout.size() > 0 {
            // SAFETY: allocated with this layout, and nobody else frees it.
            unsafe { dealloc(self.start.as_ptr().cast(), self.layout) };
        }
    }
}
