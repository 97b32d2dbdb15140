//! Elements of a URDF that have no meaning for the engine.

use std::collections::BTreeMap;

use super::UrdfWarning;
use super::element::abbreviated;
use crate::spec::tree::Tree;

/// Returns the elements in an element that are converted.
fn known(tag: &str) -> &'static [&'static str] {
    match tag {
        "robot" => &["link", "joint", "material", "mujoco"],
        "link" => &["inertial", "visual", "collision"],
        "inertial" => &["origin", "mass", "inertia"],
        "visual" => &["origin", "geometry", "material"],
        "collision" => &["origin", "geometry"],
        "geometry" => &["box", "cylinder", "sphere", "capsule", "mesh"],
        "material" => &["color"],
        "joint" => &["parent", "child", "origin", "axis", "dynamics", "limit", "mimic"],
        "mujoco" => &["compiler", "option", "size"],
        _ => &[],
    }
}

/// Descriptions of what is ignored, with their numbers.
#[derive(Default)]
pub(super) struct Ignored(BTreeMap<String, usize>);

impl Ignored {
    pub(super) fn add(&mut self, what: &str) {
        *self.0.entry(abbreviated(what)).or_default() += 1;
    }

    /// Adds the elements of a URDF that are not converted.
    pub(super) fn add_elements(&mut self, urdf: &Tree) {
        let mut open = vec![(Tree::ROOT, "robot")];
        while let Some((parent, tag)) = open.pop() {
            for &index in urdf.children(parent) {
                let child = urdf.tag(index);
                match known(tag).contains(&child) {
                    // The sections of MuJoCo are checked by the schema.
                    true if tag == "mujoco" => {}
                    true => open.push((index, child)),
                    false if parent == Tree::ROOT => self.add(&format!("<{child}>")),
                    false => self.add(&format!("<{child}> in <{tag}>")),
                }
            }
        }
    }

    pub(super) fn into_warnings(self) -> impl Iterator<Item = UrdfWarning> {
        self.0.into_iter().map(|(what, count)| UrdfWarning::Ignored { what, count })
    }
}
