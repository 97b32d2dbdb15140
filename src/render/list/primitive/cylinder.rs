//! A cylinder: its side and two disks.

use super::{Part, side};
use crate::render::content::Round;

pub(super) fn parts(size: [f32; 3], round: impl Fn(Round) -> u32) -> [Part; 3] {
    let [x, y, z] = size;
    let end = Part::new(round(Round::Disk), [x, y, z]);
    let (top, bottom) = (end.shifted(z).lifted(1.0), end.turned().shifted(-z).lifted(-1.0));
    [side(size, round), top, bottom]
}
