//! Geoms: the shapes that collide and are drawn.

use super::{SameFrame, View, ViewMut};
use crate::data::Data;
use crate::enums::GeomType;
use crate::id::{BodyId, HeightFieldId, MaterialId, MeshId, kind};
use crate::model::{Model, ModelMut};

fields!(Geom on Model {
    /// Its shape.
    geom_type: {GeomType} = |geom| GeomType::of_field(geom.owner.geom_type()[geom.index()]);
    /// The body that it belongs to.
    body: {BodyId} = |geom| geom.id_in(geom.owner.geom_bodyid());
    /// Its mesh, if it is one.
    #[doc(alias = "dataid")]
    mesh: {Option<MeshId>} = |geom| match geom.geom_type() {
        GeomType::Mesh => geom.optional_id_in(geom.owner.geom_dataid()),
        _ => None,
    };
    /// Its height field, if it is one.
    #[doc(alias = "dataid")]
    height_field: {Option<HeightFieldId>} = |geom| match geom.geom_type() {
        GeomType::HeightField => geom.optional_id_in(geom.owner.geom_dataid()),
        _ => None,
    };
    /// Its material, if it has one.
    #[doc(alias = "matid")]
    material: {Option<MaterialId>} = |geom| geom.optional_id_in(geom.owner.geom_matid());
    /// Whether its frame is one of its body's.
    sameframe: {SameFrame} = |geom| SameFrame::of_field(geom.owner.geom_sameframe()[geom.index()]);
    /// Its bits: two geoms can collide if those of one meet the [`conaffinity`](Self::conaffinity) of the other. A mesh whose
    /// geoms did not collide when the model was compiled has no hull, and is slow to collide: see [`Mesh`](super::Mesh).
    contype: i32 = geom_contype, set_contype;
    /// The bits that it meets.
    conaffinity: i32 = geom_conaffinity, set_conaffinity;
    /// The dimension of its contacts: 1, 3, 4 or 6.
    condim: i32 = geom_condim, set_condim if [1, 3, 4, 6];
    /// The group, for display.
    group: i32 = geom_group, set_group;
    /// Which of two geoms decides the parameters of their contact.
    priority: i32 = geom_priority, set_priority;
    /// Its weight where the parameters of two geoms are mixed.
    solmix: f64 = geom_solmix, set_solmix in geom_solmix_mut;
    /// Time constant and damping ratio of its contacts.
    solref: [f64; 2] = geom_solref, solref_mut in geom_solref_mut;
    /// Impedance of its contacts.
    solimp: [f64; 5] = geom_solimp, solimp_mut in geom_solimp_mut;
    /// Size, m: what it means depends on the shape. Contacts are looked for within [`rbound`](Self::rbound) only, which
    /// [`update_constants`](crate::ModelMut::update_constants) makes large enough.
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
    /// Coefficients of the fluid model of ellipsoids; all 0 where it is not used. See the engine's `mjNFLUID`.
    fluid: [f64; 12] = geom_fluid, fluid_mut in geom_fluid_mut;
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
