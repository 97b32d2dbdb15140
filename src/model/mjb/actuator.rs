//! Actuators: transmission, dynamics, gain and bias.

use mujoco_sys::{
    mjBIAS_USER, mjDYN_NONE, mjDYN_USER, mjGAIN_USER, mjTRN_BODY, mjTRN_JOINT, mjTRN_JOINTINPARENT, mjTRN_SITE,
    mjTRN_SLIDERCRANK, mjTRN_TENDON,
};

use super::invalid::Invalid;
use super::layout::{field, size};
use super::rule::{all_bytes, all_in, ids, is, is_in};
use super::view::View;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    all_in(view, field::actuator_trntype, 0..=mjTRN_BODY.into())?;
    all_in(view, field::actuator_dyntype, 0..=mjDYN_USER.into())?;
    all_in(view, field::actuator_gaintype, 0..=mjGAIN_USER.into())?;
    all_in(view, field::actuator_biastype, 0..=mjBIAS_USER.into())?;
    all_bytes(view, field::actuator_ctrllimited, 1)?;
    all_bytes(view, field::actuator_forcelimited, 1)?;
    all_bytes(view, field::actuator_actlimited, 1)?;
    for (i, kind) in view.values(field::actuator_trntype).enumerate() {
        let count = match kind as u32 {
            mjTRN_JOINT | mjTRN_JOINTINPARENT => size::njnt,
            mjTRN_SLIDERCRANK | mjTRN_SITE => size::nsite,
            mjTRN_TENDON => size::ntendon,
            _ => size::nbody,
        };
        is_in(view, field::actuator_trnid, 2 * i, ids(view.size(count)))?;
        let second = 2 * i + 1;
        match kind as u32 {
            mjTRN_SLIDERCRANK => is_in(view, field::actuator_trnid, second, ids(view.size(size::nsite)))?,
            mjTRN_SITE => is_in(view, field::actuator_trnid, second, -1..=view.size(size::nsite) as i64 - 1)?,
            _ => is(view, field::actuator_trnid, second, -1, "since only slider-cranks and sites have a second site")?,
        }
    }
    adhesion(view)?;
    activations(view)
}

/// The transmission of an adhesive actuator takes the constraint rows of each contact of its body for granted. With no room for
/// any row, the engine makes none, says nothing, and writes before the beginning of a null pointer.
///
/// Where there is room for some rows but not for all, no look at the file can tell: the same happens, after a warning that the
/// constraint buffer is full, which whoever steps such a model must treat as an error.
fn adhesion(view: &View<'_>) -> Result<(), Invalid> {
    let adhesive = view.values(field::actuator_trntype).position(|kind| kind as u32 == mjTRN_BODY);
    match adhesive {
        Some(i) if view.size(size::njmax) == 0 => {
            Err(Invalid::scalar("njmax", 0, format!("actuator {i} is adhesive and needs the constraints of contacts")))
        }
        _ => Ok(()),
    }
}

/// The engine gives activation `i - (nu - na)` to actuator `i`, so that those with a state must be the last `na`.
fn activations(view: &View<'_>) -> Result<(), Invalid> {
    let (nu, na) = (view.size(size::nu), view.size(size::na));
    if na > nu {
        return Err(Invalid::scalar("na", na, format!("there are only {nu} actuators")));
    }
    for (i, kind) in view.values(field::actuator_dyntype).enumerate() {
        let stateful = i >= nu - na;
        if stateful != (kind as u32 != mjDYN_NONE) {
            let wanted = format!("na is {na}, so the last {na} of {nu} actuators have a state, and only they");
            return Err(Invalid::element(field::actuator_dyntype.name(), i, kind, wanted));
        }
    }
    Ok(())
}
