//! Geoms: the shapes that collide and are drawn.

use super::{View, ViewMut};
use crate::data::Data;
use crate::enums::GeomType;
use crate::ffi;
use crate::id::{BodyId, Id, kind};
use crate::model::{Model, ModelMut};

fields!(Geom on Model {
    /// Its shape.
    geom_type: {GeomType} = |geom| GeomType::of_field(geom.owner.geom_type()[geom.index()]);
    /// The body that it belongs to.
    body: {BodyId} = |geom| Id::new(ffi::size(geom.owner.geom_bodyid()[geom.index()]), geom.owner.lineage());
    /// Its bits: two geoms can collide if those of one meet the [`conaffinity`](Self::conaffinity) of the other.
    contype: i32 = geom_contype;
    /// The bits that it meets.
    conaffinity: i32 = geom_conaffinity;
    /// The dimension of its contacts: 1, 3, 4 or 6.
    condim: i32 = geom_condim;
    /// The group, for display.
    group: i32 = geom_group;
    /// Which of two geoms decides the parameters of their contact.
    priority: i32 = geom_priority;
    /// Its weight where the parameters of two geoms are mixed.
    solmix: f64 = geom_solmix, set_solmix in geom_solmix_mut;
    /// Time constant and damping ratio of its contacts.
    solref: [f64; 2] = geom_solref, solref_mut in geom_solref_mut;
    /// Impedance of its contacts.
    solimp: [f64; 5] = geom_solimp, solimp_mut in geom_solimp_mut;
    /// Size, m: what it means depends on the shape.
    size: [f64; 3] = geom_size, size_mut in geom_size_mut;
    /// Radius of the sphere around it, m. Derived from the shape; 0 for a plane.
    rbound: f64 = geom_rbound;
    /// Position in the frame of its body, m.
    pos: [f64; 3] = geom_pos, pos_mut in geom_pos_mut;
    /// Orientation in the frame of its body: a unit quaternion `[w, x, y, z]`.
    quat: [f64; 4] = geom_quat, quat_mut in geom_quat_mut;
    /// Friction: sliding, spinning, rolling.
    friction: [f64; 3] = geom_friction, friction_mut in geom_friction_mut;
    /// At which distance contacts are detected, m.
    margin: f64 = geom_margin, set_margin in geom_margin_mut;
    /// By how much less they become active, m.
    gap: f64 = geom_gap, set_gap in geom_gap_mut;
    /// Red, green, blue and opacity, where no material gives them.
    rgba: [f32; 4] = geom_rgba, rgba_mut in geom_rgba_mut;
    /// The user's own numbers.
    user: [f64] = geom_user, user_mut in geom_user_mut;
});

fields!(Geom on Data {
    /// Position, m, world frame.
    xpos: [f64; 3] = geom_xpos;
    /// Orientation as a row-major rotation matrix, world frame.
    xmat: [f64; 9] = geom_xmat;
});
