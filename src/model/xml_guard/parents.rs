//! Elements on which the compiler crashes, or that it rejects too late, inside a certain mesh or
//! `flexcomp`.

use super::is_empty;
use super::tags::Tag;

/// The mesh or `flexcomp` that contains the present place.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Parent {
    /// Neither.
    #[default]
    Other,
    /// A mesh from a file. The engine crashes if it has a plugin.
    FileMesh,
    /// A `flexcomp` whose points are a grid. The engine crashes if a `flexcomp` has a plugin
    /// without a name.
    Grid,
    /// Another `flexcomp`.
    Points,
}

impl Parent {
    /// Records the start of an element, and returns the reason to reject it.
    pub(super) fn start(&mut self, tag: &Tag<'_>) -> Option<&'static str> {
        let lacks_all = |names: [&[u8]; 2]| names.iter().all(|name| is_empty(tag, name));
        match tag.name {
            b"mesh" if !tag.empty && tag.attribute(b"file").is_some() => *self = Self::FileMesh,
            b"flexcomp" if !tag.empty => {
                let is_grid = tag.attribute(b"type").is_none_or(|kind| *kind == *b"grid");
                *self = if is_grid { Self::Grid } else { Self::Points };
            }
            b"plugin" if *self == Self::FileMesh => return Some("a mesh has either a file or a plugin"),
            b"plugin" if *self != Self::Other && lacks_all([b"plugin", b"instance"]) => {
                return Some("the plugin of a flexcomp needs the attribute plugin or instance");
            }
            // Compilers before 4.0 mark the points of a grid that the flex does not have, beyond
            // the end of an array.
            b"pin"
                if cfg!(not(engine_since = "4.0.0"))
                    && *self == Self::Points
                    && !lacks_all([b"grid", b"gridrange"]) =>
            {
                return Some("the grid or gridrange of a pin needs a flexcomp of type grid; use id or range");
            }
            _ => {}
        }
        None
    }

    /// Records the end of an element.
    pub(super) fn end(&mut self, tag: &Tag<'_>) {
        if [&b"mesh"[..], b"flexcomp"].contains(&tag.name) {
            *self = Self::Other;
        }
    }
}
