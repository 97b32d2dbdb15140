//! Number and depth of the elements that the compiler creates from a text, in which `<replicate>`
//! and `<attach>` copy other elements. Copies of copies grow exponentially with the length of the
//! text.

use std::collections::HashMap;
use std::ops::Add;

use super::tags::Tag;
use super::{MOST_ELEMENTS, MOST_NESTED, grid};

/// Size of a tree of elements after its expansion.
#[derive(Clone, Copy, Default)]
pub(super) struct Size {
    elements: u64,
    /// Attached models. The text may describe them after their use.
    models: u64,
    depth: usize,
}

impl Size {
    pub(super) fn elements(self) -> u64 {
        self.elements
    }

    fn times(self, count: u64) -> Self {
        Self {
            elements: self.elements.saturating_mul(count),
            models: self.models.saturating_mul(count),
            depth: self.depth,
        }
    }

    /// Returns the size of the elements that were added to `before`. The depth includes `before`.
    fn since(self, before: Self) -> Self {
        Self { elements: self.elements - before.elements, models: self.models - before.models, depth: self.depth }
    }

    /// Returns the larger of each number.
    fn max(self, other: Self) -> Self {
        Self {
            elements: self.elements.max(other.elements),
            models: self.models.max(other.models),
            depth: self.depth.max(other.depth),
        }
    }
}

impl Add for Size {
    type Output = Self;

    /// Adds the numbers of elements. The depth is the larger one.
    fn add(self, other: Self) -> Self {
        Self {
            elements: self.elements.saturating_add(other.elements),
            models: self.models.saturating_add(other.models),
            depth: self.depth.max(other.depth),
        }
    }
}

/// Body or frame whose end tag has not been read.
struct Open {
    name: Vec<u8>,
    /// Number of elements that contain it.
    outer: usize,
    /// The model's size before it.
    before: Size,
    /// Depth of the deepest element in it, from the root.
    deepest: usize,
}

/// Size of a model, collected tag by tag.
pub(super) struct Expansion {
    size: Size,
    /// Depth and count of each `replicate` element that contains the present one.
    replicates: Vec<(usize, u64)>,
    /// The world, and the bodies and frames that contain the present element.
    open: Vec<Open>,
    /// Sizes of the bodies and frames with a name.
    named: HashMap<Vec<u8>, Size>,
    /// Upper bound of the sizes of the models that are assets of this one.
    child: Size,
}

impl Default for Expansion {
    fn default() -> Self {
        let world = Open { name: b"world".to_vec(), outer: 0, before: Size::default(), deepest: 0 };
        Self {
            size: Size::default(),
            replicates: Vec::new(),
            open: vec![world],
            named: HashMap::new(),
            child: Size::default(),
        }
    }
}

impl Expansion {
    /// Returns the number of copies of an element at the present place.
    pub(super) fn copies(&self) -> u64 {
        self.replicates.iter().fold(1, |product: u64, (_, count)| product.saturating_mul(*count))
    }

    /// Records a start tag in `outer` elements. Returns the reason to reject it, if any.
    pub(super) fn start(&mut self, tag: &Tag<'_>, outer: usize) -> Result<(), String> {
        let before = self.size;
        let count = self.copies();
        let copies = if tag.name == b"attach" { self.copied(tag) } else { Size::default() };
        let elements = if [&b"composite"[..], b"flexcomp"].contains(&tag.name) { grid(tag) } else { 1 };
        self.size = self.size + (copies + Size { elements, ..Size::default() }).times(count);
        self.reaches(outer + 1 + copies.depth)?;
        if self.size.elements > MOST_ELEMENTS && (!self.replicates.is_empty() || tag.name == b"attach") {
            return Err(too_many());
        }
        match tag.name {
            b"replicate" if !tag.empty => {
                let count = tag.integer(b"count").and_then(|count| u64::try_from(count).ok()).unwrap_or(MOST_ELEMENTS);
                self.replicates.push((outer, count.clamp(1, MOST_ELEMENTS)));
                // The compiler attaches each copy, also if it is empty.
                self.size = self.size + Size { elements: 1, ..Size::default() }.times(self.copies());
                if self.size.elements > MOST_ELEMENTS {
                    return Err(too_many());
                }
            }
            b"body" | b"frame" => {
                let name = tag.attribute(b"name").unwrap_or_default().into_owned();
                let open = Open { name, outer, before, deepest: outer + 1 };
                if tag.empty { self.close(open) } else { self.open.push(open) }
            }
            _ => {}
        }
        Ok(())
    }

