//! Height fields, textures and materials.

use mujoco_sys::{mjTEXTURE_2D, mjTEXTURE_SKYBOX};

use super::invalid::Invalid;
use super::layout::{field, size};
use super::rule::{all_bytes, all_ids_or_none, all_in, is, size_is};
use super::view::View;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    height_fields(view)?;
    textures(view)?;
    all_ids_or_none(view, field::mat_texid, view.size(size::ntex))?;
    all_bytes(view, field::mat_texuniform, 1)
}

fn height_fields(view: &View<'_>) -> Result<(), Invalid> {
    all_in(view, field::hfield_nrow, 1..=i32::MAX.into())?;
    all_in(view, field::hfield_ncol, 1..=i32::MAX.into())?;
    let mut next = 0_u64;
    for i in 0..view.size(size::nhfield) {
        is(view, field::hfield_adr, i, next as i64, "where the one before it ends")?;
        // Below 2^62; the next field's address is compared with the sum before anything is added again.
        next += u64::from(view.get(field::hfield_nrow, i) as u32) * u64::from(view.get(field::hfield_ncol, i) as u32);
    }
    size_is(view, size::nhfielddata, next, "the sum of rows times columns")?;
    // The collision code turns positions divided by these into rows and columns.
    for (i, value) in view.values(field::hfield_size).enumerate() {
        if !(value.is_finite() && value > 0.0) {
            return Err(Invalid::element(field::hfield_size.name(), i, value, "it must be finite and positive"));
        }
    }
    Ok(())
}

fn textures(view: &View<'_>) -> Result<(), Invalid> {
    all_in(view, field::tex_type, 0..=mjTEXTURE_SKYBOX.into())?;
    all_in(view, field::tex_width, 1..=i32::MAX.into())?;
    all_in(view, field::tex_height, 1..=i32::MAX.into())?;
    let mut next = 0_u128;
    for i in 0..view.size(size::ntex) {
        let (width, height) = (view.get(field::tex_width, i), view.get(field::tex_height, i));
        let flat = view.get(field::tex_type, i) as u32 == mjTEXTURE_2D;
        if !flat && height != width && i64::from(height) != 6 * i64::from(width) {
            let wanted = format!("a cube of width {width} has one square image or six");
            return Err(Invalid::element(field::tex_height.name(), i, height, wanted));
        }
        is(view, field::tex_adr, i, next as i64, "where the one before it ends")?;
        // Three bytes for each pixel. An address is an int, so that only the last sum can be large.
        next += 3 * width as u128 * height as u128;
    }
    size_is(view, size::ntexdata, u64::try_from(next).unwrap_or(u64::MAX), "three bytes for each pixel")
}
