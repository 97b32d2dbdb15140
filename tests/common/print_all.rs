//! Prints every view of every element, which reads every field: ids, types and addresses in the
//! model must be valid.

use mujoco_safe::{Data, Model};

/// Returns the length of the printed text.
pub(crate) fn print_all(model: &Model, data: &Data) -> usize {
    let mut length = 0;
    macro_rules! print {
        ($owner:ident: $($many:ident)*) => {
            $(length += $owner.$many().map(|element| element.to_string().len()).sum::<usize>();)*
        };
    }
    print!(model: bodies joints geoms sites cameras lights tendons actuators sensors keyframes meshes skins height_fields
        textures materials pairs excludes equalities numerics texts tuples);
    print!(data: bodies joints geoms sites cameras lights tendons actuators sensors);
    length
}
