//! Reads and overwrites every value of every generated accessor. Under memcheck, this detects
//! uninitialised memory and accesses outside of the engine's memory.

use std::hint::black_box;

use mujoco_safe::{Data, MatrixView, MatrixViewMut, Model, ModelMut};

#[macro_use]
#[path = "fields.rs"]
mod fields;

/// The return type of an accessor.
trait Touch: Sized {
    /// Returns the number of nonzero values.
    fn touch(self) -> usize;

    /// Overwrites every value with a result of the function, if the accessor is mutable.
    fn write(self, _: &mut dyn FnMut() -> f64) {}
}

/// Types of elements of the engine's arrays.
trait Number: PartialEq + Default + Copy {
    fn from_f64(value: f64) -> Self;
}

macro_rules! numbers {
    ($($type:ty)*) => {$(
        impl Number for $type {
            fn from_f64(value: f64) -> Self {
                value as Self
            }
        }
    )*};
}
numbers!(f64 f32 i32 i64 u8);

/// Branches on the value, because memcheck reports uninitialised values in branches.
#[inline(never)]
#[allow(clippy::bool_to_int_with_if, reason = "memcheck reports branches, not conversions")]
fn branch<T: PartialEq + Default>(value: T) -> usize {
    if black_box(value) == T::default() { 0 } else { 1 }
}

impl Touch for usize {
    fn touch(self) -> usize {
        branch(self)
    }
}

impl Touch for bool {
    fn touch(self) -> usize {
        branch(self)
    }
}

impl Touch for f64 {
    fn touch(self) -> usize {
        branch(self)
    }
}

impl<T: Number> Touch for &[T] {
    fn touch(self) -> usize {
        self.iter().map(|&value| branch(value)).sum()
    }
}

impl<T: Number, const N: usize> Touch for &[[T; N]] {
    fn touch(self) -> usize {
        self.as_flattened().touch()
    }
}

impl Touch for MatrixView<'_> {
    fn touch(self) -> usize {
        self.as_slice().touch()
    }
}

impl<T: Number> Touch for &mut [T] {
    fn touch(self) -> usize {
        for value in self.iter_mut() {
            *value = black_box(*value);
        }
        self.len()
    }

    fn write(self, value: &mut dyn FnMut() -> f64) {
        for number in self {
            *number = T::from_f64(value());
        }
    }
}

impl<T: Number, const N: usize> Touch for &mut [[T; N]] {
    fn touch(self) -> usize {
        self.as_flattened_mut().touch()
    }

    fn write(self, value: &mut dyn FnMut() -> f64) {
        self.as_flattened_mut().write(value);
    }
}

impl Touch for MatrixViewMut<'_> {
    fn touch(mut self) -> usize {
        self.as_mut_slice().touch()
    }

    fn write(mut self, value: &mut dyn FnMut() -> f64) {
        self.as_mut_slice().write(value);
    }
}

/// Defines a function that reads the results of all accessors.
macro_rules! reading {
    ($(#[$doc:meta])* $function:ident($owner:ty): $($name:ident)*) => {
        $(#[$doc])*
        pub(crate) fn $function(owner: $owner) -> usize {
            [$(owner.$name().touch()),*].iter().sum()
        }
    };
}

/// Defines a function that writes to all arrays, a list of the writers' names, and a function that
/// writes to one array of the list.
macro_rules! writing {
    ($(#[$doc:meta])* $function:ident($owner:ty), $list:ident, $write:ident: $($name:ident($field:ident))*) => {
        reading! { $(#[$doc])* $function($owner): $($name)* }

        #[allow(dead_code, reason = "the fuzzer uses it")]
        pub(crate) const $list: &[&str] = &[$(stringify!($name)),*];

        /// Writes to the array at this index of the list.
        #[allow(dead_code, reason = "the fuzzer uses it")]
        pub(crate) fn $write(owner: $owner, index: usize, value: &mut dyn FnMut() -> f64) {
            let mut at = 0;
            $(
                if at == index {
                    return owner.$name().write(value);
                }
                at += 1;
            )*
            panic!("index out of range for {at} arrays");
        }
    };
}

model_readers! { reading
    /// Reads every accessor of a model.
    model(&Model):
}
data_readers! { reading
    /// Reads every accessor of a simulation.
    data(&Data):
}
model_writers! { writing
    /// Writes to all writable arrays of a model.
    model_mut(&mut ModelMut<'_>), MODEL_MUT, write_model:
}
data_writers! { writing
    /// Writes to all writable arrays of a simulation.
    data_mut(&mut Data), DATA_MUT, write_data:
}
