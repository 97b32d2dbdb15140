//! Surfaces of revolution about the z-axis: sphere, hemisphere, cylinder, disk and cone.

use super::{Tessellation, Triangles};

/// Generates the unit sphere around the origin, with its poles on the z-axis.
pub(crate) fn sphere(tessellation: Tessellation) -> Triangles {
    let half = half_stacks(tessellation) as i32;
    revolve(tessellation.slices, (-half..=half).map(|stack| meridian(stack, half)))
}

/// Generates the upper half of the unit sphere, without a bottom. A rotation by 180° about the
/// x-axis gives the lower half.
pub(crate) fn hemisphere(tessellation: Tessellation) -> Triangles {
    let half = half_stacks(tessellation) as i32;
    let point =
        |stack| ProfilePoint { v: Texcoord::Latitude(1.0 - stack as f32 / half as f32), ..meridian(stack, half) };
    revolve(tessellation.slices, (0..=half).map(point))
}

/// Returns the number of stacks from the equator to a pole.
fn half_stacks(tessellation: Tessellation) -> u32 {
    (tessellation.stacks / 2).max(1)
}

/// Returns a point of the semicircle from pole to pole. The two halves are bitwise mirror images.
fn meridian(stack: i32, half: i32) -> ProfilePoint {
    let v = Texcoord::Latitude(0.5 - 0.5 * (stack as f32 / half as f32));
    if stack.abs() == half {
        let z = if stack > 0 { 1.0 } else { -1.0 };
        return ProfilePoint { radius: 0.0, z, normal: [0.0, z], v };
    }
    let (sin, cos) = (std::f64::consts::FRAC_PI_2 * f64::from(stack) / f64::from(half)).sin_cos();
    let (radius, z) = (cos as f32, sin as f32);
    ProfilePoint { radius, z, normal: [radius, z], v }
}

/// Generates the lateral surface of the cylinder of radius 1 from z = -1 to 1. A long cylinder
/// requires many stacks because the interpolated depth is less precise in longer triangles.
pub(crate) fn cylinder(slices: u32, stacks: u32) -> Triangles {
    let (slices, stacks) = clamp(slices, stacks);
    let height = |stack| (2.0 * f64::from(stack) / f64::from(stacks) - 1.0) as f32;
    let point = |stack| {
        let z = height(stack);
        ProfilePoint { radius: 1.0, z, normal: [1.0, 0.0], v: Texcoord::Latitude((1.0 - z) / 2.0) }
    };
    revolve(slices, (0..=stacks).map(point))
}

/// Generates the unit disk around the origin with normal +z, of `stacks` rings. A rotation by 180°
/// about the x-axis reverses the normal.
pub(crate) fn disk(slices: u32, stacks: u32) -> Triangles {
    let (slices, stacks) = clamp(slices, stacks);
    let radius = |stack| (f64::from(stack) / f64::from(stacks)) as f32;
    let point = |stack| ProfilePoint { radius: radius(stack), z: 0.0, normal: [0.0, 1.0], v: Texcoord::Planar };
    revolve(slices, (0..=stacks).rev().map(point))
}

/// Generates the lateral surface of the cone with its base, of radius 1, at z = 0 and its tip at
/// z = 1.
pub(crate) fn cone(slices: u32, stacks: u32) -> Triangles {
    /// Radial and axial component of the normal.
    const SLOPE: f32 = std::f32::consts::FRAC_1_SQRT_2;
    let (slices, stacks) = clamp(slices, stacks);
    let mut triangles = Triangles::default();
    // Rings of vertices from the base upwards. The tip has one vertex per slice, because the
    // normals differ.
    for stack in 0..stacks {
        let z = (f64::from(stack) / f64::from(stacks)) as f32;
        for slice in 0..=slices {
            let [cos, sin] = direction(slice % slices, slices);
            let (radius, u) = (1.0 - z, slice as f32 / slices as f32);
            let normal = [cos * SLOPE, sin * SLOPE, SLOPE];
            let vertex = triangles.vertex([cos * radius, sin * radius, z], normal, [u, radius]);
            set_parity(&mut triangles, vertex, [stack, slice], slices);
        }
    }
    for stack in 0..stacks {
        for slice in 0..slices {
            let next = slice + 1;
            let (below, above) = (stack * (slices + 1), (stack + 1) * (slices + 1));
            if stack + 1 < stacks {
                triangles.quad([below + slice, below + next, above + next, above + slice]);
            } else {
                let [cos, sin] = direction(2 * slice + 1, 2 * slices);
                let u = (slice as f32 + 0.5) / slices as f32;
                let tip = triangles.vertex([0.0, 0.0, 1.0], [cos * SLOPE, sin * SLOPE, SLOPE], [u, 0.0]);
                triangles.indices.extend([below + slice, below + next, tip]);
            }
        }
    }
    triangles
}

