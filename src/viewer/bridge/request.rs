//! Requests done.

use std::sync::Arc;

use super::Bridge;
use crate::data::Data;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::id::{ElementKind, Id, JointId};
use crate::math::normalize4;
use crate::viewer::capture::{CapturedKey, key_xml};
use crate::viewer::event::Event;
use crate::viewer::request::Request;

/// How many keys wait at most for a program that does not ask for them.
const MOST_KEYS: usize = 256;

/// What became of a request.
#[derive(Debug)]
pub(crate) enum Outcome {
    /// It is done, and the simulation is what it was.
    Done,
    /// It is done, and the simulation has changed: what depends on its state has to be computed.
    Changed,
    /// It is not for a bridge, and nothing is done.
    Left,
}

impl Bridge {
    /// Does a request, if it is one that any simulation can do.
    ///
    /// # Errors
    ///
    /// Those of the calls that it makes.
    pub fn execute(&mut self, request: Request, data: &mut Data) -> Result<Outcome> {
        match request {
            Request::Look(look) => {
                self.set_window_look(*look);
                return Ok(Outcome::Done);
            }
            Request::Reset => self.reset(data)?,
            Request::Select(place) => return self.select(place, data),
            Request::SelectBody(body) => return self.select_body(body, data),
            Request::SelectParent => return self.select_parent(data),
            Request::LookAt(place) => return self.look_at(place, data),
            Request::Track(place) => return self.track(place, data),
            Request::StartPerturbation(flags) => return self.start_perturbation(flags, data),
            Request::MovePerturbation(action, motion) => return self.move_perturbation(action, motion, data),
            Request::StopPerturbation => self.stop_perturbation(data),
            Request::SetControl(actuator, value) => {
                if self.is_stale(actuator) {
                    return Ok(Outcome::Done);
                }
                check_finite("a control", value)?;
                data.ctrl_mut()[actuator.index()] = value;
            }
            Request::ClearControls => data.ctrl_mut().fill(0.0),
            Request::SetPosition(joint, part, value) => {
                if self.is_stale(joint) {
                    return Ok(Outcome::Done);
                }
                return set_position(joint, part, value, data);
            }
            Request::LoadKey(key) => {
                if self.is_stale(key) {
                    return Ok(Outcome::Done);
                }
                data.reset_to_key(key)?;
            }
            Request::SaveKey(name) => return Ok(self.save_key(name, data)),
            Request::LoadCaptured(number) => {
                let Some(key) = self.captured.iter().find(|key| key.number == number) else {
                    return Ok(Outcome::Done);
                };
                key.apply(data)?;
            }
            Request::RemoveCaptured(number) => {
                if self.captured.iter().any(|key| key.number == number) {
                    Arc::make_mut(&mut self.captured).retain(|key| key.number != number);
                }
                return Ok(Outcome::Done);
            }
            Request::CopyState => {
                self.back.tell(Event::Copied(key_xml(data, None)));
                return Ok(Outcome::Done);
            }
            Request::CopyCamera => return self.copy_camera(data),
            Request::SetEquality(equality, active) => {
                if self.is_stale(equality) {
                    return Ok(Outcome::Done);
                }
                data.edit_model(|model| model.equality_mut(equality).set_active(active))?;
                self.adopt(data);
            }
            Request::SetOptions(options) => {
                data.edit_model(|model| model.options(|present| *present = *options))??;
                self.adopt(data);
            }
            Request::Watch(watches) => {
                self.watches = watches;
                return Ok(Outcome::Done);
            }
            Request::Key(press) => {
                if self.keys.len() < MOST_KEYS {
                    self.keys.push(press);
                }
                return Ok(Outcome::Done);
            }
            Request::Pause(_)
            | Request::TogglePause
            | Request::Step(_)
            | Request::ToggleSpeed
            | Request::Faster
            | Request::Slower
            | Request::SetSpeed(_)
            | Request::CycleMode(_)
            | Request::SetMode(_)
            | Request::Scrub(_)
            | Request::Reload(_)
            | Request::Reverse
            | Request::CycleTrajectory(_)
            | Request::SetTrajectory(_)
            | Request::SetFrame(_)
            | Request::Burst
            | Request::Doppler
            | Request::BurstFactor(_)
            | Request::BurstGamma(_) => return Ok(Outcome::Left),
        }
        Ok(Outcome::Changed)
    }

    /// Whether an id is of a model that was replaced since the window has seen it.
    pub(super) fn is_stale<K: ElementKind>(&self, id: Id<K>) -> bool {
        id.lineage() != self.model.lineage()
    }

    fn save_key(&mut self, name: Option<String>, data: &Data) -> Outcome {
        let name = name.unwrap_or_else(|| {
            let taken = |name: &str| self.captured.iter().any(|key| key.name == name);
            let numbered = (1..).map(|number| format!("captured_{number}"));
            numbered.into_iter().find(|name| !taken(name)).expect("Bug: there is always a next number")
        });
        self.back.tell(Event::Notice(format!("kept as keyframe {name}")));
        Arc::make_mut(&mut self.captured).push(CapturedKey::new(data, self.kept, name));
        self.kept += 1;
        Outcome::Done
    }
}

/// A part of a quaternion turns the rest with it: whatever is dragged by it later needs a rotation.
fn set_position(joint: JointId, part: usize, value: f64, data: &mut Data) -> Result<Outcome> {
    check_finite("a position", value)?;
    let mut joint = data.joint_mut(joint);
    let Some(number) = joint.qpos_mut().get_mut(part) else { return Ok(Outcome::Done) };
    *number = value;
    let quaternion = match joint.as_view().in_model().joint_type() {
        JointType::Free => 3,
        JointType::Ball => 0,
        JointType::Slide | JointType::Hinge => return Ok(Outcome::Changed),
    };
    if part >= quaternion
        && let Some(quaternion) = joint.qpos_mut()[quaternion..].first_chunk_mut()
    {
        normalize4(quaternion);
    }
    Ok(Outcome::Changed)
}

fn check_finite(what: &str, value: f64) -> Result<()> {
    if value.is_finite() { Ok(()) } else { Err(Error::invalid(what, value, "a finite number")) }
}
