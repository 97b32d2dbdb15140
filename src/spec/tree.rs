//! Elements of a model description, as a tree with stable indices.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// Index of an element in a [`Tree`]. The index of a removed element is not used again.
pub(super) type Index = u32;

/// Joint position whose unit depends on the type of the joint, which may be a setting of another
/// element than the position.
#[derive(Clone, Debug)]
pub(super) struct Position {
    pub(super) attribute: String,
    /// Value of the attribute if it is an angle.
    pub(super) angle: String,
    /// Value of the attribute if it is a length.
    pub(super) length: String,
}

/// Element with values in a vector of a keyframe.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) index: Index,
    /// Number of the copy that each `replicate` around the element makes, from the outside.
    pub(super) copies: Vec<usize>,
    /// Number of values, `None` if only the compiler knows it.
    pub(super) width: Option<usize>,
    /// Hash of what determines a number that only the compiler knows.
    pub(super) makeup: u64,
}

/// Element of MJCF: a tag, attributes in the order of the text, and elements in it.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) tag: String,
    pub(super) attributes: Vec<(String, String)>,
    /// Positions from a spec with another unit of angles. The attribute has one of the two values.
    pub(super) positions: Vec<Position>,
    /// Vectors of a keyframe, and the elements to which their numbers belong.
    pub(super) owners: Vec<(String, Arc<Vec<Entry>>)>,
    pub(super) children: Vec<Index>,
    /// `None` for the root.
    pub(super) parent: Option<Index>,
}

impl Node {
    fn new(tag: &str, parent: Option<Index>) -> Self {
        Self {
            tag: tag.to_owned(),
            attributes: Vec::new(),
            positions: Vec::new(),
            owners: Vec::new(),
            children: Vec::new(),
            parent,
        }
    }

    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(found, _)| found == name).map(|(_, value)| &value[..])
    }

    pub(super) fn set(&mut self, name: &str, value: String) {
        self.forget(name);
        match self.attributes.iter_mut().find(|(found, _)| found == name) {
            Some((_, old)) => *old = value,
            // A name is the first attribute in the text, as is usual.
            None if name == "name" => self.attributes.insert(0, (name.to_owned(), value)),
            None => self.attributes.push((name.to_owned(), value)),
        }
    }

    pub(super) fn unset(&mut self, name: &str) -> Option<String> {
        let position = self.attributes.iter().position(|(found, _)| found == name)?;
        self.forget(name);
        Some(self.attributes.remove(position).1)
    }

    /// Removes what belongs to the old value of an attribute.
    fn forget(&mut self, name: &str) {
        self.positions.retain(|position| position.attribute != name);
        self.owners.retain(|(attribute, _)| attribute != name);
    }
}

/// Tree of elements. The root is the element `mujoco`.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// `None` for a removed element.
    nodes: Vec<Option<Node>>,
    /// Classes by their names, from the first search to the next change of a class.
    classes: OnceLock<HashMap<String, Index>>,
}

/// Tag of classes of defaults.
const CLASS: &str = "default";

impl Tree {
    pub(super) const ROOT: Index = 0;

    /// Creates a tree with a root only.
    pub(super) fn new(tag: &str) -> Self {
        Self { nodes: vec![Some(Node::new(tag, None))], classes: OnceLock::new() }
    }

    /// Returns the index of the next element.
    ///
    /// # Panics
    ///
    /// If the tree has 2³² elements.
    #[track_caller]
    pub(super) fn next(&self) -> Index {
        Index::try_from(self.nodes.len()).expect("a spec has fewer than 2³² elements")
    }

    pub(super) fn contains(&self, index: Index) -> bool {
        self.nodes.get(index as usize).is_some_and(Option::is_some)
    }

    /// # Panics
    ///
    /// If the element was removed.
    #[track_caller]
    pub(super) fn node(&self, index: Index) -> &Node {
        self.nodes[index as usize].as_ref().expect("the element was removed from its spec")
    }

    /// # Panics
    ///
    /// If the element was removed.
    #[track_caller]
    pub(super) fn node_mut(&mut self, index: Index) -> &mut Node {
        let node = self.nodes[index as usize].as_mut().expect("the element was removed from its spec");
        if node.tag == CLASS {
            self.classes.take();
        }
        node
    }

    /// Returns the classes by their names, which `find` finds in the tree.
    pub(super) fn classes(&self, find: impl FnOnce() -> HashMap<String, Index>) -> &HashMap<String, Index> {
        self.classes.get_or_init(find)
    }

