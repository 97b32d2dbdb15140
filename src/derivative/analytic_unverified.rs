//! Replacement of the analytic method for engines other than 2.2.2, with which its formulas have not been compared yet.

use super::TransitionOutputs;
use super::method::{DifferencedTerms, Fallback};
use crate::data::Data;
use crate::error::Result;
use crate::model::Model;

/// Terms that were differenced, or the reason why there is no closed form.
pub(super) type Outcome = std::result::Result<DifferencedTerms, Fallback>;

/// Analytic method without formulas.
#[derive(Debug)]
pub(super) struct Analytic;

/// Returns the reason why a step has no closed form.
pub(super) fn obstacle(_: &Model) -> Option<Fallback> {
    Some(Fallback::EngineVersion)
}

/// Returns true if the rows of C and D of a sensor have a closed form.
pub(super) fn is_sensor_covered(_: &Model, _: usize) -> bool {
    false
}

impl Analytic {
    pub(super) fn new(_: &Model) -> Self {
        Self
    }

    /// Returns the reason why a step has no closed form.
    pub(super) fn linearise(&mut self, _: &mut Data, _: &mut TransitionOutputs<'_>) -> Result<Outcome> {
        Ok(Err(Fallback::EngineVersion))
    }

    /// Returns the flags of the rows of C and D that were written.
    pub(super) fn sensors_in_closed_form(&self) -> &[bool] {
        &[]
    }
}
