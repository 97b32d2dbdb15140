//! Pairs of geoms that are tested for contact whatever their masks say, with parameters of their own.

use super::{View, ViewMut};
use crate::id::{GeomId, kind};
use crate::model::{Model, ModelMut};

fields!(Pair on Model {
    /// The dimension of their contacts: 1, 3, 4 or 6.
    #[doc(alias = "condim")]
    dim: i32 = pair_dim, set_dim if [1, 3, 4, 6];
    /// One of the geoms.
    geom1: {GeomId} = |pair| pair.id_in(pair.owner.pair_geom1());
    /// The other geom.
    geom2: {GeomId} = |pair| pair.id_in(pair.owner.pair_geom2());
    /// The bodies of both in one number, by which the engine sorts the pairs.
    signature: i32 = pair_signature;
    /// Time constant and damping ratio of their contacts.
    solref: [f64; 2] = pair_solref, solref_mut in pair_solref_mut;
    /// Impedance of their contacts.
    solimp: [f64; 5] = pair_solimp, solimp_mut in pair_solimp_mut;
    /// At which distance contacts are detected, m.
    margin: f64 = pair_margin, set_margin in pair_margin_mut;
    /// By how much less they become active, m.
    gap: f64 = pair_gap, set_gap in pair_gap_mut;
    /// Friction: sliding along both tangents, spinning, rolling about both tangents.
    friction: [f64; 5] = pair_friction, friction_mut in pair_friction_mut;
});
