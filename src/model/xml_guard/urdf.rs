//! Checks that the engine's URDF reader lacks.
//!
//! The reader of 2.2.2 dereferences a null pointer for a joint of an unknown type. It adds links to
//! the tree of bodies by recursion along the joints, so a long chain overflows the stack.

use std::collections::HashMap;

use super::files::abbreviated;
use super::tags::Tag;

/// Joint types that the reader supports, the last one since 3.2. It compares them byte by byte.
const JOINT_TYPES: &[&str] = if cfg!(engine_since = "3.2.0") {
    &["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical"]
} else {
    &["revolute", "continuous", "prismatic", "fixed", "floating", "planar"]
};

/// Depths of tags below the root element: `<link>` and `<joint>` are its children, `<parent>` and
/// `<child>` are a joint's.
const IN_ROOT: usize = 1;
const IN_JOINT: usize = 2;

/// Joints of a URDF, collected tag by tag.
#[derive(Default)]
pub(super) struct Urdf {
    root: Root,
    joints: Vec<Joint>,
    /// `true` while the most recent child of the root element is a joint.
    in_joint: bool,
}

#[derive(Default, PartialEq)]
enum Root {
    #[default]
    NotSeen,
    /// `<robot>`, in upper or lower case: the text is a URDF.
    Robot,
    /// Another element, or a second root element, which the engine ignores.
    Other,
}

#[derive(Default)]
struct Joint {
    position: usize,
    parent: Option<Vec<u8>>,
    child: Option<Vec<u8>>,
}

impl Urdf {
    /// Returns `true` if the text is a URDF.
    pub(super) fn is_urdf(&self) -> bool {
        self.root == Root::Robot
    }

    /// Records a start tag at `depth` below the document. Returns the reason to reject it, if any.
    pub(super) fn record(&mut self, tag: &Tag<'_>, depth: usize) -> Result<(), String> {
        if depth == 0 {
            let is_robot = self.root == Root::NotSeen && tag.name.eq_ignore_ascii_case(b"robot");
            self.root = if is_robot { Root::Robot } else { Root::Other };
        }
        if self.root != Root::Robot {
            return Ok(());
        }
        match depth {
            IN_ROOT => {
                self.in_joint = tag.name == b"joint";
                if self.in_joint {
                    check_type(tag)?;
                    self.joints.push(Joint { position: tag.position, ..Joint::default() });
                }
            }
            IN_JOINT if self.in_joint => self.record_link(tag),
            _ => {}
        }
        Ok(())
    }

    /// Records the parent or the child of the current joint. The reader rejects a second one.
    fn record_link(&mut self, tag: &Tag<'_>) {
        let (Some(joint), Some(link)) = (self.joints.last_mut(), tag.attribute(b"link")) else { return };
        match tag.name {
            b"parent" => joint.parent = Some(link.into_owned()),
            b"child" => joint.child = Some(link.into_owned()),
            _ => {}
        }
    }

    /// Checks that no link is its own ancestor, and that no chain of links has more than `longest`
    /// joints. Returns the number of joints in the longest chain, or the position of the offending
    /// joint and the reason. Visits each link once, without recursion.
    pub(super) fn check_chains(&self, longest: usize) -> Result<usize, (usize, String)> {
        // The reader rejects a link with two parents, so either is sufficient here.
        let joint_of: HashMap<&[u8], (&[u8], usize)> = self
            .joints
            .iter()
            .filter_map(|joint| Some((joint.child.as_deref()?, (joint.parent.as_deref()?, joint.position))))
            .collect();
        // Number of joints between a link and its root; `None` while the link is on the current
        // path.
        let mut depths: HashMap<&[u8], Option<usize>> = HashMap::new();
        for start in self.joints.iter().filter_map(|joint| joint.child.as_deref()) {
            let mut path = Vec::new();
            let mut link = start;
            let mut depth = loop {
                match (depths.get(link), joint_of.get(link)) {
                    (Some(&Some(depth)), _) => break depth,
                    (Some(None), joint) => {
                        let position = joint.map_or(0, |&(_, position)| position);
                        return Err((position, format!("link '{}' is its own ancestor", abbreviated(link))));
                    }
                    (None, None) => break 0,
                    (None, Some(&(parent, _))) => {
                        depths.insert(link, None);
                        path.push(link);
                        link = parent;
                    }
                }
            };
            for link in path.into_iter().rev() {
                depth += 1;
                if depth > longest {
                    let (_, position) = joint_of[link];
                    return Err((
                        position,
                        format!("link '{}' ends a chain of more than {longest} joints", abbreviated(link)),
                    ));
                }
                depths.insert(link, Some(depth));
            }
        }
        Ok(depths.into_values().flatten().max().unwrap_or_default())
    }
}

/// Rejects a type that the reader does not support. The reader itself reports a missing type.
fn check_type(tag: &Tag<'_>) -> Result<(), String> {
    match tag.attribute(b"type") {
        Some(found) if !JOINT_TYPES.iter().any(|known| known.as_bytes() == &*found) => Err(format!(
            "the joint has type '{}', but the URDF reader supports only {}, in lower case and without spaces",
            abbreviated(&found),
            JOINT_TYPES.join(", ")
        )),
        _ => Ok(()),
    }
}
