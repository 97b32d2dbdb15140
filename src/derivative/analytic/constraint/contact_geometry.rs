//! Dependence of a contact on the relative pose of its two geoms.
//!
//! Position p, normal n and distance of a contact are functions of the relative pose of the geoms,
//! six numbers. So is y, the vector from which the engine makes the first tangent by projection:
//! the axis of a capsule on a plane, else an axis of the world. The derivatives by a twist `[ω; v]`
//! of the second geom alone, with v the velocity of the point at p, determine those by all degrees
//! of freedom.

use mujoco_sys::mjContact;

use crate::data::Data;
use crate::enums::GeomType;
use crate::ffi;
use crate::numerics::spatial::{Spatial, Vec3, add_scaled, cross, dot, scale, sub};

/// Smallest determinant of the equations for the nearest points of two capsules. With a smaller one
/// their axes are parallel.
const MIN_DETERMINANT: f64 = 1e-8;
/// Relative distance from the end of a capsule within which its nearest point counts as the end.
const END: f64 = 1e-9;

/// Derivatives of a contact by a twist of its second geom. Each row is the derivative of one
/// number.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactGeometry {
    pub(super) position: [Spatial; 3],
    pub(super) normal: [Spatial; 3],
    pub(super) distance: Spatial,
    /// y
    pub(super) hint: Vec3,
    /// Derivative of y, if it belongs to the geoms. An axis of the world has none.
    pub(super) hint_by_twist: Option<[Spatial; 3]>,
}

impl ContactGeometry {
    /// Returns the derivatives in closed form, or `None` for pairs of geoms without a formula.
    pub(super) fn in_closed_form(data: &Data, contact: &mjContact) -> Option<Self> {
        let model = data.model();
        let geoms = [contact.geom1, contact.geom2].map(ffi::size);
        let types = geoms.map(|geom| GeomType::of_field(model.geom_type()[geom]));
        let radius = model.geom_size()[geoms[1]][0];
        match types {
            // The contact is at a sphere, at an end of a capsule, or at a corner of a box.
            [GeomType::Plane, GeomType::Sphere] => Some(on_plane(contact, radius, None)),
            [GeomType::Plane, GeomType::Capsule] => Some(on_plane(contact, radius, Some(axis(data, geoms[1])))),
            [GeomType::Plane, GeomType::Box] => Some(on_plane(contact, 0.0, None)),
            [GeomType::Sphere | GeomType::Capsule, GeomType::Sphere | GeomType::Capsule] => {
                round(data, contact, geoms, types)
            }
            _ => None,
        }
    }
}

/// Returns the derivatives for a ball of a radius that is fixed to the second geom, on a plane.
fn on_plane(contact: &mjContact, radius: f64, axis: Option<Vec3>) -> ContactGeometry {
    let normal = normal(contact);
    // The centre of the ball is p + n (dist/2 + radius), and moves with the geom.
    let centre = moving_point(&scale(&normal, 0.5 * contact.dist + radius));
    let distance = combine(&normal, &centre);
    ContactGeometry {
        position: std::array::from_fn(|i| {
            let mut row = centre[i];
            add_scaled(&mut row, &distance, -0.5 * normal[i]);
            row
        }),
        normal: [[0.0; 6]; 3],
        distance,
        hint: axis.unwrap_or_else(|| world_axis(&normal)),
        hint_by_twist: axis.map(|axis| turning_vector(&axis)),
    }
}

