//! The parts of the engine's pipeline, the inputs of each among the others, and the record of those
//! whose results are valid.

use bitflags::bitflags;

use super::{SensorUpdate, Stage};

bitflags! {
    /// Parts of the pipeline whose results are valid: laid out as the present options require, and
    /// newer than all results that they depend on.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) struct PipelineFlags: u32 {
        const KINEMATICS = 1;
        const COM_POS = 1 << 1;
        const CAMLIGHT = 1 << 2;
        const TENDON = 1 << 3;
        const CRB = 1 << 4;
        const FACTOR_M = 1 << 5;
        const COLLISION = 1 << 6;
        const CONSTRAINT = 1 << 7;
        const TRANSMISSION = 1 << 8;
        const PROJECTION = 1 << 9;
        const TENDON_VELOCITY = 1 << 10;
        const ACTUATOR_VELOCITY = 1 << 11;
        const COM_VEL = 1 << 12;
        const PASSIVE = 1 << 13;
        const REFERENCE = 1 << 14;
        const BIAS = 1 << 15;
        const SUBTREE_VEL = 1 << 16;
        const ACTUATION = 1 << 17;
        const ACCELERATION = 1 << 18;
        const FORCE = 1 << 19;
        const POST_CONSTRAINT = 1 << 20;
        /// The state has not been advanced since the position-dependent quantities were computed.
        const CURRENT = 1 << 21;
        const SENSOR_POS = 1 << 22;
        const SENSOR_VEL = 1 << 23;
        const SENSOR_ACC = 1 << 24;
        /// Linear term `efc_b` of the cost that the solver of forward dynamics minimises.
        const SOLVER_COST = 1 << 25;
        /// States of the constraints, `efc_state`. A sensor callback runs before newer engines have
        /// written them.
        const CONSTRAINT_STATE = 1 << 26;

        /// Poses of bodies, cameras and lights, and positions of flexes.
        const POSES = Self::KINEMATICS.bits() | Self::COM_POS.bits() | Self::CAMLIGHT.bits();
        /// Results of [`Stage::Position`].
        const POSITION = Self::POSES.bits() | Self::TENDON.bits() | Self::CRB.bits() | Self::FACTOR_M.bits() | Self::COLLISION.bits() | Self::CONSTRAINT.bits()
            | Self::TRANSMISSION.bits();
        /// Results of [`Stage::Velocity`].
        const VELOCITY = Self::POSITION.bits() | Self::TENDON_VELOCITY.bits() | Self::ACTUATOR_VELOCITY.bits()
            | Self::COM_VEL.bits() | Self::PASSIVE.bits() | Self::REFERENCE.bits() | Self::BIAS.bits();
        /// Results of [`Stage::Acceleration`]. Inverse dynamics reaches this stage too.
        const FORCES = Self::VELOCITY.bits() | Self::FORCE.bits();

        /// Results of forward and of inverse dynamics of the constraints.
        const SOLVED = Self::FORCE.bits() | Self::CONSTRAINT_STATE.bits();

        /// Readings of the sensors of all stages.
        const SENSORS = Self::SENSOR_POS.bits() | Self::SENSOR_VEL.bits() | Self::SENSOR_ACC.bits();

        /// Valid results at the call of the passive force callback.
        const BEFORE_PASSIVE = Self::POSITION.bits() | Self::TENDON_VELOCITY.bits() | Self::ACTUATOR_VELOCITY.bits()
            | Self::COM_VEL.bits() | Self::SENSOR_POS.bits();

        /// Results of the first half of a step that the second half reads.
        const FIRST_HALF = Self::VELOCITY.bits() | Self::PROJECTION.bits() | Self::CURRENT.bits();
        /// Results of forward dynamics without sensors.
        const FORWARD = Self::FIRST_HALF.bits() | Self::ACTUATION.bits() | Self::ACCELERATION.bits() | Self::FORCE.bits()
            | Self::SOLVER_COST.bits() | Self::CONSTRAINT_STATE.bits();

        /// Valid results after the first half of a step.
        const AFTER_STEP1 = Self::FIRST_HALF.bits() | Self::SENSOR_POS.bits() | Self::SENSOR_VEL.bits();
        /// Valid results after forward dynamics.
        const AFTER_FORWARD = Self::FORWARD.bits() | Self::SENSORS.bits();
        /// Valid results after a step. They belong to the state before the step, or to the last
        /// evaluation of a Runge–Kutta step.
        const AFTER_STEP = Self::AFTER_FORWARD.bits() & !Self::CURRENT.bits();
        /// Valid results after inverse dynamics, which uses neither the projection nor the
        /// actuators.
        const AFTER_INVERSE = Self::SOLVED.bits() | Self::VELOCITY.bits() | Self::CURRENT.bits() | Self::SENSORS.bits();
    }
}

