//! Constraints at the point where they begin or cease to act, and friction at its limit.

use mujoco_sys::{
    mjCNSTR_EQUALITY, mjCNSTR_FRICTION_DOF, mjCNSTR_FRICTION_TENDON, mjCNSTR_LIMIT_JOINT, mjCNSTR_LIMIT_TENDON,
    mjMINVAL,
};

use super::{is_active, row_count, violation};
use crate::data::Data;
use crate::derivative::kinks::is_at;
use crate::derivative::method::Kinks;
use crate::derivative::newton::contacts;
use crate::enums::JointType;
use crate::ffi;
use crate::math;
use crate::model::{DisableFlags, Model};

/// Returns the kinks of constraints at the present state: distances that equal the margin, and, if
/// the residuals `jar` of the rows are known, thresholds of these and kinks of the impedance.
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
            .any(|(row, (jar, aref))| is_at_threshold(data, row, *jar, *aref))
        || (!jar.is_empty() && has_impedance_kink(data));
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

/// Returns `true` if the impedance of a constraint has a kink. It is a piecewise linear function of
/// the violation if the power of `solimp` is 1.
fn has_impedance_kink(data: &Data) -> bool {
    let mut row = 0;
    while row < data.nefc() {
        let count = row_count(data, row);
        if is_active(data, row, count) && is_at_impedance_kink(data, row, count) {
            return true;
        }
        row += count;
    }
    false
}

/// Returns `true` if the violation of a constraint is where its impedance has a kink.
fn is_at_impedance_kink(data: &Data, row: usize, count: usize) -> bool {
    let (id, kind) = (ffi::size(data.efc_id()[row]), data.efc_type()[row] as u32);
    #[expect(non_upper_case_globals, reason = "the engine's constants")]
    let [start, end, width, _, power] = match kind {
        mjCNSTR_EQUALITY => data.model().eq_solimp()[id],
        // The violation is always zero.
        mjCNSTR_FRICTION_DOF | mjCNSTR_FRICTION_TENDON => return false,
        mjCNSTR_LIMIT_JOINT => data.model().jnt_solimp()[id],
        mjCNSTR_LIMIT_TENDON => data.model().tendon_solimp_lim()[id],
        _ => contacts(data)[id].solimp,
    };
    if power > 1.0 || start == end || width <= mjMINVAL {
        return false;
    }
    let violation = violation(data, row, count);
    is_at(violation, 0.0) || is_at(violation, width)
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
