//! Poses and inertias of a URDF.

use super::Attributes;
use super::element::Urdf;
use crate::error::Result;
use crate::math;
use crate::spec::tree::Index;
use crate::spec::value::Value;

/// Smallest principal moment of inertia that the compiler accepts in a complete matrix. It rejects
/// negative ones there only.
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
    /// The link states moments of inertia.
    pub(super) has_moments: bool,
}

/// Returns the inertia of a link, if it has one.
pub(super) fn inertial(urdf: Urdf<'_>, link: Index) -> Result<Option<Inertial>> {
    let Some(element) = urdf.child(link, "inertial")? else { return Ok(None) };
    let [xyz, rpy] = origin(urdf, element)?;
    let [mass] = urdf.required_numbers(urdf.required(element, "mass")?, "value")?;
    let inertia = urdf.child(element, "inertia")?;
    let has_moments = inertia.is_some();
    let mut moments = [0.0; 6];
    if let Some(inertia) = inertia {
        for (moment, attribute) in moments.iter_mut().zip(MOMENTS) {
            [*moment] = urdf.required_numbers(inertia, attribute)?;
        }
    }
    if let Some(angles) = rpy.filter(|angles| *angles != [0.0; 3]) {
        moments = turned(moments, angles);
    }
    let mut attributes = vec![("pos", xyz.unwrap_or_default().text().into_owned()), ("mass", mass.text().into_owned())];
    let principal = math::eig3(&matrix(moments));
    if principal.eigval[2].abs() >= SMALLEST {
        attributes.push(("fullinertia", moments.text().into_owned()));
    } else {
        attributes.push(("quat", principal.quat.text().into_owned()));
        attributes.push(("diaginertia", principal.eigval.map(|moment| moment.max(0.0)).text().into_owned()));
    }
    Ok(Some(Inertial { attributes, mass, has_moments }))
}

fn matrix([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [f64; 9] {
    [xx, xy, xz, xy, yy, yz, xz, yz, zz]
}

/// Returns moments about the axes of a link, given those about axes that are turned by angles about
/// the fixed axes x, y and z: `R I Rᵀ`.
fn turned(moments: [f64; 6], angles: [f64; 3]) -> [f64; 6] {
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let half = angles[axis] / 2.0;
        let mut quat = [half.cos(), 0.0, 0.0, 0.0];
        quat[axis + 1] = half.sin();
        quat
    });
    let rotation = math::quat2mat(&math::mul_quat(&z, &math::mul_quat(&y, &x)));
    let inertia = matrix(moments);
    let moment = |i: usize, j: usize| -> f64 {
        let product = |k: usize, l: usize| rotation[3 * i + k] * inertia[3 * k + l] * rotation[3 * j + l];
        (0..9).map(|at| product(at / 3, at % 3)).sum()
    };
    [moment(0, 0), moment(1, 1), moment(2, 2), moment(0, 1), moment(0, 2), moment(1, 2)]
}
