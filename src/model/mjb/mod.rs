//! Validation of binary models (MJB), which are untrusted input.
//!
//! `mj_loadModel` trusts the file. Its own validation checks the ranges of most references, but it
//! allows -1 for all of them, checks no enum, does not compare the sizes with the arrays that
//! depend on them, and reads out of bounds itself. A single flipped bit caused a segmentation fault
//! in `mj_step`. This module therefore checks every value that the engine, or an accessor of this
//! crate, uses as an index, a count, an address, an enum or a size of memory. Values that follow
//! from the rest of the file, which include most of the kinematic tree, are recomputed and
//! compared.
//!
//! A model that the engine compiled from XML passes through the same check (`Model::validate`). The
//! check rejects settings that the compiler accepts although no program needs them: a time step
//! that is not positive, more than a million iterations, or a fixed tendon with the same joint
//! twice, on which the engine writes out of bounds.
//!
//! Floating-point fields may have any value, including NaN, because the engine uses them without
//! memory errors. The exceptions encode an id (the side site in `wrap_prm`), control how the engine
//! iterates over an array (`hfield_size`, `mesh_vert`), or are the time step.
//!
//! The file has header integers, the sizes, the memory images of `mjOption`, `mjVisual` and
//! `mjStatistic`, then the arrays without padding in the order of the engine's X-macros. The build
//! script generates the table of the arrays. Each engine version has another layout; the counts in
//! the header distinguish them, and since 3.0 the version is one of the header integers.
//!
//! The module has the rules for MuJoCo 2.2.2 and 3.5.0. `newer` contains those for values that
//! 2.2.2 does not have. Binary models of 3.5.0 must not have flexes, plugins, signed distance
//! fields and tactile sensors: the rules are not known for the first three, and the engine reads
//! beyond its arrays for a tactile sensor in contact with a flex.
#![allow(non_upper_case_globals, reason = "the engine's constants, in patterns")]

mod asset;
mod custom;
mod geom;
mod invalid;
mod layout;
#[cfg(engine_since = "3.5.0")]
mod newer;
mod rule;
mod sensor;
mod settings;
mod transmission;
mod tree;
mod view;

pub(crate) use invalid::Invalid;

use super::Model;
use view::View;

/// Checks that a binary model from any source is safe to load, to simulate and to read.
///
/// Two conditions depend on the simulation and are checked there: a model with an adhesive actuator
/// must not be stepped after the warning that the constraint buffer is full (see
/// `transmission::adhesion`), and the option `multiccd` must not be enabled for some meshes (see
/// `Model::find_unsafe_polygons`).
///
/// # Errors
///
/// The first violation.
pub(crate) fn check(bytes: &[u8]) -> Result<(), Invalid> {
    let view = View::new(bytes)?;
    #[cfg(engine_since = "3.5.0")]
    newer::check_features(&view)?;
    // The order matters: each check may rely on the previous ones.
    settings::check(&view)?;
    tree::check(&view)?;
    geom::check(&view)?;
    asset::check(&view)?;
    geom::check_pairs(&view)?;
    transmission::check(&view)?;
    sensor::check(&view)?;
    #[cfg(engine_since = "3.5.0")]
    newer::check_histories(&view)?;
    custom::check(&view)
}

#[cfg(test)]
mod tests;

impl Model {
    /// Applies the rules for binary models to a model that the engine compiled. Every model that
    /// loads from XML can therefore be saved and loaded as a binary model too, except those with
    /// features that binary models must not have. Returns the reason for a rejection.
    pub(super) fn validate_binary(&self) -> Result<(), String> {
        let bytes = self.to_binary().map_err(|error| error.to_string())?;
        match check(&bytes) {
            Err(error) if !error.is_unsupported() => Err(error.to_string()),
            _ => Ok(()),
        }
    }
}

#[cfg(not(engine_since = "2.3.0"))]
impl Model {
    /// Returns the reason why a compiled model is not supported.
    pub(super) fn validate(&self) -> Result<(), String> {
        self.validate_binary()
    }
}
