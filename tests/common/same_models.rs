//! Comparison of two compiled models: every array and size of the engine.

#![allow(dead_code, reason = "each program uses only some of the functions")]
#![allow(clippy::disallowed_methods, reason = "the engine's arrays are read without the library")]
#![allow(clippy::cast_lossless, reason = "the same code for all types of numbers")]
#![allow(clippy::needless_pass_by_value, reason = "accessors return values")]

use mujoco_safe::sys::mjModel;
use mujoco_safe::{MatrixView, Model};

/// Numbers of an accessor.
trait Numbers {
    fn numbers(&self) -> Vec<f64>;
}

/// Numbers of the field of the struct. An array has the length of the accessor's.
trait Raw {
    /// # Safety
    ///
    /// A pointer is valid for `length` values.
    unsafe fn numbers(self, length: usize) -> Vec<f64>;
}

macro_rules! values {
    ($($number:ty)*) => {
        $(
            impl Numbers for &[$number] {
                fn numbers(&self) -> Vec<f64> {
                    self.iter().map(|&value| value as f64).collect()
                }
            }

            impl<const N: usize> Numbers for &[[$number; N]] {
                fn numbers(&self) -> Vec<f64> {
                    self.as_flattened().numbers()
                }
            }

            impl Raw for *mut $number {
                unsafe fn numbers(self, length: usize) -> Vec<f64> {
                    if length == 0 {
                        return Vec::new();
                    }
                    // SAFETY: the caller's promise.
                    unsafe { std::slice::from_raw_parts(self, length) }.numbers()
                }
            }

            impl Numbers for [$number] {
                fn numbers(&self) -> Vec<f64> {
                    self.iter().map(|&value| value as f64).collect()
                }
            }
        )*
    };
}
values!(f64 f32 i32 i64 u8);

macro_rules! sizes {
    ($($number:ty)*) => {
        $(
            impl Raw for $number {
                unsafe fn numbers(self, _: usize) -> Vec<f64> {
                    vec![(self as f64).max(0.0)]
                }
            }
        )*
    };
}
sizes!(i32 i64);

impl Numbers for usize {
    fn numbers(&self) -> Vec<f64> {
        vec![*self as f64]
    }
}

impl Numbers for MatrixView<'_> {
    fn numbers(&self) -> Vec<f64> {
        self.as_slice().to_vec()
    }
}

/// A field of both models.
struct Field {
    name: &'static str,
    ours: Vec<f64>,
    theirs: Vec<f64>,
}

/// Adds a field. Inlined for each of the hundreds of fields, it would take the compiler seconds.
#[inline(never)]
unsafe fn push(fields: &mut Vec<Field>, name: &'static str, ours: impl Numbers, theirs: impl Raw, only_sizes: bool) {
    let is_size = name.starts_with('n') && !name.contains('_') || name.starts_with("nuser_");
    if is_size == only_sizes {
        let ours = ours.numbers();
        // SAFETY: the sizes of both models are equal before arrays are read.
        let theirs = unsafe { theirs.numbers(ours.len()) };
        fields.push(Field { name, ours, theirs });
    }
}

macro_rules! fields {
    ($ours:ident, $raw:ident, $only_sizes:ident: $($name:ident)*) => {{
        let mut fields = Vec::new();
        // SAFETY: the fields of a valid model, and equal sizes if arrays are read.
        unsafe { $(push(&mut fields, stringify!($name), $ours.$name(), $raw.$name, $only_sizes);)* }
        fields
    }};
}

fn fields(ours: &Model, raw: &mjModel, only_sizes: bool) -> Vec<Field> {
    model_readers! { fields ours, raw, only_sizes: }
}

/// Returns the fields that differ by more than a relative and absolute tolerance, except the given
/// ones. Each one with an example. If sizes differ, only those.
///
/// # Safety
///
/// The second model is valid.
pub(crate) unsafe fn differences(ours: &Model, theirs: *const mjModel, tolerance: f64, except: &[&str]) -> Vec<String> {
    // SAFETY: the caller's promise.
    let raw = unsafe { &*theirs };
    let mut found = Vec::new();
    // Sizes of buffers follow from the other sizes. The size of the names and their map depend on
    // the names.
    let ignored = ["nnames", "nnames_map", "nbuffer", "npaths", "names_map"];
    for only_sizes in [true, false] {
        for Field { name, ours, theirs } in fields(ours, raw, only_sizes) {
            // Addresses of names and of paths depend on the lengths of these texts.
            let is_address = name.starts_with("name_") || name.ends_with("_pathadr");
            if except.contains(&name) || ignored.contains(&name) || is_address {
                continue;
            }
            let differs = |at: usize| {
                let (a, b) = (ours[at], theirs[at]);
                // The centre of a box is rounded as its size, which is 1e10 for planes.
                let whole = if name == "bvh_aabb" { &ours[at / 6 * 6..][..6] } else { &[a, b][..] };
                let size = whole.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
                !(a == b || (a.is_nan() && b.is_nan()) || (a - b).abs() <= tolerance * (1.0 + size))
            };
            if let Some(at) = (0..ours.len().min(theirs.len())).find(|&at| differs(at)) {
                found.push(format!("{name}[{at}]: {:?} and {:?}", ours[at], theirs[at]));
            }
        }
        if !found.is_empty() {
            break;
        }
    }
    found
}

/// Checks that all fields of two models are equal up to a tolerance.
#[track_caller]
pub(crate) fn assert_same(ours: &Model, theirs: &Model, tolerance: f64, what: &str) {
    // SAFETY: a valid model.
    let found = unsafe { differences(ours, theirs.as_ptr(), tolerance, &[]) };
    assert!(found.is_empty(), "{what}: {found:#?}");
}
