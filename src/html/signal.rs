//! Sources, names and units of the plotted values.

use std::iter;

use super::options::Signal;
use crate::data::Data;
use crate::element::quantity::Quantity;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::trajectory::Trajectory;

/// Source of a curve.
#[derive(Debug)]
pub(super) struct Source<'s> {
    pub(super) name: String,
    /// Empty for a number without a unit, or with one that the model does not state.
    pub(super) unit: &'static str,
    pub(super) place: Place<'s>,
}

/// Place of a value in each record.
#[derive(Debug)]
pub(super) enum Place<'s> {
    Qpos(usize),
    Qvel(usize),
    Ctrl(usize),
    Reading(usize),
    Value(&'s [f64]),
}

impl Place<'_> {
    pub(super) fn value(&self, data: &Data, trajectory: &Trajectory, record: usize) -> f64 {
        match *self {
            Self::Qpos(index) => data.qpos()[index],
            Self::Qvel(index) => data.qvel()[index],
            Self::Ctrl(index) => data.ctrl()[index],
            Self::Reading(index) => {
                *trajectory.sensordata(record).get(index).unwrap_or_else(|| &data.sensordata()[index])
            }
            Self::Value(values) => values[record],
        }
    }
}

/// Returns the sources of the curves of a signal.
pub(super) fn sources<'s>(data: &Data, trajectory: &Trajectory, signal: &'s Signal) -> Result<Vec<Source<'s>>> {
    let model = data.model();
    let (name, range, units, place): (_, _, Vec<&'static str>, fn(usize) -> Place<'s>) = match signal {
        Signal::Qpos(name) => {
            let joint = model.joint(name)?;
            let units = match joint.joint_type() {
                JointType::Free => [&["m"; 3][..], &[""; 4]].concat(),
                JointType::Ball => vec![""; 4],
                JointType::Slide => vec!["m"],
                JointType::Hinge => vec!["rad"],
            };
            (format!("qpos of {name}"), joint.qpos_range(), units, Place::Qpos)
        }
        Signal::Qvel(name) => {
            let joint = model.joint(name)?;
            let units = match joint.joint_type() {
                JointType::Free => [["m/s"; 3], ["rad/s"; 3]].concat(),
                JointType::Ball => vec!["rad/s"; 3],
                JointType::Slide => vec!["m/s"],
                JointType::Hinge => vec!["rad/s"],
            };
            (format!("qvel of {name}"), joint.dofs(), units, Place::Qvel)
        }
        Signal::Sensor(name) => {
            let sensor = model.sensor(name)?;
            let (range, unit) = (sensor.data_range(), Quantity::of_sensor(model, &sensor).unit);
            (name.clone(), range.clone(), vec![unit; range.len()], Place::Reading)
        }
        Signal::Ctrl(name) => {
            let index = model.actuator(name)?.id().index();
            (format!("ctrl of {name}"), index..index + 1, vec![""], Place::Ctrl)
        }
        Signal::Values { name, values } => {
            Error::check_length("the values of a signal in a page", values.len(), trajectory.len())?;
            return Ok(vec![Source { name: name.clone(), unit: "", place: Place::Value(values) }]);
        }
    };
    let count = range.len();
    let units = units.into_iter().chain(iter::repeat(""));
    let source = |(number, (index, unit))| {
        let name = if count == 1 { name.clone() } else { format!("{name} [{number}]") };
        Source { name, unit, place: place(index) }
    };
    Ok(range.zip(units).enumerate().map(source).collect())
}
