//! Derivatives of contacts by the pose of a geom: in closed form, or by differences of a collision
//! function for pairs of geoms without a formula.
//!
//! Only the collision function of the pair is called, with a perturbed pose of its second geom. The
//! functions for boxes, and for a plane with any shape, are exact, so their central differences are
//! good to ten digits. Functions that iterate to a tolerance are not differenced: their error would
//! be divided by the step.

use mujoco_sys::mjContact;

use super::contact_geometry::{ContactGeometry, world_axis};
use crate::data::{CollisionFunction, Data, FoundContact};
use crate::derivative::method::{DifferencedTerms, Kinks};
use crate::enums::GeomType;
use crate::error::Result;
use crate::ffi;
use crate::math;
use crate::numerics::spatial::{Vec3, add, dot, scale, sub};

/// Steps of the differences, m and rad, in the order of trial. A smaller step has larger rounding
/// errors. It is used only near a kink, such as the border between a face and an edge of a box.
const STEPS: [f64; 3] = [1e-6, 1e-7, 1e-8];
/// Largest deviation of the quotients of a step and of its double, relative to the largest
/// quotient. A larger one shows a kink.
const MAX_DEVIATION: f64 = 1e-5;
/// Excess over the margin of the contact, so that a shallow contact does not vanish, m.
const MARGIN: f64 = 1e-3;
/// Largest shift of a contact by a perturbation, m. A larger one shows that the function has found
/// other contacts.
const MAX_SHIFT: f64 = 1e-4;

/// Returns the derivatives, in closed form or else by differences of the collision function,
/// the terms that were differenced, and the kinks that the differences have found. Returns
/// `None` for pairs of geoms whose collision function iterates.
pub(super) fn geometry(
    data: &mut Data,
    contact: &mjContact,
) -> Result<Option<(ContactGeometry, DifferencedTerms, Kinks)>> {
    if let Some(geometry) = ContactGeometry::in_closed_form(data, contact) {
        return Ok(Some((geometry, DifferencedTerms::empty(), Kinks::empty())));
    }
    let geometry = differentiate(data, contact)?;
    Ok(geometry.map(|(geometry, kinks)| (geometry, DifferencedTerms::CONTACTS, kinks)))
}

/// Returns the derivatives of a contact by a twist of its second geom, and the kinks, or `None` if
/// they cannot be differenced.
fn differentiate(data: &mut Data, contact: &mjContact) -> Result<Option<(ContactGeometry, Kinks)>> {
    let geoms = [contact.geom1, contact.geom2].map(ffi::size);
    let types = geoms.map(|geom| GeomType::of_field(data.model().geom_type()[geom]));
    let is_exact =
        matches!(types, [GeomType::Plane, _] | [GeomType::Sphere | GeomType::Capsule | GeomType::Box, GeomType::Box]);
    if !is_exact {
        return Ok(None);
    }
    let pose = (data.geom_xpos()[geoms[1]], data.geom_xmat()[geoms[1]]);
    let result = difference(data, contact, geoms, &pose);
    move_geom(data, geoms[1], &pose);
    result
}

/// A position in the world, and a row-major rotation matrix.
type Pose = (Vec3, [f64; 9]);

fn move_geom(data: &mut Data, geom: usize, (position, rotation): &Pose) {
    data.geom_xpos_mut()[geom] = *position;
    data.geom_xmat_mut()[geom] = *rotation;
}

