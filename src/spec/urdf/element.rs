//! Elements of a URDF, their values, and errors that name them.

use crate::error::{Error, Result};
use crate::spec::tree::{Index, Tree};
use crate::spec::value;

/// Longest name in a message, in characters.
const LONGEST: usize = 80;

/// Elements of a URDF.
#[derive(Clone, Copy)]
pub(super) struct Urdf<'t> {
    pub(super) tree: &'t Tree,
    pub(super) source_name: &'t str,
}

impl<'t> Urdf<'t> {
    pub(super) fn error(&self, message: String) -> Error {
        Error::Load { source_name: self.source_name.to_owned(), message }
    }

    /// Returns the elements with a tag directly in the robot.
    pub(super) fn all(&self, tag: &'static str) -> impl Iterator<Item = Index> + use<'t> {
        let tree = self.tree;
        tree.children(Tree::ROOT).iter().copied().filter(move |&index| tree.tag(index) == tag)
    }

    /// Returns the only element with a tag in another one. Two are an error.
    pub(super) fn child(&self, parent: Index, tag: &str) -> Result<Option<Index>> {
        let mut found = self.tree.children(parent).iter().copied().filter(|&index| self.tree.tag(index) == tag);
        let first = found.next();
        if found.next().is_some() {
            return Err(self.error(format!("{} has more than one <{tag}>", self.describe(parent))));
        }
        Ok(first)
    }

    pub(super) fn required(&self, parent: Index, tag: &str) -> Result<Index> {
        self.child(parent, tag)?.ok_or_else(|| self.error(format!("{} has no <{tag}>", self.describe(parent))))
    }

    pub(super) fn text(&self, index: Index, attribute: &str) -> Option<&'t str> {
        self.tree.attribute(index, attribute)
    }

    pub(super) fn required_text(&self, index: Index, attribute: &str) -> Result<&'t str> {
        let missing = || self.error(format!("{} has no attribute '{attribute}'", self.describe(index)));
        self.text(index, attribute).ok_or_else(missing)
    }

    /// Returns the numbers of an attribute, which are finite.
    pub(super) fn numbers<const N: usize>(&self, index: Index, attribute: &str) -> Result<Option<[f64; N]>> {
        let Some(text) = self.text(index, attribute) else { return Ok(None) };
        let numbers = value::numbers(text).and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        let numbers = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
        let expected = if N == 1 { "a finite number".to_owned() } else { format!("{N} finite numbers") };
        numbers.map(Some).ok_or_else(|| self.wrong(index, attribute, &expected))
    }

    pub(super) fn required_numbers<const N: usize>(&self, index: Index, attribute: &str) -> Result<[f64; N]> {
        self.required_text(index, attribute)?;
        Ok(self.numbers(index, attribute)?.unwrap_or([0.0; N]))
    }

    /// Returns a number that is not NaN.
    pub(super) fn limit(&self, index: Index, attribute: &str) -> Result<Option<f64>> {
        let Some(text) = self.text(index, attribute) else { return Ok(None) };
        let number = text.trim().parse().ok().filter(|number: &f64| !number.is_nan());
        number.map(Some).ok_or_else(|| self.wrong(index, attribute, "a number"))
    }

    fn wrong(&self, index: Index, attribute: &str, expected: &str) -> Error {
        let found = abbreviated(self.text(index, attribute).unwrap_or_default());
        self.error(format!("attribute '{attribute}' of {} is '{found}' instead of {expected}", self.describe(index)))
    }

    /// Describes an element: `<limit> of joint 'elbow'`.
    pub(super) fn describe(&self, index: Index) -> String {
        let mut parts = Vec::new();
        let mut at = index;
        while let Some(parent) = self.tree.parent(at) {
            let tag = self.tree.tag(at);
            parts.push(match self.text(at, "name") {
                Some(name) if parent == Tree::ROOT => format!("{tag} '{}'", abbreviated(name)),
                _ => format!("<{tag}>"),
            });
            at = parent;
        }
        if parts.is_empty() { "the robot".to_owned() } else { parts.join(" of ") }
    }
}

/// Returns a number for a message.
pub(super) fn number(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 || !size.is_finite() || (1e-4..1e16).contains(&size) {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

/// Returns the start of a text for a message.
pub(super) fn abbreviated(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
