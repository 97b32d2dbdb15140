//! Elements attached to the frame of a body: geoms, sites, cameras and lights.

use super::{View, ViewMut};
use crate::data::Data;
use crate::enums::{CameraMode, GeomType, SameFrame};
use crate::id::{BodyId, HeightFieldId, MaterialId, MeshId};
use crate::kind;
use crate::model::{Model, ModelMut};

fields!(Geom on Model {
    /// Shape.
    geom_type: {GeomType} = |geom| GeomType::of_field(geom.owner.geom_type()[geom.index()]);
    /// Body that the geom is attached to.
    body: {BodyId} = |geom| geom.id_in(geom.owner.geom_bodyid());
    /// Mesh of a mesh geom, or the mesh that shows a signed distance field; `None` for other
    /// shapes.
    #[doc(alias = "dataid")]
    mesh: {Option<MeshId>} = |geom| match geom.geom_type() {
        GeomType::Mesh | GeomType::Sdf => geom.optional_id_in(geom.owner.geom_dataid()),
        _ => None,
    };
    /// Height field of a height field geom; `None` for other shapes.
    #[doc(alias = "dataid")]
    height_field: {Option<HeightFieldId>} = |geom| match geom.geom_type() {
        GeomType::HeightField => geom.optional_id_in(geom.owner.geom_dataid()),
        _ => None,
    };
    /// Material, if any.
    #[doc(alias = "matid")]
    material: {Option<MaterialId>} = |geom| geom.optional_id_in(geom.owner.geom_matid());
    /// Frame of the body that the frame of the geom coincides with.
    sameframe: {SameFrame} = |geom| SameFrame::of_field(geom.owner.geom_sameframe()[geom.index()]);
    /// Contact type bit mask. Two geoms can collide if the mask of one shares a bit with the
    /// [`conaffinity`](Self::conaffinity) of the other. A mesh whose geoms could not collide when
    /// the model was compiled has no convex hull, so its collisions are slow: see
    /// [`Mesh`](super::Mesh). With engines since 2.3.3, a geom that could not collide when the
    /// model was compiled, on a body with others that could, disables the [middle
    /// phase](crate::model::DisableFlags::MIDPHASE) of collision detection once it can.
    contype: i32 = geom_contype, set_contype then update_masks;
    /// Contact affinity bit mask: see [`contype`](Self::contype).
    conaffinity: i32 = geom_conaffinity, set_conaffinity then update_masks;
    /// Dimension of its contacts: 1, 3, 4 or 6.
    condim: i32 = geom_condim, set_condim if [1, 3, 4, 6] then avoid_wrong_jacobian;
    /// Visualisation group.
    group: i32 = geom_group, set_group;
    /// Contact priority. The geom with the higher priority determines the contact parameters of a
    /// pair.
    priority: i32 = geom_priority, set_priority;
    /// Weight of the geom when the contact parameters of a pair are mixed.
    solmix: f64 = geom_solmix, set_solmix in geom_solmix_mut;
    /// Solver reference parameters of its contacts: time constant and damping ratio.
    solref: [f64; 2] = geom_solref, solref_mut in geom_solref_mut;
    /// Solver impedance parameters of its contacts.
    solimp: [f64; 5] = geom_solimp, solimp_mut in geom_solimp_mut;
    /// Size, m; its meaning depends on the shape. The mass of the body does not depend on later
    /// changes.
    size: [f64; 3] = geom_size, size_mut in geom_size_mut;
    /// Radius of the bounding sphere, m. Derived from the shape; 0 for a plane.
    rbound: f64 = geom_rbound;
    /// Position in the body frame, m.
    pos: [f64; 3] = geom_pos, pos_mut in geom_pos_mut;
    /// Orientation in the body frame: a unit quaternion `[w, x, y, z]`.
    quat: [f64; 4] = geom_quat, quat_mut in geom_quat_mut;
    /// Friction coefficients: sliding, torsional, rolling.
    friction: [f64; 3] = geom_friction, friction_mut in geom_friction_mut;
    /// Distance at which contacts are detected, m.
    margin: f64 = geom_margin, set_margin in geom_margin_mut;
    /// Contact gap, m. A contact becomes active at the distance `margin - gap`.
    gap: f64 = geom_gap, set_gap in geom_gap_mut;
    /// Coefficients of the ellipsoid fluid model; all 0 if the geom does not use it. See the
    /// engine's `mjNFLUID`.
    fluid: [f64; 12] = geom_fluid, fluid_mut in geom_fluid_mut;
    /// Red, green, blue and opacity, used without a material.
    rgba: [f32; 4] = geom_rgba, rgba_mut in geom_rgba_mut;
    /// User data.
    user: [f64] = geom_user, user_mut in geom_user_mut;
});