bitflags! {
    /// Features of a model that add inputs to parts of the pipeline, or that the engine computes in
    /// whole stages only.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) struct PipelineFeatures: u8 {
        const ADHESION_ACTUATOR = 1;
        /// Adhesion of geoms and of pairs of geoms.
        const CONTACT_ADHESION = 1 << 1;
        const TENDON_ARMATURE = 1 << 2;
        const FLEX = 1 << 3;
        /// Actuators that apply the compensation of gravity.
        const GRAVITY_ACTUATION = 1 << 4;
        const KINETIC_ENERGY_SENSOR = 1 << 5;
        const DISCRETE_INTEGRATOR = 1 << 6;
    }
}

type Features = PipelineFeatures;

impl PipelineFlags {
    /// Inputs of the reference accelerations. Newer engines subtract the part of the accelerations
    /// of `connect` and `weld` that depends on velocities only.
    const REFERENCE_INPUTS: Self =
        if cfg!(engine_since = "3.6.0") { Self::CONSTRAINT.union(Self::COM_VEL) } else { Self::CONSTRAINT };

    /// True if the islands of the constraints contain copies of the inertia matrix and its factor.
    const ISLANDS_COPY_INERTIA: bool = cfg!(all(engine_since = "3.3.0", not(engine_since = "3.12.0")));

