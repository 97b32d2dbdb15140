//! Names: one array of characters with the model's own name first, then that of every object, kind by kind, each ended by a
//! zero. An object without a name has an empty one, so that every address is where the name before it ends.

use super::invalid::Invalid;
use super::layout::{Field, field};
use super::rule::is;
use super::view::View;

/// The order of the characters, which is also that of the fields.
const ADDRESSES: [Field<i32>; 21] = [
    field::name_bodyadr,
    field::name_jntadr,
    field::name_geomadr,
    field::name_siteadr,
    field::name_camadr,
    field::name_lightadr,
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
];

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    let names = view.slice(field::names);
    // The zero from `start` on. Addresses only grow, so that all searches together read each byte once.
    let end = |start: usize| names[start..].iter().position(|&byte| byte == 0).map(|length| start + length + 1);
    let unfinished = || Invalid::scalar("nnames", names.len(), "the names do not end with a zero");

    let mut next = end(0).ok_or_else(unfinished)?;
    for address in ADDRESSES {
        for i in 0..view.len(address) {
            is(view, address, i, next as i64, "where the name before it ends")?;
            next = end(next).ok_or_else(unfinished)?;
        }
    }
    if next != names.len() {
        return Err(Invalid::scalar("nnames", names.len(), format!("the names end at {next}")));
    }
    Ok(())
}
