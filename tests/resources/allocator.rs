//! Replacement of the C library's allocator, which counts the allocations of Rust, C and C++.
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use std::cell::Cell;
use std::ffi::{c_int, c_void};

thread_local! {
    /// Number of allocations of this thread. A cell without a destructor does not allocate.
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

/// Counts one allocation of this thread.
fn count() {
    let _ = COUNT.try_with(|count| count.set(count.get() + 1));
}

unsafe extern "C" {
    fn __libc_malloc(size: usize) -> *mut c_void;
    fn __libc_calloc(count: usize, size: usize) -> *mut c_void;
    fn __libc_realloc(block: *mut c_void, size: usize) -> *mut c_void;
    fn __libc_memalign(alignment: usize, size: usize) -> *mut c_void;
}

/// Counts and forwards to the C library.
#[unsafe(no_mangle)]
extern "C" fn malloc(size: usize) -> *mut c_void {
    count();
    // SAFETY: the C library exports its allocator under this name for replacements.
    unsafe { __libc_malloc(size) }
}

/// Counts and forwards to the C library.
#[unsafe(no_mangle)]
extern "C" fn calloc(number: usize, size: usize) -> *mut c_void {
    count();
    // SAFETY: as for `malloc`.
    unsafe { __libc_calloc(number, size) }
}

/// Counts and forwards to the C library.
///
/// # Safety
///
/// `block` is NULL or points to an allocated block.
#[unsafe(no_mangle)]
unsafe extern "C" fn realloc(block: *mut c_void, size: usize) -> *mut c_void {
    count();
    // SAFETY: the caller guarantees that `block` is NULL or allocated.
    unsafe { __libc_realloc(block, size) }
}

/// Counts and forwards to the C library.
#[unsafe(no_mangle)]
extern "C" fn aligned_alloc(alignment: usize, size: usize) -> *mut c_void {
    count();
    // SAFETY: as for `malloc`.
    unsafe { __libc_memalign(alignment, size) }
}

/// Counts and forwards to the C library.
///
/// # Safety
///
/// `block` is valid for writes.
#[unsafe(no_mangle)]
unsafe extern "C" fn posix_memalign(block: *mut *mut c_void, alignment: usize, size: usize) -> c_int {
    const OUT_OF_MEMORY: c_int = 12;
    count();
    // SAFETY: as for `malloc`; the caller guarantees that `block` is valid for writes.
    unsafe {
        *block = __libc_memalign(alignment, size);
        if (*block).is_null() { OUT_OF_MEMORY } else { 0 }
    }
}

/// Statistics of the C library's allocator.
#[repr(C)]
struct MallInfo2 {
    before: [usize; 4],
    /// Bytes in blocks from `mmap`.
    hblkhd: usize,
    between: [usize; 2],
    /// Bytes in all other allocated blocks.
    uordblks: usize,
    after: [usize; 2],
}

unsafe extern "C" {
    fn mallinfo2() -> MallInfo2;
}

/// Returns the number of bytes that Rust, C and C++ have allocated and not freed in this process.
pub(crate) fn allocated_bytes() -> usize {
    // SAFETY: no precondition.
    let info = unsafe { mallinfo2() };
    info.hblkhd + info.uordblks
}

/// Returns the number of allocations of `action` on this thread, and its result.
pub(crate) fn allocations<T>(action: impl FnOnce() -> T) -> (usize, T) {
    let before = COUNT.get();
    let result = action();
    (COUNT.get() - before, result)
}
