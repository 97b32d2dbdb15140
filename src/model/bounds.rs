//! Bounds by which the engine skips pairs of geoms in collision detection: bounding spheres and
//! boxes of geoms, and the hierarchies of boxes, the margins and the masks of bodies.
//!
//! The compiler computes the bounds, and the engine detects no contact outside of them, even if the
//! values that they depend on have changed. Mutable access to such values therefore makes the
//! bounds [loose](ModelMut::loosen_bounds), which hides no contact and is slower. (Collision
//! functions can find contacts outside of the bounds: the function for two boxes takes a lower
//! bound for the distance of edges.) [`update_bounds`](ModelMut::update_bounds) computes the bounds
//! of the present values.

use super::{Model, ModelMut};
use crate::enums::GeomType;
#[cfg(engine_since = "2.3.3")]
use crate::ffi;
#[cfg(engine_since = "3.5.0")]
use crate::math;

/// Radius and half the edges of loose bounds, m. The engine uses this length in its boxes of
/// planes.
const LOOSE: f64 = 1e10;

/// Writes a value to an array that the generated accessors do not write.
#[cfg(engine_since = "2.3.3")]
macro_rules! write {
    ($edit:ident.$array:ident[$index:expr] = $value:expr) => {{
        let (index, length) = ($index, $edit.$array().len());
        let array = $edit.raw_mut().$array;
        // SAFETY: the engine allocated the array with this length, and the model is borrowed
        // exclusively.
        let array = unsafe { ffi::array_mut(array.cast(), length) };
        array[index] = $value;
    }};
}

impl ModelMut<'_> {
    /// Makes the bounds so large that they contain everything. Mutable access to a value that
    /// bounds depend on calls this first.
    pub(crate) fn loosen_bounds(&mut self) {
        if std::mem::replace(&mut self.inner().has_loose_bounds, true) {
            return;
        }
        for geom in 0..self.ngeom() {
            if self.extent(geom).is_some() {
                self.set_geom_bounds(geom, [LOOSE; 3], LOOSE);
            }
        }
        #[cfg(engine_since = "2.3.3")]
        for body in 0..self.nbody() {
            for node in self.nodes(body) {
                write!(self.bvh_aabb[node] = [0.0, 0.0, 0.0, LOOSE, LOOSE, LOOSE]);
            }
            #[cfg(engine_since = "3.0.0")]
            write!(self.body_margin[body] = LOOSE);
        }
    }

    /// Loosens the bounds, if the engine has bounds that depend on more than the sizes of geoms.
    pub(crate) fn loosen_boxes(&mut self) {
        if cfg!(engine_since = "2.3.3") {
            self.loosen_bounds();
        }
    }

    /// Computes the bounds of the present values.
    pub(crate) fn update_bounds(&mut self) {
        self.inner().has_loose_bounds = false;
        for geom in 0..self.ngeom() {
            if let Some((half, radius)) = self.extent(geom) {
                self.set_geom_bounds(geom, half, radius);
            }
        }
        self.update_masks();
        #[cfg(engine_since = "3.0.0")]
        for body in 0..self.nbody() {
            let margin = self.geoms_of(body).map(|geom| self.reach(geom)).fold(0.0, f64::max);
            write!(self.body_margin[body] = margin);
        }
        // The frame of the boxes in the hierarchies of older engines is unknown: they stay loose.
        #[cfg(engine_since = "3.5.0")]
        for body in 0..self.nbody() {
            self.update_hierarchy(body);
        }
    }

    /// Computes the bounds of the present values, if they are loose.
    pub(crate) fn tighten_bounds(&mut self) {
        if self.inner().has_loose_bounds {
            self.update_bounds();
        }
    }

    /// Declares that the arrays of bounds have been overwritten, so that the next edit must loosen
    /// them again.
    pub(crate) fn forget_loose_bounds(&mut self) {
        self.inner().has_loose_bounds = false;
    }

    /// Computes the masks of bodies from the masks of their geoms.
    #[cfg_attr(not(engine_since = "2.3.3"), allow(clippy::unused_self, reason = "bodies have no masks"))]
    pub(crate) fn update_masks(&mut self) {
        #[cfg(engine_since = "3.0.0")]
        for body in 0..self.nbody() {
            let contype = self.geoms_of(body).fold(0, |mask, geom| mask | self.geom_contype()[geom]);
            let conaffinity = self.geoms_of(body).fold(0, |mask, geom| mask | self.geom_conaffinity()[geom]);
            write!(self.body_contype[body] = contype);
            write!(self.body_conaffinity[body] = conaffinity);
        }
        #[cfg(engine_since = "2.3.3")]
        self.inner().disable_unsafe_midphase();
    }

    fn set_geom_bounds(&mut self, geom: usize, half: [f64; 3], radius: f64) {
        self.geom_rbound_mut()[geom] = radius;
        #[cfg(engine_since = "2.3.3")]
        write!(self.geom_aabb[geom] = [0.0, 0.0, 0.0, half[0], half[1], half[2]]);
        #[cfg(not(engine_since = "2.3.3"))]
        let _ = half;
    }

    /// Computes the boxes in the hierarchy of a body, in its inertial frame, from the leaves to the
    /// root.
    #[cfg(engine_since = "3.5.0")]
    fn update_hierarchy(&mut self, body: usize) {
        let nodes = self.nodes(body);
        // A child follows its parent.
        for node in nodes.clone().rev() {
            // Nodes of bodies that contain fused ones have the geom of an earlier hierarchy in
            // 3.5.0, so that only a leaf's is valid.
            let aabb = match self.bvh_child()[node] {
                [-1, -1] => self.box_of(ffi::size(self.bvh_nodeid()[node])),
                children => {
                    let [first, second] = children.map(|child| self.bvh_aabb()[nodes.start + ffi::size(child)]);
                    union(&first, &second)
                }
            };
            write!(self.bvh_aabb[node] = aabb);
        }
        if let Some(root) = nodes.clone().next() {
            let outside = self.geoms_without_box(body);
            let aabb = outside.iter().fold(self.bvh_aabb()[root], |aabb, &geom| union(&aabb, &self.box_of(geom)));
            write!(self.bvh_aabb[root] = aabb);
        }
    }
}

