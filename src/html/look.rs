//! Looks of a model with the assets of a page.

use std::collections::BTreeMap;

use serde::Serialize;

use super::assets::{HeightField, Mesh, Texture};
use super::deformable::{Deformable, Sampler};
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
    deformables: Vec<Deformable>,
}

impl Look {
    /// Collects the looks of a model. `data` has the positions of the first record.
    pub(super) fn new(binary: &mut Binary, data: &mut Data, frames: &[Frame], options: &HtmlOptions) -> Result<Self> {
        let look = replay::Look::new(data, frames, Groups { geom: options.geomgroup, site: options.sitegroup })?;
        let model = data.model();
        let error = options.largest_mesh_error(model)?;
        let meshes = look.meshes.iter();
        let meshes =
            meshes.map(|(&id, &is_textured)| (id.index(), Mesh::new(binary, model, id, is_textured, error))).collect();
        let fields = look.height_fields.iter();
        let height_fields = fields.map(|&id| (id.index(), HeightField::new(binary, model, id))).collect();
        let textures = look.textures.iter();
        let textures = textures
            .map(|(&index, texture)| (index, texture.as_ref().map(|texture| Texture::new(binary, texture))))
            .collect();
        Ok(Self { base: look, meshes, height_fields, textures, deformables: Vec::new() })
    }

    /// Adds the shapes that a sampler has found.
    pub(super) fn add_deformables(&mut self, sampler: Option<&Sampler>) {
        self.deformables = sampler.map(|sampler| sampler.shapes().to_vec()).unwrap_or_default();
        for shape in &self.deformables {
            self.base.left_out.remove(&shape.description);
        }
    }
}