/// # Methods of [`GeomMut`](super::GeomMut)
impl ViewMut<'_, ModelMut<'_>, kind::Geom> {
    /// Sets `material`. Give a model several materials to choose the textures of its pictures at
    /// random. The mass does not change.
    ///
    /// # Panics
    ///
    /// If the id belongs to another model.
    ///
    /// ```
    /// use mujoco_safe::Model;
    ///
    /// let mut model = Model::from_xml_str(
    ///     "<mujoco><asset><material name='wood'/><material name='steel'/></asset>
    ///        <worldbody><geom name='table' size='.1' material='wood'/></worldbody></mujoco>",
    /// )?;
    /// let steel = model.material("steel")?.id();
    /// model.edit().geom_mut("table")?.set_material(Some(steel));
    /// assert_eq!(model.geom("table")?.material(), Some(steel));
    /// # Ok::<(), mujoco_safe::Error>(())
    /// ```
    #[track_caller]
    #[doc(alias = "matid")]
    pub fn set_material(&mut self, material: Option<MaterialId>) {
        let material = material.map(|id| {
            self.owner.check_id(id);
            id.index()
        });
        let index = self.id.index();
        self.owner.set_geom_material(index, material);
    }
}

fields!(Geom on Data {
    /// Position, m, world frame.
    xpos: [f64; 3] = geom_xpos;
    /// Orientation as a row-major rotation matrix, world frame.
    xmat: [f64; 9] = geom_xmat;
});

fields!(Site on Model {
    /// Shape, for visualisation and touch sensors.
    site_type: {GeomType} = |site| GeomType::of_field(site.owner.site_type()[site.index()]);
    /// Body that the site is attached to.
    body: {BodyId} = |site| site.id_in(site.owner.site_bodyid());
    /// Material, if any.
    #[doc(alias = "matid")]
    material: {Option<MaterialId>} = |site| site.optional_id_in(site.owner.site_matid());
    /// Frame of the body that the frame of the site coincides with.
    sameframe: {SameFrame} = |site| SameFrame::of_field(site.owner.site_sameframe()[site.index()]);
    /// Visualisation group.
    group: i32 = site_group, set_group;
    /// Size, m.
    size: [f64; 3] = site_size, size_mut in site_size_mut;
    /// Position in the body frame, m.
    pos: [f64; 3] = site_pos, pos_mut in site_pos_mut;
    /// Orientation in the body frame: a unit quaternion `[w, x, y, z]`.
    quat: [f64; 4] = site_quat, quat_mut in site_quat_mut;
    /// Red, green, blue and opacity, used without a material.
    rgba: [f32; 4] = site_rgba, rgba_mut in site_rgba_mut;
    /// User data.
    user: [f64] = site_user, user_mut in site_user_mut;
});

fields!(Site on Data {
    /// Position, m, world frame.
    xpos: [f64; 3] = site_xpos;
    /// Orientation as a row-major rotation matrix, world frame.
    xmat: [f64; 9] = site_xmat;
});

