//! The results of a simulation that the engine reads for a scene.

use mujoco_sys::{mjSENS_GEOMFROMTO, mjSENS_RANGEFINDER};

use super::{Categories, SceneOptions, VisualFlags};
use crate::data::Data;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::stage::{MissingResults, PipelineFlags, Stage};

/// Returns an error if the poses of cameras and lights have not been computed.
pub(super) fn check_poses(call: &'static str, data: &Data) -> Result<()> {
    data.check_usable()?;
    if data.computed().contains(PipelineFlags::POSES) {
        return Ok(());
    }
    Err(Error::NotComputed { call, missing: Stage::Position.into() })
}

impl SceneOptions {
    /// Returns an error if a result that the engine reads for these geoms has not been computed.
    pub(super) fn check_computed(&self, call: &'static str, data: &Data, categories: Categories) -> Result<()> {
        data.check_usable()?;
        let missing = self.reads(data.model(), categories) - data.computed();
        let missing = match missing {
            _ if missing.is_empty() => return Ok(()),
            PipelineFlags::SENSOR_POS => MissingResults::parts(missing),
            _ if self.shows_contacts() => Stage::Acceleration.into(),
            _ => Stage::Position.into(),
        };
        Err(Error::NotComputed { call, missing })
    }

    /// Computes the results that the engine reads for a scene, and no other ones.
    #[cfg(feature = "renderer")]
    pub(crate) fn compute(&self, data: &mut Data, categories: Categories) -> Result<()> {
        let reads = self.reads(data.model(), categories);
        if self.shows_contacts() {
            return data.forward();
        }
        if PipelineFlags::POSES.contains(reads) {
            data.kinematics()?;
            data.com_pos()?;
            return data.camlight();
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
