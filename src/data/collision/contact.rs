//! Contacts, their forces, and contacts that the user adds.

use std::ffi::c_int;
use std::fmt;

use mujoco_sys::{self as sys, guard, mjContact, mjMINMU};

use crate::data::{Data, PipelineFlags, Stage};
use crate::error::{Error, InvalidKind, Result};
use crate::ffi;
use crate::id::{BodyId, GeomId, Id, IntoId};
use crate::kind;
use crate::math::{cross, rot_vec_mat_t};
use crate::model::DisableFlags;
use crate::numerics::spatial::norm;

/// Contact of the last collision detection.
#[derive(Clone, Copy)]
pub struct Contact<'d> {
    data: &'d Data,
    index: usize,
    raw: &'d mjContact,
}

/// Object in contact with another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ContactSide {
    /// A geom.
    Geom(GeomId),
    /// An element of a flex: a segment, a triangle or a tetrahedron.
    FlexElement {
        /// Index of the flex.
        flex: usize,
        /// Index of the element in the flex.
        element: usize,
    },
    /// A vertex of a flex.
    FlexVertex {
        /// Index of the flex.
        flex: usize,
        /// Index of the vertex in the flex.
        vertex: usize,
    },
}

/// Force and torque of a contact on its second geom, contact frame. The first geom receives the
/// opposite. For the order see [`Contact::geoms`].
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ContactForce {
    /// Force, N, along the normal and the two tangents.
    pub force: [f64; 3],
    /// Torque, N·m, about the normal and the two tangents.
    pub torque: [f64; 3],
}

/// # Contacts
impl Data {
    /// Returns the contacts of the last collision detection.
    ///
    /// ```
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?;
    /// data.reset_to_key("stand")?;
    /// data.forward()?;
    /// for contact in data.contacts() {
    ///     let Some([first, second]) = contact.geoms() else { continue };
    ///     let (first, second) = (data.geom(first).name(), data.geom(second).name());
    ///     println!("{first:?} on {second:?} at {:?}: {:?} N", contact.pos(), contact.force()?.force);
    /// }
    /// let foot = data.model().geom("foot_left_inner")?.id();
    /// let mut total = [0.0; 3];
    /// for contact in data.contacts() {
    ///     let force = contact.force_on(foot)?;
    ///     (0..3).for_each(|axis| total[axis] += force[axis]);
    /// }
    /// println!("on the foot: {total:?} N");
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    pub fn contacts(&self) -> impl DoubleEndedIterator<Item = Contact<'_>> + ExactSizeIterator {
        // SAFETY: the array has `ncon` contacts, and they are not modified while `self` is
        // borrowed.
        let contacts: &[mjContact] = unsafe { ffi::array(self.raw().contact, self.ncon()) };
        contacts.iter().enumerate().map(|(index, raw)| Contact { data: self, index, raw })
    }
}

impl<'d> Contact<'d> {
    /// Returns the index among the contacts.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Returns the distance between the nearest points, m. Negative for penetration.
    pub fn dist(&self) -> f64 {
        self.raw.dist
    }

