//! Joints whose type differs from the type of their class.
//!
//! When compilers from 3.2 to 3.12 resize keyframes, for `<key>`, `<attach>` and `<replicate>`,
//! they write the positions of a joint as if it had the type of its class, beyond the end of an
//! array if the own type has fewer.

use super::tags::Tag;

/// State of the check. Numbers of positions follow from the types of joints.
#[derive(Default)]
pub(super) struct JointTypes {
    /// Depth of the outermost open `<default>`.
    default: Option<usize>,
    /// Largest number of positions of a joint in a class.
    of_classes: usize,
    /// Smallest number of positions of a joint that states its own type.
    of_joints: Option<usize>,
    /// `true` for a text with elements for which the compiler resizes keyframes.
    has_keyframes: bool,
}

impl JointTypes {
    /// Records the start of an element.
    pub(super) fn start(&mut self, tag: &Tag<'_>, depth: usize) {
        match tag.name {
            b"default" if !tag.empty && self.default.is_none() => self.default = Some(depth),
            b"joint" => {
                let positions = match tag.attribute(b"type").as_deref() {
                    None => return,
                    Some(b"free") => 7,
                    Some(b"ball") => 4,
                    Some(_) => 1,
                };
                if self.default.is_some() {
                    self.of_classes = self.of_classes.max(positions);
                } else {
                    self.of_joints = Some(self.of_joints.map_or(positions, |least| least.min(positions)));
                }
            }
            b"key" | b"attach" | b"replicate" => self.has_keyframes = true,
            _ => {}
        }
    }

    /// Records the end of the element at this depth.
    pub(super) fn end(&mut self, depth: usize) {
        self.default = self.default.filter(|&open| open < depth);
    }

    /// Returns the reason to reject the model.
    pub(super) fn check(&self) -> Option<String> {
        let is_unsafe = cfg!(all(engine_since = "3.2.0", not(engine_since = "3.17.0")));
        let is_short = self.of_joints.is_some_and(|positions| positions < self.of_classes);
        (is_unsafe && self.has_keyframes && is_short).then(|| {
            "a joint type in a class and another type in a joint, for which this engine's compiler writes beyond an array in a model with \
             keyframes, attach or replicate; state the types in the joints only"
                .to_owned()
        })
    }
}