    /// Each part of the pipeline, its inputs among the other parts, and the method that computes
    /// it, in topological order. `CURRENT` is an input of those that also read the state itself.
    /// Features of a model add the inputs in [`FEATURE_INPUTS`](Self::FEATURE_INPUTS).
    const PARTS: [(Self, Self, &'static str); 26] = [
        (Self::KINEMATICS, Self::empty(), "kinematics"),
        (Self::COM_POS, Self::KINEMATICS, "com_pos"),
        (Self::CAMLIGHT, Self::COM_POS, "camlight"),
        (Self::TENDON, Self::COM_POS, "compute_tendon"),
        (Self::CRB, Self::COM_POS, "compute_crb"),
        (Self::FACTOR_M, Self::CRB, "factor_m"),
        (Self::COLLISION, Self::KINEMATICS, "collision"),
        (Self::CONSTRAINT, Self::TENDON.union(Self::COLLISION), "make_constraint"),
        (Self::TRANSMISSION, Self::TENDON, "transmission"),
        (Self::PROJECTION, Self::FACTOR_M.union(Self::CONSTRAINT), "project_constraint"),
        (Self::TENDON_VELOCITY, Self::TENDON.union(Self::CURRENT), "compute_ten_velocity"),
        (Self::ACTUATOR_VELOCITY, Self::TRANSMISSION.union(Self::CURRENT), "compute_actuator_velocity"),
        (Self::COM_VEL, Self::COM_POS.union(Self::CURRENT), "com_vel"),
        (Self::PASSIVE, Self::COM_VEL.union(Self::TENDON_VELOCITY).union(Self::CURRENT), "passive"),
        (Self::REFERENCE, Self::REFERENCE_INPUTS.union(Self::CURRENT), "reference_constraint"),
        (Self::BIAS, Self::COM_VEL.union(Self::CURRENT), "compute_qfrc_bias"),
        (Self::SUBTREE_VEL, Self::COM_VEL, "subtree_vel"),
        (Self::ACTUATION, Self::ACTUATOR_VELOCITY.union(Self::CURRENT), "fwd_actuation"),
        (
            Self::ACCELERATION,
            Self::FACTOR_M.union(Self::PASSIVE).union(Self::BIAS).union(Self::ACTUATION),
            "fwd_acceleration",
        ),
        (Self::SOLVER_COST, Self::PROJECTION.union(Self::REFERENCE).union(Self::ACCELERATION), "fwd_constraint"),
        (Self::CONSTRAINT_STATE, Self::PROJECTION.union(Self::REFERENCE).union(Self::ACCELERATION), "fwd_constraint"),
        (Self::FORCE, Self::PROJECTION.union(Self::REFERENCE).union(Self::ACCELERATION), "fwd_constraint"),
        (Self::POST_CONSTRAINT, Self::COM_VEL.union(Self::FORCE), "rne_post_constraint"),
        (Self::SENSOR_POS, Self::POSITION.union(Self::CURRENT), "sensor_pos"),
        (Self::SENSOR_VEL, Self::VELOCITY.union(Self::CURRENT), "sensor_vel"),
        (Self::SENSOR_ACC, Self::FORCES, "sensor_acc"),
    ];

    /// Further inputs of a part in models with a feature. The order of the parts remains
    /// topological.
    const FEATURE_INPUTS: [(Features, Self, Self); 5] = [
        (Features::ADHESION_ACTUATOR, Self::TRANSMISSION, Self::CONSTRAINT),
        (Features::CONTACT_ADHESION, Self::PASSIVE, Self::CONSTRAINT),
        (Features::TENDON_ARMATURE, Self::CRB, Self::TENDON),
        // The method `com_pos` computes the vertices.
        (Features::FLEX, Self::COLLISION, Self::COM_POS),
        (Features::GRAVITY_ACTUATION, Self::ACTUATION, Self::PASSIVE),
    ];

    /// Parts that the engine computes only together with others in models with a feature, because
    /// it exports no function for a computation between them. The texts name the features.
    const ONLY_IN_STAGES: [(Features, Self, &'static str); 3] = [
        // The forces of tendons' armature on the bias.
        (Features::TENDON_ARMATURE, Self::BIAS, "armature of tendons"),
        // The velocities of edges.
        (Features::FLEX, Self::PASSIVE, "flexes"),
        // The engine adds springs and dampers to the inertia matrix, in memory that it allocates
        // behind the constraints, and changes the constraints after the actuation.
        (
            Features::DISCRETE_INTEGRATOR,
            Self::COLLISION
                .union(Self::CONSTRAINT)
                .union(Self::PROJECTION)
                .union(Self::PASSIVE)
                .union(Self::REFERENCE)
                .union(Self::BIAS)
                .union(Self::ACCELERATION)
                .union(Self::SOLVER_COST)
                .union(Self::SOLVED),
            "the integrator discrete",
        ),
    ];

    /// Parts that neither forward dynamics nor a step marks as valid.
    pub(super) const NOT_IN_FORWARD: Self = Self::SUBTREE_VEL.union(Self::POST_CONSTRAINT);

    /// Returns the inputs of these parts in a model without features, except those that are among
    /// the parts.
    pub(crate) const fn inputs(self) -> Self {
        let mut inputs = Self::empty();
        let mut part = 0;
        while part < Self::PARTS.len() {
            let (result, reads, _) = Self::PARTS[part];
            if self.contains(result) {
                inputs = inputs.union(reads);
            }
            part += 1;
        }
        inputs.difference(self)
    }

    /// Returns the further inputs of these parts in a model with these features, without those
    /// among the parts.
    pub(crate) const fn feature_inputs(self, features: Features) -> Self {
        let mut inputs = Self::empty();
        let mut row = if features.is_empty() { Self::FEATURE_INPUTS.len() } else { 0 };
        while row < Self::FEATURE_INPUTS.len() {
            let (feature, part, reads) = Self::FEATURE_INPUTS[row];
            if features.contains(feature) && self.contains(part) {
                inputs = inputs.union(reads);
            }
            row += 1;
        }
        inputs.difference(self)
    }

    /// Returns the name of a feature for which the engine computes some of these parts only
    /// together with others. Whole stages contain all of them.
    pub(crate) fn only_in_stages(self, features: Features) -> Option<&'static str> {
        if self.contains(Self::POSITION) || self.contains(Self::VELOCITY - Self::POSITION) {
            return None;
        }
        let row = |&&(feature, parts, _): &&(Features, Self, _)| features.contains(feature) && self.intersects(parts);
        Self::ONLY_IN_STAGES.iter().find(row).map(|&(_, _, name)| name)
    }

    /// Returns all parts that depend on these, directly or indirectly. They become stale when these
    /// are recomputed.
    const fn dependents(self, features: Features) -> Self {
        // The constraints themselves do not read the factor, so it does not have to be computed
        // before them.
        let has_old_copies = Self::ISLANDS_COPY_INERTIA && self.contains(Self::FACTOR_M);
        let mut stale = if has_old_copies { Self::CONSTRAINT } else { Self::empty() };
        let mut part = 0;
        // One pass is enough, because the table is in topological order.
        while part < Self::PARTS.len() {
            let (result, reads, _) = Self::PARTS[part];
            if reads.union(result.feature_inputs(features)).intersects(self.union(stale)) {
                stale = stale.union(result);
            }
            part += 1;
        }
        // This sensor of the position stage reads `qvel`, which has changed if the velocities of
        // bodies are computed again.
        if features.contains(Features::KINETIC_ENERGY_SENSOR) && self.contains(Self::COM_VEL) {
            stale = stale.union(Self::SENSOR_POS);
        }
        stale
    }

    /// Returns the parts that are valid after `results` has been recomputed in a model with these
    /// features.
    pub(crate) const fn after(self, results: Self, features: Features) -> Self {
        self.difference(results.dependents(features)).union(results)
    }

    /// Returns the sensor stages that are valid after forward or inverse dynamics with the stages
    /// up to `skip` left out.
    pub(crate) fn sensors_after(self, skip: Stage, sensors: SensorUpdate, features: Features) -> Self {
        let skipped = match skip {
            Stage::None => Self::empty(),
            Stage::Position => Self::SENSOR_POS,
            Stage::Velocity | Stage::Acceleration => Self::SENSOR_POS | Self::SENSOR_VEL,
        };
        let has_changed = skip == Stage::Position && features.contains(Features::KINETIC_ENERGY_SENSOR);
        let kept = if has_changed { Self::empty() } else { skipped };
        let read = if sensors == SensorUpdate::Skip { Self::empty() } else { Self::SENSORS - skipped };
        (self & kept) | read
    }

    /// Returns the methods that compute these parts, in topological order.
    pub(crate) fn methods(self) -> impl Iterator<Item = &'static str> {
        let mut last = "";
        Self::PARTS.iter().filter_map(move |&(part, _, method)| {
            // Several parts have the same method.
            let is_new = self.contains(part) && method != last;
            last = if is_new { method } else { last };
            is_new.then_some(method)
        })
    }

