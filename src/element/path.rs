//! The paths of tendons: as the model describes them, and as they lie in space.

use std::fmt;
use std::ops::Range;

use crate::enums::WrapType;
use crate::ffi;
use crate::id::{GeomId, Id, JointId, Lineage, SiteId};
use crate::model::Model;

/// One element of a tendon's path.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[doc(alias = "mjtWrap")]
pub enum Wrap {
    /// Fixed tendons: a joint, whose position counts with a coefficient.
    Joint {
        /// The joint.
        joint: JointId,
        /// By what its position is multiplied.
        coefficient: f64,
    },
    /// Here a branch ends and another begins, whose length counts less.
    Pulley {
        /// By what the length of the branch is divided.
        divisor: f64,
    },
    /// A site that it passes through.
    Site(SiteId),
    /// A sphere that it goes around.
    Sphere {
        /// The sphere.
        geom: GeomId,
        /// The site on whose side it passes, if that is given.
        side: Option<SiteId>,
    },
    /// A cylinder, without ends, that it goes around.
    Cylinder {
        /// The cylinder.
        geom: GeomId,
        /// The site on whose side it passes, if that is given.
        side: Option<SiteId>,
    },
}

/// The path of a tendon as the model describes it: an iterator over its elements.
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
        // The id of a site, as a real number; -1 is none.
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

/// One point of a tendon's path in space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WrapPoint {
    /// At a site.
    Site {
        /// Where, m, world frame.
        xpos: [f64; 3],
    },
    /// Where it touches or leaves a geom.
    Geom {
        /// The geom.
        geom: GeomId,
        /// Where, m, world frame.
        xpos: [f64; 3],
    },
    /// Between two branches: no point.
    Pulley,
}

/// The path of a tendon as it lies in space: an iterator over its points.
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
