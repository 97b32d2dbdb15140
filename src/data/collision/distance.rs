//! Distance between two geoms.

use std::mem::MaybeUninit;

use mujoco_sys::{
    guard, mjContact, mjGEOM_BOX, mjGEOM_CAPSULE, mjGEOM_ELLIPSOID, mjGEOM_HFIELD, mjGEOM_PLANE, mjGEOM_SDF,
    mjGEOM_SPHERE, mjMAXCONPAIR,
};

use crate::data::{Data, PipelineFlags};
use crate::error::{Error, Result};
use crate::id::IntoId;
use crate::kind;

/// Distance between two geoms, and the nearest points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeomDistance {
    /// Distance, m. Negative for penetration.
    pub distance: f64,
    /// Nearest points of the first and the second geom, m, world frame.
    pub fromto: [[f64; 3]; 2],
}

/// Contact that a collision function has found.
#[derive(Clone, Copy)]
pub(crate) struct FoundContact {
    pub(crate) distance: f64,
    pub(crate) midpoint: [f64; 3],
    /// Points from the geom with the smaller type number to the other. Almost a unit vector.
    pub(crate) normal: [f64; 3],
}

/// Width, m, to which the bracket of a positive distance is reduced.
const RESOLUTION: f64 = 1e-9;

/// # Distances between geoms
impl Data {
    /// Computes the smallest signed distance between two geoms, or `None` if it is larger than
    /// `distmax` in m. Newer engines provide this as `mj_geomDistance`. Version 2.2.2 does not, so
    /// this method uses the collision functions.
    ///
    /// Pairs of planes, spheres and capsules, and spheres with boxes, have closed-form solutions.
    /// For all other pairs of convex shapes the engine iterates (Minkowski portal refinement of
    /// libccd, to the precision `mpr_tolerance`): a positive distance is found by bisection of the
    /// collision margin; a penetration depth is enough to separate the shapes, but may not be the
    /// smallest one. Meshes are replaced by their convex hulls.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before poses were computed, [`Error::Invalid`] for a `distmax` that
    /// is negative or not finite, [`Error::Unsupported`] for a pair without a collision function,
    /// such as two planes, for a signed distance field, or for a geom whose pose is not finite,
    /// [`Error::Engine`] for a shape that the collision functions reject, such as a box whose size
    /// is not positive. This last error poisons the data, because the engine moves geoms during the
    /// call.
    ///
    /// # Panics
    ///
    /// If an id belongs to another model.
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
    /// let found = data.geom_distance("a", "b", 10.0)?.expect("nearer than 10 m");
    /// assert!((found.distance - 1.25).abs() < 1e-12);
    /// assert_eq!(found.fromto, [[0.5, 0.0, 0.0], [1.75, 0.0, 0.0]]);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_geomDistance")]
    pub fn geom_distance(
        &mut self,
        geom1: impl IntoId<kind::Geom>,
        geom2: impl IntoId<kind::Geom>,
        distmax: f64,
    ) -> Result<Option<GeomDistance>> {
        let model = &**self.model();
        let geoms = [geom1.id_in(model)?.index(), geom2.id_in(model)?.index()];
        self.check_parts("geom_distance", PipelineFlags::KINEMATICS)?;
        if !(distmax.is_finite() && distmax >= 0.0) {
            return Err(Error::out_of_range("distmax of geom_distance", distmax, "finite and not negative"));
        }
        for geom in geoms {
            let pose = self.geom_xpos()[geom].iter().chain(&self.geom_xmat()[geom]);
            if !pose.copied().all(f64::is_finite) {
                return Err(Error::Unsupported(format!("the distance of geom {geom}, whose pose is not finite")));
            }
        }
        if let Some(geom) = geoms.into_iter().find(|&geom| self.model().geom_type()[geom] as u32 == mjGEOM_SDF) {
            return Err(Error::Unsupported(format!("the distance of geom {geom}, a signed distance field")));
        }
        // The collision functions expect the geom with the smaller type number first.
        let types = geoms.map(|geom| self.model().geom_type()[geom] as u32);
        let swapped = types[0] > types[1];
        let pair = if swapped { [geoms[1], geoms[0]] } else { geoms };
        let nearest = if self.has_closed_form(pair) {
            self.nearest(pair, CollisionFunction::Table, distmax)?
        } else {
            self.nearest_by_bisection(pair, distmax)?
        };
        Ok(nearest.filter(|nearest| nearest.distance <= distmax).map(|FoundContact { distance, midpoint, normal }| {
            let at = |side: f64| std::array::from_fn(|i| midpoint[i] + side * distance * normal[i]);
            let fromto = if swapped { [at(0.5), at(-0.5)] } else { [at(-0.5), at(0.5)] };
            GeomDistance { distance, fromto }
        }))
    }

