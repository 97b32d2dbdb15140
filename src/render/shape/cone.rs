//! The side of a cone.

use super::lathe::direction;
use super::{Detail, Triangles};

/// Both parts of the normal, outwards and upwards.
const SLOPE: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// The side of the cone with its base, of radius 1, at z = 0 and its tip at z = 1.
pub(crate) fn cone(slices: u32, stacks: u32) -> Triangles {
    let (slices, stacks) = (slices.clamp(3, Detail::MOST), stacks.clamp(1, Detail::MOST));
    let mut triangles = Triangles::default();
    // From the base up; each ring of corners but that of the tip, which is at one place with a normal for every slice.
    for stack in 0..stacks {
        let z = (f64::from(stack) / f64::from(stacks)) as f32;
        for slice in 0..slices {
            let [cos, sin] = direction(slice, slices);
            let radius = 1.0 - z;
            triangles.vertex([cos * radius, sin * radius, z], [cos * SLOPE, sin * SLOPE, SLOPE]);
        }
    }
    for stack in 0..stacks {
        for slice in 0..slices {
            let next = (slice + 1) % slices;
            let (below, above) = (stack * slices, (stack + 1) * slices);
            if stack + 1 < stacks {
                triangles.rectangle([below + slice, below + next, above + next, above + slice]);
            } else {
                let [cos, sin] = direction(2 * slice + 1, 2 * slices);
                let tip = triangles.vertex([0.0, 0.0, 1.0], [cos * SLOPE, sin * SLOPE, SLOPE]);
                triangles.indices.extend([below + slice, below + next, tip]);
            }
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::check::{assert_closed, assert_normals_agree, placed, volume};
    use super::super::disk;
    use super::cone;

    #[test]
    fn a_cone_with_its_base_is_closed_and_has_its_volume() {
        for (slices, stacks) in [(3, 1), (5, 2), (28, 16)] {
            let (side, base) = (cone(slices, stacks), placed(&disk(slices, 3), |[x, y, _]| [x, -y, 0.0]));
            assert_closed(&[&side, &base]);
            assert_normals_agree(&side, 0.4);
            let polygon = f64::from(slices) / 2.0 * (2.0 * PI / f64::from(slices)).sin();
            assert!((volume(&[&side, &base]) - polygon / 3.0).abs() < 1e-5);
        }
    }
}
