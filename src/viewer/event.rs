//! What the physics tells the window once.

use crate::id::{BodyId, HeightFieldId, MeshId, TextureId};

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

/// What a model's shapes are drawn with, and a renderer keeps a copy of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Asset {
    Texture(TextureId),
    Mesh(MeshId),
    HeightField(HeightFieldId),
}