fn clamp(slices: u32, stacks: u32) -> (u32, u32) {
    (slices.clamp(3, Tessellation::MAX), stacks.clamp(1, Tessellation::MAX))
}

/// Point of a profile curve, with the normal as (radial, axial) components.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ProfilePoint {
    radius: f32,
    z: f32,
    normal: [f32; 2],
    v: Texcoord,
}

/// Texture coordinates of the vertices of a profile point.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Texcoord {
    /// The first coordinate is the angle about the axis, from 0 to 1, and this is the second.
    Latitude(f32),
    /// Both are x and y, from 0 to 1.
    Planar,
}

/// Revolves a profile curve about the z-axis. In the half-plane with the radius to the right and z
/// upwards, the outside is to the right of the direction of the curve: the profile of a cylinder
/// goes upwards. The first and the last vertex of a circle coincide, with different texture
/// coordinates, as do all vertices of a point on the axis.
fn revolve(slices: u32, profile: impl IntoIterator<Item = ProfilePoint>) -> Triangles {
    let mut triangles = Triangles::default();
    let mut previous: Option<Ring> = None;
    for (stack, point) in (0..).zip(profile) {
        let ring = Ring::new(&mut triangles, slices, stack, point);
        if let Some(previous) = previous {
            for slice in 0..slices {
                let [a, b] = [slice, slice + 1].map(|slice| previous.vertex(slice));
                let [c, d] = [slice + 1, slice].map(|slice| ring.vertex(slice));
                match (previous, ring) {
                    (Ring::Pole(_), Ring::Pole(_)) => {}
                    (Ring::Pole(_), Ring::Circle(_)) => triangles.indices.extend([a, c, d]),
                    (Ring::Circle(_), Ring::Pole(_)) => triangles.indices.extend([a, b, d]),
                    (Ring::Circle(_), Ring::Circle(_)) => triangles.quad([a, b, c, d]),
                }
            }
        }
        previous = Some(ring);
    }
    triangles
}

/// Vertices of a profile point: index of the first vertex. A pole has a vertex for each slice, a
/// circle one more.
#[derive(Clone, Copy)]
enum Ring {
    Pole(u32),
    Circle(u32),
}

impl Ring {
    fn new(triangles: &mut Triangles, slices: u32, stack: u32, point: ProfilePoint) -> Self {
        let ProfilePoint { radius, z, normal: [radial, axial], v } = point;
        let first = triangles.vertices.len() as u32;
        let texcoord = |slice: f32, [x, y]: [f32; 2]| match v {
            Texcoord::Latitude(v) => [slice / slices as f32, v],
            Texcoord::Planar => [0.5 + 0.5 * x, 0.5 + 0.5 * y],
        };
        if radius == 0.0 {
            for slice in 0..slices {
                triangles.vertex([0.0, 0.0, z], [radial, 0.0, axial], texcoord(slice as f32 + 0.5, [0.0; 2]));
            }
            return Self::Pole(first);
        }
        for slice in 0..=slices {
            let [cos, sin] = direction(slice % slices, slices);
            let (x, y) = (cos * radius, sin * radius);
            let vertex =
                triangles.vertex([x, y, z], [cos * radial, sin * radial, axial], texcoord(slice as f32, [x, y]));
            set_parity(triangles, vertex, [stack, slice], slices);
        }
        Self::Circle(first)
    }

    fn vertex(self, slice: u32) -> u32 {
        let (Self::Pole(first) | Self::Circle(first)) = self;
        first + slice
    }
}

/// Sets the parity of a vertex in a ring. A ring of an odd number of slices has no alternating
/// parities; its diagonals remain visible.
fn set_parity(triangles: &mut Triangles, vertex: u32, position: [u32; 2], slices: u32) {
    if slices.is_multiple_of(2) {
        triangles.set_parity(vertex, position);
    }
}

