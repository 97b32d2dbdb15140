//! The distance of two geoms.

use std::mem::MaybeUninit;

use mujoco_sys::{
    guard, mjContact, mjGEOM_BOX, mjGEOM_CAPSULE, mjGEOM_ELLIPSOID, mjGEOM_HFIELD, mjGEOM_PLANE, mjGEOM_SPHERE,
    mjMAXCONPAIR,
};

use super::{Computed, Data};
use crate::error::{Error, Result};
use crate::id::GeomId;

/// How far two geoms are from each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeomDistance {
    /// The distance, m; negative where they penetrate.
    pub distance: f64,
    /// The nearest points, m, world frame: of the first geom, of the second.
    pub fromto: [[f64; 3]; 2],
}

/// The contact of two geoms that is nearest or deepest.
#[derive(Clone, Copy)]
struct Nearest {
    distance: f64,
    midpoint: [f64; 3],
    /// From the geom of the smaller type to the other.
    normal: [f64; 3],
}

/// The positive distance of a pair for which the engine searches is bracketed until it is known to this, m.
const RESOLUTION: f64 = 1e-9;

impl Data {
    /// The smallest signed distance of two geoms; `None` if it is larger than `distmax` in m. The meaning is that of
    /// `mj_geomDistance` in the newer engines, which 2.2.2 does not have; here it comes from the collision functions.
    ///
    /// Planes, spheres and capsules among each other, and spheres with boxes, have formulas. All other pairs are convex shapes,
    /// for which the engine searches (Minkowski portal refinement of libccd, to the precision `mpr_tolerance`): a positive
    /// distance is bracketed by growing the shapes until they touch; a penetration is a depth along which they come apart, and
    /// may not be the smallest one. A mesh is its convex hull.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before poses were computed, [`Error::Invalid`] for a `distmax` that is negative or not finite,
    /// [`Error::Unsupported`] for a pair that the engine has no function for, such as two planes, or for a geom whose pose is not
    /// finite, [`Error::Engine`] for a shape that the collision functions reject, such as a box whose size is not positive. The
    /// latter poisons the data, because the engine moves geoms during the call.
    ///
    /// # Panics
    ///
    /// If an id is of another model.
    ///
    /// ```
    /// use mujoco_safe::{Data, Model};
    ///
    /// let mut data = Data::new(Model::from_xml_str(
    ///     r#"<mujoco><worldbody>
    ///          <geom name="a" size="0.5"/>
    ///          <body pos="2 0 0"><freejoint/><geom name="b" size="0.25"/></body>
    ///        </worldbody></mujoco>"#,
    /// )?)?;
    /// data.forward()?;
    /// let [a, b] = ["a", "b"].map(|name| data.model().geom(name).map(|geom| geom.id()));
    /// let found = data.geom_distance(a?, b?, 10.0)?.expect("nearer than 10 m");
    /// assert!((found.distance - 1.25).abs() < 1e-12);
    /// assert_eq!(found.fromto, [[0.5, 0.0, 0.0], [1.75, 0.0, 0.0]]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_geomDistance")]
    pub fn geom_distance(
        &mut self,
        geom1: impl Into<GeomId>,
        geom2: impl Into<GeomId>,
        distmax: f64,
    ) -> Result<Option<GeomDistance>> {
        let geoms = [geom1.into(), geom2.into()];
        for geom in geoms {
            self.model().check_id(geom);
        }
        self.check_parts("geom_distance", Computed::KINEMATICS)?;
        if !(distmax.is_finite() && distmax >= 0.0) {
            return Err(Error::invalid("distmax of geom_distance", distmax, "finite and not negative"));
        }
        let geoms = geoms.map(|geom| geom.index());
        for geom in geoms {
            let pose = self.geom_xpos()[geom].iter().chain(&self.geom_xmat()[geom]);
            if !pose.copied().all(f64::is_finite) {
                return Err(Error::Unsupported(format!("the distance of geom {geom}, whose pose is not finite")));
            }
        }
        // The engine's table has a function for the smaller type first.
        let types = geoms.map(|geom| self.model().geom_type()[geom] as u32);
        let turned = types[0] > types[1];
        let pair = if turned { [geoms[1], geoms[0]] } else { geoms };
        let nearest =
            if self.exact(pair) { self.nearest(pair, Search::Table, distmax)? } else { self.searched(pair, distmax)? };
        Ok(nearest.filter(|nearest| nearest.distance <= distmax).map(|Nearest { distance, midpoint, normal }| {
            let at = |side: f64| std::array::from_fn(|i| midpoint[i] + side * distance * normal[i]);
            let fromto = if turned { [at(0.5), at(-0.5)] } else { [at(-0.5), at(0.5)] };
            GeomDistance { distance, fromto }
        }))
    }

