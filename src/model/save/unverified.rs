//! Replacement of the checks of saved models for engines other than 2.2.2, whose table of fields they do not cover yet.

use crate::error::{Error, Result, UnsavedField};
use crate::model::Model;

/// Returns an error: the comparison is not supported.
pub(super) fn lost(_: &Model, _: &Model) -> Result<Vec<UnsavedField>> {
    check_supported().map(|()| Vec::new())
}

/// Returns an error: the comparison is not supported.
pub(super) fn check_supported() -> Result<()> {
    let version = crate::built_against();
    Err(Error::Unsupported(format!("the check of saved XML with MuJoCo {version}; save with XmlCheck::Skip")))
}

/// Returns `false`: the comparison is not supported.
pub(super) fn have_same_sizes(_: &Model, _: &Model) -> bool {
    false
}
