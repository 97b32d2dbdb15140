//! Accessors of the 450 arrays and sizes of `mjModel` and `mjData`, with the engine's names.
//!
//! The accessors are generated: `mujoco-sys` expands the engine's `mjxmacro.h` into a table (type,
//! rows, columns, comment), and `cargo xtask generate` converts each line of the table into a
//! documented method. An array with one column becomes a slice, with a fixed number of columns a
//! slice of arrays, and with a number of columns determined by the model a
//! [`MatrixView`](crate::MatrixView). The files here are those of 2.2.2; for other versions the
//! build script generates them. Floating-point arrays are writable, because the engine stays within
//! its memory for any value, except for three arrays that `build/accessors.rs` lists. Integers are
//! sizes, addresses and ids that the engine trusts, so they are read-only.
//!
//! Structured members have typed accessors elsewhere: [`Model::options`], [`Model::visual`],
//! [`Model::statistics`], [`Data::warning`], [`Data::timer`], [`Data::solver`].
//!
//! [`Model::options`]: crate::Model::options
//! [`Model::visual`]: crate::Model::visual
//! [`Model::statistics`]: crate::Model::statistics
//! [`Data::warning`]: crate::Data::warning
//! [`Data::timer`]: crate::Data::timer
//! [`Data::solver`]: crate::Data::solver
//!
//! `restore.rs` copies the editable arrays from one model to another of the same structure, and
//! clears a simulation. `values.rs` lists the values that are not in arrays. `numbers.rs` reads and
//! writes single numbers of arrays by name.
//!
//! Newer engines allocate the arrays of constraints again in each computation. Their accessors are
//! empty until the engine has written them (`build/arena.rs`).
//!
//! A getter of any other array of `mjData` is unchecked. Its documentation names the call that
//! computes the array, from the table in `build/computed_by.rs`, and the argument of
//! [`Data::require`](crate::Data::require) that checks for the result.

#![allow(non_snake_case, reason = "qM, efc_J, nD: the engine's own spelling, which users search for")]

#[cfg(not(engine_since = "2.3.0"))]
mod data;
#[cfg(not(engine_since = "2.3.0"))]
mod model;
#[cfg(not(engine_since = "2.3.0"))]
mod model_mut;
#[cfg(not(engine_since = "2.3.0"))]
mod numbers;
#[cfg(not(engine_since = "2.3.0"))]
mod restore;
#[cfg(not(engine_since = "2.3.0"))]
mod values;

/// Includes a file that the build script has generated for another version of the engine.
#[cfg(engine_since = "2.3.0")]
macro_rules! generated {
    ($($name:ident in $file:literal;)*) => {
        $(
        #[allow(unused_imports, unused_braces, reason = "the table of some engines does not need them")]
        mod $name {
            include!(concat!(env!("OUT_DIR"), "/", $file));
        }
        )*
    };
}

#[cfg(engine_since = "2.3.0")]
generated! {
    data in "data.rs";
    model in "model.rs";
    model_mut in "model_mut.rs";
    numbers in "numbers.rs";
    restore in "restore.rs";
    values in "values.rs";
}

pub(crate) use values::{model_settings, model_sizes};
