//! Record of the results that have been computed for the present model, part by part.

use bitflags::bitflags;

use super::Stage;

bitflags! {
    /// One bit for each part of the pipeline: its results are there, laid out as the present options say, and none of the results
    /// that they depend on has been recomputed since.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) struct Computed: u32 {
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
        /// The state was not advanced since the positions were taken from it.
        const CURRENT = 1 << 21;
        const SENSOR_POS = 1 << 22;
        const SENSOR_VEL = 1 << 23;
        const SENSOR_ACC = 1 << 24;

        /// Results of [`Stage::Position`].
        const POSITION = Self::KINEMATICS.bits() | Self::COM_POS.bits() | Self::CAMLIGHT.bits() | Self::TENDON.bits()
            | Self::CRB.bits() | Self::FACTOR_M.bits() | Self::COLLISION.bits() | Self::CONSTRAINT.bits()
            | Self::TRANSMISSION.bits();
        /// Results of [`Stage::Velocity`].
        const VELOCITY = Self::POSITION.bits() | Self::TENDON_VELOCITY.bits() | Self::ACTUATOR_VELOCITY.bits()
            | Self::COM_VEL.bits() | Self::PASSIVE.bits() | Self::REFERENCE.bits() | Self::BIAS.bits();
        /// Results of [`Stage::Acceleration`], which inverse dynamics reaches too.
        const FORCES = Self::VELOCITY.bits() | Self::FORCE.bits();

        /// Readings of the sensors of all stages.
        const SENSORS = Self::SENSOR_POS.bits() | Self::SENSOR_VEL.bits() | Self::SENSOR_ACC.bits();

        /// Results that exist when passive forces have just been computed.
        const BEFORE_PASSIVE = Self::POSITION.bits() | Self::TENDON_VELOCITY.bits() | Self::ACTUATOR_VELOCITY.bits()
            | Self::COM_VEL.bits() | Self::SENSOR_POS.bits();

        /// Results of the first half of a step that its second half reads.
        const FIRST_HALF = Self::VELOCITY.bits() | Self::PROJECTION.bits() | Self::CURRENT.bits();
        /// Results of forward dynamics, without sensors.
        const FORWARD = Self::FIRST_HALF.bits() | Self::ACTUATION.bits() | Self::ACCELERATION.bits() | Self::FORCE.bits();

        /// Results after the first half of a step.
        const AFTER_STEP1 = Self::FIRST_HALF.bits() | Self::SENSOR_POS.bits() | Self::SENSOR_VEL.bits();
        /// Results after forward dynamics.
        const AFTER_FORWARD = Self::FORWARD.bits() | Self::SENSORS.bits();
        /// Results after a step: those of the state before it.
        const AFTER_STEP = Self::AFTER_FORWARD.bits() & !Self::CURRENT.bits();
        /// Results after inverse dynamics, which uses neither the projection nor the actuators.
        const AFTER_INVERSE = Self::FORCES.bits() | Self::CURRENT.bits() | Self::SENSORS.bits();
    }
}

