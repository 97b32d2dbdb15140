//! Equality constraints, and explicit contact pairs and exclusions.

use super::{View, ViewMut};
use crate::data::Data;
use crate::enums::EqualityType;
use crate::ffi;
use crate::id::{BodyId, GeomId, Id, JointId, SiteId, TendonId};
use crate::kind;
use crate::model::{Model, ModelMut};

/// Offset of the ids of bodies in the signature of an exclusion.
const FIRST_BODY: usize = if cfg!(engine_since = "3.0.0") { 0 } else { 1 };
/// Number of parameters: 11 in 2.2.2.
const DATA: usize = mujoco_sys::mjNEQDATA as usize;

fields!(Equality on Model {
    /// Type of the constraint.
    equality_type: {EqualityType} = |equality| EqualityType::of_field(equality.owner.eq_type()[equality.index()]);
    /// Elements that the constraint couples.
    #[doc(alias = "obj1id")]
    #[doc(alias = "obj2id")]
    objects: {EqualityObjects} = |equality| {
        let (one, other) = (equality.owner.eq_obj1id(), equality.owner.eq_obj2id());
        match equality.equality_type() {
            EqualityType::Connect | EqualityType::Weld if equality.owner.couples_sites(equality.index()) => {
                EqualityObjects::Sites(equality.id_in(one), equality.id_in(other))
            }
            EqualityType::Connect | EqualityType::Weld => {
                EqualityObjects::Bodies(equality.id_in(one), equality.id_in(other))
            }
            EqualityType::Joint => EqualityObjects::Joints(equality.id_in(one), equality.optional_id_in(other)),
            EqualityType::Tendon => EqualityObjects::Tendons(equality.id_in(one), equality.optional_id_in(other)),
            EqualityType::Flex | EqualityType::FlexVertex | EqualityType::FlexStrain => {
                EqualityObjects::Flex(ffi::size(one[equality.index()]))
            }
        }
    };
    /// Returns `true` if the constraint is enforced; with engines from 3.0, in the initial state of
    /// a simulation.
    #[doc(alias = "eq_active")]
    #[doc(alias = "active0")]
    active: {bool} = |equality| equality.owner.equality_active()[equality.index()] != 0;
    /// Solver reference parameters: time constant and damping ratio.
    solref: [f64; 2] = eq_solref, solref_mut in eq_solref_mut;
    /// Solver impedance parameters.
    solimp: [f64; 5] = eq_solimp, solimp_mut in eq_solimp_mut;
    /// Parameters, which depend on the type. Connect: the anchor in the frame of the first body,
    /// then in the frame of the second, m. Weld: the anchor in the frame of the second body, then
    /// in the frame of the first, the relative orientation as a unit quaternion `[w, x, y, z]`, the
    /// scale of torques, and with newer engines 1 if the compiler computed the relative pose. Joint
    /// and tendon: the five coefficients of the polynomial.
    data: {&'a [f64; DATA]} = |equality| &equality.owner.eq_data()[equality.index()];
});

fields!(Equality on Data {
    /// Returns `true` if the constraint is enforced. Before 3.0 the model has the state, which is
    /// then the same as [`active`](super::Equality::active).
    #[doc(alias = "eq_active")]
    active: {bool} = |equality| equality.owner.active_equalities()[equality.index()] != 0;
});

/// # Methods of [`EqualityMut`](super::EqualityMut)
impl ViewMut<'_, ModelMut<'_>, kind::Equality> {
    /// Sets `active`.
    pub fn set_active(&mut self, value: bool) {
        let index = self.id.index();
        self.owner.set_equality_active(index, value);
    }

    /// Returns a mutable reference to `data`.
    pub fn data_mut(&mut self) -> &mut [f64; DATA] {
        let index = self.id.index();
        &mut self.owner.eq_data_mut()[index]
    }
}

/// Elements that an equality constraint couples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum EqualityObjects {
    /// Two bodies; the second may be the world.
    Bodies(BodyId, BodyId),
    /// Two sites, with engines from 3.2.3.
    Sites(SiteId, SiteId),
    /// A joint and a second joint, or a constant if `None`.
    Joints(JointId, Option<JointId>),
    /// A tendon and a second tendon, or a constant if `None`.
    Tendons(TendonId, Option<TendonId>),
    /// A flex, by its index, with engines from 3.0.
    Flex(usize),
}

// Explicit contact pairs: tested for contact irrespective of the contact masks, with separate
// parameters.
fields!(Pair on Model {
    /// Dimension of the contacts: 1, 3, 4 or 6.
    #[doc(alias = "condim")]
    dim: i32 = pair_dim, set_dim if [1, 3, 4, 6];
    /// First geom.
    geom1: {GeomId} = |pair| pair.id_in(pair.owner.pair_geom1());
    /// Second geom.
    geom2: {GeomId} = |pair| pair.id_in(pair.owner.pair_geom2());
    /// Indices of both bodies packed into one integer, the engine's sort key of the pairs.
    signature: i32 = pair_signature;
    /// Solver reference parameters of the contacts: time constant and damping ratio.
    solref: [f64; 2] = pair_solref, solref_mut in pair_solref_mut;
    /// Solver impedance parameters of the contacts.
    solimp: [f64; 5] = pair_solimp, solimp_mut in pair_solimp_mut;
    /// Distance at which contacts are detected, m.
    margin: f64 = pair_margin, set_margin in pair_margin_mut;
    /// Contact gap, m. A contact becomes active at the distance `margin - gap`.
    gap: f64 = pair_gap, set_gap in pair_gap_mut;
    /// Friction coefficients: sliding along both tangents, torsional, rolling about both tangents.
    friction: [f64; 5] = pair_friction, friction_mut in pair_friction_mut;
});

// Pairs of bodies whose geoms do not collide.
fields!(Exclude on Model {
    /// Indices of both bodies packed into one integer, the engine's search key.
    signature: i32 = exclude_signature;
    /// First body.
    body1: {BodyId} = |exclude| Id::new((exclude.signature().cast_unsigned() >> 16) as usize - FIRST_BODY, exclude.owner.lineage());
    /// Second body.
    body2: {BodyId} = |exclude| Id::new((exclude.signature().cast_unsigned() & 0xFFFF) as usize - FIRST_BODY, exclude.owner.lineage());
});
