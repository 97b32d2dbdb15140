//! Textures: images that materials put onto surfaces.

use std::ops::Range;

use super::{View, ViewMut};
use crate::enums::TextureType;
use crate::ffi;
use crate::id::kind;
use crate::model::{Model, ModelMut};

/// Bytes of a pixel: red, green and blue.
const PIXEL: usize = 3;

fields!(Texture on Model {
    /// How it is put onto a surface.
    texture_type: {TextureType} = |texture| TextureType::of_field(texture.owner.tex_type()[texture.index()]);
    /// Its height, in pixels. A cube's six faces lie below each other.
    height: {usize} = |texture| ffi::size(texture.owner.tex_height()[texture.index()]);
    /// Its width, in pixels.
    width: {usize} = |texture| ffi::size(texture.owner.tex_width()[texture.index()]);
    /// Where its bytes are in `tex_rgb`.
    #[doc(alias = "adr")]
    rgb_range: {Range<usize>} = |texture| {
        let start = ffi::size(texture.owner.tex_adr()[texture.index()]);
        start..start + PIXEL * texture.height() * texture.width()
    };
    /// Its pixels, row by row: red, green and blue of each. `(height · width · 3)`
    rgb: [u8] = tex_rgb at rgb_range;
});

impl ViewMut<'_, ModelMut<'_>, kind::Texture> {
    /// `rgb`, to be written to.
    pub fn rgb_mut(&mut self) -> &mut [u8] {
        let range = self.as_view().in_model().rgb_range();
        let length = self.owner.tex_rgb().len();
        let array = self.owner.raw_mut().tex_rgb;
        // SAFETY: the engine allocated the array with this length, the model is borrowed exclusively, and any byte is a colour.
        let bytes = unsafe { ffi::array_mut(array, length) };
        &mut bytes[range]
    }
}