impl Computed {
    /// Each part of the pipeline, what it reads of the others, and the method that computes it, in an order that works.
    pub(super) const PARTS: [(Self, Self, &'static str); 24] = [
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
        (Self::TENDON_VELOCITY, Self::TENDON, "compute_ten_velocity"),
        (Self::ACTUATOR_VELOCITY, Self::TRANSMISSION, "compute_actuator_velocity"),
        (Self::COM_VEL, Self::COM_POS, "com_vel"),
        (Self::PASSIVE, Self::COM_VEL.union(Self::TENDON_VELOCITY), "passive"),
        (Self::REFERENCE, Self::CONSTRAINT, "reference_constraint"),
        (Self::BIAS, Self::COM_VEL, "compute_qfrc_bias"),
        (Self::SUBTREE_VEL, Self::COM_VEL, "subtree_vel"),
        (Self::ACTUATION, Self::ACTUATOR_VELOCITY, "fwd_actuation"),
        (
            Self::ACCELERATION,
            Self::FACTOR_M.union(Self::PASSIVE).union(Self::BIAS).union(Self::ACTUATION),
            "fwd_acceleration",
        ),
        (Self::FORCE, Self::PROJECTION.union(Self::REFERENCE).union(Self::ACCELERATION), "fwd_constraint"),
        (Self::POST_CONSTRAINT, Self::FORCE, "rne_post_constraint"),
        (Self::SENSOR_POS, Self::POSITION, "sensor_pos"),
        (Self::SENSOR_VEL, Self::VELOCITY, "sensor_vel"),
        (Self::SENSOR_ACC, Self::FORCES, "sensor_acc"),
    ];

    /// Parts that neither forward dynamics nor a step records.
    pub(super) const NOT_IN_FORWARD: Self = Self::SUBTREE_VEL.union(Self::POST_CONSTRAINT);

    /// Results that become stale when these are recomputed: all that depend on them, directly or not.
    const fn dependents(self) -> Self {
        let mut stale = Self::empty();
        let mut part = 0;
        // One pass is enough, because a part comes after what it reads.
        while part < Self::PARTS.len() {
            let (result, reads, _) = Self::PARTS[part];
            if reads.intersects(self.union(stale)) {
                stale = stale.union(result);
            }
            part += 1;
        }
        stale
    }

    /// Results that depend on the constraints only in a model with an adhesion actuator.
    const MADE_OF_TRANSMISSION: Self = Self::TRANSMISSION.union(Self::TRANSMISSION.dependents());

    /// Results that are valid after `gives` has been recomputed.
    pub(super) const fn after(self, gives: Self, adhesion: bool) -> Self {
        let mut stale = gives.dependents();
        if adhesion && gives.union(stale).intersects(Self::CONSTRAINT) {
            stale = stale.union(Self::MADE_OF_TRANSMISSION);
        }
        self.difference(stale).union(gives)
    }

    /// The readings of sensors that exist after forward or inverse dynamics that took the stages up to `skip` from earlier calls.
    pub(super) fn sensors_after(self, skip: Stage, skip_sensors: bool) -> Self {
        let kept = match skip {
            Stage::Nothing => Self::empty(),
            Stage::Position => Self::SENSOR_POS,
            Stage::Velocity | Stage::Acceleration => Self::SENSOR_POS | Self::SENSOR_VEL,
        };
        let read = if skip_sensors { Self::empty() } else { Self::SENSORS - kept };
        (self & kept) | read
    }

    pub(super) fn stage(self) -> Stage {
        [Stage::Acceleration, Stage::Velocity, Stage::Position]
            .into_iter()
            .find(|&stage| self.contains(stage.into()))
            .unwrap_or(Stage::Nothing)
    }
}

impl From<Stage> for Computed {
    #[inline]
    fn from(stage: Stage) -> Self {
        match stage {
            Stage::Nothing => Self::empty(),
            Stage::Position => Self::POSITION,
            Stage::Velocity => Self::VELOCITY,
            Stage::Acceleration => Self::FORCES,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Computed, Stage};

    #[test]
    fn every_part_comes_after_what_it_reads() {
        let mut earlier = Computed::empty();
        for (part, reads, method) in Computed::PARTS {
            assert!(earlier.contains(reads), "{method} reads {:?}", reads - earlier);
            assert_eq!(part.bits().count_ones(), 1, "{method}");
            earlier |= part;
        }
        assert_eq!(earlier | Computed::CURRENT, Computed::all());
    }

    #[test]
    fn what_is_computed_anew_makes_stale_what_was_made_of_it() {
        let all = Computed::all();
        assert_eq!(all.after(Computed::KINEMATICS, false), Computed::KINEMATICS | Computed::CURRENT);
        let stale = all - all.after(Computed::COLLISION, false);
        let rows = Computed::CONSTRAINT | Computed::PROJECTION | Computed::REFERENCE;
        assert_eq!(stale, rows | Computed::FORCE | Computed::POST_CONSTRAINT | Computed::SENSORS);
        let with_adhesion = all - all.after(Computed::COLLISION, true);
        let actuators =
            Computed::TRANSMISSION | Computed::ACTUATOR_VELOCITY | Computed::ACTUATION | Computed::ACCELERATION;
        assert_eq!(with_adhesion - stale, actuators);
        assert_eq!(all - all.after(Computed::POST_CONSTRAINT, false), Computed::empty());
    }

    #[test]
    fn readings_of_skipped_stages_are_kept_and_no_others() {
        let (all, none) = (Computed::all(), Computed::empty());
        assert_eq!(none.sensors_after(Stage::Nothing, false), Computed::SENSORS);
        assert_eq!(all.sensors_after(Stage::Nothing, true), none);
        assert_eq!(none.sensors_after(Stage::Position, false), Computed::SENSOR_VEL | Computed::SENSOR_ACC);
        assert_eq!(all.sensors_after(Stage::Position, true), Computed::SENSOR_POS);
        assert_eq!(none.sensors_after(Stage::Velocity, false), Computed::SENSOR_ACC);
        assert_eq!(all.sensors_after(Stage::Velocity, true), Computed::SENSOR_POS | Computed::SENSOR_VEL);
    }
}
