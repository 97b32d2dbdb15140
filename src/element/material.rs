//! Materials: how surfaces look.

use super::{View, ViewMut};
use crate::id::{TextureId, kind};
use crate::model::{Model, ModelMut};

fields!(Material on Model {
    /// Its texture, if it has one.
    #[doc(alias = "texid")]
    texture: {Option<TextureId>} = |material| material.optional_id_in(material.owner.mat_texid());
    /// Whether the texture keeps its size in space, instead of being stretched over each object.
    texuniform: bool = mat_texuniform, set_texuniform;
    /// How often the texture is repeated along each axis: over an object, or over a metre if it is uniform.
    texrepeat: [f32; 2] = mat_texrepeat, texrepeat_mut in mat_texrepeat_mut;
    /// How much of its colour it emits, from 0 to 1.
    emission: f32 = mat_emission, set_emission in mat_emission_mut;
    /// How strong highlights are, from 0 to 1.
    specular: f32 = mat_specular, set_specular in mat_specular_mut;
    /// How small highlights are, from 0 to 1.
    shininess: f32 = mat_shininess, set_shininess in mat_shininess_mut;
    /// How much it mirrors, from 0 to 1.
    reflectance: f32 = mat_reflectance, set_reflectance in mat_reflectance_mut;
    /// Red, green, blue and opacity.
    rgba: [f32; 4] = mat_rgba, rgba_mut in mat_rgba_mut;
});