    /// Returns the midpoint between the nearest points, m, world frame.
    pub fn pos(&self) -> &'d [f64; 3] {
        &self.raw.pos
    }

    /// Returns the axes of the contact frame as rows, world frame: the normal, which points from
    /// the first geom to the second, and two tangents.
    /// [`math::rot_vec_mat`](crate::math::rot_vec_mat) rotates a vector into this frame.
    pub fn frame(&self) -> &'d [f64; 9] {
        &self.raw.frame
    }

    /// Returns the unit normal, which points from the first geom to the second, world frame.
    pub fn normal(&self) -> &'d [f64; 3] {
        self.frame().first_chunk().expect("Bug: nine values do not start with three")
    }

    /// Returns the two geoms, or `None` for a contact of a flex, whose [`sides`](Self::sides) are
    /// more general. Engines before 3.0 have no flexes.
    ///
    /// The engine orders them by their types, as in [`GeomType`](crate::enums::GeomType): a plane
    /// is before a sphere, and a sphere before a box, also if the sphere moves and the box is
    /// fixed. Do not rely on the order of two geoms of one type. [`force_on`](Self::force_on) is
    /// independent of the order.
    #[doc(alias = "geom1")]
    #[doc(alias = "geom2")]
    pub fn geoms(&self) -> Option<[GeomId; 2]> {
        let geoms = [self.raw.geom1, self.raw.geom2];
        let lineage = self.data.model().lineage();
        geoms.iter().all(|&geom| geom >= 0).then(|| geoms.map(|geom| Id::new(ffi::size(geom), lineage)))
    }

    /// Returns the two objects in contact.
    #[doc(alias = "geom")]
    #[doc(alias = "flex")]
    #[doc(alias = "elem")]
    #[doc(alias = "vert")]
    pub fn sides(&self) -> [ContactSide; 2] {
        [0, 1].map(|side| {
            // SAFETY: a contact, of which the function reads numbers.
            let side = unsafe { sys::adapted::contact_side(self.raw, side) };
            let index = |index: c_int| usize::try_from(index).ok();
            match (index(side.geom), index(side.vert)) {
                (Some(geom), _) => ContactSide::Geom(Id::new(geom, self.data.model().lineage())),
                (None, Some(vertex)) => ContactSide::FlexVertex { flex: ffi::size(side.flex), vertex },
                (None, None) => ContactSide::FlexElement { flex: ffi::size(side.flex), element: ffi::size(side.elem) },
            }
        })
    }

    /// Returns the friction coefficients: two sliding, one torsional, two rolling.
    pub fn friction(&self) -> &'d [f64; 5] {
        &self.raw.friction
    }

    /// Returns the dimension of the contact space: 1 without friction, 3, 4 or 6.
    pub fn dim(&self) -> usize {
        ffi::size(self.raw.dim)
    }

    /// Returns `true` if the contact has constraint rows. A contact within its gap, for example,
    /// has none.
    #[doc(alias = "exclude")]
    #[doc(alias = "efc_address")]
    pub fn is_active(&self) -> bool {
        // Newer engines remove all rows if the arena is full, but not their addresses.
        (0..self.data.raw().nefc).contains(&self.raw.efc_address)
    }

    /// Computes the force and torque of the contact, contact frame. Zero for a contact that is not
    /// active.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before forces were computed, for example between
    /// [`step1`](Data::step1) and [`step2`](Data::step2), when the engine would return forces of
    /// another state.
    #[doc(alias = "mj_contactForce")]
    pub fn force(&self) -> Result<ContactForce> {
        self.data.check_computed("contact force", Stage::Acceleration)?;
        if !self.is_active() {
            return Ok(ContactForce::default());
        }
        let mut result = [0.0; 6];
        // SAFETY: the index is below `ncon`, and the forces were computed with the layout of the
        // model's present options.
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

    /// Computes the force of the contact on its second [geom](Self::geoms), N, world frame.
    ///
    /// # Errors
    ///
    /// As for [`force`](Self::force).
    pub fn force_in_world(&self) -> Result<[f64; 3]> {
        Ok(rot_vec_mat_t(&self.force()?.force, self.frame()))
    }

    /// Computes the force of the contact on a geom, N, world frame. Zero if the contact does not
    /// touch the geom.
    ///
    /// # Errors
    ///
    /// As for [`force`](Self::force), and [`Error::NoSuchName`].
    #[doc(alias = "touching")]
    #[doc(alias = "contact pair")]
    pub fn force_on(&self, geom: impl IntoId<kind::Geom>) -> Result<[f64; 3]> {
        let geom: GeomId = geom.id_in(self.data.model().as_ref())?;
        let force = self.force_in_world()?;
        let [first, second] = self.sides().map(|side| side == ContactSide::Geom(geom));
        Ok(match (first, second) {
            (_, true) => force,
            (true, false) => force.map(|part| -part),
            (false, false) => [0.0; 3],
        })
    }
}

