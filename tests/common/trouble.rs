//! Models for which the engine fails or warns.

#![allow(unreachable_pub, dead_code, reason = "included by several tests, each of which uses some of it")]

use mujoco_safe::data::Warning;
use mujoco_safe::{Data, Model, Result};

/// Part of the engine's message when its stack overflows.
pub const STACK_OVERFLOW: &str = if cfg!(engine_since = "2.3.0") { "stack overflow" } else { "Stack overflow" };

/// Returns a body that falls on a floor. The engine's stack is this large: in 2.2.2 a number of
/// values, since 2.3 in bytes and together with the contacts and constraints.
pub fn with_stack(size: u32) -> Result<Model> {
    let attribute = if cfg!(engine_since = "2.3.0") { "memory" } else { "nstack" };
    // The dual solver of a box with rolling friction needs more memory for its stack than for its
    // constraints. With less memory than a ball needs, 3.5.0 drops the contacts with a warning.
    let (solver, geom) = if cfg!(all(engine_since = "3.5.0", not(engine_since = "3.17.0"))) {
        (r#"<option solver="PGS" jacobian="dense"/>"#, r#"type="box" size=".1 .1 .1" condim="6""#)
    } else {
        ("", r#"size=".1""#)
    };
    Model::from_xml_str(&format!(
        r#"<mujoco><size {attribute}="{size}"/>{solver}<worldbody>
             <geom type="plane" size="1 1 1"/><body pos="0 0 .2"><freejoint/><geom {geom}/></body>
           </worldbody></mujoco>"#
    ))
}

/// Returns the falling body with a stack that overflows when the body hits the floor.
pub fn overflowing() -> Model {
    let sizes = if cfg!(engine_since = "2.3.0") { (100..40_000).step_by(64) } else { (10..5000).step_by(10) };
    let overflows = |model: &Model| {
        let mut data = Data::new(model.clone()).unwrap();
        (0..200).any(|_| data.step().is_err())
    };
    sizes
        .filter_map(|size| with_stack(size).ok())
        .find(overflows)
        .expect("a stack that is large enough to fall and too small to land")
}

/// Returns four balls on a floor, with room for two contacts. Since 2.3 the number of contacts has
/// no limit.
pub fn crowded() -> Model {
    balls(r#"nconmax="2""#)
}

/// Returns four balls that lie on a floor, with an attribute of the element `size`.
fn balls(size: &str) -> Model {
    let balls = [0, 1, 2, 3].map(|x| format!(r#"<body pos="{x} 0 .09"><freejoint/><geom size=".1"/></body>"#)).concat();
    Model::from_xml_str(&format!(
        r#"<mujoco><size {size}/><worldbody><geom type="plane" size="9 9 1"/>{balls}</worldbody></mujoco>"#
    ))
    .unwrap()
}

/// Returns a model whose steps raise a warning, and this warning.
pub fn warning() -> (Model, Warning) {
    if cfg!(not(engine_since = "2.3.0")) {
        return (crowded(), Warning::ContactFull);
    }
    if cfg!(not(engine_since = "3.17.0")) {
        return (balls(r#"memory="10000""#), Warning::ContactFull);
    }
    // Without memory for contacts, a step with these engines is an error. Earlier engines do not
    // warn of a body without mass.
    let xml =
        "<mujoco><worldbody><body><joint axis='0 1 0'/><geom size='.1' pos='.3 0 0'/></body></worldbody></mujoco>";
    let mut model = Model::from_xml_str(xml).unwrap();
    let mut edit = model.edit();
    edit.body_mass_mut().fill(0.0);
    edit.body_inertia_mut().as_flattened_mut().fill(0.0);
    (model, Warning::Inertia)
}

/// Returns a pendulum whose length and names depend on the number.
pub fn pendulum(number: u64) -> String {
    format!(
        r#"<mujoco model="number {number}"><worldbody><body name="b{number}"><joint name="j{number}" axis="0 1 0"/>
             <geom type="capsule" size=".02" fromto="0 0 0 .{number}1 0 0"/></body></worldbody>
           <actuator><motor joint="j{number}"/></actuator></mujoco>"#
    )
}
