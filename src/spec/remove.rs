//! Removal of elements.

use std::collections::HashSet;

use super::Spec;
use super::element_id::ElementId;
use super::names::{self, Names};
use super::tree::{Index, Tree};
use super::{attach, attributes};
use crate::error::{Error, InvalidKind, Result};

/// # Removal
impl Spec {
    /// Removes an element and all elements in it.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`], and nothing is removed, if other elements refer to a removed one, or if
    /// the element is the world or the root. [`Error::Unsupported`] if an attribute that only
    /// engines newer than the supported ones have may refer to it.
    ///
    /// # Panics
    ///
    /// If the id belongs to another spec, or the element was removed.
    ///
    /// ```
    /// use mujoco_safe::spec::Spec;
    ///
    /// let mut spec = Spec::from_xml_str(
    ///     "<mujoco>
    ///        <worldbody><body name='arm'><joint name='elbow'/><geom size='0.1'/></body></worldbody>
    ///        <actuator><motor name='torque' joint='elbow'/></actuator>
    ///      </mujoco>",
    /// )?;
    /// let arm = spec.body("arm")?.id();
    /// let error = spec.remove(arm).unwrap_err();
    /// assert!(error.to_string().contains("motor 'torque'"), "{error}");
    ///
    /// spec.remove_with_references(arm)?;
    /// assert_eq!(spec.compile()?.nbody(), 1);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mjs_delete")]
    #[track_caller]
    pub fn remove<K>(&mut self, id: ElementId<K>) -> Result<()> {
        let index = self.removable(id)?;
        self.check_unknown(&[index])?;
        let referrers = self.referrers(&[index]);
        if referrers.is_empty() {
            self.tree.remove(index);
            return Ok(());
        }
        let list: Vec<String> = referrers.iter().map(|&index| names::describe(&self.tree, index)).collect();
        let element = names::describe(&self.tree, index);
        Err(Error::invalid(
            InvalidKind::Unsuitable,
            format!("the number of references to {element}"),
            format!("{} ({})", list.len(), list.join(", ")),
            "0 before it is removed; remove_with_references also removes these elements",
        ))
    }

    /// Removes an element, all elements in it, and all elements that refer to a removed one. A
    /// tendon is removed as a whole. References to a removed class, material or texture are removed
    /// instead of the elements that have them. A class whose defaults refer to a removed mesh or
    /// height field loses the reference, and the elements that have it from the class are removed.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if the element is the world or the root, [`Error::Unsupported`] as for
    /// [`remove`](Self::remove). Nothing is removed then.
    ///
    /// # Panics
    ///
    /// If the id belongs to another spec, or the element was removed.
    #[track_caller]
    pub fn remove_with_references<K>(&mut self, id: ElementId<K>) -> Result<()> {
        let mut removed = vec![self.removable(id)?];
        let before = self.tree.clone();
        loop {
            let heirs = self.remove_attributes(&removed);
            removed.extend(heirs);
            let referrers = self.referrers(&removed);
            if referrers.is_empty() {
                break;
            }
            removed.extend(referrers);
        }
        if let Err(error) = self.check_unknown(&removed) {
            self.tree = before;
            return Err(error);
        }
        for index in removed {
            if self.tree.contains(index) {
                self.tree.remove(index);
            }
        }
        Ok(())
    }

    #[track_caller]
    fn removable<K>(&self, id: ElementId<K>) -> Result<Index> {
        let index = self.index(id);
        if index == Tree::ROOT || index == self.world {
            let element = names::describe(&self.tree, index);
            return Err(Error::invalid(
                InvalidKind::Unsuitable,
                "the element to remove",
                element,
                "another one than the world and the root",
            ));
        }
        Ok(index)
    }

