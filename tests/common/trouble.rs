//! Models for which the engine fails or warns.

#![allow(unreachable_pub, dead_code, reason = "included by several tests, each of which uses some of it")]

use mujoco_safe::{Data, Model, Result};

/// Returns a ball that falls on a floor, with a stack of this size.
pub fn with_stack(nstack: u32) -> Result<Model> {
    Model::from_xml_str(&format!(
        r#"<mujoco><size nstack="{nstack}"/><worldbody>
             <geom type="plane" size="1 1 1"/><body pos="0 0 .2"><freejoint/><geom size=".1"/></body>
           </worldbody></mujoco>"#
    ))
}

/// Returns the ball with a stack that overflows when the ball hits the floor.
pub fn overflowing() -> Model {
    (10..5000)
        .step_by(10)
        .find_map(|nstack| {
            let model = with_stack(nstack).ok()?;
            let mut data = Data::new(model.clone()).unwrap();
            (0..200).any(|_| data.step().is_err()).then_some(model)
        })
        .expect("a stack that is large enough to fall and too small to land")
}

/// Returns four balls on a floor, with room for two contacts.
pub fn crowded() -> Model {
    let balls = [0, 1, 2, 3].map(|x| format!(r#"<body pos="{x} 0 .09"><freejoint/><geom size=".1"/></body>"#)).concat();
    Model::from_xml_str(&format!(
        r#"<mujoco><size nconmax="2"/><worldbody><geom type="plane" size="9 9 1"/>{balls}</worldbody></mujoco>"#
    ))
    .unwrap()
}

/// Returns a pendulum whose length and names depend on the number.
pub fn pendulum(number: u64) -> String {
    format!(
        r#"<mujoco model="number {number}"><worldbody><body name="b{number}"><joint name="j{number}" axis="0 1 0"/>
             <geom type="capsule" size=".02" fromto="0 0 0 .{number}1 0 0"/></body></worldbody>
           <actuator><motor joint="j{number}"/></actuator></mujoco>"#
    )
}
