//! What the physics tells the window once.

use crate::id::{BodyId, HeightFieldId, MeshId, TextureId};
use crate::model::Model;

/// What the physics tells the window once, while a [snapshot](super::snapshot::Snapshot) tells how things stand.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Event {
    /// A text for the clipboard.
    Copied(String),
    /// The camera is to look at this point.
    LookAt([f64; 3]),
    /// The camera is to follow this body.
    Track(BodyId),
    /// The program has changed what the model's shapes are drawn with.
    Asset(Asset),
    /// To be shown for a moment.
    Notice(String),
    /// The camera and what is shown are to be these: the program has set them.
    View(Box<super::link::Look>),
}

impl Event {
    /// Whether it is not about another model.
    pub(super) fn fits(&self, model: &Model) -> bool {
        let lineage = match self {
            Self::Track(body) => body.lineage(),
            Self::Asset(Asset::Texture(texture)) => texture.lineage(),
            Self::Asset(Asset::Mesh(mesh)) => mesh.lineage(),
            Self::Asset(Asset::HeightField(height_field)) => height_field.lineage(),
            Self::Copied(_) | Self::LookAt(_) | Self::Notice(_) | Self::View(_) => return true,
        };
        lineage == model.lineage()
    }
}

/// What a model's shapes are drawn with, and a renderer keeps a copy of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Asset {
    Texture(TextureId),
    Mesh(MeshId),
    HeightField(HeightFieldId),
}