/// Returns the cosine and sine of a vertex of a regular polygon. The lower half is the bitwise
/// mirror image of the upper half, so that shapes rotated by 180° about the x-axis fit others
/// without gaps.
fn direction(slice: u32, slices: u32) -> [f32; 2] {
    if 2 * slice > slices {
        let [cos, sin] = direction(slices - slice, slices);
        return [cos, -sin];
    }
    if 2 * slice == slices {
        return [-1.0, 0.0];
    }
    let (sin, cos) = (std::f64::consts::TAU * f64::from(slice) / f64::from(slices)).sin_cos();
    [cos as f32, sin as f32]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::test_support::{
        area, assert_closed, assert_normals_agree, border_edges, tessellations, transformed, volume,
    };
    use super::{Tessellation, cone, cylinder, disk, half_stacks, hemisphere, sphere};

    /// Returns the area of a regular polygon with circumradius 1.
    fn polygon_area(slices: u32) -> f64 {
        f64::from(slices) / 2.0 * (2.0 * PI / f64::from(slices)).sin()
    }

    /// Returns the volume of the hemispherical polyhedron: frusta between the rings, whose
    /// cross-sections are regular polygons.
    fn hemisphere_volume(tessellation: Tessellation) -> f64 {
        let half = half_stacks(tessellation);
        let ring = |stack: u32| (PI / 2.0 * f64::from(stack) / f64::from(half)).sin_cos();
        (0..half)
            .map(|stack| {
                let ((z0, r0), (z1, r1)) = (ring(stack), ring(stack + 1));
                polygon_area(tessellation.slices) * (z1 - z0) / 3.0 * (r0 * r0 + r0 * r1 + r1 * r1)
            })
            .sum()
    }

    #[test]
    fn a_sphere_is_closed_and_has_its_volume() {
        for tessellation in tessellations() {
            let sphere = sphere(tessellation);
            assert_closed(&[&sphere]);
            assert!((volume(&[&sphere]) - 2.0 * hemisphere_volume(tessellation)).abs() < 1e-5, "{tessellation:?}");
            assert_normals_agree(&sphere, 0.2);
            for vertex in &sphere.vertices {
                assert_eq!(vertex.position, vertex.normal);
            }
        }
        let round = Tessellation::new(256, 256, 1);
        assert!((volume(&[&sphere(round)]) / (4.0 / 3.0 * PI) - 1.0).abs() < 3e-4);
    }

    #[test]
    fn a_hemisphere_fits_a_disk_and_its_mirror_image() {
        for tessellation in tessellations() {
            let top = hemisphere(tessellation);
            let flipped = |triangles: &_| transformed(triangles, |[x, y, z]| [x, -y, -z]);
            let disk = flipped(&disk(tessellation.slices, 1));
            assert_closed(&[&top, &disk]);
            assert_closed(&[&top, &flipped(&top)]);
            assert!((volume(&[&top, &disk]) - hemisphere_volume(tessellation)).abs() < 1e-5);
        }
    }

    #[test]
    fn a_cylinder_with_its_ends_is_closed_and_has_its_volume() {
        for (slices, stacks) in [(3, 1), (4, 2), (7, 3), (28, 16)] {
            let (side, end) = (cylinder(slices, stacks), disk(slices, 2));
            let ends = (transformed(&end, |[x, y, _]| [x, y, 1.0]), transformed(&end, |[x, y, _]| [x, -y, -1.0]));
            assert_closed(&[&side, &ends.0, &ends.1]);
            assert_normals_agree(&side, 0.4);
            assert!((volume(&[&side, &ends.0, &ends.1]) - 2.0 * polygon_area(slices)).abs() < 1e-5);
        }
    }

    #[test]
    fn a_capsule_is_closed() {
        for slices in [3, 5, 28, 29] {
            let (side, half) = (cylinder(slices, 3), hemisphere(Tessellation::new(slices as usize, 8, 1)));
            let above = transformed(&half, |[x, y, z]| [x, y, z + 1.0]);
            let below = transformed(&half, |[x, y, z]| [x, -y, -(z + 1.0)]);
            assert_closed(&[&side, &above, &below]);
        }
    }

    #[test]
    fn a_disk_is_a_polygon_with_normal_z() {
        for (slices, stacks) in [(3, 1), (6, 3), (28, 8)] {
            let disk = disk(slices, stacks);
            assert_eq!(border_edges(&disk), slices as usize);
            assert_normals_agree(&disk, 1.0);
            assert!(disk.vertices.iter().all(|vertex| vertex.normal == [0.0, 0.0, 1.0]));
            assert!((area(&disk) - polygon_area(slices)).abs() < 1e-5);
        }
    }

    #[test]
    fn a_cone_with_its_base_is_closed_and_has_its_volume() {
        for (slices, stacks) in [(3, 1), (5, 2), (28, 16)] {
            let (side, base) = (cone(slices, stacks), transformed(&disk(slices, 3), |[x, y, _]| [x, -y, 0.0]));
            assert_closed(&[&side, &base]);
            assert_normals_agree(&side, 0.4);
            assert!((volume(&[&side, &base]) - polygon_area(slices) / 3.0).abs() < 1e-5);
        }
    }
}
