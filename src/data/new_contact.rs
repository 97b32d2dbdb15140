//! A contact that the user adds to those that collision detection found.

use std::ffi::c_int;

use mujoco_sys::{guard, mjContact, mjMINMU};

use super::momentum::cross;
use super::{Computed, Data};
use crate::error::{Error, Result};
use crate::id::GeomId;
use crate::model::DisableFlags;

/// A contact to add with [`Data::add_contact`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "mjContact")]
pub struct NewContact {
    /// The two geoms. The contact acts on their bodies.
    pub geoms: [GeomId; 2],
    /// Distance between the nearest points, m; negative where the geoms penetrate.
    pub dist: f64,
    /// Midpoint between the nearest points, m, world frame.
    pub pos: [f64; 3],
    /// The normal, which points from the first geom to the second, world frame. Of any length but zero.
    pub normal: [f64; 3],
    /// The distance below which the contact exerts forces, m.
    pub includemargin: f64,
    /// Friction coefficients: two of sliding, one of spinning, two of rolling.
    pub friction: [f64; 5],
    /// Time constant and damping ratio of the constraint, or its stiffness and damping as negative numbers.
    pub solref: [f64; 2],
    /// The impedance of the constraint.
    pub solimp: [f64; 5],
    /// The dimension of the contact space: 1 without friction, 3, 4 or 6.
    pub dim: usize,
}

impl NewContact {
    /// A contact of three dimensions, with what the engine's compiler takes for a geom that does not say otherwise.
    pub fn new(geoms: [GeomId; 2], dist: f64, pos: [f64; 3], normal: [f64; 3]) -> Self {
        Self {
            geoms,
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

    /// Refuses what would make no contact.
    fn check(&self) -> Result<()> {
        let numbers = [self.dist, self.includemargin];
        let numbers = numbers.iter().chain(&self.pos).chain(&self.normal).chain(&self.friction);
        let finite = numbers.chain(&self.solref).chain(&self.solimp).all(|value| value.is_finite());
        let length = self.length();
        let (field, value, expected) = if !matches!(self.dim, 1 | 3 | 4 | 6) {
            ("dim", self.dim.to_string(), "1, 3, 4 or 6")
        } else if !finite {
            ("a number", format!("{self:?}"), "finite")
        } else if !(length.is_finite() && length > 0.0) {
            ("normal", format!("{:?}", self.normal), "finite and not zero")
        } else if self.friction.iter().any(|&value| value < 0.0) {
            ("friction", format!("{:?}", self.friction), "not negative")
        } else {
            return Ok(());
        };
        Err(Error::Invalid { what: format!("{field} of a new contact"), value, expected: expected.to_owned() })
    }

    fn length(&self) -> f64 {
        self.normal.iter().map(|value| value * value).sum::<f64>().sqrt()
    }

    /// The contact frame: the normal, and two tangents.
    fn frame(&self) -> [f64; 9] {
        let unit = |vector: [f64; 3]| {
            let length = vector.iter().map(|value| value * value).sum::<f64>().sqrt();
            vector.map(|value| value / length)
        };
        let normal = unit(self.normal);
        // A tangent from an axis that is far from the normal.
        let axis = if normal[1].abs() < 0.5 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
        let along: f64 = (0..3).map(|i| axis[i] * normal[i]).sum();
        let first = unit(std::array::from_fn(|i| axis[i] - along * normal[i]));
        let second = cross(normal, first);
        std::array::from_fn(|i| [normal, first, second][i / 3][i % 3])
    }
}

impl Data {
    /// Adds a contact to those of the last [`collision`](Self::collision). The rows of the constraints count as not computed
    /// afterwards: go on with [`make_constraint`](Self::make_constraint). Whatever detects collisions anew, such as a step,
    /// forgets the contact.
    ///
    /// # Errors
    ///
    /// [`Error::NotComputed`] before a collision detection, [`Error::Invalid`] for numbers that make no contact or for
    /// two geoms of one body, [`Error::Unsupported`] if there are as many contacts as `nconmax` allows, or contacts are disabled.
    ///
    /// # Panics
    ///
    /// If an id is of another model.
    ///
    /// ```
    /// use mujoco_safe::{Data, NewContact, sample};
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
        self.check_parts("add_contact", Computed::COLLISION)?;
        contact.check()?;
        let model = self.model();
        let [one, other] = contact.geoms.map(|geom| model.geom(geom).body());
        if one == other {
            // The engine would make rows of it that are longer than there is room for.
            return Err(Error::invalid("the geoms of a new contact", format!("two of {one:?}"), "of two bodies"));
        }
        // The engine would make no rows of it, and trusts in places that a contact has some.
        if model.options().disable.intersects(DisableFlags::CONTACT | DisableFlags::CONSTRAINT) {
            return Err(Error::Unsupported("add_contact to a model whose contacts are disabled".to_owned()));
        }
        if self.ncon() >= model.nconmax() {
            return Err(Error::Unsupported(format!(
                "more than the {} contacts that nconmax allows; increase it",
                model.nconmax()
            )));
        }
        let [geom1, geom2] = contact.geoms.map(|geom| geom.index() as c_int);
        let raw = mjContact {
            dist: contact.dist,
            pos: contact.pos,
            frame: contact.frame(),
            includemargin: contact.includemargin,
            friction: contact.friction.map(|value| value.max(mjMINMU)),
            solref: contact.solref,
            solimp: contact.solimp,
            mu: 0.0,
            H: [0.0; 36],
            dim: contact.dim as c_int,
            geom1,
            geom2,
            exclude: 0,
            efc_address: -1,
        };
        let mut full = 0;
        self.run("mj_addContact", self.after(Computed::COLLISION), |m, d| {
            // SAFETY: geoms of this model, a dimension that there is, no rows yet, a place for the result.
            unsafe { guard::mj_add_contact(m, d, &raw const raw, &raw mut full) }
        })?;
        debug_assert_eq!(full, 0, "there was room");
        Ok(())
    }
}
