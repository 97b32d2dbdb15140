//! Paths of tendons: the waypoints in the model, and the points in space.

use std::fmt;
use std::ops::Range;

use crate::enums::WrapType;
use crate::ffi;
use crate::id::{GeomId, Id, JointId, Lineage, SiteId};
use crate::model::Model;

/// Element of a tendon's path.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Wrap {
    /// Joint of a fixed tendon.
    Joint {
        /// Joint.
        joint: JointId,
        /// Coefficient that multiplies the joint position.
        coefficient: f64,
    },
    /// Pulley: the end of one branch and the start of the next.
    Pulley {
        /// Divisor of the length of the following branch.
        divisor: f64,
    },
    /// Site that the tendon passes through.
    Site(SiteId),
    /// Sphere that the tendon wraps around.
    Sphere {
        /// Sphere.
        geom: GeomId,
        /// Site that selects the side on which the tendon passes, if any.
        side: Option<SiteId>,
    },
    /// Infinite cylinder that the tendon wraps around.
    Cylinder {
        /// Cylinder.
        geom: GeomId,
        /// Site that selects the side on which the tendon passes, if any.
        side: Option<SiteId>,
    },
}

/// Iterator over the elements of a tendon's path in the model.
#[derive(Clone)]
pub struct Wraps<'a> {
    model: &'a Model,
    range: Range<usize>,
}

impl<'a> Wraps<'a> {
    pub(super) fn new(model: &'a Model, range: Range<usize>) -> Self {
        Self { model, range }
    }
}

impl Iterator for Wraps<'_> {
    type Item = Wrap;

    fn next(&mut self) -> Option<Wrap> {
        let at = self.range.next()?;
        let (object, parameter) = (self.model.wrap_objid()[at], self.model.wrap_prm()[at]);
        let lineage = self.model.lineage();
        let geom = || Id::new(ffi::size(object), lineage);
        // The engine stores the id of the side site as a double; -1 means none.
        let side = || (parameter >= 0.0).then(|| Id::new(parameter as usize, lineage));
        Some(match WrapType::of_field(self.model.wrap_type()[at]) {
            WrapType::Joint => Wrap::Joint { joint: Id::new(ffi::size(object), lineage), coefficient: parameter },
            WrapType::Pulley => Wrap::Pulley { divisor: parameter },
            WrapType::Site => Wrap::Site(Id::new(ffi::size(object), lineage)),
            WrapType::Sphere => Wrap::Sphere { geom: geom(), side: side() },
            WrapType::Cylinder => Wrap::Cylinder { geom: geom(), side: side() },
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.range.size_hint()
    }
}

impl ExactSizeIterator for Wraps<'_> {}

impl fmt::Debug for Wraps<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.clone()).finish()
    }
}

/// Point of a tendon's path in space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WrapPoint {
    /// Point at a site.
    Site {
        /// Position, m, world frame.
        xpos: [f64; 3],
    },
    /// Tangent point on a geom.
    Geom {
        /// Geom.
        geom: GeomId,
        /// Position, m, world frame.
        xpos: [f64; 3],
    },
    /// Separator between two branches, without a position.
    Pulley,
}

/// Iterator over the points of a tendon's path in space.
#[derive(Clone)]
pub struct WrapPoints<'a> {
    objects: &'a [i32],
    positions: &'a [[f64; 3]],
    lineage: Lineage,
}

impl<'a> WrapPoints<'a> {
    pub(super) fn new(objects: &'a [i32], positions: &'a [[f64; 3]], lineage: Lineage) -> Self {
        Self { objects, positions, lineage }
    }
}

impl Iterator for WrapPoints<'_> {
    type Item = WrapPoint;

    fn next(&mut self) -> Option<WrapPoint> {
        let ((object, objects), (&xpos, positions)) = (self.objects.split_first()?, self.positions.split_first()?);
        (self.objects, self.positions) = (objects, positions);
        Some(match object {
            -2 => WrapPoint::Pulley,
            geom if *geom >= 0 => WrapPoint::Geom { geom: Id::new(ffi::size(*geom), self.lineage), xpos },
            _ => WrapPoint::Site { xpos },
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.objects.len(), Some(self.objects.len()))
    }
}

impl ExactSizeIterator for WrapPoints<'_> {}

impl fmt::Debug for WrapPoints<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.clone()).finish()
    }
}
