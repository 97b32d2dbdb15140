//! Views of flexes and of instances of plugins. Their fields are those of newer engines:
//! [`newer`](super::newer).

use super::View;
use crate::data::Data;
use crate::kind;
use crate::model::Model;

fields!(Flex on Model {
});

fields!(Flex on Data {
});

fields!(Plugin on Model {
});

fields!(Plugin on Data {
});

/// # Configuration of [`Plugin`](super::Plugin)
#[cfg(engine_since = "2.3.0")]
impl<'a> View<'a, Model, kind::Plugin> {
    /// Returns the values of the attributes that the plugin declares, in their order. An attribute
    /// that the model does not set is empty.
    #[doc(alias = "plugin_attr")]
    #[doc(alias = "plugin_attradr")]
    pub fn attr(&self) -> impl Iterator<Item = std::borrow::Cow<'a, str>> + use<'a> {
        let model = self.owner;
        let values = model.plugin_attributes();
        let own = super::to_next(model.plugin_attradr(), self.id.index(), values.len());
        values[own]
            .split_inclusive(|&byte| byte == 0)
            .map(|value| String::from_utf8_lossy(value.strip_suffix(&[0]).unwrap_or(value)))
    }
}

#[cfg(any(feature = "html", feature = "mcap", feature = "gltf"))]
impl Model {
    /// Returns the triangles of a flex as indices of its vertices: its elements in two dimensions,
    /// its surface in three. `None` for a rope. The second value is `true` in two dimensions, whose
    /// triangles have two sides.
    #[cfg(engine_since = "3.0.0")]
    pub(crate) fn flex_triangles(&self, flex: usize) -> Option<(&[[i32; 3]], bool)> {
        let (numbers, start, count) = match self.flex_dim()[flex] {
            2 => (self.flex_elem(), self.flex_elemdataadr()[flex], self.flex_elemnum()[flex]),
            3 => (self.flex_shell(), self.flex_shelldataadr()[flex], self.flex_shellnum()[flex]),
            _ => return None,
        };
        let (triangles, _) = numbers.get(start.max(0) as usize..)?.as_chunks();
        Some((triangles.get(..count.max(0) as usize)?, self.flex_dim()[flex] == 2))
    }

    /// Returns the index of the body to which each vertex of a flex is fixed. `None` if the
    /// vertices are interpolated between bodies.
    #[cfg(all(feature = "gltf", engine_since = "3.0.0"))]
    pub(crate) fn flex_bodies(&self, flex: usize) -> Option<&[i32]> {
        #[cfg(engine_since = "3.3.0")]
        if self.flex_interp()[flex] != 0 {
            return None;
        }
        let start = self.flex_vertadr()[flex].max(0) as usize;
        self.flex_vertbodyid().get(start..)?.get(..self.flex_vertnum()[flex].max(0) as usize)
    }

    /// Older engines have no flexes.
    #[cfg(all(feature = "gltf", not(engine_since = "3.0.0")))]
    #[allow(clippy::unused_self, reason = "newer engines read the model")]
    pub(crate) fn flex_bodies(&self, _: usize) -> Option<&[i32]> {
        None
    }

    /// Older engines have no flexes.
    #[cfg(not(engine_since = "3.0.0"))]
    #[allow(clippy::unused_self, reason = "newer engines read the model")]
    pub(crate) fn flex_triangles(&self, _: usize) -> Option<(&[[i32; 3]], bool)> {
        None
    }
}
