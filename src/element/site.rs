//! Sites: named places on bodies.

use super::{SameFrame, View, ViewMut};
use crate::data::Data;
use crate::enums::GeomType;
use crate::id::{BodyId, MaterialId, kind};
use crate::model::{Model, ModelMut};

fields!(Site on Model {
    /// Its shape, for display and for touch sensors.
    site_type: {GeomType} = |site| GeomType::of_field(site.owner.site_type()[site.index()]);
    /// The body that it belongs to.
    body: {BodyId} = |site| site.id_in(site.owner.site_bodyid());
    /// Its material, if it has one.
    #[doc(alias = "matid")]
    material: {Option<MaterialId>} = |site| site.optional_id_in(site.owner.site_matid());
    /// Whether its frame is one of its body's.
    sameframe: {SameFrame} = |site| SameFrame::of_field(site.owner.site_sameframe()[site.index()]);
    /// The group, for display.
    group: i32 = site_group, set_group;
    /// Size, m.
    size: [f64; 3] = site_size, size_mut in site_size_mut;
    /// Position in the frame of its body, m.
    pos: [f64; 3] = site_pos, pos_mut in site_pos_mut;
    /// Orientation in the frame of its body: a unit quaternion `[w, x, y, z]`.
    quat: [f64; 4] = site_quat, quat_mut in site_quat_mut;
    /// Red, green, blue and opacity, where no material gives them.
    rgba: [f32; 4] = site_rgba, rgba_mut in site_rgba_mut;
    /// The user's own numbers.
    user: [f64] = site_user, user_mut in site_user_mut;
});

fields!(Site on Data {
    /// Position, m, world frame.
    xpos: [f64; 3] = site_xpos;
    /// Orientation as a row-major rotation matrix, world frame.
    xmat: [f64; 9] = site_xmat;
});
