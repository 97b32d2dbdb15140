//! Cameras and lights of bodies that the compiler may fuse with their parents (`fusestatic`).
//!
//! Compilers from 3.2 to 3.5 delete a fused body with its cameras and lights, and use them
//! afterwards.

use super::tags::Tag;

/// State of the check: whether the compiler fuses bodies, and whether one of them may have a camera
/// or a light.
#[derive(Default)]
pub(super) struct Fusion {
    is_enabled: bool,
    /// Depths of the open bodies.
    bodies: Vec<usize>,
    /// `true` if a camera or a light may belong to a fused body.
    has_view: bool,
}

impl Fusion {
    /// Records the start of an element. `is_asset` is `true` in a model that is an asset of another
    /// one, whose world can become a body.
    pub(super) fn start(&mut self, tag: &Tag<'_>, depth: usize, is_asset: bool) {
        match tag.name {
            b"compiler" => self.is_enabled |= tag.attribute(b"fusestatic").is_some_and(|value| *value != *b"false"),
            b"body" if !tag.empty => self.bodies.push(depth),
            b"camera" | b"light" => self.has_view |= is_asset || !self.bodies.is_empty(),
            _ => {}
        }
    }

    /// Records the end of the element at this depth.
    pub(super) fn end(&mut self, depth: usize) {
        self.bodies.retain(|&body| body < depth);
    }

    /// Returns the reason to reject the model.
    pub(super) fn check(&self) -> Option<String> {
        let is_unsafe = cfg!(all(engine_since = "3.2.0", not(engine_since = "3.6.0")));
        (is_unsafe && self.is_enabled && self.has_view).then(|| {
            "fusestatic and a camera or light in a body, on which this engine's compiler crashes; remove fusestatic, or give the camera or \
             light to the world"
                .to_owned()
        })
    }
}