/// Returns the derivatives for two spheres or capsules: the nearest points of two segments, or
/// `None` for parallel capsules.
///
/// With the axes α₁ and α₂, the nearest points c₁ and c₂ and δ = c₂ − c₁, the conditions `α₁·δ = 0`
/// and `α₂·δ = 0` of points that are not ends determine their shifts ds and dt along the axes.
fn round(data: &Data, contact: &mjContact, geoms: [usize; 2], types: [GeomType; 2]) -> Option<ContactGeometry> {
    let normal = normal(contact);
    let sizes = geoms.map(|geom| data.model().geom_size()[geom]);
    let axes = geoms.map(|geom| axis(data, geom));
    // The nearest points, relative to the position of the contact.
    let points = [(-1.0, 0), (1.0, 1)]
        .map(|(sign, side): (f64, usize)| scale(&normal, sign * (sizes[side][0] + 0.5 * contact.dist)));
    let is_free = [0, 1].map(|side: usize| {
        let from_centre: Vec3 =
            std::array::from_fn(|i| contact.pos[i] + points[side][i] - data.geom_xpos()[geoms[side]][i]);
        types[side] == GeomType::Capsule && dot(&axes[side], &from_centre).abs() < sizes[side][1] * (1.0 - END)
    });
    let gap = sub(&points[1], &points[0]);
    let length = dot(&gap, &gap).sqrt();
    let moved = moving_point(&points[1]);
    let cosine = dot(&axes[0], &axes[1]);
    // Rows of the equations for [ds, dt], and their right-hand sides.
    let mut equations = [[-1.0, cosine], [-cosine, 1.0]];
    let mut right = [scale(&combine(&axes[0], &moved), -1.0), scale(&combine(&axes[1], &moved), -1.0)];
    add_scaled(&mut right[1], &combine(&gap, &turning_vector(&axes[1])), -1.0);
    for side in 0..2 {
        if !is_free[side] {
            equations[side] = [0.0; 2];
            equations[side][side] = 1.0;
            right[side] = [0.0; 6];
        }
    }
    let [[a, b], [c, d]] = equations;
    let determinant = a * d - b * c;
    if determinant.abs() < MIN_DETERMINANT || length == 0.0 {
        return None;
    }
    let shifts: [Spatial; 2] = [
        std::array::from_fn(|i| (d * right[0][i] - b * right[1][i]) / determinant),
        std::array::from_fn(|i| (a * right[1][i] - c * right[0][i]) / determinant),
    ];
    let first: [Spatial; 3] = std::array::from_fn(|i| scale(&shifts[0], axes[0][i]));
    let difference: [Spatial; 3] = std::array::from_fn(|i| {
        let mut row = moved[i];
        add_scaled(&mut row, &shifts[1], axes[1][i]);
        sub(&row, &first[i])
    });
    let distance = combine(&normal, &difference);
    // The centres may have passed each other: the normal then points from the second to the first.
    let sign = if dot(&normal, &gap) > 0.0 { 1.0 } else { -1.0 };
    let by_normal: [Spatial; 3] = std::array::from_fn(|i| {
        let mut row = difference[i];
        add_scaled(&mut row, &distance, -normal[i]);
        scale(&row, sign / length)
    });
    Some(ContactGeometry {
        position: std::array::from_fn(|i| {
            let mut row = first[i];
            add_scaled(&mut row, &by_normal[i], sizes[0][0] + 0.5 * contact.dist);
            add_scaled(&mut row, &distance, 0.5 * normal[i]);
            row
        }),
        normal: by_normal,
        distance,
        hint: world_axis(&normal),
        hint_by_twist: None,
    })
}

fn normal(contact: &mjContact) -> Vec3 {
    [contact.frame[0], contact.frame[1], contact.frame[2]]
}

/// Returns the z axis of a geom.
fn axis(data: &Data, geom: usize) -> Vec3 {
    let matrix = &data.geom_xmat()[geom];
    [matrix[2], matrix[5], matrix[8]]
}

/// Returns the axis of the world from which the engine makes the first tangent.
pub(super) fn world_axis(normal: &Vec3) -> Vec3 {
    if normal[1] > -0.5 && normal[1] < 0.5 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] }
}

/// Returns the velocity `v + ω × arm` of a point of the second geom by the twist.
fn moving_point(arm: &Vec3) -> [Spatial; 3] {
    let mut rows = turning_vector(arm);
    for (axis, row) in rows.iter_mut().enumerate() {
        row[3 + axis] = 1.0;
    }
    rows
}

/// Returns the rate of change `ω × vector` of a vector of the second geom by the twist.
fn turning_vector(vector: &Vec3) -> [Spatial; 3] {
    let mut rows = [[0.0; 6]; 3];
    for axis in 0..3 {
        let mut unit = [0.0; 3];
        unit[axis] = 1.0;
        for (row, value) in rows.iter_mut().zip(cross(&unit, vector)) {
            row[axis] = value;
        }
    }
    rows
}

/// Returns the derivative of `vector · x`, given the derivative of x.
fn combine(vector: &Vec3, rows: &[Spatial; 3]) -> Spatial {
    let mut result = [0.0; 6];
    for (row, &factor) in rows.iter().zip(vector) {
        add_scaled(&mut result, row, factor);
    }
    result
}
