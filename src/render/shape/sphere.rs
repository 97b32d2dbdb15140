//! A sphere, and half of one.

use super::lathe::{Profile, turn};
use super::{Detail, Triangles};

/// The sphere of radius 1 around the origin, with its poles on the z-axis.
pub(crate) fn sphere(detail: Detail) -> Triangles {
    let half = half(detail) as i32;
    turn(detail.slices, (-half..=half).map(|stack| point(stack, half)))
}

/// The upper half of that sphere, without a bottom. The lower half is this one turned about the x-axis.
pub(crate) fn hemisphere(detail: Detail) -> Triangles {
    let half = half(detail) as i32;
    turn(detail.slices, (0..=half).map(|stack| point(stack, half)))
}

/// Stacks from the equator to a pole.
fn half(detail: Detail) -> u32 {
    (detail.stacks / 2).max(1)
}

/// A point of the half circle from pole to pole. Above and below the equator it is the same to the last bit.
fn point(stack: i32, half: i32) -> Profile {
    if stack.abs() == half {
        let z = if stack > 0 { 1.0 } else { -1.0 };
        return Profile { radius: 0.0, z, normal: [0.0, z] };
    }
    let (sin, cos) = (std::f64::consts::FRAC_PI_2 * f64::from(stack) / f64::from(half)).sin_cos();
    let (radius, z) = (cos as f32, sin as f32);
    Profile { radius, z, normal: [radius, z] }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::check::{assert_closed, assert_normals_agree, details, placed, volume};
    use super::super::disk;
    use super::{Detail, half, hemisphere, sphere};

    /// That of the polyhedron: the frusta between the rings, whose cross-sections are regular polygons.
    fn expected(detail: Detail) -> f64 {
        let (slices, half) = (f64::from(detail.slices), half(detail));
        let ring = |stack: u32| (PI / 2.0 * f64::from(stack) / f64::from(half)).sin_cos();
        let polygon = slices / 2.0 * (2.0 * PI / slices).sin();
        (0..half)
            .map(|stack| {
                let ((z0, r0), (z1, r1)) = (ring(stack), ring(stack + 1));
                polygon * (z1 - z0) / 3.0 * (r0 * r0 + r0 * r1 + r1 * r1)
            })
            .sum()
    }

    #[test]
    fn a_sphere_is_closed_and_has_its_volume() {
        for detail in details() {
            let sphere = sphere(detail);
            assert_closed(&[&sphere]);
            assert!((volume(&[&sphere]) - 2.0 * expected(detail)).abs() < 1e-5, "{detail:?}");
            assert_normals_agree(&sphere, 0.2);
            for vertex in &sphere.vertices {
                assert_eq!(vertex.position, vertex.normal);
            }
        }
        let round = Detail::new(256, 256, 1);
        assert!((volume(&[&sphere(round)]) / (4.0 / 3.0 * PI) - 1.0).abs() < 3e-4);
    }

    #[test]
    fn a_hemisphere_fits_a_disk_and_its_own_mirror_image() {
        for detail in details() {
            let top = hemisphere(detail);
            let under = |triangles: &_| placed(triangles, |[x, y, z]| [x, -y, -z]);
            assert_closed(&[&top, &under(&disk(detail.slices, 1))]);
            assert_closed(&[&top, &under(&top)]);
            assert!((volume(&[&top, &under(&disk(detail.slices, 1))]) - expected(detail)).abs() < 1e-5);
        }
    }
}
