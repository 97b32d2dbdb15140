//! Names, and custom fields: numbers, texts and tuples of objects.

use super::invalid::Invalid;
use super::layout::{Field, field, size};
use super::rule::{ids, is, is_in, partition, piece};
use super::view::View;

/// The addresses of names, in the order of both the fields and the characters.
const ADDRESSES: &[Field<i32>] = &[
    field::name_bodyadr,
    field::name_jntadr,
    field::name_geomadr,
    field::name_siteadr,
    field::name_camadr,
    field::name_lightadr,
    #[cfg(engine_since = "3.5.0")]
    field::name_flexadr,
    field::name_meshadr,
    field::name_skinadr,
    field::name_hfieldadr,
    field::name_texadr,
    field::name_matadr,
    field::name_pairadr,
    field::name_excludeadr,
    field::name_eqadr,
    field::name_tendonadr,
    field::name_actuatoradr,
    field::name_sensoradr,
    field::name_numericadr,
    field::name_textadr,
    field::name_tupleadr,
    field::name_keyadr,
    #[cfg(engine_since = "3.5.0")]
    field::name_pluginadr,
];

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    partition(view, field::numeric_adr, field::numeric_size, 1, size::nnumericdata)?;
    partition(view, field::text_adr, field::text_size, 1, size::ntextdata)?;
    partition(view, field::tuple_adr, field::tuple_size, 1, size::ntupledata)?;

    let texts = view.slice(field::text_data);
    for i in 0..view.size(size::ntext) {
        let text = &texts[piece(view, field::text_adr, field::text_size, i)];
        let length = text.iter().position(|&byte| byte == 0);
        if length != Some(text.len() - 1) {
            let found =
                length.map_or("has no terminating NUL".into(), |length| format!("has a NUL after {length} bytes"));
            return Err(Invalid::element("text", i, format_args!("{} bytes long", text.len()), format!("it {found}")));
        }
    }
    for (i, kind) in view.values(field::tuple_objtype).enumerate() {
        let Some(count) = count(view, kind) else {
            return Err(Invalid::element(field::tuple_objtype.name(), i, kind, "it must be a type of object"));
        };
        is_in(view, field::tuple_objid, i, ids(count))?;
    }
    names(view)?;
    #[cfg(engine_since = "3.5.0")]
    super::newer::check_name_map(view, ADDRESSES)?;
    Ok(())
}

/// Returns the number of objects of an `mjtObj` type, or `None` if the type does not exist or is
/// "unknown".
pub(super) fn count(view: &View<'_>, kind: i32) -> Option<usize> {
    use mujoco_sys as sys;
    let count = match u32::try_from(kind).ok()? {
        sys::mjOBJ_BODY | sys::mjOBJ_XBODY => size::nbody,
        sys::mjOBJ_JOINT => size::njnt,
        sys::mjOBJ_DOF => size::nv,
        sys::mjOBJ_GEOM => size::ngeom,
        sys::mjOBJ_SITE => size::nsite,
        sys::mjOBJ_CAMERA => size::ncam,
        sys::mjOBJ_LIGHT => size::nlight,
        sys::mjOBJ_MESH => size::nmesh,
        sys::mjOBJ_SKIN => size::nskin,
        sys::mjOBJ_HFIELD => size::nhfield,
        sys::mjOBJ_TEXTURE => size::ntex,
        sys::mjOBJ_MATERIAL => size::nmat,
        sys::mjOBJ_PAIR => size::npair,
        sys::mjOBJ_EXCLUDE => size::nexclude,
        sys::mjOBJ_EQUALITY => size::neq,
        sys::mjOBJ_TENDON => size::ntendon,
        sys::mjOBJ_ACTUATOR => size::nu,
        sys::mjOBJ_SENSOR => size::nsensor,
        sys::mjOBJ_NUMERIC => size::nnumeric,
        sys::mjOBJ_TEXT => size::ntext,
        sys::mjOBJ_TUPLE => size::ntuple,
        sys::mjOBJ_KEY => size::nkey,
        _ => return None,
    };
    Some(view.size(count))
}

/// Checks the array of names: the name of the model first, then the names of all objects, kind by
/// kind, each NUL-terminated. An unnamed object has an empty string, so every address is the end of
/// the previous name.
fn names(view: &View<'_>) -> Result<(), Invalid> {
    let names = view.slice(field::names);
    // Addresses only increase, so all searches together read each byte once.
    let end = |start: usize| names[start..].iter().position(|&byte| byte == 0).map(|length| start + length + 1);
    let unterminated = || Invalid::scalar("nnames", names.len(), "the names do not end with a NUL");

    let mut next = end(0).ok_or_else(unterminated)?;
    for &address in ADDRESSES {
        for i in 0..view.len(address) {
            is(view, address, i, next as i64, "the end of the previous name")?;
            next = end(next).ok_or_else(unterminated)?;
        }
    }
    if next != names.len() {
        return Err(Invalid::scalar("nnames", names.len(), format!("the names end at {next}")));
    }
    Ok(())
}
