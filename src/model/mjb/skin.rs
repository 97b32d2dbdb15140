//! Skins: a surface, and the bones that carry its vertices along.

use super::invalid::Invalid;
use super::layout::{field, size};
use super::mesh::faces;
use super::rule::{all_ids, all_ids_or_none, all_in, is_in, optional_partition, partition, piece};
use super::view::View;

/// The visualiser indexes its group flags with a skin's group as it is; those of other elements it clamps.
const LAST_GROUP: i64 = mujoco_sys::mjNGROUP as i64 - 1;

pub(super) fn check(view: &View<'_>) -> Result<(), Invalid> {
    all_ids_or_none(view, field::skin_matid, view.size(size::nmat))?;
    all_in(view, field::skin_group, 0..=LAST_GROUP)?;
    partition(view, field::skin_vertadr, field::skin_vertnum, 1, size::nskinvert)?;
    optional_partition(view, field::skin_texcoordadr, field::skin_vertnum, size::nskintexvert)?;
    partition(view, field::skin_faceadr, field::skin_facenum, 1, size::nskinface)?;
    partition(view, field::skin_boneadr, field::skin_bonenum, 1, size::nskinbone)?;
    partition(view, field::skin_bonevertadr, field::skin_bonevertnum, 1, size::nskinbonevert)?;
    all_ids(view, field::skin_bonebodyid, view.size(size::nbody))?;
    for skin in 0..view.size(size::nskin) {
        let vertices = view.get(field::skin_vertnum, skin);
        faces(view, field::skin_face, piece(view, field::skin_faceadr, field::skin_facenum, skin), vertices)?;
        for bone in piece(view, field::skin_boneadr, field::skin_bonenum, skin) {
            for i in piece(view, field::skin_bonevertadr, field::skin_bonevertnum, bone) {
                is_in(view, field::skin_bonevertid, i, 0..=i64::from(vertices) - 1)?;
            }
        }
    }
    Ok(())
}
