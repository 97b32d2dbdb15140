//! Reads, and writes back, every number behind every generated accessor: under memcheck, whatever is not initialised or lies
//! outside of the engine's memory is found.

use std::hint::black_box;

use mujoco_safe::{Data, MatrixView, MatrixViewMut, Model, ModelMut};

#[macro_use]
#[path = "fields.rs"]
mod fields;

/// Something that an accessor returns.
trait Touch {
    /// How many of its numbers are not zero.
    fn touch(self) -> usize;
}

/// What the engine's arrays are made of.
trait Number: PartialEq + Default + Copy {}

impl Number for f64 {}
impl Number for f32 {}
impl Number for i32 {}
impl Number for u8 {}

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
}

impl<T: Number, const N: usize> Touch for &mut [[T; N]] {
    fn touch(self) -> usize {
        self.as_flattened_mut().touch()
    }
}

impl Touch for MatrixViewMut<'_> {
    fn touch(mut self) -> usize {
        self.as_mut_slice().touch()
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

/// A function that writes to all of it.
macro_rules! writing {
    ($(#[$doc:meta])* $function:ident($owner:ty): $($name:ident($field:ident))*) => {
        reading! { $(#[$doc])* $function($owner): $($name)* }
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
    model_mut(&mut ModelMut<'_>):
}
data_writers! { writing
    /// Writes to all that may be written to in a simulation.
    data_mut(&mut Data):
}
