//! Pairs of bodies whose geoms do not collide.

use super::View;
use crate::id::{BodyId, Id, kind};
use crate::model::Model;

fields!(Exclude on Model {
    /// Both bodies in one number, by which the engine looks the pair up.
    signature: i32 = exclude_signature;
    /// One of the bodies.
    body1: {BodyId} = |exclude| Id::new((exclude.signature().cast_unsigned() >> 16) as usize - 1, exclude.owner.lineage());
    /// The other body.
    body2: {BodyId} = |exclude| Id::new((exclude.signature().cast_unsigned() & 0xFFFF) as usize - 1, exclude.owner.lineage());
});
