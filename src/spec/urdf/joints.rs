//! Joints of a URDF as joints and equalities of MJCF.

use std::collections::HashMap;

use super::element::{Urdf, number};
use super::links::{Joint, Type};
use super::{Attributes, UrdfWarning};
use crate::error::Result;
use crate::spec::tree::Index;
use crate::spec::value::Value;

/// Attribute with the limit of the force of a joint, which the engine has since 3.0.
pub(super) const EFFORT: &str = "actuatorfrcrange";

/// Joints of MJCF for one joint of a URDF.
pub(super) fn joints(
    urdf: Urdf<'_>,
    joint: &Joint<'_>,
    has_effort: bool,
    warnings: &mut Vec<UrdfWarning>,
) -> Result<Vec<Attributes>> {
    let axis = match urdf.child(joint.element, "axis")? {
        Some(axis) => urdf.required_numbers(axis, "xyz")?,
        None => [1.0, 0.0, 0.0],
    };
    let of_type = |word: &'static str, suffix: &str| {
        let mut attributes = Attributes::new();
        if !joint.name.is_empty() || !suffix.is_empty() {
            attributes.push(("name", format!("{}{suffix}", joint.name)));
        }
        attributes.push(("type", word.to_owned()));
        attributes
    };
    let along = |word: &'static str, suffix: &str, axis: [f64; 3]| {
        let mut attributes = of_type(word, suffix);
        attributes.push(("axis", axis.text().into_owned()));
        attributes
    };
    let mut joints = match joint.of_type {
        Type::Fixed => return Ok(Vec::new()),
        Type::Floating => vec![of_type("free", "")],
        Type::Spherical => vec![of_type("ball", "")],
        Type::Revolute | Type::Continuous => vec![along("hinge", "", axis)],
        Type::Prismatic => vec![along("slide", "", axis)],
        Type::Planar => {
            let [x, y] = plane(axis);
            vec![along("slide", "_TX", x), along("slide", "_TY", y), along("hinge", "_RZ", axis)]
        }
    };
    if let Some(dynamics) = urdf.child(joint.element, "dynamics")? {
        for (attribute, name) in [("damping", "damping"), ("friction", "frictionloss")] {
            if let Some([value]) = urdf.numbers(dynamics, attribute)? {
                for joint in &mut joints {
                    joint.push((name, value.text().into_owned()));
                }
            }
        }
    }
    if let Some(limit) = urdf.child(joint.element, "limit")? {
        // Those of a planar joint act along its first axis.
        joints[0].extend(limits(urdf, joint, limit, has_effort, warnings)?);
    }
    Ok(joints)
}

/// Limits of a joint.
fn limits(
    urdf: Urdf<'_>,
    joint: &Joint<'_>,
    limit: Index,
    has_effort: bool,
    warnings: &mut Vec<UrdfWarning>,
) -> Result<Attributes> {
    let name = || joint.name.to_owned();
    let mut attributes = Attributes::new();
    let [lower, upper] = [urdf.limit(limit, "lower")?, urdf.limit(limit, "upper")?];
    let range = [lower.unwrap_or(0.0), upper.unwrap_or(0.0)];
    if lower.is_some() || upper.is_some() {
        // Older engines take 0 for the missing one.
        let is_complete = lower.is_some() == upper.is_some() || !cfg!(engine_since = "3.1.5");
        let reason = match joint.of_type {
            Type::Continuous => "it is continuous".to_owned(),
            Type::Floating => "it is floating".to_owned(),
            Type::Spherical if range[0] != 0.0 => "'lower' of a spherical joint must be 0".to_owned(),
            _ if !is_complete => "one of 'lower' and 'upper' is missing".to_owned(),
            _ if range[0] >= range[1] => format!("'lower' is {} and 'upper' is {}", number(range[0]), number(range[1])),
            _ => String::new(),
        };
        let is_unlimited = match joint.of_type {
            Type::Continuous | Type::Floating => true,
            Type::Spherical => !reason.is_empty(),
            _ => false,
        };
        if !is_unlimited {
            attributes.push(("limited", reason.is_empty().text().into_owned()));
            attributes.push(("range", range.text().into_owned()));
        }
        if !reason.is_empty() {
            warnings.push(UrdfWarning::Range { joint: name(), reason });
        } else if joint.of_type == Type::Planar {
            let reason = "the limits of a planar joint act along its first axis only".to_owned();
            warnings.push(UrdfWarning::Range { joint: format!("{}_TY", joint.name), reason: reason.clone() });
            warnings.push(UrdfWarning::Range { joint: format!("{}_RZ", joint.name), reason });
        }
    }
    if let Some(effort) = urdf.limit(limit, "effort")?.map(f64::abs).filter(|&effort| effort > 0.0) {
        if has_effort && !matches!(joint.of_type, Type::Floating | Type::Spherical) {
            attributes.push(("actuatorfrclimited", "true".to_owned()));
            attributes.push((EFFORT, [-effort, effort].text().into_owned()));
        } else {
            // The limits of a planar joint act along its first axis.
            let suffix = if joint.of_type == Type::Planar { "_TX" } else { "" };
            warnings.push(UrdfWarning::EffortLimit { joint: name() + suffix, effort });
        }
    }
    if let Some(velocity) = urdf.limit(limit, "velocity")? {
        warnings.push(UrdfWarning::VelocityLimit { joint: name(), velocity });
    }
    Ok(attributes)
}