impl fmt::Debug for Contact<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Contact")
            .field("sides", &self.sides())
            .field("dist", &self.dist())
            .field("pos", self.pos())
            .field("normal", self.normal())
            .finish_non_exhaustive()
    }
}

/// Contact to add with [`Data::add_contact`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewContact {
    /// The two geoms. The contact acts on their bodies.
    pub geoms: [GeomId; 2],
    /// Distance between the nearest points, m. Negative for penetration.
    pub dist: f64,
    /// Midpoint between the nearest points, m, world frame.
    pub pos: [f64; 3],
    /// Normal from the first geom to the second, world frame. Any length except zero.
    pub normal: [f64; 3],
    /// Distance below which the contact exerts forces, m.
    pub includemargin: f64,
    /// Friction coefficients: two sliding, one torsional, two rolling.
    pub friction: [f64; 5],
    /// Time constant (s) and damping ratio of the constraint, or its negated stiffness and damping.
    pub solref: [f64; 2],
    /// Impedance of the constraint.
    pub solimp: [f64; 5],
    /// Dimension of the contact space: 1 without friction, 3, 4 or 6.
    pub dim: usize,
}

impl NewContact {
    /// Creates a contact of dimension 3, with the default values of the engine's compiler for
    /// geoms.
    pub fn new(geoms: [impl Into<GeomId>; 2], dist: f64, pos: [f64; 3], normal: [f64; 3]) -> Self {
        Self {
            geoms: geoms.map(Into::into),
            dist,
            pos,
            normal,
            includemargin: 0.0,
            friction: [1.0, 1.0, 0.005, 0.0001, 0.0001],
            solref: [0.02, 1.0],
            solimp: [0.9, 0.95, 0.001, 0.5, 2.0],
            dim: 3,
        }
    }

    /// Checks that the values describe a contact.
    fn check(&self) -> Result<()> {
        let numbers = [self.dist, self.includemargin];
        let numbers = numbers.iter().chain(&self.pos).chain(&self.normal).chain(&self.friction);
        let finite = numbers.chain(&self.solref).chain(&self.solimp).all(|value| value.is_finite());
        let length = norm(&self.normal);
        if !finite {
            return Err(Error::not_finite("a value of a new contact", format!("{self:?}")));
        }
        let (field, value, expected) = if !matches!(self.dim, 1 | 3 | 4 | 6) {
            ("dim", self.dim.to_string(), "1, 3, 4 or 6")
        } else if !(length.is_finite() && length > 0.0) {
            ("normal", format!("{:?}", self.normal), "finite and not zero")
        } else if self.friction.iter().any(|&value| value < 0.0) {
            ("friction", format!("{:?}", self.friction), "not negative")
        } else {
            return Ok(());
        };
        Err(Error::out_of_range(format!("{field} of a new contact"), value, expected))
    }

    /// Computes the contact frame: the normal and two tangents.
    fn frame(&self) -> [f64; 9] {
        let unit = |vector: [f64; 3]| {
            let length = norm(&vector);
            vector.map(|value| value / length)
        };
        let normal = unit(self.normal);
        // Derive the first tangent from a coordinate axis that is not close to the normal.
        let axis = if normal[1].abs() < 0.5 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
        let along: f64 = (0..3).map(|i| axis[i] * normal[i]).sum();
        let first = unit(std::array::from_fn(|i| axis[i] - along * normal[i]));
        let second = cross(&normal, &first);
        std::array::from_fn(|i| [normal, first, second][i / 3][i % 3])
    }
}

