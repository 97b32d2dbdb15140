//! The arm of `models/arm.xml` as a part of a scene, with position servos.

use mujoco_safe::kind;
use mujoco_safe::spec::{ActuatorElement, Spec};

/// Returns the arm without light, floor and target, and with a servo in place of each motor.
pub fn spec() -> mujoco_safe::Result<Spec> {
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
