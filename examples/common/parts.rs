//! Parts of scenes that programs build: the arm of `models/arm.xml` with servos, and a sky.

use mujoco_safe::enums::TextureType;
use mujoco_safe::kind;
use mujoco_safe::spec::{ActuatorElement, Spec, TexturePattern};

/// Returns the arm without light, floor and target, and with a servo in place of each motor.
pub fn servo_arm() -> mujoco_safe::Result<Spec> {
    let mut arm = Spec::from_xml_str(include_str!("../../models/arm.xml"))?;
    let light = arm.ids::<kind::Light>()[0].any();
    for id in [arm.geom("floor")?.id().any(), arm.body("target")?.id().any(), light] {
        arm.remove(id)?;
    }
    for motor in arm.ids() {
        let name = arm.actuator(motor).name().unwrap_or_default().to_owned();
        let gear = arm.actuator(motor).numbers("gear")?.unwrap_or_default();
        arm.remove(motor)?;
        arm.add_actuator(ActuatorElement::Position)
            .set_name(&name)
            .set_joint(&name[..])
            .set_kp(5.0 * gear[0])
            .set_ctrlrange([-3.0, 3.0]);
    }
    Ok(arm)
}

/// Adds a sky with these colours at the horizon and above.
pub fn add_sky(spec: &mut Spec, horizon: [f32; 3], zenith: [f32; 3]) -> mujoco_safe::Result<()> {
    spec.add_texture()
        .set_name("sky")
        .set_type(TextureType::Skybox)
        .set_builtin(TexturePattern::Gradient)
        .set_width(64)
        .set_height(384);
    spec.texture_mut("sky")?.set_rgb1(horizon).set_rgb2(zenith);
    Ok(())
}
