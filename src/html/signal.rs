//! Sources, names and units of the plotted values.

use super::options::Signal;
use crate::data::Data;
use crate::element::quantity::Quantity;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::trajectory::Trajectory;

/// Returns the value in a record, of which the simulation has the state.
type Value<'s> = Box<dyn Fn(&Data, usize) -> f64 + 's>;

/// Reads the value of an index from a state, or from the recorded readings.
type Reader = fn(&Data, &[f64], usize) -> f64;

/// Source of a curve.
pub(super) struct Source<'s> {
    pub(super) name: String,
    /// Empty for a number without a unit, or with one that the model does not state.
    pub(super) unit: &'static str,
    pub(super) value: Value<'s>,
}

/// Returns the units of a joint: of a linear or of an angular coordinate, and of the coordinates of
/// a rotation in space.
fn units(joint: JointType, [linear, angular]: [&'static str; 2], rotation: &[&'static str]) -> Vec<&'static str> {
    match joint {
        JointType::Free => [&[linear; 3], rotation].concat(),
        JointType::Ball => rotation.to_vec(),
        JointType::Slide => vec![linear],
        JointType::Hinge => vec![angular],
    }
}

/// Returns the sources of the curves of a signal.
pub(super) fn sources<'s>(data: &Data, trajectory: &'s Trajectory, signal: &'s Signal) -> Result<Vec<Source<'s>>> {
    let model = data.model();
    let (name, range, units, read): (_, _, _, Reader) = match signal {
        Signal::Qpos(name) => {
            let joint = model.joint(name)?;
            let units = units(joint.joint_type(), ["m", "rad"], &[""; 4]);
            (format!("qpos of {name}"), joint.qpos_range(), units, |data, _, index| data.qpos()[index])
        }
        Signal::Qvel(name) => {
            let joint = model.joint(name)?;
            let units = units(joint.joint_type(), ["m/s", "rad/s"], &["rad/s"; 3]);
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
            return Ok(vec![Source { name: name.clone(), unit: "", value: Box::new(|_, record| values[record]) }]);
        }
    };
    let count = range.len();
    let source = |(number, (index, unit))| {
        let name = if count == 1 { name.clone() } else { format!("{name} [{number}]") };
        let value = move |data: &Data, record| read(data, trajectory.sensordata(record), index);
        Source { name, unit, value: Box::new(value) }
    };
    Ok(range.zip(units).enumerate().map(source).collect())
}