    /// Returns the parts that a method computes.
    #[cfg(test)]
    pub(crate) fn of_method(method: &str) -> Self {
        Self::PARTS.iter().filter(|&&(.., name)| name == method).fold(Self::empty(), |parts, &(part, ..)| parts | part)
    }

    /// Returns the last stage whose results are all valid.
    pub(crate) fn stage(self) -> Stage {
        [Stage::Acceleration, Stage::Velocity, Stage::Position]
            .into_iter()
            .find(|&stage| self.contains(stage.into()))
            .unwrap_or(Stage::None)
    }
}

#[cfg(test)]
mod tests {
    use super::{PipelineFeatures as Features, PipelineFlags, SensorUpdate, Stage};

    #[test]
    fn parts_are_in_topological_order() {
        let mut earlier = PipelineFlags::CURRENT;
        for (part, reads, method) in PipelineFlags::PARTS {
            let reads = reads | part.feature_inputs(Features::all());
            assert!(earlier.contains(reads), "{method} reads {:?}", reads - earlier);
            assert_eq!(part.bits().count_ones(), 1, "{method}");
            earlier |= part;
        }
        assert_eq!(earlier, PipelineFlags::all());
    }

    #[test]
    fn recomputing_a_part_invalidates_its_dependents() {
        let (all, none) = (PipelineFlags::all(), Features::empty());
        assert_eq!(all.after(PipelineFlags::KINEMATICS, none), PipelineFlags::KINEMATICS | PipelineFlags::CURRENT);
        let stale = all - all.after(PipelineFlags::COLLISION, none);
        let rows = PipelineFlags::CONSTRAINT | PipelineFlags::PROJECTION | PipelineFlags::REFERENCE;
        let forces = PipelineFlags::SOLVER_COST | PipelineFlags::SOLVED | PipelineFlags::POST_CONSTRAINT;
        assert_eq!(stale, rows | forces | PipelineFlags::SENSORS);
        let with_adhesion = all - all.after(PipelineFlags::COLLISION, Features::ADHESION_ACTUATOR);
        let actuators = PipelineFlags::TRANSMISSION
            | PipelineFlags::ACTUATOR_VELOCITY
            | PipelineFlags::ACTUATION
            | PipelineFlags::ACCELERATION;
        assert_eq!(with_adhesion - stale, actuators);
        assert_eq!(all - all.after(PipelineFlags::POST_CONSTRAINT, none), PipelineFlags::empty());
        let keeps_constraints = all.after(PipelineFlags::FACTOR_M, none).contains(PipelineFlags::CONSTRAINT);
        assert_eq!(keeps_constraints, !PipelineFlags::ISLANDS_COPY_INERTIA);
        let velocity = PipelineFlags::VELOCITY - PipelineFlags::POSITION;
        assert!(all.after(velocity, none).contains(PipelineFlags::SENSOR_POS));
        assert!(!all.after(velocity, Features::KINETIC_ENERGY_SENSOR).contains(PipelineFlags::SENSOR_POS));
    }

