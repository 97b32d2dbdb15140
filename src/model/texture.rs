//! Pixels of textures, also of those that the model has by reference.

use std::borrow::Cow;
use std::ffi::c_int;
use std::ptr;

use mujoco_sys::{self as sys, guard};

use super::Model;
use super::load::XmlState;
use crate::error::{Error, Result};
use crate::ffi;
use crate::id::TextureId;

/// Pixels of a texture.
#[derive(Debug)]
pub(crate) struct TexturePixels<'m> {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Bytes per pixel.
    pub(crate) channels: usize,
    pub(crate) bytes: Cow<'m, [u8]>,
    /// The engine converts the pixels from the sRGB colour space to linear colours.
    pub(crate) is_srgb: bool,
}

impl Model {
    /// Returns the pixels of a texture. Engines from 3.17 leave the pixels of a texture in its file
    /// if the MJCF asks for it; they are decoded here.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if a load would reject the file of the texture, or with the engine's
    /// message if the file cannot be decoded, [`Error::OutOfMemory`], and the errors of loading a
    /// model.
    pub(crate) fn texture_pixels(&self, id: TextureId) -> Result<TexturePixels<'_>> {
        let texture = self.texture(id);
        let channels = texture.channels();
        if self.tex_adr()[id.index()] >= 0 {
            let (width, height, is_srgb) = (texture.width(), texture.height(), self.texture_is_srgb(id.index()));
            return Ok(TexturePixels { width, height, channels, bytes: Cow::Borrowed(texture.rgb()), is_srgb });
        }
        #[cfg(engine_since = "3.17.0")]
        if let Some(message) = super::xml_guard::reject_texture(self.texture_path(id)) {
            return Err(Error::Unsupported(format!("a texture whose file cannot be read: {message}")));
        }
        let (mut data, mut size, mut colorspace) = (ptr::null_mut(), [0; 2], 0);
        let (mut message, mut failure) = ([0; 1000], 0);
        let mut xml = XmlState::enter()?;
        // SAFETY: a valid model and texture, places for all results, and a buffer of the given
        // length.
        let status = unsafe {
            guard::mj_load_texture(
                self.as_ptr(),
                id.index() as c_int,
                &raw mut data,
                size.as_mut_ptr(),
                &raw mut colorspace,
                message.as_mut_ptr(),
                message.len() as c_int,
                &raw mut failure,
            )
        };
        xml.leave("mj_loadTexture", status)?;
        drop(xml);
        if failure != 0 || data.is_null() {
            // SAFETY: the engine terminates its message with NUL, and the buffer was zero.
            let message = unsafe { ffi::text(message.as_ptr()) };
            return Err(Error::Unsupported(format!("a texture whose file cannot be read: {message}")));
        }
        let [width, height] = size.map(ffi::size);
        // SAFETY: the engine has written this many bytes.
        let bytes = unsafe { ffi::array(data.cast_const(), width * height * channels) }.to_vec();
        // SAFETY: the engine has allocated the pixels for the caller.
        unsafe { sys::mju_free(data.cast()) };
        Ok(TexturePixels { width, height, channels, bytes: bytes.into(), is_srgb: colorspace == SRGB })
    }

    /// Returns the path of a texture's file, which is empty for a texture without a file. The file
    /// can have changed since the model was loaded.
    #[cfg(engine_since = "3.17.0")]
    fn texture_path(&self, id: TextureId) -> &[u8] {
        let model = self.raw();
        // SAFETY: the array has an element for each texture.
        let addresses = unsafe { ffi::array(model.tex_pathadr, self.ntex()) };
        let Ok(start) = usize::try_from(addresses[id.index()]) else { return &[] };
        // SAFETY: the array of all paths has this length.
        let paths = unsafe { ffi::array(model.paths.cast::<u8>(), ffi::size(model.npaths)) };
        paths.get(start..).unwrap_or_default().split(|&byte| byte == 0).next().unwrap_or_default()
    }
}

/// `mjCOLORSPACE_SRGB`.
const SRGB: c_int = 2;
