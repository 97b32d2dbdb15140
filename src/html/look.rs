//! Looks of a model with the assets of a page.

use std::collections::BTreeMap;

use serde::Serialize;

use super::assets::{HeightField, Mesh, Texture};
use super::deformable::Deformable;
use super::options::HtmlOptions;
use super::stream::Binary;
use crate::data::Data;
use crate::error::Result;
use crate::replay::{self, Frame, Groups};

/// Contents of the picture, apart from its motion. Assets have the indices of the model.
#[derive(Debug, Serialize)]
pub(super) struct Look {
    #[serde(flatten)]
    pub(super) base: replay::Look,
    meshes: BTreeMap<usize, Mesh>,
    height_fields: BTreeMap<usize, HeightField>,
    /// `None` for a texture that is drawn white.
    textures: BTreeMap<usize, Option<Texture>>,
    pub(super) deformables: Vec<Deformable>,
}

impl Look {
    /// Collects the looks of a model. `data` has the positions of the first record.
    pub(super) fn new(binary: &mut Binary, data: &mut Data, frames: &[Frame], options: &HtmlOptions) -> Result<Self> {
        let look = replay::Look::new(data, frames, Groups { geom: options.geomgroup, site: options.sitegroup })?;
        let model = data.model();
        let meshes = look.meshes.iter();
        let meshes =
            meshes.map(|(&id, &is_textured)| (id.index(), Mesh::new(binary, model, id, is_textured))).collect();
        let fields = look.height_fields.iter();
        let height_fields = fields.map(|&id| (id.index(), HeightField::new(binary, model, id))).collect();
        let textures = look.textures.iter();
        let textures = textures
            .map(|(&index, texture)| (index, texture.as_ref().map(|texture| Texture::new(binary, texture))))
            .collect();
        Ok(Self { base: look, meshes, height_fields, textures, deformables: Vec::new() })
    }
}