/// Two axes that form a frame with the third one, which is turned from the z axis by the smallest
/// angle.
fn plane(axis: [f64; 3]) -> [[f64; 3]; 2] {
    // The axis and the angle of the turn.
    let length = axis[0].hypot(axis[1]);
    let turn = if length < 1e-10 { [1.0, 0.0] } else { [-axis[1] / length, axis[0] / length] };
    let (sine, cosine) = (length.atan2(axis[2]) / 2.0).sin_cos();
    // The first two columns of the matrix of the quaternion (cosine, i, j, 0).
    let [i, j] = turn.map(|component| component * sine);
    let square = cosine * cosine;
    [[square + i * i - j * j, 2.0 * i * j, -2.0 * cosine * j], [2.0 * i * j, square - i * i + j * j, 2.0 * cosine * i]]
}

/// Equalities by which joints follow others (`mimic`), in the order of the joints.
pub(super) fn equalities(
    urdf: Urdf<'_>,
    joints: &[Joint<'_>],
    warnings: &mut Vec<UrdfWarning>,
) -> Result<Vec<Attributes>> {
    let can_follow = |of_type| matches!(of_type, Type::Revolute | Type::Continuous | Type::Prismatic);
    // A fixed joint is no joint of the model, so another one can have its name.
    let fixed = joints.iter().filter(|joint| joint.of_type == Type::Fixed);
    let others = joints.iter().filter(|joint| joint.of_type != Type::Fixed);
    let types: HashMap<&str, Type> = fixed.chain(others).map(|joint| (joint.name, joint.of_type)).collect();
    let mut equalities = Vec::new();
    for joint in joints {
        let Some(mimic) = urdf.child(joint.element, "mimic")? else { continue };
        let leader = urdf.required_text(mimic, "joint")?;
        if leader == joint.name {
            return Err(urdf.error(format!("{} has itself as 'joint'", urdf.describe(mimic))));
        }
        let [multiplier] = urdf.numbers(mimic, "multiplier")?.unwrap_or([1.0]);
        let [offset] = urdf.numbers(mimic, "offset")?.unwrap_or([0.0]);
        let reason = match types.get(leader).filter(|_| !leader.is_empty()) {
            None => format!("there is no joint '{leader}'"),
            Some(&of_type) if can_follow(of_type) && can_follow(joint.of_type) && !joint.name.is_empty() => {
                equalities.push(vec![
                    ("joint1", joint.name.to_owned()),
                    ("joint2", leader.to_owned()),
                    ("polycoef", [offset, multiplier, 0.0, 0.0, 0.0].text().into_owned()),
                ]);
                continue;
            }
            Some(_) => "both joints must have one degree of freedom".to_owned(),
        };
        warnings.push(UrdfWarning::Mimic { joint: joint.name.to_owned(), reason });
    }
    Ok(equalities)
}

#[cfg(test)]
mod tests {
    use super::plane;

    #[test]
    fn the_axes_of_a_plane_are_a_frame() {
        for axis in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [-0.6, 0.0, 0.8], [0.48, -0.64, -0.6]] {
            let [x, y] = plane(axis);
            let cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
            assert!((0..3).all(|i| (cross[i] - axis[i]).abs() < 1e-15), "{axis:?} {x:?} {y:?}");
            let dot: f64 = (0..3).map(|i| x[i] * y[i]).sum();
            assert!(dot.abs() < 1e-15, "{axis:?}");
        }
        assert_eq!(plane([0.0, 0.0, 2.0]), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    }
}