impl Model {
    /// Returns half the edges of the bounding box and the radius of the bounding sphere of a geom,
    /// if they are determined by its size.
    fn extent(&self, geom: usize) -> Option<([f64; 3], f64)> {
        let size @ [a, b, c] = self.geom_size()[geom];
        Some(match GeomType::of_field(self.geom_type()[geom]) {
            GeomType::Sphere => ([a; 3], a),
            GeomType::Capsule => ([a, a, a + b], a + b),
            GeomType::Cylinder => ([a, a, b], (a * a + b * b).sqrt()),
            GeomType::Ellipsoid => (size, a.max(b).max(c)),
            GeomType::Box => (size, (a * a + b * b + c * c).sqrt()),
            _ => return None,
        })
    }
}

/// # Hierarchies of bounding boxes
#[cfg(engine_since = "2.3.3")]
impl Model {
    /// Returns the nodes of the hierarchy of a body.
    fn nodes(&self, body: usize) -> std::ops::Range<usize> {
        let start = usize::try_from(self.body_bvhadr()[body]).unwrap_or(0);
        start..start + ffi::size(self.body_bvhnum()[body])
    }

    /// Returns the distance from a geom at which it has contacts.
    #[cfg(engine_since = "3.0.0")]
    fn reach(&self, geom: usize) -> f64 {
        // A later release measures the gap outwards. Until its number is known, the larger distance
        // is correct for both.
        let gap = if cfg!(engine_since = "3.6.0") { self.geom_gap()[geom] } else { 0.0 };
        self.geom_margin()[geom] + gap
    }

