//! The side of a cylinder.

use super::lathe::{Profile, turn};
use super::{Detail, Triangles};

/// The side of the cylinder of radius 1 from z = -1 to 1. A long one wants many stacks, for the depth of a point within a
/// triangle is the less precise the longer the triangle is.
pub(crate) fn cylinder(slices: u32, stacks: u32) -> Triangles {
    let (slices, stacks) = (slices.clamp(3, Detail::MOST), stacks.clamp(1, Detail::MOST));
    let height = |stack| (2.0 * f64::from(stack) / f64::from(stacks) - 1.0) as f32;
    turn(slices, (0..=stacks).map(|stack| Profile { radius: 1.0, z: height(stack), normal: [1.0, 0.0] }))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::check::{assert_closed, assert_normals_agree, placed, volume};
    use super::super::{Detail, disk, hemisphere};
    use super::cylinder;

    #[test]
    fn a_cylinder_with_its_ends_is_closed_and_has_its_volume() {
        for (slices, stacks) in [(3, 1), (4, 2), (7, 3), (28, 16)] {
            let (side, end) = (cylinder(slices, stacks), disk(slices, 2));
            let ends = (placed(&end, |[x, y, _]| [x, y, 1.0]), placed(&end, |[x, y, _]| [x, -y, -1.0]));
            assert_closed(&[&side, &ends.0, &ends.1]);
            assert_normals_agree(&side, 0.4);
            let polygon = f64::from(slices) / 2.0 * (2.0 * PI / f64::from(slices)).sin();
            assert!((volume(&[&side, &ends.0, &ends.1]) - 2.0 * polygon).abs() < 1e-5);
        }
    }

    #[test]
    fn a_capsule_is_closed() {
        for slices in [3, 5, 28, 29] {
            let (side, half) = (cylinder(slices, 3), hemisphere(Detail::new(slices as usize, 8, 1)));
            let above = placed(&half, |[x, y, z]| [x, y, z + 1.0]);
            let below = placed(&half, |[x, y, z]| [x, -y, -(z + 1.0)]);
            assert_closed(&[&side, &above, &below]);
        }
    }
}
