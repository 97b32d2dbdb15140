//! Features of a model on which the inputs of parts of the pipeline depend.

use mujoco_sys::mjTRN_BODY;

use super::Model;
use crate::enums::{Integrator, SensorType};
use crate::stage::PipelineFeatures;

impl Model {
    /// Returns the features of the model with its present integrator.
    pub(crate) fn features(&self) -> PipelineFeatures {
        let is_discrete = Integrator::from_raw(self.raw().opt.integrator) == Some(Integrator::Discrete);
        if is_discrete { self.features | PipelineFeatures::DISCRETE_INTEGRATOR } else { self.features }
    }

    /// Finds the features that no edit changes, because the arrays of types, armatures and
    /// adhesions are read-only.
    pub(super) fn find_features(&self) -> PipelineFeatures {
        let mut features = PipelineFeatures::empty();
        features.set(PipelineFeatures::ADHESION_ACTUATOR, self.actuator_trntype().contains(&(mjTRN_BODY as i32)));
        features.set(
            PipelineFeatures::KINETIC_ENERGY_SENSOR,
            self.sensor_type().contains(&SensorType::KineticEnergy.raw()),
        );
        #[cfg(engine_since = "3.0.0")]
        features.set(PipelineFeatures::FLEX, self.nflex() > 0);
        #[cfg(engine_since = "3.5.0")]
        {
            features.set(PipelineFeatures::GRAVITY_ACTUATION, has_any(self.jnt_actgravcomp()));
            features.set(PipelineFeatures::TENDON_ARMATURE, has_any(self.tendon_armature()));
        }
        #[cfg(engine_since = "3.12.0")]
        {
            let tendon = mujoco_sys::mjTRN_TENDON as i32;
            let mut actuators = self.actuator_trntype().iter().zip(self.actuator_armature());
            if actuators.any(|(&kind, &armature)| kind == tendon && armature != 0.0) {
                features |= PipelineFeatures::TENDON_ARMATURE;
            }
            let has_adhesion = has_any(self.geom_adhesion()) || has_any(self.pair_adhesion());
            features.set(PipelineFeatures::CONTACT_ADHESION, has_adhesion);
        }
        features
    }
}

/// Returns `true` if an element of an array is not zero.
#[cfg(engine_since = "3.5.0")]
fn has_any<T: Copy + Default + PartialEq>(values: &[T]) -> bool {
    values.iter().any(|&value| value != T::default())
}
