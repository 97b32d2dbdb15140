//! Removal of elements.

use super::Spec;
use super::key::ElementId;
use super::names::{self, Named};
use super::tree::{Index, Tree};
use crate::error::{Error, Result};

/// # Removal
impl Spec {
    /// Removes an element and all elements in it.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`], and nothing is removed, if other elements refer to a removed one, or if the element is the world or the root.
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
        let referrers = self.referrers(&[index]);
        if referrers.is_empty() {
            self.tree.remove(index);
            return Ok(());
        }
        let list: Vec<String> = referrers.iter().map(|&index| names::describe(&self.tree, index)).collect();
        let element = names::describe(&self.tree, index);
        Err(Error::invalid(
            format!("the number of references to {element}"),
            format!("{} ({})", list.len(), list.join(", ")),
            "0 before it is removed; remove_with_references also removes these elements",
        ))
    }

    /// Removes an element, all elements in it, and all elements that refer to a removed one. A tendon is removed as a whole. References to a
    /// removed class, material or texture are removed instead of the elements that have them.
    ///
    /// # Errors
    ///
    /// [`Error::Invalid`] if the element is the world or the root.
    ///
    /// # Panics
    ///
    /// If the id belongs to another spec, or the element was removed.
    #[track_caller]
    pub fn remove_with_references<K>(&mut self, id: ElementId<K>) -> Result<()> {
        let mut removed = vec![self.removable(id)?];
        loop {
            self.remove_attributes(&removed);
            let referrers = self.referrers(&removed);
            if referrers.is_empty() {
                break;
            }
            removed.extend(referrers);
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
            return Err(Error::invalid("the element to remove", element, "another one than the world and the root"));
        }
        Ok(index)
    }

    /// Removes the attributes without which an element can exist and that refer to the given elements or to those in them.
    fn remove_attributes(&mut self, removed: &[Index]) {
        const OPTIONAL: [&str; 4] = ["class", "childclass", "material", "texture"];
        for (class, name) in self.removed_names(removed) {
            for index in names::referrers(&self.tree, class, &name) {
                for attribute in OPTIONAL {
                    let refers = names::references(&self.tree, index).contains(&(attribute, class));
                    if refers && self.tree.attribute(index, attribute) == Some(&name) {
                        self.tree.node_mut(index).unset(attribute);
                    }
                }
            }
        }
    }

    /// Returns the names of the given elements and those in them, except the names that other elements have too.
    fn removed_names(&self, removed: &[Index]) -> Vec<(Named, String)> {
        let inside: Vec<Index> = removed.iter().flat_map(|&index| self.tree.descendants(index)).collect();
        let name = |index: Index| names::named(&self.tree, index).zip(names::name(&self.tree, index));
        let remains = |(class, text): &(Named, &str)| {
            names::all(&self.tree, *class)
                .any(|other| !inside.contains(&other) && names::name(&self.tree, other) == Some(text))
        };
        let names = inside.iter().filter_map(|&index| name(index)).filter(|name| !remains(name));
        names.map(|(class, name)| (class, name.to_owned())).collect()
    }

    /// Returns the elements outside of the given ones that refer to an element in them. An element without a name of its own, such as a
    /// part of a tendon, is represented by the one that contains it.
    fn referrers(&self, removed: &[Index]) -> Vec<Index> {
        let inside: Vec<Index> = removed.iter().flat_map(|&index| self.tree.descendants(index)).collect();
        let mut found = Vec::new();
        for (class, name) in self.removed_names(removed) {
            for referrer in names::referrers(&self.tree, class, &name) {
                let whole = self.whole(referrer);
                if !inside.contains(&whole) && !found.contains(&whole) {
                    found.push(whole);
                }
            }
        }
        found
    }

    /// Returns the tendon, tuple, material or skin of which an element is a part, or the element.
    fn whole(&self, index: Index) -> Index {
        let is_part = matches!(self.tree.tag(index), "site" | "geom" | "joint" | "element" | "bone" | "layer")
            && names::named(&self.tree, index).is_none();
        match self.tree.parent(index) {
            Some(parent) if is_part && self.tree.tag(parent) != "default" => parent,
            _ => index,
        }
    }
}
