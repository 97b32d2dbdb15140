//! Poses and inertias of a URDF.

use super::Attributes;
use super::element::Urdf;
use crate::error::Result;
use crate::math;
use crate::spec::tree::Index;
use crate::spec::value::Value;

/// Smallest moment of inertia that the compiler accepts in a complete matrix.
const SMALLEST: f64 = 1e-14;

/// Moments in the order of `fullinertia`.
const MOMENTS: [&str; 6] = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];

/// Position and angles (roll, pitch, yaw) of an element, if it has them.
fn origin(urdf: Urdf<'_>, element: Index) -> Result<[Option<[f64; 3]>; 2]> {
    match urdf.child(element, "origin")? {
        Some(origin) => Ok([urdf.numbers(origin, "xyz")?, urdf.numbers(origin, "rpy")?]),
        None => Ok([None, None]),
    }
}

/// Attributes of the pose of an element.
pub(super) fn pose(urdf: Urdf<'_>, element: Index) -> Result<Attributes> {
    let [xyz, rpy] = origin(urdf, element)?;
    let given = |vector: Option<[f64; 3]>| vector.filter(|vector| *vector != [0.0; 3]);
    let mut attributes = Attributes::new();
    attributes.extend(given(xyz).map(|pos| ("pos", pos.text().into_owned())));
    attributes.extend(given(rpy).map(|euler| ("euler", euler.text().into_owned())));
    Ok(attributes)
}

/// Inertia of a link.
pub(super) struct Inertial {
    pub(super) attributes: Attributes,
    pub(super) mass: f64,
}

/// Returns the inertia of a link, if it has one.
pub(super) fn inertial(urdf: Urdf<'_>, link: Index) -> Result<Option<Inertial>> {
    let Some(element) = urdf.child(link, "inertial")? else { return Ok(None) };
    let [xyz, rpy] = origin(urdf, element)?;
    let [mass] = urdf.required_numbers(urdf.required(element, "mass")?, "value")?;
    let inertia = urdf.required(element, "inertia")?;
    let mut moments = [0.0; 6];
    for (moment, attribute) in moments.iter_mut().zip(MOMENTS) {
        [*moment] = urdf.required_numbers(inertia, attribute)?;
    }
    let mut attributes = vec![("pos", xyz.unwrap_or_default().text().into_owned()), ("mass", mass.text().into_owned())];
    let [xx, yy, zz, xy, xz, yz] = moments;
    let principal = math::eig3(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
    let rotation = rpy.filter(|angles| *angles != [0.0; 3]);
    if rotation.is_none() && principal.eigval[2] >= SMALLEST {
        attributes.push(("fullinertia", moments.text().into_owned()));
        return Ok(Some(Inertial { attributes, mass }));
    }
    // MJCF has a complete matrix only with the axes of the body.
    let quat = rotation.map_or(principal.quat, |angles| product(quaternion(angles), principal.quat));
    attributes.push(("quat", quat.text().into_owned()));
    attributes.push(("diaginertia", principal.eigval.text().into_owned()));
    Ok(Some(Inertial { attributes, mass }))
}

/// Rotation by angles about the fixed axes x, y and z.
fn quaternion(angles: [f64; 3]) -> [f64; 4] {
    let turn = |axis: usize| {
        let half = angles[axis] / 2.0;
        let mut quat = [half.cos(), 0.0, 0.0, 0.0];
        quat[axis + 1] = half.sin();
        quat
    };
    product(turn(2), product(turn(1), turn(0)))
}

fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    math::mul_quat(&a, &b)
}
