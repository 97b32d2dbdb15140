//! Elements: lookup, errors of unknown names, reading and writing through views, and printing.
//!
//! `models/zoo.xml` has most kinds of element, with and without names, and
//! `models/every_element.xml` has all. The expected names and numbers are those of the XML. The
//! program `engine` compares each field with the engine's memory.
#![forbid(unsafe_code)]
#![allow(clippy::float_cmp, reason = "numbers are read as they were written")]

#[path = "../common/cases.rs"]
mod cases;
#[path = "../common/installed.rs"]
mod installed;
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

use mujoco_safe::model::EnableFlags;
use mujoco_safe::{Data, Error, Model};

const ZOO_XML: &str = include_str!("../models/zoo.xml");

fn zoo() -> Arc<Model> {
    Arc::new(Model::from_xml_str(ZOO_XML).unwrap())
}

fn every_element() -> Model {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/every_element.xml");
    Model::from_xml_path(path).unwrap()
}

fn simulation() -> Data {
    let mut data = Data::new(zoo()).unwrap();
    data.forward().unwrap();
    data
}

/// Returns the message of an error that an unknown name gives.
fn unknown<T: std::fmt::Debug>(result: Result<T, Error>) -> String {
    let error = result.unwrap_err();
    assert!(matches!(error, Error::NoSuchName { .. }), "{error}");
    error.to_string()
}

#[test]
fn a_sensors_reading_is_its_part_of_sensordata() {
    let mut data = simulation();
    let model = data.model().clone();
    let elbow = model.sensor("elbow").unwrap();
    assert_eq!((elbow.dim(), elbow.data_range()), (1, 3..4));
    data.joint_mut("elbow").unwrap().qpos_mut()[0] = 0.75;
    data.forward().unwrap();
    assert_eq!(data.sensor(elbow).data().unwrap(), [0.75]);
    // The value is clamped at the cutoff of 1.
    data.joint_mut("elbow").unwrap().qpos_mut()[0] = 1.5;
    data.forward().unwrap();
    assert_eq!(data.sensor(elbow).data().unwrap(), [1.0]);
    assert_eq!(data.sensordata()[3], 1.0);
    assert!(!model.options().enable.contains(EnableFlags::SENSORNOISE));
}
