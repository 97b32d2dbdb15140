//! Lights.

use super::{View, ViewMut};
use crate::data::Data;
use crate::enums::CameraMode;
use crate::id::{BodyId, kind};
use crate::model::{Model, ModelMut};

fields!(Light on Model {
    /// What it does while its body moves.
    mode: {CameraMode} = |light| CameraMode::of_field(light.owner.light_mode()[light.index()]);
    /// The body that it belongs to.
    body: {BodyId} = |light| light.id_in(light.owner.light_bodyid());
    /// The body that it turns to, if its mode has one.
    #[doc(alias = "targetbodyid")]
    target: {Option<BodyId>} = |light| light.optional_id_in(light.owner.light_targetbodyid());
    /// Whether its rays are parallel.
    directional: bool = light_directional, set_directional;
    /// Whether it casts shadows.
    castshadow: bool = light_castshadow, set_castshadow;
    /// Whether it is on.
    active: bool = light_active, set_active;
    /// Position in the frame of its body, m.
    pos: [f64; 3] = light_pos, pos_mut in light_pos_mut;
    /// Direction in the frame of its body.
    dir: [f64; 3] = light_dir, dir_mut in light_dir_mut;
    /// Position relative to the centre of mass of its subtree in the reference configuration, m.
    poscom0: [f64; 3] = light_poscom0;
    /// Position relative to its body in the reference configuration, m, world frame.
    pos0: [f64; 3] = light_pos0;
    /// Direction in the reference configuration, world frame.
    dir0: [f64; 3] = light_dir0;
    /// Attenuation: constant, linear, quadratic.
    attenuation: [f32; 3] = light_attenuation, attenuation_mut in light_attenuation_mut;
    /// Half the angle of a spot light, degrees.
    cutoff: f32 = light_cutoff, set_cutoff in light_cutoff_mut;
    /// How sharply a spot light falls off.
    exponent: f32 = light_exponent, set_exponent in light_exponent_mut;
    /// Ambient red, green and blue.
    ambient: [f32; 3] = light_ambient, ambient_mut in light_ambient_mut;
    /// Diffuse red, green and blue.
    diffuse: [f32; 3] = light_diffuse, diffuse_mut in light_diffuse_mut;
    /// Specular red, green and blue.
    specular: [f32; 3] = light_specular, specular_mut in light_specular_mut;
});

fields!(Light on Data {
    /// Position, m, world frame.
    xpos: [f64; 3] = light_xpos;
    /// Direction, world frame.
    xdir: [f64; 3] = light_xdir;
});
