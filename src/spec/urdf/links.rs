//! Links and joints of a URDF, and the tree that they form.

use std::collections::HashMap;

use super::element::{Urdf, abbreviated};
use crate::error::Result;
use crate::spec::names::WORLD;
use crate::spec::tree::Index;

/// Type of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    Floating,
    Planar,
    Spherical,
}

/// Types by their words, which the engine's reader compares byte by byte.
const TYPES: [(&str, Type); 7] = [
    ("revolute", Type::Revolute),
    ("continuous", Type::Continuous),
    ("prismatic", Type::Prismatic),
    ("fixed", Type::Fixed),
    ("floating", Type::Floating),
    ("planar", Type::Planar),
    ("spherical", Type::Spherical),
];

pub(super) struct Link<'t> {
    pub(super) element: Index,
    pub(super) name: &'t str,
    /// Number of the joint to the parent, `None` for a root.
    pub(super) joint: Option<usize>,
}

impl Link<'_> {
    /// Returns `true` for the link that is the world.
    pub(super) fn is_world(&self) -> bool {
        self.name == WORLD
    }
}

pub(super) struct Joint<'t> {
    pub(super) element: Index,
    pub(super) name: &'t str,
    pub(super) of_type: Type,
    pub(super) parent: usize,
}

/// Links and joints in the order of the text.
pub(super) struct Links<'t> {
    pub(super) all: Vec<Link<'t>>,
    pub(super) joints: Vec<Joint<'t>>,
    /// All links, each one with those below it after it, and the children of a link in the order of
    /// the joints.
    pub(super) order: Vec<usize>,
}

impl<'t> Links<'t> {
    pub(super) fn read(urdf: Urdf<'t>) -> Result<Self> {
        let mut links: Vec<Link<'t>> = Vec::new();
        let mut by_name: HashMap<&str, usize> = HashMap::new();
        for element in urdf.all("link") {
            let name = urdf.required_text(element, "name")?;
            if by_name.insert(name, links.len()).is_some() {
                return Err(urdf.error(format!("there are two links '{}'; names must be unique", abbreviated(name))));
            }
            links.push(Link { element, name, joint: None });
        }
        let mut joints: Vec<Joint<'t>> = Vec::new();
        let mut children: Vec<Vec<usize>> = links.iter().map(|_| Vec::new()).collect();
        for element in urdf.all("joint") {
            let joint = Joint {
                element,
                name: urdf.required_text(element, "name")?,
                of_type: of_type(urdf, element)?,
                parent: link(urdf, element, "parent", &by_name)?,
            };
            let child = link(urdf, element, "child", &by_name)?;
            let name = abbreviated(links[child].name);
            if let Some(other) = links[child].joint.replace(joints.len()) {
                let [a, b] = [joints[other].name, joint.name].map(abbreviated);
                let message =
                    format!("link '{name}' is the child of the joints '{a}' and '{b}'; a link has at most one parent");
                return Err(urdf.error(message));
            }
            if links[child].is_world() {
                let message =
                    format!("link 'world' is the world and cannot be the child of {}", urdf.describe(element));
                return Err(urdf.error(message));
            }
            children[joint.parent].push(child);
            joints.push(joint);
        }
        check_names(urdf, &joints)?;
        let mut order = Vec::with_capacity(links.len());
        let mut open: Vec<usize> = (0..links.len()).rev().filter(|&link| links[link].joint.is_none()).collect();
        while let Some(link) = open.pop() {
            order.push(link);
            open.extend(children[link].iter().rev());
        }
        let links = Self { all: links, joints, order };
        links.check_cycles(urdf)?;
        Ok(links)
    }

    /// Returns an error if a link is its own ancestor: such links are below no root.
    fn check_cycles(&self, urdf: Urdf<'_>) -> Result<()> {
        let mut is_below_root = vec![false; self.all.len()];
        for &link in &self.order {
            is_below_root[link] = true;
        }
        let Some(mut link) = is_below_root.iter().position(|is| !is) else { return Ok(()) };
        // The first link can be below a cycle. After this many parents it is in it.
        for _ in 0..self.all.len() {
            link = self.all[link].joint.map_or(link, |joint| self.joints[joint].parent);
        }
        let name = abbreviated(self.all[link].name);
        Err(urdf.error(format!("link '{name}' is its own ancestor: the joints must form a tree")))
    }
}

/// Returns an error if two joints with degrees of freedom have the same name.
fn check_names(urdf: Urdf<'_>, joints: &[Joint<'_>]) -> Result<()> {
    let mut known = std::collections::HashSet::new();
    for joint in joints.iter().filter(|joint| joint.of_type != Type::Fixed && !joint.name.is_empty()) {
        if !known.insert(joint.name) {
            let name = abbreviated(joint.name);
            return Err(urdf.error(format!("there are two joints '{name}'; names must be unique")));
        }
    }
    Ok(())
}

fn of_type(urdf: Urdf<'_>, joint: Index) -> Result<Type> {
    let word = urdf.required_text(joint, "type")?;
    let found = TYPES.iter().find(|(known, _)| *known == word).map(|&(_, of_type)| of_type);
    found.ok_or_else(|| {
        let known: Vec<&str> = TYPES.iter().map(|(word, _)| *word).collect();
        let (joint, word) = (urdf.describe(joint), abbreviated(word));
        urdf.error(format!("the type of {joint} is '{word}' instead of one of {}", known.join(", ")))
    })
}

/// Returns the number of the parent or of the child of a joint.
fn link(urdf: Urdf<'_>, joint: Index, tag: &str, by_name: &HashMap<&str, usize>) -> Result<usize> {
    let name = urdf.required_text(urdf.required(joint, tag)?, "link")?;
    by_name.get(name).copied().ok_or_else(|| {
        let name = abbreviated(name);
        urdf.error(format!("the {tag} of {} is '{name}', and there is no such link", urdf.describe(joint)))
    })
}
