//! Sources, names and units of the plotted values.

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

/// Reads the value of an index from a state, or from the recorded readings.
type Reader = fn(&Data, &[f64], usize) -> f64;

/// Place of a value in each record.
#[derive(Debug)]
pub(super) enum Place<'s> {
    State(Reader, usize),
    Values(&'s [f64]),
}

impl Place<'_> {
    pub(super) fn value(&self, data: &Data, trajectory: &Trajectory, record: usize) -> f64 {
        match *self {
            Self::State(read, index) => read(data, trajectory.sensordata(record), index),
            Self::Values(values) => values[record],
        }
    }
}

/// Returns the units of a joint: of a linear and of an angular coordinate, and of the coordinates
/// of a rotation in space.
fn units(
    joint: JointType,
    linear: &'static str,
    angular: &'static str,
    rotation: &[&'static str],
) -> Vec<&'static str> {
    match joint {
        JointType::Free => [&[linear; 3], rotation].concat(),
        JointType::Ball => rotation.to_vec(),
        JointType::Slide => vec![linear],
        JointType::Hinge => vec![angular],
    }
}

/// Returns the sources of the curves of a signal.
pub(super) fn sources<'s>(data: &Data, trajectory: &Trajectory, signal: &'s Signal) -> Result<Vec<Source<'s>>> {
    let model = data.model();
    let (name, range, units, read): (_, _, _, Reader) = match signal {
        Signal::Qpos(name) => {
            let joint = model.joint(name)?;
            let units = units(joint.joint_type(), "m", "rad", &[""; 4]);
            (format!("qpos of {name}"), joint.qpos_range(), units, |data, _, index| data.qpos()[index])
        }
        Signal::Qvel(name) => {
            let joint = model.joint(name)?;
            let units = units(joint.joint_type(), "m/s", "rad/s", &["rad/s"; 3]);
            (format!("qvel of {name}"), joint.dofs(), units, |data, _, index| data.qvel()[index])
        }
        Signal::Sensor(name) => {
            let sensor = model.sensor(name)?;
            let (range, unit) = (sensor.data_range(), Quantity::of_sensor(model, &sensor).unit);
            (name.clone(), range.clone(), vec![unit; range.len()], |data, recorded, index| {
                *recorded.get(index).unwrap_or_else(|| &data.sensordata()[index])
            })
        }
        Signal::Ctrl(name) => {
            let index = model.actuator(name)?.id().index();
            (format!("ctrl of {name}"), index..index + 1, vec![""], |data, _, index| data.ctrl()[index])
        }
        Signal::Values { name, values } => {
            Error::check_length("the values of a signal in a page", values.len(), trajectory.len())?;
            return Ok(vec![Source { name: name.clone(), unit: "", place: Place::Values(values) }]);
        }
    };
    let count = range.len();
    let source = |(number, (index, unit))| {
        let name = if count == 1 { name.clone() } else { format!("{name} [{number}]") };
        Source { name, unit, place: Place::State(read, index) }
    };
    Ok(range.zip(units).enumerate().map(source).collect())
}
