//! A profile turned about the z-axis.

use super::Triangles;

/// A point of a profile, and the normal there: distance from the axis, and along the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Profile {
    pub(super) radius: f32,
    pub(super) z: f32,
    pub(super) normal: [f32; 2],
}

/// Turns a profile about the z-axis. It is outside that is to the right of one who walks along it, in the half plane where
/// the radius is to the right and z up: a cylinder's profile goes upwards. Where it meets the axis there is one corner.
pub(super) fn turn(slices: u32, profile: impl IntoIterator<Item = Profile>) -> Triangles {
    let mut triangles = Triangles::default();
    let mut before: Option<Ring> = None;
    for point in profile {
        let ring = Ring::new(&mut triangles, slices, point);
        if let Some(before) = before {
            for slice in 0..slices {
                let next = (slice + 1) % slices;
                let corners = [before.corner(slice), before.corner(next), ring.corner(next), ring.corner(slice)];
                match (before, ring) {
                    (Ring::Pole(_), Ring::Pole(_)) => {}
                    (Ring::Pole(_), Ring::Circle(_)) => triangles.indices.extend([corners[0], corners[2], corners[3]]),
                    (Ring::Circle(_), Ring::Pole(_)) => triangles.indices.extend([corners[0], corners[1], corners[2]]),
                    (Ring::Circle(_), Ring::Circle(_)) => triangles.rectangle(corners),
                }
            }
        }
        before = Some(ring);
    }
    triangles
}

/// The corners that a point of the profile makes: the index of the only or of the first of them.
#[derive(Clone, Copy)]
enum Ring {
    Pole(u32),
    Circle(u32),
}

impl Ring {
    fn new(triangles: &mut Triangles, slices: u32, point: Profile) -> Self {
        let Profile { radius, z, normal: [outward, upward] } = point;
        if radius == 0.0 {
            return Self::Pole(triangles.vertex([0.0, 0.0, z], [outward, 0.0, upward]));
        }
        let first = triangles.vertices.len() as u32;
        for slice in 0..slices {
            let [cos, sin] = direction(slice, slices);
            triangles.vertex([cos * radius, sin * radius, z], [cos * outward, sin * outward, upward]);
        }
        Self::Circle(first)
    }

    fn corner(self, slice: u32) -> u32 {
        match self {
            Self::Pole(corner) => corner,
            Self::Circle(first) => first + slice,
        }
    }
}

/// A corner of a regular polygon: cosine and sine. The lower half is the mirror image of the upper one to the last bit, so
/// that shapes that are turned upside down fit the others without a crack.
pub(super) fn direction(slice: u32, slices: u32) -> [f32; 2] {
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