    /// Returns the bounding box of a geom in the inertial frame of its body: centre and half the
    /// edges.
    #[cfg(engine_since = "3.5.0")]
    fn box_of(&self, geom: usize) -> [f64; 6] {
        let body = ffi::size(self.geom_bodyid()[geom]);
        let [x, y, z, half @ ..] = self.geom_aabb()[geom];
        let (to_inertia, orientation) = (math::neg_quat(&self.body_iquat()[body]), &self.geom_quat()[geom]);
        let centre = math::rot_vec_quat(&[x, y, z], orientation);
        let (pos, ipos) = (self.geom_pos()[geom], self.body_ipos()[body]);
        let centre = math::rot_vec_quat(&std::array::from_fn(|i| centre[i] + pos[i] - ipos[i]), &to_inertia);
        let axes = math::quat2mat(&math::mul_quat(&to_inertia, orientation));
        let half: [f64; 3] = std::array::from_fn(|i| (0..3).map(|j| axes[3 * i + j].abs() * half[j]).sum());
        [centre[0], centre[1], centre[2], half[0], half[1], half[2]]
    }

    /// Returns the geoms of a body that collide, but are not in its hierarchy because the compiler
    /// excludes geoms that do not collide.
    fn geoms_without_box(&self, body: usize) -> Vec<usize> {
        let nodes = self.nodes(body);
        let collides = |geom: usize| self.geom_contype()[geom] != 0 || self.geom_conaffinity()[geom] != 0;
        let geoms = self.geoms_of(body);
        if nodes.is_empty() || nodes.len() == 2 * geoms.len() - 1 {
            // Without a hierarchy the engine tests all geoms.
            return Vec::new();
        }
        #[cfg(engine_since = "3.0.0")]
        let leaves = &self.bvh_nodeid()[nodes];
        #[cfg(not(engine_since = "3.0.0"))]
        let leaves = &self.bvh_geomid()[nodes];
        geoms.filter(|&geom| collides(geom) && !leaves.contains(&(geom as i32))).collect()
    }

    /// Sets the masks of these geoms to zero and returns the masks, because newer engines raise an
    /// error for them in `mj_setConst`.
    #[cfg(engine_since = "3.0.0")]
    pub(super) fn hide_geoms_without_box(&mut self) -> Vec<(usize, [i32; 2])> {
        let geoms = (0..self.nbody()).flat_map(|body| self.geoms_without_box(body));
        let masks: Vec<_> =
            geoms.map(|geom| (geom, [self.geom_contype()[geom], self.geom_conaffinity()[geom]])).collect();
        self.set_masks(&masks.iter().map(|&(geom, _)| (geom, [0; 2])).collect::<Vec<_>>());
        masks
    }

    #[cfg(engine_since = "3.0.0")]
    pub(super) fn set_masks(&mut self, masks: &[(usize, [i32; 2])]) {
        for &(geom, [contype, conaffinity]) in masks {
            let edit = &mut self.edit();
            write!(edit.geom_contype[geom] = contype);
            write!(edit.geom_conaffinity[geom] = conaffinity);
        }
    }

    /// Disables the phase of collision detection that uses the hierarchies if it would skip a geom:
    /// see [`DisableFlags::MIDPHASE`](super::DisableFlags::MIDPHASE).
    pub(super) fn disable_unsafe_midphase(&mut self) {
        if (0..self.nbody()).any(|body| !self.geoms_without_box(body).is_empty()) {
            self.raw_mut().opt.disableflags |= mujoco_sys::mjDSBL_MIDPHASE as i32;
        }
    }
}

/// Returns the smallest box that contains two boxes.
#[cfg(engine_since = "3.5.0")]
fn union(first: &[f64; 6], second: &[f64; 6]) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for i in 0..3 {
        let least = (first[i] - first[i + 3]).min(second[i] - second[i + 3]);
        let most = (first[i] + first[i + 3]).max(second[i] + second[i + 3]);
        (sum[i], sum[i + 3]) = (0.5 * (least + most), 0.5 * (most - least));
    }
    sum
}
