//! The results of a simulation that the engine reads for a scene.

use mujoco_sys::{mjSENS_GEOMFROMTO, mjSENS_RANGEFINDER};

use super::{Categories, SceneOptions, VisualFlags};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::stage::{MissingResults, PipelineFlags, Stage};

/// Returns an error if the poses of cameras and lights have not been computed.
pub(super) fn check_poses(call: &'static str, data: &Data) -> Result<()> {
    check(call, data, PipelineFlags::POSES, Stage::Position)
}

/// Returns an error if a result of `reads` has not been computed, with the stage that computes
/// them. Readings of sensors are no results of a stage.
fn check(call: &'static str, data: &Data, reads: PipelineFlags, stage: Stage) -> Result<()> {
    data.check_usable()?;
    let missing = reads - data.computed();
    let missing = match missing {
        _ if missing.is_empty() => return Ok(()),
        PipelineFlags::SENSOR_POS => MissingResults::parts(missing),
        _ => stage.into(),
    };
    Err(Error::NotComputed { call, missing })
}

/// Computes the poses of bodies, cameras and lights.
#[cfg(any(feature = "renderer", feature = "live"))]
pub(crate) fn compute_poses(data: &mut Data) -> Result<()> {
    data.kinematics()?;
    data.com_pos()?;
    data.camlight()
}

impl SceneOptions {
    /// Returns an error if a result that the engine reads for these geoms has not been computed.
    pub(super) fn check_computed(&self, call: &'static str, data: &Data, categories: Categories) -> Result<()> {
        let stage = if self.shows_contacts() { Stage::Acceleration } else { Stage::Position };
        check(call, data, self.reads(data.model(), categories), stage)
    }

    /// Computes the results that the engine reads for a scene, and no other ones.
    #[cfg(any(feature = "renderer", feature = "live"))]
    pub(crate) fn compute(&self, data: &mut Data, categories: Categories) -> Result<()> {
        let reads = self.reads(data.model(), categories);
        if self.shows_contacts() {
            return data.forward();
        }
        if PipelineFlags::POSES.contains(reads) {
            return compute_poses(data);
        }
        data.fwd_position()?;
        if reads.contains(PipelineFlags::SENSOR_POS) { data.sensor_pos() } else { Ok(()) }
    }

    fn reads(&self, model: &Model, categories: Categories) -> PipelineFlags {
        // The colours of tendons and joints depend on the constraints of their limits. Plugins draw
        // what they like.
        let reads_constraints = model.ntendon() > 0
            || model.nplugin() > 0
            || self.flags.intersects(VisualFlags::JOINT | VisualFlags::BODYBVH | VisualFlags::MESHBVH);
        let stage = if self.shows_contacts() {
            Stage::Acceleration.into()
        } else if reads_constraints {
            Stage::Position.into()
        } else {
            PipelineFlags::POSES
        };
        let is_ray = |kind: &i32| [mjSENS_RANGEFINDER, mjSENS_GEOMFROMTO].contains(&(*kind as u32));
        let shows_rays = categories.contains(Categories::DECOR)
            && self.flags.contains(VisualFlags::RANGEFINDER)
            && model.sensor_type().iter().any(is_ray);
        if shows_rays { stage | PipelineFlags::SENSOR_POS } else { stage }
    }
}
