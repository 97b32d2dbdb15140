//! Reads, and writes back, every number behind every generated accessor: under memcheck, whatever is not initialised or lies
//! outside of the engine's memory is found.

use std::hint::black_box;

use mujoco_safe::{Data, MatrixView, MatrixViewMut, Model, ModelMut};

#[macro_use]
#[path = "fields.rs"]
mod fields;

/// Something that an accessor returns.
trait Touch: Sized {
    /// How many of its numbers are not zero.
    fn touch(self) -> usize;

    /// Gives every number the value of the function, if it may be written to.
    fn write(self, _: &mut dyn FnMut() -> f64) {}
}

/// What the engine's arrays are made of.
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
numbers!(f64 f32 i32 u8);

/// A jump that depends on the value, which is what memcheck looks at.
#[inline(never)]
#[allow(clippy::bool_to_int_with_if, reason = "a conversion is no jump, and memcheck would say nothing")]
fn look<T: PartialEq + Default>(value: T) -> usize {
    if black_box(value) == T::default() { 0 } else { 1 }
}

impl Touch for usize {
    fn touch(self) -> usize {
        look(self)
    }
}

impl Touch for f64 {
    fn touch(self) -> usize {
        look(self)
    }
}

impl<T: Number> Touch for &[T] {
    fn touch(self) -> usize {
        self.iter().map(|&value| look(value)).sum()
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

/// A function that reads all of what the accessors return.
macro_rules! reading {
    ($(#[$doc:meta])* $function:ident($owner:ty): $($name:ident)*) => {
        $(#[$doc])*
        pub(crate) fn $function(owner: $owner) -> usize {
            [$(owner.$name().touch()),*].iter().sum()
        }
    };
}

/// A function that writes to all of it, the list of their names, and a function that writes to the one of an index.
macro_rules! writing {
    ($(#[$doc:meta])* $function:ident($owner:ty), $list:ident, $write:ident: $($name:ident($field:ident))*) => {
        reading! { $(#[$doc])* $function($owner): $($name)* }

        #[allow(dead_code, reason = "included by several tests, of which one writes")]
        pub(crate) const $list: &[&str] = &[$(stringify!($name)),*];

        /// Writes to the array that is at this place of the list.
        #[allow(dead_code, reason = "idem")]
        pub(crate) fn $write(owner: $owner, index: usize, value: &mut dyn FnMut() -> f64) {
            let mut at = 0;
            $(
                if at == index {
                    return owner.$name().write(value);
                }
                at += 1;
            )*
            panic!("there are only {at} arrays");
        }
    };
}

model_readers! { reading
    /// Reads all of a model.
    model(&Model):
}
data_readers! { reading
    /// Reads all of a simulation.
    data(&Data):
}
model_writers! { writing
    /// Writes to all that may be written to in a model.
    model_mut(&mut ModelMut<'_>), MODEL_MUT, write_model:
}
data_writers! { writing
    /// Writes to all that may be written to in a simulation.
    data_mut(&mut Data), DATA_MUT, write_data:
}
