//! Pairs of geoms that are tested for contact, and pairs of bodies that are not. The engine looks both up by a signature that
//! has the bodies in it, in a list that it takes to be sorted.

use super::geom::condim;
use super::invalid::Invalid;
use super::layout::{Field, field, size};
use super::rule::{all_ids, is};
use super::view::View;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    condim(view, field::pair_dim)?;
    all_ids(view, field::pair_geom1, view.size(size::ngeom))?;
    all_ids(view, field::pair_geom2, view.size(size::ngeom))?;
    for i in 0..view.size(size::npair) {
        let body = |geom| i64::from(view.get(field::geom_bodyid, view.get(geom, i) as usize));
        let (one, other) = (body(field::pair_geom1), body(field::pair_geom2));
        let wanted = signature(one.min(other), one.max(other));
        is(view, field::pair_signature, i, wanted, "the signature of its geoms' bodies")?;
    }
    sorted(view, field::pair_signature)?;

    for (i, value) in view.values(field::exclude_signature).enumerate() {
        let nbody = view.size(size::nbody) as i64;
        let (one, other) = ((i64::from(value) >> 16) - 1, (i64::from(value) & 0xFFFF) - 1);
        if !(0 <= one && one <= other && other < nbody) {
            let wanted = format!("it stands for bodies {one} and {other} of {nbody}, the smaller id first");
            return Err(Invalid::element(field::exclude_signature.name(), i, value, wanted));
        }
    }
    sorted(view, field::exclude_signature)
}

/// Fits into an int, since there are fewer than 2^15 bodies.
fn signature(first: i64, second: i64) -> i64 {
    ((first + 1) << 16) + second + 1
}

fn sorted(view: &View<'_>, field: Field<i32>) -> Result<(), Invalid> {
    for i in 1..view.len(field) {
        let (before, value) = (view.get(field, i - 1), view.get(field, i));
        if value < before {
            return Err(Invalid::element(
                field.name(),
                i,
                value,
                format!("they must ascend, and the one before is {before}"),
            ));
        }
    }
    Ok(())
}
