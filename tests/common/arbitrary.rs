//! Proptest strategies for numbers and models.

#![allow(dead_code, reason = "included by several programs, each of which uses some of it")]

use std::sync::{Arc, LazyLock};

use mujoco_safe::{Model, sample};
use proptest::prelude::*;

pub(crate) static ZOO: LazyLock<Arc<Model>> =
    LazyLock::new(|| Arc::new(Model::from_xml_str(include_str!("../models/zoo.xml")).unwrap()));
pub(crate) static HUMANOID: LazyLock<Arc<Model>> = LazyLock::new(|| Arc::new(sample::humanoid()));
pub(crate) static CARTPOLE: LazyLock<Arc<Model>> = LazyLock::new(|| Arc::new(sample::cartpole()));
/// A free ball, without actuators or sensors.
pub(crate) static BALL: LazyLock<Arc<Model>> = LazyLock::new(|| {
    let xml = r#"<mujoco><worldbody><body><freejoint/><geom size=".1"/></body></worldbody></mujoco>"#;
    Arc::new(Model::from_xml_str(xml).unwrap())
});
/// A static geom, without degrees of freedom.
pub(crate) static ROCK: LazyLock<Arc<Model>> = LazyLock::new(|| {
    let xml = r#"<mujoco><worldbody><geom size=".1"/></worldbody></mujoco>"#;
    Arc::new(Model::from_xml_str(xml).unwrap())
});

pub(crate) fn any_model() -> impl Strategy<Value = Arc<Model>> {
    prop::sample::select(vec![&ZOO, &HUMANOID, &CARTPOLE, &BALL, &ROCK]).prop_map(|model| (**model).clone())
}

/// Any double, with a high share of special values.
pub(crate) fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        prop::num::f64::NORMAL,
        prop::sample::select(vec![0.0, -0.0, f64::MIN_POSITIVE, 5e-324, -5e-324, f64::MAX, f64::MIN, 0.1, 1e23, 9e15]),
    ]
}

pub(crate) fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}