fields!(Camera on Model {
    /// Tracking mode.
    mode: {CameraMode} = |camera| CameraMode::of_field(camera.owner.cam_mode()[camera.index()]);
    /// Body that the camera is attached to.
    body: {BodyId} = |camera| camera.id_in(camera.owner.cam_bodyid());
    /// Target body of the targeting modes.
    #[doc(alias = "targetbodyid")]
    target: {Option<BodyId>} = |camera| camera.optional_id_in(camera.owner.cam_targetbodyid());
    /// Position in the body frame, m.
    pos: [f64; 3] = cam_pos, pos_mut in cam_pos_mut;
    /// Orientation in the body frame: a unit quaternion `[w, x, y, z]`.
    quat: [f64; 4] = cam_quat, quat_mut in cam_quat_mut;
    /// Position relative to the centre of mass of the body's subtree in the reference
    /// configuration, m.
    poscom0: [f64; 3] = cam_poscom0;
    /// Position relative to the body in the reference configuration, m, world frame.
    pos0: [f64; 3] = cam_pos0;
    /// Orientation in the reference configuration, as a row-major rotation matrix.
    mat0: [f64; 9] = cam_mat0;
    /// Vertical field of view, degrees. It has no effect on a camera with a `sensorsize`, whose
    /// focal lengths determine its view.
    fovy: f64 = cam_fovy, set_fovy in cam_fovy_mut;
    /// Interpupillary distance for stereoscopic rendering, m.
    ipd: f64 = cam_ipd, set_ipd in cam_ipd_mut;
    /// User data.
    user: [f64] = cam_user, user_mut in cam_user_mut;
});

fields!(Camera on Data {
    /// Position, m, world frame.
    xpos: [f64; 3] = cam_xpos;
    /// Orientation as a row-major rotation matrix, world frame. The view direction is the negative
    /// z axis.
    xmat: [f64; 9] = cam_xmat;
});

fields!(Light on Model {
    /// Tracking mode.
    mode: {CameraMode} = |light| CameraMode::of_field(light.owner.light_mode()[light.index()]);
    /// Body that the light is attached to.
    body: {BodyId} = |light| light.id_in(light.owner.light_bodyid());
    /// Target body of the targeting modes.
    #[doc(alias = "targetbodyid")]
    target: {Option<BodyId>} = |light| light.optional_id_in(light.owner.light_targetbodyid());
    /// Returns `true` for a directional light, whose rays are parallel.
    directional: {bool} = |light| light.owner.is_directional(light.index());
    /// Returns `true` if the light casts shadows.
    castshadow: bool = light_castshadow, set_castshadow;
    /// Returns `true` if the light is on.
    active: bool = light_active, set_active;
    /// Position in the body frame, m.
    pos: [f64; 3] = light_pos, pos_mut in light_pos_mut;
    /// Direction in the body frame.
    dir: [f64; 3] = light_dir, dir_mut in light_dir_mut;
    /// Position relative to the centre of mass of the body's subtree in the reference
    /// configuration, m.
    poscom0: [f64; 3] = light_poscom0;
    /// Position relative to the body in the reference configuration, m, world frame.
    pos0: [f64; 3] = light_pos0;
    /// Direction in the reference configuration, world frame.
    dir0: [f64; 3] = light_dir0;
    /// Attenuation coefficients: constant, linear, quadratic.
    attenuation: [f32; 3] = light_attenuation, attenuation_mut in light_attenuation_mut;
    /// Half the cone angle of a spotlight, degrees.
    cutoff: f32 = light_cutoff, set_cutoff in light_cutoff_mut;
    /// Exponent of the angular fall-off of a spotlight.
    exponent: f32 = light_exponent, set_exponent in light_exponent_mut;
    /// Ambient colour: red, green and blue.
    ambient: [f32; 3] = light_ambient, ambient_mut in light_ambient_mut;
    /// Diffuse colour: red, green and blue.
    diffuse: [f32; 3] = light_diffuse, diffuse_mut in light_diffuse_mut;
    /// Specular colour: red, green and blue.
    specular: [f32; 3] = light_specular, specular_mut in light_specular_mut;
});

/// # Methods of [`LightMut`](super::LightMut)
impl ViewMut<'_, ModelMut<'_>, kind::Light> {
    /// Sets `directional`.
    pub fn set_directional(&mut self, value: bool) {
        let index = self.id.index();
        self.owner.set_is_directional(index, value);
    }
}

fields!(Light on Data {
    /// Position, m, world frame.
    xpos: [f64; 3] = light_xpos;
    /// Direction, world frame.
    xdir: [f64; 3] = light_xdir;
});
