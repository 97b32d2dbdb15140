//! Contacts and their forces.

use std::fmt;

use mujoco_sys::{self as sys, mjContact};

use super::{Data, Stage};
use crate::error::Result;
use crate::ffi;
use crate::id::{GeomId, Id};

/// A contact that collision detection found.
#[derive(Clone, Copy)]
#[doc(alias = "mjContact")]
pub struct Contact<'d> {
    data: &'d Data,
    index: usize,
    raw: &'d mjContact,
}

/// What a contact does to the second of its geoms, in the contact frame; the first receives the opposite.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ContactForce {
    /// Force, N: along the normal, then along the two tangents.
    pub force: [f64; 3],
    /// Torque, N·m: about the normal, then about the two tangents.
    pub torque: [f64; 3],
}

impl Data {
    /// The contacts of the last collision detection.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.reset_to_key("stand")?;
    /// data.forward()?;
    /// for contact in data.contacts() {
    ///     let [first, second] = contact.geoms();
    ///     let (first, second) = (data.geom(first).name(), data.geom(second).name());
    ///     println!("{first:?} on {second:?} at {:?}: {:?} N", contact.pos(), contact.force()?.force);
    /// }
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn contacts(&self) -> impl ExactSizeIterator<Item = Contact<'_>> {
        // SAFETY: the engine keeps `ncon` contacts there, and nothing writes to them while `self` is borrowed.
        let contacts: &[mjContact] = unsafe { ffi::array(self.raw().contact, self.ncon()) };
        contacts.iter().enumerate().map(|(index, raw)| Contact { data: self, index, raw })
    }
}

impl<'d> Contact<'d> {
    /// Its index among the contacts.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Distance between the nearest points, m; negative where the geoms penetrate.
    pub fn dist(&self) -> f64 {
        self.raw.dist
    }

    /// Midpoint between the nearest points, m, world frame.
    pub fn pos(&self) -> &'d [f64; 3] {
        &self.raw.pos
    }

    /// The axes of the contact frame as rows, in the world frame: the normal, which points from the first geom to the second,
    /// and two tangents.
    pub fn frame(&self) -> &'d [[f64; 3]; 3] {
        self.raw.frame.as_chunks().0.try_into().expect("Bug: nine numbers are not three rows")
    }

    /// The normal, which points from the first geom to the second.
    pub fn normal(&self) -> &'d [f64; 3] {
        &self.frame()[0]
    }

    /// The two geoms.
    #[doc(alias = "geom1")]
    #[doc(alias = "geom2")]
    pub fn geoms(&self) -> [GeomId; 2] {
        [self.raw.geom1, self.raw.geom2].map(|geom| Id::new(ffi::size(geom), self.data.model().lineage()))
    }

    /// Friction coefficients: two of sliding, one of spinning, two of rolling.
    pub fn friction(&self) -> &'d [f64; 5] {
        &self.raw.friction
    }

    /// The dimension of the contact space: 1 without friction, 3, 4 or 6.
    pub fn dim(&self) -> usize {
        ffi::size(self.raw.dim)
    }

    /// Whether the solver takes the contact into account; one within its gap, for instance, is only reported.
    #[doc(alias = "exclude")]
    #[doc(alias = "efc_address")]
    pub fn is_active(&self) -> bool {
        self.raw.efc_address >= 0
    }

    /// The contact's force and torque, in the contact frame. Zero for a contact that is not active.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`](crate::Error::NotComputed) before forces were computed, as between
    /// [`step1`](Data::step1) and [`step2`](Data::step2): what the engine would return is of another state.
    #[doc(alias = "mj_contactForce")]
    pub fn force(&self) -> Result<ContactForce> {
        self.data.check_computed("contact force", Stage::Acceleration)?;
        let mut result = [0.0; 6];
        // SAFETY: the index is below `ncon`, and the forces were computed with the layout that the model's options give.
        unsafe {
            sys::mj_contactForce(
                self.data.model().as_ptr(),
                self.data.as_ptr(),
                self.index as i32,
                result.as_mut_ptr(),
            );
        };
        let [fx, fy, fz, tx, ty, tz] = result;
        Ok(ContactForce { force: [fx, fy, fz], torque: [tx, ty, tz] })
    }

    /// The contact's force, N, in the world frame.
    ///
    /// # Errors
    ///
    /// As for [`force`](Self::force).
    pub fn force_in_world(&self) -> Result<[f64; 3]> {
        let force = self.force()?.force;
        let frame = self.frame();
        Ok(std::array::from_fn(|axis| (0..3).map(|row| frame[row][axis] * force[row]).sum()))
    }
}

impl fmt::Debug for Contact<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Contact")
            .field("geoms", &self.geoms())
            .field("dist", &self.dist())
            .field("pos", self.pos())
            .field("normal", self.normal())
            .finish_non_exhaustive()
    }
}