    /// Returns `true` if the engine has a closed-form solution for a pair, which is sorted by type.
    fn has_closed_form(&self, pair: [usize; 2]) -> bool {
        let [first, second] = pair.map(|geom| self.model().geom_type()[geom] as u32);
        let round = |geom_type| [mjGEOM_SPHERE, mjGEOM_CAPSULE].contains(&geom_type);
        first == mjGEOM_PLANE || (round(first) && round(second)) || (first == mjGEOM_SPHERE && second == mjGEOM_BOX)
    }

    /// Returns the nearest contact of a pair without a closed-form solution.
    fn nearest_by_bisection(&mut self, pair: [usize; 2], distmax: f64) -> Result<Option<FoundContact>> {
        let types = pair.map(|geom| self.model().geom_type()[geom] as u32);
        // The special functions for boxes compute contacts only, and no distances.
        let function = if types == [mjGEOM_BOX; 2] || types == [mjGEOM_CAPSULE, mjGEOM_BOX] {
            CollisionFunction::Convex
        } else {
            CollisionFunction::Table
        };
        if let Some(nearest) = self.nearest(pair, function, 0.0)? {
            return Ok(Some(nearest));
        }
        // The distance of convex shapes is at most the distance of their centres. A height field is
        // not convex.
        let [a, b] = pair.map(|geom| self.geom_xpos()[geom]);
        let mut farthest = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt() * (1.0 + 1e-9);
        if types[0] == mjGEOM_HFIELD {
            farthest += pair.iter().map(|&geom| self.model().geom_rbound()[geom].abs()).sum::<f64>();
        }
        let mut upper = distmax.min(farthest);
        let Some(mut nearest) = self.nearest(pair, function, upper)? else { return Ok(None) };
        // With a margin below the distance, the shapes do not collide.
        let mut lower: f64 = 0.0;
        while upper - lower > RESOLUTION.max(1e-12 * upper) {
            let middle = lower + 0.5 * (upper - lower);
            if middle <= lower || middle >= upper {
                break;
            }
            match self.nearest(pair, function, middle)? {
                Some(found) => (upper, nearest) = (middle, found),
                None => lower = middle,
            }
        }
        Ok(Some(FoundContact { distance: upper, ..nearest }))
    }

    /// Returns the nearest of the contacts that a collision function finds within a margin.
    fn nearest(&mut self, pair: [usize; 2], function: CollisionFunction, margin: f64) -> Result<Option<FoundContact>> {
        let mut nearest: Option<FoundContact> = None;
        self.collide(pair, function, margin, |found| {
            let is_nearer = nearest.is_none_or(|nearest| found.distance.total_cmp(&nearest.distance).is_lt());
            if is_nearer && !found.distance.is_nan() {
                nearest = Some(found);
            }
        })?;
        Ok(nearest)
    }

    /// Calls `found` for each contact that a collision function finds within a margin, for a pair
    /// that is sorted by type.
    pub(crate) fn collide(
        &mut self,
        [first, second]: [usize; 2],
        function: CollisionFunction,
        margin: f64,
        found: impl FnMut(FoundContact),
    ) -> Result<()> {
        #[allow(
            clippy::large_stack_arrays,
            reason = "26 kB, as large as the array on the stack of the engine's caller of this function"
        )]
        let mut contacts = [const { MaybeUninit::<mjContact>::uninit() }; mjMAXCONPAIR as usize];
        let types = match function {
            CollisionFunction::Table => [first, second].map(|geom| self.model().geom_type()[geom]),
            CollisionFunction::Convex => [mjGEOM_ELLIPSOID as i32; 2],
        };
        let mut count = 0;
        let (array, place) = (contacts.as_mut_ptr().cast(), &raw mut count);
        self.call_mut("mjCOLLISIONFUNC", |m, d| {
            // SAFETY: two geoms of this model, whose poses were computed, and the function for
            // their types or the one for any two convex shapes; an array for the largest number of
            // contacts that a function may find. The function moves the geoms and restores them,
            // for which `call_mut` borrows the data exclusively.
            unsafe { guard::collide(m, d, array, types[0], types[1], first as i32, second as i32, margin, place) }
        })?;
        let Ok(count) = usize::try_from(count) else {
            return Err(Error::Unsupported(format!(
                "the distance of geoms {first} and {second}: the engine has no collision function for their types"
            )));
        };
        let contacts = contacts[..count].iter().map(|contact| {
            // The collision functions leave some fields uninitialised, so a reference to the whole
            // struct would be invalid.
            let contact = contact.as_ptr();
            // SAFETY: every collision function sets these fields of each contact that it counts.
            let (distance, midpoint, frame) = unsafe { ((*contact).dist, (*contact).pos, (*contact).frame) };
            FoundContact { distance, midpoint, normal: [frame[0], frame[1], frame[2]] }
        });
        contacts.for_each(found);
        Ok(())
    }
}

/// Selection of the collision function.
#[derive(Clone, Copy)]
pub(crate) enum CollisionFunction {
    /// Function of the engine's table for the types of the pair.
    Table,
    /// Function for any two convex shapes.
    Convex,
}