    /// Records an end tag in `outer` elements.
    pub(super) fn end(&mut self, outer: usize) {
        self.replicates.retain(|&(depth, _)| depth < outer);
        // The world stays open.
        while self.open[1..].last().is_some_and(|open| open.outer >= outer)
            && let Some(open) = self.open.pop()
        {
            self.close(open);
        }
    }

    fn close(&mut self, open: Open) {
        if let Some(parent) = self.open.last_mut() {
            parent.deepest = parent.deepest.max(open.deepest);
        }
        let size = self.within(&open);
        self.name(open.name, size);
    }

    /// Records the size of a body or frame. A body and a frame may have the same name.
    fn name(&mut self, name: Vec<u8>, size: Size) {
        let known = self.named.entry(name).or_default();
        *known = known.max(size);
    }

    /// Returns the size of a body or frame up to the present tag.
    fn within(&self, open: &Open) -> Size {
        Size { depth: open.deepest - open.outer, ..self.size.since(open.before) }
    }

    /// Returns the size of the elements that an `<attach>` copies.
    fn copied(&mut self, tag: &Tag<'_>) -> Size {
        if tag.attribute(b"model").is_some() {
            return Size { models: 1, ..Size::default() };
        }
        let name = tag.attribute(b"body").or_else(|| tag.attribute(b"frame")).unwrap_or_default();
        let deepest = self.deepest();
        let open = self.open.iter().filter(|open| open.name == *name);
        let known = open
            .map(|open| Size { depth: deepest - open.outer, ..self.within(open) })
            .chain(self.named.get(&*name).copied())
            .reduce(Size::max);
        // The name may belong to a part of a copy, which is not recorded.
        let size = known.unwrap_or(Size { depth: deepest, ..self.size });
        let prefix = tag.attribute(b"prefix").unwrap_or_default();
        self.name([&prefix[..], &name].concat(), size);
        size
    }

    /// Records an element at a depth. Returns the reason to reject it, if any.
    fn reaches(&mut self, depth: usize) -> Result<(), String> {
        if let Some(open) = self.open.last_mut() {
            open.deepest = open.deepest.max(depth);
        }
        if depth > MOST_NESTED { Err(too_deep()) } else { Ok(()) }
    }

    fn deepest(&self) -> usize {
        self.open.iter().map(|open| open.deepest).max().unwrap_or_default()
    }

    /// Records a model that is an asset of this one.
    pub(super) fn record_model(&mut self, child: Size) {
        self.child = self.child.max(child);
    }

    /// Returns the size of the model, or the reason to reject it. `chain` is the depth of its links
    /// if it is a URDF.
    pub(super) fn finish(&self, chain: usize) -> Result<Size, String> {
        let attached = if self.size.models > 0 { self.child } else { Size::default() };
        let elements = self.size.elements.saturating_add(attached.elements.saturating_mul(self.size.models));
        let depth = self.deepest().max(chain) + attached.depth;
        if elements > MOST_ELEMENTS && self.size.models > 0 {
            return Err(too_many());
        }
        if depth > MOST_NESTED { Err(too_deep()) } else { Ok(Size { elements, models: 0, depth }) }
    }
}

fn too_many() -> String {
    format!("the model has more than {MOST_ELEMENTS} elements after its replication")
}

fn too_deep() -> String {
    format!("elements are nested more than {MOST_NESTED} deep")
}
