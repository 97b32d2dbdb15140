//! Equality constraints.

use super::{View, ViewMut};
use crate::enums::EqualityType;
use crate::id::{BodyId, JointId, TendonId, kind};
use crate::model::{Model, ModelMut};

fields!(Equality on Model {
    /// What it ties together.
    equality_type: {EqualityType} = |equality| EqualityType::of_field(equality.owner.eq_type()[equality.index()]);
    /// The two elements that it ties together.
    #[doc(alias = "obj1id")]
    #[doc(alias = "obj2id")]
    objects: {EqualityObjects} = |equality| {
        let (one, other) = (equality.owner.eq_obj1id(), equality.owner.eq_obj2id());
        match equality.equality_type() {
            EqualityType::Connect | EqualityType::Weld => {
                EqualityObjects::Bodies(equality.id_in(one), equality.id_in(other))
            }
            EqualityType::Joint => EqualityObjects::Joints(equality.id_in(one), equality.optional_id_in(other)),
            EqualityType::Tendon => EqualityObjects::Tendons(equality.id_in(one), equality.optional_id_in(other)),
        }
    };
    /// Whether it is enforced.
    #[doc(alias = "active0")]
    active: bool = eq_active, set_active;
    /// Time constant and damping ratio.
    solref: [f64; 2] = eq_solref, solref_mut in eq_solref_mut;
    /// Impedance.
    solimp: [f64; 5] = eq_solimp, solimp_mut in eq_solimp_mut;
    /// Its numbers, by its type. Connect: the point in the frame of the first body and in that of the second, m. Weld: the same
    /// the other way round, the relative orientation as a unit quaternion `[w, x, y, z]`, and the scale of torques. Joint and
    /// tendon: the five coefficients of the polynomial.
    data: [f64; 11] = eq_data, data_mut in eq_data_mut;
});

/// What an equality constraint ties together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum EqualityObjects {
    /// Two bodies; the second may be the world.
    Bodies(BodyId, BodyId),
    /// A joint to another one, or to a constant.
    Joints(JointId, Option<JointId>),
    /// A tendon to another one, or to a constant.
    Tendons(TendonId, Option<TendonId>),
}