    /// Removes the attributes without which an element or a class can exist and that refer to the
    /// given elements or to those in them. Returns the elements that had other references than
    /// these from a class.
    fn remove_attributes(&mut self, removed: &[Index]) -> Vec<Index> {
        const OPTIONAL: [&str; 4] = ["class", "childclass", "material", "texture"];
        let names = self.removed_names(removed);
        let mut heirs = Vec::new();
        for index in names::referrers(&self.tree, &names) {
            // A layer of a material needs its texture, and the material does not need the layer.
            if self.tree.tag(index) == "layer" {
                self.tree.remove(index);
                continue;
            }
            let is_default = self.tree.parent(index).is_some_and(|parent| self.tree.tag(parent) == "default");
            let references = names::references(&self.tree, index).into_iter();
            let removable: Vec<String> = references
                .filter(|found| is_default || OPTIONAL.contains(&found.attribute))
                .filter(|found| found.refers_to(&self.tree, index, &names))
                .map(|found| found.attribute.to_owned())
                .collect();
            for attribute in removable {
                if !OPTIONAL.contains(&&attribute[..]) {
                    heirs.extend(attach::heirs(&self.tree, index, &attribute));
                }
                self.tree.node_mut(index).unset(&attribute);
            }
        }
        heirs
    }

    /// Returns an error if an attribute of a newer engine may refer to an element that is to be
    /// removed.
    fn check_unknown(&self, removed: &[Index]) -> Result<()> {
        let inside = self.inside(removed);
        let names = self.removed_names(removed);
        let may_be_removed = |value: &str| {
            names.contains_key(value) || value.split_ascii_whitespace().any(|word| names.contains_key(word))
        };
        for other in self.tree.descendants(Tree::ROOT).into_iter().filter(|index| !inside.contains(index)) {
            for attribute in attributes::unknown(&self.tree, other) {
                if self.tree.attribute(other, attribute).is_some_and(may_be_removed) {
                    let [element, other] = [removed[0], other].map(|index| names::describe(&self.tree, index));
                    return Err(Error::Unsupported(format!(
                        "cannot remove {element}: attribute '{attribute}' of {other} is not known here and may refer to it"
                    )));
                }
            }
        }
        Ok(())
    }

    /// Returns the names of the given elements and those in them, except the names that other
    /// elements have too.
    fn removed_names(&self, removed: &[Index]) -> Names {
        let inside = self.inside(removed);
        let mut names = Names::new();
        let name = |index: Index| names::named(&self.tree, index).zip(names::name(&self.tree, index));
        for (class, text) in inside.iter().filter_map(|&index| name(index)) {
            names.entry(text.to_owned()).or_default().push(class);
        }
        let others = self.tree.descendants(Tree::ROOT).into_iter().filter(|index| !inside.contains(index));
        for (class, text) in others.filter_map(name) {
            if let Some(classes) = names.get_mut(text) {
                classes.retain(|&removed| removed != class);
            }
        }
        names
    }

    /// Returns the elements outside of the given ones that refer to an element in them. An element
    /// without a name of its own, such as a part of a tendon, is represented by the one that
    /// contains it.
    fn referrers(&self, removed: &[Index]) -> Vec<Index> {
        let inside = self.inside(removed);
        let mut found = Vec::new();
        for referrer in names::referrers(&self.tree, &self.removed_names(removed)) {
            let whole = self.whole(referrer);
            if !inside.contains(&whole) && !found.contains(&whole) {
                found.push(whole);
            }
        }
        found
    }

    fn inside(&self, removed: &[Index]) -> HashSet<Index> {
        removed
            .iter()
            .filter(|&&index| self.tree.contains(index))
            .flat_map(|&index| self.tree.descendants(index))
            .collect()
    }

    /// Returns the tendon, tuple or skin of which an element is a part, or the element.
    fn whole(&self, index: Index) -> Index {
        let is_part = matches!(self.tree.tag(index), "site" | "geom" | "joint" | "element" | "bone")
            && names::named(&self.tree, index).is_none();
        match self.tree.parent(index) {
            Some(parent) if is_part && self.tree.tag(parent) != "default" => parent,
            _ => index,
        }
    }
}
