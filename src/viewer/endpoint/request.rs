//! Execution of the requests that any simulation supports.

use std::path::Path;
use std::sync::Arc;

use super::SimulationEndpoint;
use super::keyframe::{CapturedKey, key_xml};
use crate::data::Data;
use crate::enums::JointType;
use crate::error::{Error, Result};
use crate::file::free_path;
use crate::id::{Id, JointId};
use crate::kind::ElementKind;
use crate::math::normalize4;
use crate::viewer::link::{EndpointRequest, Event, SavedFile};

/// Capacity of the queue of key presses, for a program that never reads them.
const MAX_KEYS: usize = 256;

impl SimulationEndpoint {
    /// Executes a request. Returns `true` if the state or the model has changed, so that dependent
    /// quantities must be recomputed.
    ///
    /// # Errors
    ///
    /// Errors of the calls that the request requires.
    pub fn execute(&mut self, request: EndpointRequest, data: &mut Data) -> Result<bool> {
        match request {
            EndpointRequest::SetView(view) => self.adopt_view(*view),
            EndpointRequest::Select(point) => self.select(point, data)?,
            EndpointRequest::SelectBody(body) => self.select_body(body, data)?,
            EndpointRequest::SelectParent => self.select_parent(data)?,
            EndpointRequest::LookAt(point) => self.look_at(point, data)?,
            EndpointRequest::Track(point) => self.track(point, data)?,
            EndpointRequest::StartPerturbation(flags) => self.start_perturbation(flags, data)?,
            EndpointRequest::MovePerturbation(action, motion) => self.move_perturbation(action, motion, data)?,
            EndpointRequest::StopPerturbation => {
                self.stop_perturbation(data);
                return Ok(true);
            }
            EndpointRequest::SetControl(actuator, number, value) if !self.is_stale(actuator) => {
                check_finite("a control", value)?;
                data.actuator_mut(actuator).ctrls_mut()[number] = value;
                return Ok(true);
            }
            EndpointRequest::ClearControls => {
                data.ctrl_mut().fill(0.0);
                return Ok(true);
            }
            EndpointRequest::SetPosition(joint, part, value) if !self.is_stale(joint) => {
                return set_position(joint, part, value, data);
            }
            EndpointRequest::LoadKey(key) if !self.is_stale(key) => {
                data.reset_to_key(key)?;
                return Ok(true);
            }
            EndpointRequest::SaveKey(name) => self.save_key(name, data),
            EndpointRequest::LoadCaptured(number) => {
                let Some(key) = self.captured.iter().find(|key| key.number == number) else { return Ok(false) };
                key.restore(data)?;
                return Ok(true);
            }
            EndpointRequest::RemoveCaptured(number) => {
                if self.captured.iter().any(|key| key.number == number) {
                    Arc::make_mut(&mut self.captured).retain(|key| key.number != number);
                }
            }
            EndpointRequest::CopyState => self.link.send(Event::Copied(key_xml(data, None))),
            EndpointRequest::CopyCamera => self.copy_camera(data)?,
            EndpointRequest::SetEquality(equality, active) if !self.is_stale(equality) => {
                data.edit_model(|model| model.equality_mut(equality).set_active(active))?;
                self.adopt(data);
                return Ok(true);
            }
            EndpointRequest::SetOptions(options) => {
                data.edit_model(|model| model.edit_options(|present| *present = *options))?;
                self.adopt(data);
                return Ok(true);
            }
            EndpointRequest::SetAppearance(appearance) => {
                data.edit_model(|model| {
                    model.edit_visual(|visual| *visual = appearance.visual)?;
                    model.edit_statistics(|statistics| *statistics = appearance.statistics)
                })?;
                self.adopt(data);
                return Ok(true);
            }
            EndpointRequest::Save(file, directory) => self.save(file, &directory, data)?,
            EndpointRequest::SetParameter(name, value) => {
                check_finite("a parameter", value)?;
                self.instruments.edit(&name, value);
            }
            EndpointRequest::Watch(watches) => self.signals.watch(watches),
            EndpointRequest::ForwardKey(press) => {
                if self.keys.len() < MAX_KEYS {
                    self.keys.push(press);
                }
            }
            // Ids of a model that was replaced.
            EndpointRequest::SetControl(..)
            | EndpointRequest::SetPosition(..)
            | EndpointRequest::LoadKey(_)
            | EndpointRequest::SetEquality(..) => {}
        }
        Ok(false)
    }

    /// Returns `true` if an id belongs to a model that was replaced since the window has seen it.
    pub(super) fn is_stale<K: ElementKind>(&self, id: Id<K>) -> bool {
        id.lineage() != self.model.lineage()
    }

    fn save(&mut self, file: SavedFile, directory: &Path, data: &mut Data) -> Result<()> {
        let path = free_path(&directory.join(file.name()));
        match file {
            SavedFile::Xml => data.model().save_xml(&path)?,
            SavedFile::Binary => data.model().save_binary(&path)?,
            SavedFile::ModelText => data.model().print_to(&path)?,
            SavedFile::DataText => {
                self.refresh_if_needed(data)?;
                data.print_to(&path)?;
            }
        }
        self.link.send(Event::Notice(format!("saved {}", path.display())));
        Ok(())
    }

    fn save_key(&mut self, name: Option<String>, data: &Data) {
        let name = name.unwrap_or_else(|| {
            let taken = |name: &str| self.captured.iter().any(|key| key.name == name);
            let numbered = (1..).map(|number| format!("captured_{number}"));
            numbered.into_iter().find(|name| !taken(name)).expect("Bug: no free name for a keyframe")
        });
        self.link.send(Event::Notice(format!("captured as keyframe {name}")));
        Arc::make_mut(&mut self.captured).push(CapturedKey::new(data, self.captures, name));
        self.captures += 1;
    }
}

/// Sets one element of a joint's position. Normalises the quaternion that contains the element,
/// because a drag with the mouse requires a rotation.
fn set_position(joint: JointId, part: usize, value: f64, data: &mut Data) -> Result<bool> {
    check_finite("a position", value)?;
    let mut joint = data.joint_mut(joint);
    let Some(number) = joint.qpos_mut().get_mut(part) else { return Ok(false) };
    *number = value;
    let quaternion = match joint.view().in_model().joint_type() {
        JointType::Free => 3,
        JointType::Ball => 0,
        JointType::Slide | JointType::Hinge => return Ok(true),
    };
    if part >= quaternion
        && let Some(quaternion) = joint.qpos_mut()[quaternion..].first_chunk_mut()
    {
        normalize4(quaternion);
    }
    Ok(true)
}

fn check_finite(what: &str, value: f64) -> Result<()> {
    if value.is_finite() { Ok(()) } else { Err(Error::not_finite(what, value)) }
}
