//! A disk.

use super::lathe::{Profile, turn};
use super::{Detail, Triangles};

/// The disk of radius 1 around the origin, facing along z, of `stacks` rings. The one that faces down is this one turned about
/// the x-axis.
pub(crate) fn disk(slices: u32, stacks: u32) -> Triangles {
    let (slices, stacks) = (slices.clamp(3, Detail::MOST), stacks.clamp(1, Detail::MOST));
    let radius = |stack| (f64::from(stack) / f64::from(stacks)) as f32;
    turn(slices, (0..=stacks).rev().map(|stack| Profile { radius: radius(stack), z: 0.0, normal: [0.0, 1.0] }))
}

#[cfg(test)]
mod tests {
    use super::super::check::{area, assert_normals_agree, border};
    use super::disk;

    #[test]
    fn a_disk_is_a_polygon_that_faces_upwards() {
        for (slices, stacks) in [(3, 1), (6, 3), (28, 8)] {
            let disk = disk(slices, stacks);
            assert_eq!(border(&disk), slices as usize);
            assert_normals_agree(&disk, 1.0);
            assert!(disk.vertices.iter().all(|vertex| vertex.normal == [0.0, 0.0, 1.0]));
            let angle = std::f64::consts::TAU / f64::from(slices);
            assert!((area(&disk) - f64::from(slices) / 2.0 * angle.sin()).abs() < 1e-5);
        }
    }
}