/// # Additional contacts
impl Data {
    /// Adds a contact to the contacts of the last [`collision`](Self::collision). The constraint
    /// rows count as not computed afterwards: continue with
    /// [`make_constraint`](Self::make_constraint). The next collision detection, for example of a
    /// step, removes the contact.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before a collision detection, [`Error::Invalid`] for values that do
    /// not describe a contact or for two geoms of the same body, [`Error::Unsupported`] if the
    /// number of contacts has reached `nconmax` or contacts are disabled.
    ///
    /// # Panics
    ///
    /// If an id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::data::NewContact;
    /// use mujoco_safe::{Data, sample};
    ///
    /// let mut data = Data::new(sample::humanoid())?; // in the air
    /// data.fwd_position()?;
    /// let [floor, foot] = ["floor", "foot_left_inner"].map(|name| data.model().geom(name).map(|geom| geom.id()));
    /// let (floor, foot) = (floor?, foot?);
    /// let below = data.geom_xpos()[foot.index()];
    /// data.add_contact(&NewContact::new([floor, foot], -0.01, below, [0.0, 0.0, 1.0]))?;
    /// data.make_constraint()?;
    /// data.project_constraint()?;
    /// data.fwd_velocity()?;
    /// data.fwd_actuation()?;
    /// data.fwd_acceleration()?;
    /// data.fwd_constraint()?;
    /// let contact = data.contacts().last().expect("it was added");
    /// assert!(contact.force()?.force[0] > 0.0);
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[doc(alias = "mj_addContact")]
    pub fn add_contact(&mut self, contact: &NewContact) -> Result<()> {
        for geom in contact.geoms {
            self.model().check_id(geom);
        }
        self.check_parts("add_contact", PipelineFlags::COLLISION)?;
        contact.check()?;
        let model = self.model();
        let [first, second] = contact.geoms.map(|geom| model.geom(geom).body());
        if first == second {
            // The engine would create rows longer than the space that it reserves for them.
            return Err(Error::invalid(
                InvalidKind::Unsuitable,
                "the geoms of a new contact",
                format!("both of {first:?}"),
                "of different bodies",
            ));
        }
        // The engine would create no rows for the contact, but some engine functions assume that
        // every contact has rows.
        if model.options().disable.intersects(DisableFlags::CONTACT | DisableFlags::CONSTRAINT) {
            return Err(Error::Unsupported("add_contact to a model whose contacts are disabled".to_owned()));
        }
        if model.nconmax() > 0 && self.ncon() >= model.nconmax() {
            return Err(Error::Unsupported(format!(
                "more than the {} contacts that nconmax allows; increase it",
                model.nconmax()
            )));
        }
        let [geom1, geom2] = contact.geoms.map(|geom| geom.index() as c_int);
        // SAFETY: all-zero bytes are a valid structure of numbers.
        let mut raw: mjContact = unsafe { std::mem::zeroed() };
        (raw.dist, raw.pos, raw.frame) = (contact.dist, contact.pos, contact.frame());
        (raw.includemargin, raw.friction) = (contact.includemargin, contact.friction.map(|value| value.max(mjMINMU)));
        (raw.solref, raw.solimp) = (contact.solref, contact.solimp);
        (raw.dim, raw.geom1, raw.geom2, raw.efc_address) = (contact.dim as c_int, geom1, geom2, -1);
        let is_static = |body: BodyId| model.body_weldid()[body.index()] == 0;
        if cfg!(engine_since = "2.3.0") && is_static(first) && is_static(second) {
            // The value for contacts without degrees of freedom. With a dense Jacobian 3.5.0 would
            // create rows of zeros, which its `mj_island` rejects.
            raw.exclude = 3;
        }
        // SAFETY: a valid contact between two geoms.
        unsafe { sys::adapted::complete_contact(&raw mut raw) };
        let mut full = 0;
        self.run("mj_addContact", self.after(PipelineFlags::COLLISION), |m, d| {
            // SAFETY: geoms of this model, a valid dimension, no rows yet, a valid pointer for the
            // result.
            unsafe { guard::mj_add_contact(m, d, &raw const raw, &raw mut full) }
        })?;
        // The engine has removed the constraints.
        self.clear_absent_constraints();
        // Newer engines have a limit of memory instead of a number.
        if full == 0 { Ok(()) } else { Err(Error::Unsupported("more contacts than fit in the arena".to_owned())) }
    }
}