    /// Returns `true` if an element has a position whose unit depends on the type of the joint.
    pub(super) fn has_positions(&self) -> bool {
        self.nodes.iter().flatten().any(|node| !node.positions.is_empty())
    }

    pub(super) fn tag(&self, index: Index) -> &str {
        &self.node(index).tag
    }

    pub(super) fn parent(&self, index: Index) -> Option<Index> {
        self.node(index).parent
    }

    pub(super) fn children(&self, index: Index) -> &[Index] {
        &self.node(index).children
    }

    pub(super) fn attribute(&self, index: Index, name: &str) -> Option<&str> {
        self.node(index).attribute(name)
    }

    /// Appends an element without attributes to the elements in `parent`.
    #[track_caller]
    pub(super) fn add(&mut self, parent: Index, tag: &str) -> Index {
        let index = self.next();
        self.node_mut(parent).children.push(index);
        self.nodes.push(Some(Node::new(tag, Some(parent))));
        if tag == CLASS {
            self.classes.take();
        }
        index
    }

    /// Removes an element and those in it.
    #[track_caller]
    pub(super) fn remove(&mut self, index: Index) {
        if let Some(parent) = self.parent(index) {
            self.node_mut(parent).children.retain(|&child| child != index);
        }
        self.classes.take();
        for index in self.descendants(index) {
            self.nodes[index as usize] = None;
        }
    }

    /// Moves an element to the end of the elements in `parent`.
    pub(super) fn relocate(&mut self, index: Index, parent: Index) {
        if let Some(old) = self.node_mut(index).parent.replace(parent) {
            self.node_mut(old).children.retain(|&child| child != index);
        }
        self.node_mut(parent).children.push(index);
    }

    /// Appends a copy of an element of another tree, with the elements in it, to those in `parent`.
    pub(super) fn copy(&mut self, from: &Self, source: Index, parent: Index) -> Index {
        self.copy_into(from, source, parent, &mut HashMap::new())
    }

    /// Copies like [`copy`](Self::copy), and inserts the copy of each element into `copies`.
    pub(super) fn copy_into(
        &mut self,
        from: &Self,
        source: Index,
        parent: Index,
        copies: &mut HashMap<Index, Index>,
    ) -> Index {
        let mut first = None;
        let mut open = vec![(source, parent)];
        while let Some((source, parent)) = open.pop() {
            let node = from.node(source);
            let copy = self.add(parent, &node.tag);
            self.node_mut(copy).attributes.clone_from(&node.attributes);
            self.node_mut(copy).positions.clone_from(&node.positions);
            self.node_mut(copy).owners.clone_from(&node.owners);
            copies.insert(source, copy);
            open.extend(node.children.iter().rev().map(|&child| (child, copy)));
            first.get_or_insert(copy);
        }
        first.expect("the source was copied")
    }

    /// Replaces an element by copies of the elements in the root of another tree, and returns the
    /// copies.
    pub(super) fn replace(&mut self, index: Index, from: &Self) -> Vec<Index> {
        let Some(parent) = self.parent(index) else { return Vec::new() };
        let position = self.children(parent).iter().position(|&child| child == index).unwrap_or_default();
        let after = self.node_mut(parent).children.split_off(position + 1);
        let copies: Vec<Index> =
            from.children(Self::ROOT).iter().map(|&child| self.copy(from, child, parent)).collect();
        self.node_mut(parent).children.extend(after);
        self.remove(index);
        copies
    }

    /// Returns an element and all elements in it, in the order of the text.
    pub(super) fn descendants(&self, index: Index) -> Vec<Index> {
        let mut found = Vec::new();
        let mut open = vec![index];
        while let Some(index) = open.pop() {
            found.push(index);
            open.extend(self.children(index).iter().rev());
        }
        found
    }

    /// Returns the elements directly in the root with this tag. MJCF may repeat its sections.
    pub(super) fn sections(&self, tag: &str) -> impl DoubleEndedIterator<Item = Index> {
        self.children(Self::ROOT).iter().copied().filter(move |&index| self.tag(index) == tag)
    }

    /// Returns the last section with this tag, and creates it if there is none.
    pub(super) fn section(&mut self, tag: &str) -> Index {
        let last = self.sections(tag).next_back();
        last.unwrap_or_else(|| self.add(Self::ROOT, tag))
    }
}