    /// Whether the engine has a formula for the distance of a pair, in order of types.
    fn exact(&self, pair: [usize; 2]) -> bool {
        let [first, second] = pair.map(|geom| self.model().geom_type()[geom] as u32);
        let round = |geom_type| [mjGEOM_SPHERE, mjGEOM_CAPSULE].contains(&geom_type);
        first == mjGEOM_PLANE || (round(first) && round(second)) || (first == mjGEOM_SPHERE && second == mjGEOM_BOX)
    }

    /// The nearest contact of a pair that the engine searches for.
    fn searched(&mut self, pair: [usize; 2], distmax: f64) -> Result<Option<Nearest>> {
        let types = pair.map(|geom| self.model().geom_type()[geom] as u32);
        // Of boxes the engine's own functions tell contacts, not distances.
        let search = if types == [mjGEOM_BOX; 2] || types == [mjGEOM_CAPSULE, mjGEOM_BOX] {
            Search::Convex
        } else {
            Search::Table
        };
        if let Some(nearest) = self.nearest(pair, search, 0.0)? {
            return Ok(Some(nearest));
        }
        // Convex shapes are not farther from each other than their centres. A height field is not convex.
        let [a, b] = pair.map(|geom| self.geom_xpos()[geom]);
        let mut farthest = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt() * (1.0 + 1e-9);
        if types[0] == mjGEOM_HFIELD {
            farthest += pair.iter().map(|&geom| self.model().geom_rbound()[geom].abs()).sum::<f64>();
        }
        let mut upper = distmax.min(farthest);
        let Some(mut nearest) = self.nearest(pair, search, upper)? else { return Ok(None) };
        // Grown by less than the distance, the shapes do not meet.
        let mut lower: f64 = 0.0;
        while upper - lower > RESOLUTION.max(1e-12 * upper) {
            let middle = lower + 0.5 * (upper - lower);
            if middle <= lower || middle >= upper {
                break;
            }
            match self.nearest(pair, search, middle)? {
                Some(found) => (upper, nearest) = (middle, found),
                None => lower = middle,
            }
        }
        Ok(Some(Nearest { distance: upper, ..nearest }))
    }

    /// The nearest of the contacts that a collision function finds within a margin.
    fn nearest(&mut self, [first, second]: [usize; 2], search: Search, margin: f64) -> Result<Option<Nearest>> {
        #[allow(
            clippy::large_stack_arrays,
            reason = "as large as the engine's own, of 26 kB, on its way to the same function"
        )]
        let mut contacts = [const { MaybeUninit::<mjContact>::uninit() }; mjMAXCONPAIR as usize];
        let types = match search {
            Search::Table => [first, second].map(|geom| self.model().geom_type()[geom]),
            Search::Convex => [mjGEOM_ELLIPSOID as i32; 2],
        };
        let mut count = 0;
        let (found, place) = (contacts.as_mut_ptr().cast(), &raw mut count);
        self.call_mut("mjCOLLISIONFUNC", |m, d| {
            // SAFETY: two geoms of this model, whose poses were computed, and the function for their types or the one for any two
            // convex shapes; room for the largest number of contacts that a function may find. It moves the geoms and puts them
            // back, for which `call_mut` borrows the data exclusively.
            unsafe { guard::collide(m, d, found, types[0], types[1], first as i32, second as i32, margin, place) }
        })?;
        let Ok(count) = usize::try_from(count) else {
            return Err(Error::Unsupported(format!(
                "the distance of geoms {first} and {second}: the engine has no collision function for their types"
            )));
        };
        let nearest = contacts[..count].iter().map(|contact| {
            // The functions leave what is not theirs uninitialised, so there is no reference to the whole.
            let contact = contact.as_ptr();
            // SAFETY: what every collision function sets of each contact that it counts.
            let (distance, midpoint, frame) = unsafe { ((*contact).dist, (*contact).pos, (*contact).frame) };
            Nearest { distance, midpoint, normal: [frame[0], frame[1], frame[2]] }
        });
        Ok(nearest.filter(|nearest| !nearest.distance.is_nan()).min_by(|a, b| a.distance.total_cmp(&b.distance)))
    }
}

/// Which function finds the contacts.
#[derive(Clone, Copy)]
enum Search {
    /// That of the engine's table.
    Table,
    /// That for any two convex shapes.
    Convex,
}
