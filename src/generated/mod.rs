//! One accessor for each array and size of `mjModel` and `mjData`, under the engine's own name.
//!
//! They are generated because there are 450 of them and the engine describes them itself: `mujoco-sys` expands the engine's
//! `mjxmacro.h` into a table (type, rows, columns, comment), and `generator.rs` turns each line of the table into a documented
//! method. One column gives a slice, a fixed number of columns a slice of arrays, a number that the model decides a
//! [`MatrixView`](crate::MatrixView). Real numbers may be written to: whatever is in them, the engine stays within its memory
//! (save the three arrays that the generator lists). Integers are sizes, addresses and ids, which it trusts, so they are
//! read-only.
//!
//! What lies in the structs themselves and is no plain number has a typed accessor elsewhere: [`Model::options`],
//! [`Model::visual`], [`Model::statistics`], [`Data::warning`], [`Data::timer`], [`Data::solver`].
//!
//! [`Model::options`]: crate::Model::options
//! [`Model::visual`]: crate::Model::visual
//! [`Model::statistics`]: crate::Model::statistics
//! [`Data::warning`]: crate::Data::warning
//! [`Data::timer`]: crate::Data::timer
//! [`Data::solver`]: crate::Data::solver
//!
//! `restore.rs` copies what an edit can have changed from one model to another of the same structure,
//! and clears a simulation.
//!
//! A getter of an array of `mjData` checks nothing. Its documentation names the call that computes the array, from the table in
//! `computed_by.rs`, and the argument of [`Data::require`](crate::Data::require) that checks for it.
//!
//! The test `coverage` compares the files with the output of the generator: `UPDATE_GENERATED=1 cargo test --test coverage` writes
//! them.

#![allow(non_snake_case, reason = "qM, efc_J, nD: the engine's own spelling, which is what users search for")]

mod data;
mod model;
mod model_mut;
mod restore;