/// Differences the contact, and leaves the second geom moved.
fn difference(
    data: &mut Data,
    contact: &mjContact,
    geoms: [usize; 2],
    pose: &Pose,
) -> Result<Option<(ContactGeometry, Kinks)>> {
    let mut kinks = Kinks::empty();
    let frame_normal = [contact.frame[0], contact.frame[1], contact.frame[2]];
    let mut geometry = ContactGeometry {
        position: [[0.0; 6]; 3],
        normal: [[0.0; 6]; 3],
        distance: [0.0; 6],
        hint: world_axis(&frame_normal),
        hint_by_twist: None,
    };
    for column in 0..6 {
        let mut derivative = [0.0; 7];
        let mut converges = false;
        for step in STEPS {
            let mut quotient =
                |step| quotient(data, contact, geoms, |by| perturbed(pose, &contact.pos, column, by), step);
            let (Some(near), Some(far)) = (quotient(step)?, quotient(2.0 * step)?) else { return Ok(None) };
            // Richardson extrapolation. The normal of a contact nearly as deep as the radius of a
            // sphere or a capsule turns so fast that one step alone is not accurate.
            derivative = std::array::from_fn(|i| (4.0 * near[i] - far[i]) / 3.0);
            let largest = |values: [f64; 7]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            let deviation = largest(std::array::from_fn(|i| near[i] - far[i]));
            if deviation <= MAX_DEVIATION * (1.0 + largest(near)) {
                converges = true;
                break;
            }
        }
        if !converges {
            kinks |= Kinks::DIFFERENCES;
        }
        for axis in 0..3 {
            geometry.position[axis][column] = derivative[axis];
            geometry.normal[axis][column] = derivative[3 + axis];
        }
        geometry.distance[column] = derivative[6];
    }
    Ok(Some((geometry, kinks)))
}

/// Returns the central difference quotients of the position, the normal and the distance of a
/// contact, or `None` if a perturbed contact is not near the contact at the base point. Leaves the
/// second geom moved.
fn quotient(
    data: &mut Data,
    contact: &mjContact,
    geoms: [usize; 2],
    pose: impl Fn(f64) -> Pose,
    step: f64,
) -> Result<Option<[f64; 7]>> {
    let mut sides = [[0.0; 7]; 2];
    for (side, by) in sides.iter_mut().zip([step, -step]) {
        move_geom(data, geoms[1], &pose(by));
        let Some(FoundContact { midpoint, normal, distance }) = nearest(data, contact, geoms)? else { return Ok(None) };
        let ([x, y, z], [nx, ny, nz]) = (midpoint, normal);
        *side = [x, y, z, nx, ny, nz, distance];
    }
    let [right, left] = sides;
    Ok(Some(std::array::from_fn(|i| (right[i] - left[i]) / (2.0 * step))))
}

/// Returns a pose after a turn about an axis of the world through a point, or after a shift.
fn perturbed((position, rotation): &Pose, about: &Vec3, column: usize, by: f64) -> Pose {
    let mut axis = [0.0; 3];
    axis[column % 3] = 1.0;
    if column >= 3 {
        return (add(position, &scale(&axis, by)), *rotation);
    }
    let turn = math::quat2mat(&math::axis_angle2quat(&axis, by));
    let arm = math::rot_vec_mat(&sub(position, about), &turn);
    let turned = std::array::from_fn(|at| (0..3).map(|i| turn[at / 3 * 3 + i] * rotation[3 * i + at % 3]).sum());
    (add(about, &arm), turned)
}

/// Returns the contact nearest to the one at the base point, with a unit normal, or `None` if it is
/// too far away.
fn nearest(data: &mut Data, contact: &mjContact, geoms: [usize; 2]) -> Result<Option<FoundContact>> {
    let mut nearest: Option<(f64, FoundContact)> = None;
    data.collide(geoms, CollisionFunction::Table, contact.includemargin + MARGIN, |found| {
        let shift = sub(&found.midpoint, &contact.pos);
        let square = dot(&shift, &shift);
        if square <= nearest.map_or(MAX_SHIFT * MAX_SHIFT, |(least, _)| least) {
            nearest = Some((square, found));
        }
    })?;
    Ok(nearest.map(|(_, found)| {
        let length = dot(&found.normal, &found.normal).sqrt();
        FoundContact { normal: scale(&found.normal, 1.0 / length), ..found }
    }))
}
