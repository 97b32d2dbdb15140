//! A sphere, or an ellipsoid.

use super::Part;
use crate::render::content::Round;

pub(super) fn part(size: [f32; 3], round: impl Fn(Round) -> u32) -> Part {
    Part::new(round(Round::Sphere), size)
}
