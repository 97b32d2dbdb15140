//! Custom fields: numbers, texts and tuples of objects.

use super::invalid::Invalid;
use super::layout::{field, size};
use super::rule::{ids, is_in, partition, piece};
use super::view::View;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    partition(view, field::numeric_adr, field::numeric_size, 1, size::nnumericdata)?;
    partition(view, field::text_adr, field::text_size, 1, size::ntextdata)?;
    partition(view, field::tuple_adr, field::tuple_size, 1, size::ntupledata)?;

    let texts = view.slice(field::text_data);
    for i in 0..view.size(size::ntext) {
        let text = &texts[piece(view, field::text_adr, field::text_size, i)];
        let length = text.iter().position(|&byte| byte == 0);
        if length != Some(text.len() - 1) {
            let found = length.map_or("has no end".into(), |length| format!("ends after {length} bytes"));
            return Err(Invalid::element("text", i, format_args!("{} bytes long", text.len()), format!("it {found}")));
        }
    }
    for (i, kind) in view.values(field::tuple_objtype).enumerate() {
        let Some(count) = objects(view, kind) else {
            return Err(Invalid::element(field::tuple_objtype.name(), i, kind, "there is no such type of object"));
        };
        is_in(view, field::tuple_objid, i, ids(count))?;
    }
    Ok(())
}

/// How many objects there are of an `mjtObj` type; `None` if there is no such type, or it is "unknown".
pub(super) fn objects(view: &View<'_>, kind: i32) -> Option<usize> {
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