    #[test]
    fn whole_stages_compute_what_single_parts_do_not() {
        let all = Features::all();
        let velocity = PipelineFlags::VELOCITY - PipelineFlags::POSITION;
        for stage in [PipelineFlags::POSITION, PipelineFlags::POSITION | PipelineFlags::PROJECTION, velocity] {
            assert_eq!(stage.only_in_stages(all), None);
        }
        assert_eq!(PipelineFlags::BIAS.only_in_stages(Features::TENDON_ARMATURE), Some("armature of tendons"));
        assert_eq!(PipelineFlags::BIAS.only_in_stages(Features::FLEX), None);
        assert_eq!(PipelineFlags::KINEMATICS.only_in_stages(all), None);
        assert_eq!(velocity.feature_inputs(all), PipelineFlags::CONSTRAINT);
    }

    #[test]
    fn only_sensor_readings_of_skipped_stages_are_kept() {
        let (all, none, plain) = (PipelineFlags::all(), PipelineFlags::empty(), Features::empty());
        assert_eq!(none.sensors_after(Stage::None, SensorUpdate::Compute, plain), PipelineFlags::SENSORS);
        assert_eq!(all.sensors_after(Stage::None, SensorUpdate::Skip, plain), none);
        assert_eq!(
            none.sensors_after(Stage::Position, SensorUpdate::Compute, plain),
            PipelineFlags::SENSOR_VEL | PipelineFlags::SENSOR_ACC
        );
        assert_eq!(all.sensors_after(Stage::Position, SensorUpdate::Skip, plain), PipelineFlags::SENSOR_POS);
        assert_eq!(none.sensors_after(Stage::Velocity, SensorUpdate::Compute, plain), PipelineFlags::SENSOR_ACC);
        assert_eq!(
            all.sensors_after(Stage::Velocity, SensorUpdate::Skip, plain),
            PipelineFlags::SENSOR_POS | PipelineFlags::SENSOR_VEL
        );
        let kinetic = all.sensors_after(Stage::Position, SensorUpdate::Compute, Features::KINETIC_ENERGY_SENSOR);
        assert_eq!(kinetic, PipelineFlags::SENSOR_VEL | PipelineFlags::SENSOR_ACC);
    }
}
