//! The shapes of each primitive meet where they should.

use super::{Part, arrow, capsule, cylinder};
use crate::render::content::Round;

/// From where to where a part reaches along z, if its shape reaches so far.
fn reach(part: &Part, shape: [f32; 2]) -> [f32; 2] {
    let ends = shape.map(|end| part.shift + part.scale[2] * end);
    [ends[0].min(ends[1]), ends[0].max(ends[1])]
}

fn round(shape: Round) -> u32 {
    shape as u32
}

#[test]
fn the_caps_of_a_capsule_are_on_its_ends() {
    let [side, top, bottom] = capsule::parts([0.25, 0.25, 2.0], round);
    assert_eq!(reach(&side, [-1.0, 1.0]), [-2.0, 2.0]);
    assert_eq!(reach(&top, [0.0, 1.0]), [2.0, 2.25]);
    assert_eq!(reach(&bottom, [0.0, 1.0]), [-2.25, -2.0]);
}

#[test]
fn the_ends_of_a_cylinder_are_on_its_ends() {
    let [side, top, bottom] = cylinder::parts([0.25, 0.25, 2.0], round);
    assert_eq!(reach(&side, [-1.0, 1.0]), [-2.0, 2.0]);
    assert_eq!((reach(&top, [0.0; 2])[0], reach(&bottom, [0.0; 2])[0]), (2.0, -2.0));
}

#[test]
fn an_arrow_begins_at_the_origin_and_has_no_gap() {
    let [shaft, top, bottom, cone, base] = arrow::parts([0.1, 0.1, 6.0], 1.75, round);
    assert_eq!(reach(&shaft, [-1.0, 1.0]), [0.0, 2.0]);
    assert_eq!((reach(&top, [0.0; 2])[0], reach(&bottom, [0.0; 2])[0]), (2.0, 0.0));
    assert_eq!(reach(&cone, [0.0, 1.0]), [2.0, 3.0]);
    assert_eq!(reach(&base, [0.0; 2])[0], 2.0);
}

#[test]
fn a_double_arrow_reaches_as_far_to_both_sides() {
    let [shaft, up, _, down, _] = arrow::double([0.1, 0.1, 6.0], round);
    assert_eq!(reach(&shaft, [-1.0, 1.0]), [-2.0, 2.0]);
    assert_eq!(reach(&up, [0.0, 1.0]), [2.0, 3.0]);
    assert_eq!(reach(&down, [0.0, 1.0]), [-3.0, -2.0]);
}
