//! Arrows: a shaft and a wedge, or one at both ends.

use super::Part;
use crate::render::content::Round;

/// By how much the wedge is wider than the shaft.
pub(super) const WEDGE: f32 = 1.75;

/// From the origin along z, for half the length that is given: two thirds of it are shaft, the rest is wedge.
pub(super) fn parts(size: [f32; 3], wedge: f32, round: impl Fn(Round) -> u32) -> [Part; 5] {
    let [x, y, length] = size;
    let sixth = length / 6.0;
    let shaft = [x, y, sixth];
    let end = Part::new(round(Round::Disk), shaft);
    let broad = [wedge * x, wedge * y, sixth];
    [
        Part::new(round(Round::LongSide), shaft).shifted(sixth),
        end.shifted(2.0 * sixth).lifted(1.0),
        end.turned().lifted(-1.0),
        Part::new(round(Round::Cone), broad).shifted(2.0 * sixth),
        Part::new(round(Round::Disk), broad).turned().shifted(2.0 * sixth),
    ]
}

/// Around the origin along z, with a wedge at both ends.
pub(super) fn double(size: [f32; 3], round: impl Fn(Round) -> u32) -> [Part; 5] {
    let [x, y, length] = size;
    let third = length / 3.0;
    let broad = [WEDGE * x, WEDGE * y, third / 2.0];
    let cone = Part::new(round(Round::Cone), broad);
    let base = Part::new(round(Round::Disk), broad);
    [
        Part::new(round(Round::LongSide), [x, y, third]),
        cone.shifted(third),
        base.turned().shifted(third),
        cone.turned().shifted(-third),
        base.shifted(-third),
    ]
}
