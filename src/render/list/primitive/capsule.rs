//! A capsule: the side of a cylinder and two halves of a sphere.

use super::{Part, side};
use crate::render::content::Round;

pub(super) fn parts(size: [f32; 3], round: impl Fn(Round) -> u32) -> [Part; 3] {
    let [x, y, z] = size;
    let cap = Part::new(round(Round::Hemisphere), [x, y, x.midpoint(y)]);
    let (top, bottom) = (cap.shifted(z).lifted(1.0), cap.turned().shifted(-z).lifted(-1.0));
    [side(size, round), top, bottom]
}
