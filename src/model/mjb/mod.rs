//! Binary models (MJB) as untrusted input: a look at the bytes before the engine sees them.
//!
//! `mj_loadModel` believes what it reads. Its own validation covers the ranges of most references, but allows -1 for all of
//! them, looks at no enum, follows no size into the arrays it belongs to, and itself reads out of bounds. One flipped bit
//! was enough for a segmentation fault in `mj_step`. So everything that the engine, or an accessor of this crate, uses as
//! an index, a count, an address, an enum or a size of memory is checked here, and where it follows from the rest of the
//! file (most of the kinematic tree does) it is computed again and compared.
//!
//! A model that the engine compiled from XML passes through the same check (`Model::validate`). It rejects settings that the
//! compiler accepts and that no program wants: a time step that is not positive, more than a million iterations, a fixed tendon
//! with the same joint twice, on which the engine writes out of bounds.
//!
//! Real numbers may have any value: the engine's use of them is free of memory errors, be they NaN. The exceptions are
//! those that serve as something else (a side site in `wrap_prm`), those that decide how the engine steps through an array
//! (`hfield_size`, `mesh_vert`), and the time step.
//!
//! The layout is that of MuJoCo 2.2.2: four header integers, the sizes, `mjOption`, `mjVisual` and `mjStatistic` as they lie
//! in memory, then the arrays without padding in the order of the engine's X-macros. Each version has its own, and the
//! header's counts tell them apart.
#![allow(non_upper_case_globals, reason = "the engine's constants, in patterns")]

mod actuator;
mod asset;
mod contact;
mod custom;
mod equality;
mod geom;
mod graph;
mod invalid;
mod layout;
mod mesh;
mod name;
mod option;
mod rule;
mod sensor;
mod size;
mod skin;
mod tendon;
mod tree;
mod view;

pub(crate) use invalid::Invalid;
pub(crate) use view::length;

use view::View;

/// Checks that a binary model of whatever origin is safe to load, to simulate and to read.
///
/// One thing depends on the simulation and is left to it: a model with an adhesive actuator must not go on after the warning
/// that the constraint buffer is full (see `actuator`).
///
/// # Errors
///
/// The first thing that is wrong.
pub(crate) fn check(bytes: &[u8]) -> Result<(), Invalid> {
    let view = View::new(bytes)?;
    // Each of these may rely on those before it.
    size::check(&view)?;
    option::check(&view)?;
    tree::check(&view)?;
    geom::check(&view)?;
    mesh::check(&view)?;
    graph::check(&view)?;
    skin::check(&view)?;
    asset::check(&view)?;
    contact::check(&view)?;
    equality::check(&view)?;
    tendon::check(&view)?;
    actuator::check(&view)?;
    sensor::check(&view)?;
    custom::check(&view)?;
    name::check(&view)
}

#[cfg(test)]
mod tests;
