//! Named access: what can be looked up and by what, what an unknown name is told, that writing through a view arrives where
//! the engine reads it, and how a view is printed.
//!
//! `models/zoo.xml` has most kinds of element, with and without names; the expected names and numbers are those of its text.
//! `models/every_element.xml` has all.
//! That each field reads the engine's memory is the matter of `against_c`.
#![forbid(unsafe_code)]
#![allow(clippy::float_cmp, reason = "what is written is what is read")]

mod iterating;
mod kinds;
mod looking_up;
mod mass;
mod printing;
mod ranges;
mod setters;
mod unknown_names;
mod writing;

use std::sync::Arc;

use mujoco_safe::{Data, EnableFlags, Error, Model};

const ZOO_XML: &str = include_str!("../models/zoo.xml");

fn zoo() -> Arc<Model> {
    Arc::new(Model::from_xml_str(ZOO_XML).expect("the zoo loads"))
}

fn every_element() -> Model {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml");
    Model::from_xml_path(path).expect("it is valid")
}

fn simulation() -> Data {
    let mut data = Data::new(zoo()).expect("there is memory");
    data.forward().expect("forward dynamics");
    data
}

/// The text of the error, if it is of the kind that an unknown name gives.
fn unknown<T: std::fmt::Debug>(result: Result<T, Error>) -> String {
    let error = result.expect_err("there is no such element");
    assert!(matches!(error, Error::NoSuchName { .. }), "{error}");
    error.to_string()
}

#[test]
fn readings_of_a_sensor_are_its_part_of_the_sensor_data() {
    let mut data = simulation();
    let model = data.model().clone();
    let elbow = model.sensor("elbow").expect("there is a sensor");
    assert_eq!((elbow.dim(), elbow.data_range()), (1, 3..4));
    data.joint_mut("elbow").expect("an elbow").qpos_mut()[0] = 0.75;
    data.forward().expect("forward dynamics");
    assert_eq!(data.sensor(elbow).data().expect("computed"), [0.75]);
    // Beyond its cutoff of 1 it is clamped.
    data.joint_mut("elbow").expect("an elbow").qpos_mut()[0] = 1.5;
    data.forward().expect("forward dynamics");
    assert_eq!(data.sensor(elbow).data().expect("computed"), [1.0]);
    assert_eq!(data.sensordata()[3], 1.0);
    assert!(!model.options().enable.contains(EnableFlags::SENSORNOISE));
}
