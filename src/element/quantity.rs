//! Quantities and units of the readings of sensors.

use super::{Object, Transmission, View};
use crate::enums::{JointType, SensorType};
use crate::id::JointId;
use crate::kind;
use crate::model::Model;

/// Quantity, and its unit, which is empty for a number without a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Quantity {
    pub name: &'static str,
    pub unit: &'static str,
}

pub(crate) const fn quantity(name: &'static str, unit: &'static str) -> Quantity {
    Quantity { name, unit }
}

const POSITION: Quantity = quantity("position", "m");
const VELOCITY: Quantity = quantity("velocity", "m/s");
const FORCE: Quantity = quantity("force", "N");
const ANGLE: Quantity = quantity("angle", "rad");
const ANGULAR_VELOCITY: Quantity = quantity("angular velocity", "rad/s");
const TORQUE: Quantity = quantity("torque", "N m");

/// Linear quantities, and the angular quantities of the same order.
const POSITIONS: [Quantity; 2] = [POSITION, ANGLE];
const VELOCITIES: [Quantity; 2] = [VELOCITY, ANGULAR_VELOCITY];
const FORCES: [Quantity; 2] = [FORCE, TORQUE];

impl Quantity {
    /// Returns the quantity of a sensor's reading.
    pub fn of_sensor(model: &Model, sensor: &View<'_, Model, kind::Sensor>) -> Self {
        use SensorType as S;
        let of = |[linear, angular]: [Self; 2], other| match is_angular(model, sensor) {
            Some(false) => linear,
            Some(true) => angular,
            None => other,
        };
        match sensor.sensor_type() {
            S::Touch | S::Force | S::TendonLimitForce | S::TendonActuatorForce => FORCE,
            S::Torque => TORQUE,
            S::Accelerometer | S::FrameLinearAcceleration => quantity("acceleration", "m/s²"),
            S::FrameAngularAcceleration => quantity("angular acceleration", "rad/s²"),
            S::Velocimeter
            | S::TendonVelocity
            | S::TendonLimitVelocity
            | S::FrameLinearVelocity
            | S::SubtreeLinearVelocity => VELOCITY,
            S::Gyro | S::BallAngularVelocity | S::FrameAngularVelocity => ANGULAR_VELOCITY,
            S::Rangefinder
            | S::TendonPosition
            | S::TendonLimitPosition
            | S::FramePosition
            | S::SubtreeCom
            | S::GeomDistance
            | S::GeomFromTo => POSITION,
            S::JointPosition | S::JointLimitPosition => of(POSITIONS, ANGLE),
            S::JointVelocity | S::JointLimitVelocity => of(VELOCITIES, ANGULAR_VELOCITY),
            S::JointLimitForce | S::JointActuatorForce => of(FORCES, TORQUE),
            S::ActuatorPosition => of(POSITIONS, quantity("length of actuators", "")),
            S::ActuatorVelocity => of(VELOCITIES, quantity("velocity of actuators", "")),
            S::ActuatorForce => of(FORCES, quantity("force of actuators", "")),
            S::Magnetometer => quantity("magnetic flux", ""),
            S::BallQuaternion | S::FrameQuaternion => quantity("quaternion", ""),
            S::FrameXAxis | S::FrameYAxis | S::FrameZAxis | S::GeomNormal => quantity("direction", ""),
            S::SubtreeAngularMomentum => quantity("angular momentum", "kg m²/s"),
            S::Clock => quantity("time", "s"),
            S::PotentialEnergy | S::KineticEnergy => quantity("energy", "J"),
            S::CameraProjection => quantity("image", "pixels"),
            S::InsideSite => quantity("inside of sites", ""),
            S::Contact => quantity("contact", ""),
            S::Tactile => quantity("tactile", ""),
            _ => quantity("other", ""),
        }
    }
}

/// Returns `true` if the joint of a sensor, or of its actuator, turns, `false` if it or a tendon is
/// straight, and `None` for other objects, whose unit depends on the model.
fn is_angular(model: &Model, sensor: &View<'_, Model, kind::Sensor>) -> Option<bool> {
    let turns = |joint: JointId| match model.joint(joint).joint_type() {
        JointType::Slide => Some(false),
        JointType::Hinge | JointType::Ball => Some(true),
        JointType::Free => None,
    };
    match sensor.object()? {
        Object::Joint(joint) => turns(joint),
        Object::Actuator(actuator) => match model.actuator(actuator).transmission() {
            Transmission::Joint(joint) | Transmission::JointInParent(joint) => turns(joint),
            Transmission::Tendon(_) | Transmission::SliderCrank { .. } => Some(false),
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::Quantity;
    use crate::Model;

    #[test]
    fn units_of_sensors_depend_on_their_joints() {
        let text = r#"<mujoco><worldbody>
              <body><joint name="slide" type="slide" limited="true" range="0 1"/><geom size=".1"/><site name="site"/></body>
              <body><joint name="hinge"/><geom size=".1"/></body>
            </worldbody>
            <actuator><motor name="push" joint="slide"/><motor name="turn" joint="hinge"/><motor name="jet" site="site"/></actuator>
            <sensor>
              <jointpos joint="slide"/><jointpos joint="hinge"/><jointvel joint="hinge"/><jointlimitfrc joint="slide"/>
              <actuatorfrc actuator="push"/><actuatorfrc actuator="turn"/><actuatorfrc actuator="jet"/>
              <actuatorpos actuator="turn"/><actuatorvel actuator="push"/>
              <accelerometer site="site"/><gyro site="site"/><framequat objtype="site" objname="site"/>
            </sensor></mujoco>"#;
        let model = Model::from_xml_str(text).unwrap();
        let units: Vec<&str> = model.sensors().map(|sensor| Quantity::of_sensor(&model, &sensor).unit).collect();
        assert_eq!(units, ["m", "rad", "rad/s", "N", "N", "N m", "", "rad", "m/s", "m/s²", "rad/s", ""]);
    }
}
