//! Constraints at the point where they begin or cease to act, and friction at its limit.

use mujoco_sys::{mjCNSTR_EQUALITY, mjCNSTR_FRICTION_DOF, mjCNSTR_FRICTION_TENDON};

use crate::data::Data;
use crate::derivative::kinks::is_at;
use crate::derivative::method::Kinks;
use crate::derivative::newton::contacts;
use crate::enums::JointType;
use crate::ffi;
use crate::math;
use crate::model::{DisableFlags, Model};

/// Returns the kinks of constraints at the present state: distances that equal the margin, and rows
/// at a threshold of their residuals `jar`, if these are known.
pub(in crate::derivative::analytic) fn of_state(data: &Data, jar: &[f64]) -> Kinks {
    let model = data.model();
    let disabled = DisableFlags::from_bits_retain(model.raw().opt.disableflags as u32);
    if disabled.contains(DisableFlags::CONSTRAINT) {
        return Kinks::empty();
    }
    let has_limits = !disabled.contains(DisableFlags::LIMIT);
    let begins = contacts(data).iter().any(|contact| is_at(contact.dist, contact.includemargin))
        || (has_limits && (0..model.njnt()).any(|joint| is_at_joint_limit(data, joint)))
        || (has_limits && (0..model.ntendon()).any(|tendon| is_at_tendon_limit(data, tendon)))
        || jar
            .iter()
            .zip(data.efc_aref())
            .enumerate()
            .any(|(row, (jar, aref))| is_at_threshold(data, row, *jar, *aref));
    if begins { Kinks::CONSTRAINTS } else { Kinks::empty() }
}

/// Returns `true` for a row with a residual at which its force begins, or at which the force of
/// friction reaches its limit.
fn is_at_threshold(data: &Data, row: usize, jar: f64, aref: f64) -> bool {
    #[expect(non_upper_case_globals, reason = "the engine's constants")]
    match data.efc_type()[row] as u32 {
        mjCNSTR_EQUALITY => false,
        mjCNSTR_FRICTION_DOF | mjCNSTR_FRICTION_TENDON => {
            is_at(jar.abs() / (data.efc_R()[row] * data.efc_frictionloss()[row]), 1.0)
        }
        _ => jar.abs() <= f64::EPSILON * aref.abs(),
    }
}

fn is_at_joint_limit(data: &Data, joint: usize) -> bool {
    let model = data.model();
    if model.jnt_limited()[joint] == 0 {
        return false;
    }
    let at = ffi::size(model.jnt_qposadr()[joint]);
    let margin = model.jnt_margin()[joint];
    let range @ [low, high] = model.jnt_range()[joint];
    match JointType::of_field(model.jnt_type()[joint]) {
        JointType::Hinge | JointType::Slide => is_at_end(data.qpos()[at], range, margin),
        JointType::Ball => {
            let mut quat = *data.qpos()[at..].first_chunk().expect("Bug: the quaternion is in qpos");
            math::normalize4(&mut quat);
            let angle = math::norm(&math::sub_quat(&quat, &[1.0, 0.0, 0.0, 0.0]));
            is_at(low.max(high) - angle, margin)
        }
        JointType::Free => false,
    }
}

fn is_at_tendon_limit(data: &Data, tendon: usize) -> bool {
    let model: &Model = data.model();
    model.tendon_limited()[tendon] != 0
        && is_at_end(data.ten_length()[tendon], model.tendon_range()[tendon], model.tendon_margin()[tendon])
}

/// Returns `true` if the distance of a value from an end of its range equals the margin.
fn is_at_end(value: f64, [low, high]: [f64; 2], margin: f64) -> bool {
    is_at(value - low, margin) || is_at(high - value, margin)
}
