//! Decides which computations of this crate apply to a model: closed forms, and differences of
//! inverse dynamics.
//!
//! `build/knowledge/derivative.tsv` states which fields of the model each part of a computation
//! understands, and the build script generates the checks from these statements and from the fields
//! of the linked engine. A field that no statement is about must have its default value, so that a
//! feature of a new engine is not understood until a statement is made. All parts are checked once
//! for a model or an edit, and the method is chosen from all results.

mod predicates;

use std::fmt::Debug;

use super::InverseForce;
use super::method::{Fallback, TransitionMethod};
use crate::model::Model;

/// Obstacles to the computations for a model: `None` if a computation applies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Obstacles {
    /// To the closed form of a step.
    step: Option<Fallback>,
    /// To the differences of inverse dynamics.
    implicit: Option<Fallback>,
    /// To the closed form of inverse dynamics.
    inverse: Option<Fallback>,
    /// To the closed form of the forces of actuators.
    actuators: Option<Fallback>,
    /// To the engine's own differences.
    engine: Option<Fallback>,
}

impl Obstacles {
    pub(super) fn of(model: &Model) -> Self {
        Self::with_check(model, unknown)
    }

    /// Returns the obstacles. `unknown` checks the fields that no statement is about.
    fn with_check(model: &Model, unknown: impl Fn(&Model) -> Option<Fallback>) -> Self {
        let always = (!IS_PROVED).then_some(Fallback::EngineVersion).or_else(|| unknown(model));
        let inverse = always.or_else(|| motion(model));
        let actuators = always.or_else(|| actuators(model));
        Self {
            step: always.or_else(|| integrator(model)).or(inverse).or(actuators).or_else(|| sensors(model)),
            implicit: always.or_else(|| implicit(model)),
            inverse,
            actuators,
            engine: predicates::stages(model),
        }
    }

    /// Selects the method for a step.
    pub(super) fn method(self, requested: TransitionMethod) -> (TransitionMethod, Option<Fallback>) {
        let obstacle = match requested {
            TransitionMethod::Analytic => self.step,
            TransitionMethod::Implicit => self.implicit,
            TransitionMethod::Engine => self.engine,
            TransitionMethod::Columns => None,
        };
        match (requested, obstacle) {
            (_, None) => (requested, None),
            (TransitionMethod::Analytic, _) => (self.differences(), obstacle),
            _ => (TransitionMethod::Columns, obstacle),
        }
    }

    /// Returns the method for states without a closed form.
    pub(super) fn differences(self) -> TransitionMethod {
        if self.implicit.is_none() { TransitionMethod::Implicit } else { TransitionMethod::Columns }
    }

    /// Returns the obstacle to the closed form of inverse dynamics.
    pub(super) fn to_inverse(self, force: InverseForce) -> Option<Fallback> {
        match force {
            InverseForce::Total => self.inverse,
            InverseForce::WithoutActuators => self.inverse.or(self.actuators),
        }
    }
}

/// Defines the check of a part of a computation. It returns the first obstacle.
macro_rules! part {
    ($part:ident($model:ident) $($kind:ident $($field:ident).+ $(: $rows:expr, $columns:expr)?;)*) => {
        #[allow(unused_variables, reason = "a part may have nothing to check")]
        fn $part($model: &Model) -> Option<Fallback> {
            None$(.or_else(|| check!($kind $model, $($field).+ $(, $rows, $columns)?)))*
        }
    };
}

/// Checks one field, or calls a predicate.
macro_rules! check {
    (predicate $model:ident, $name:ident) => {
        predicates::$name($model)
    };
    (value $model:ident, $($field:ident).+) => {
        find_other(path!($($field).+), &[$model.raw().$($field).+], 1, Default::default())
    };
    (array $model:ident, $array:ident, $rows:expr, $columns:expr) => {
        // SAFETY: the engine allocated the array with this shape, and nothing writes to it while
        // the model is borrowed.
        find_other(path!($array), unsafe { crate::ffi::array($model.raw().$array, $rows * $columns) }, $columns, Default::default())
    };
    (ids $model:ident, $array:ident, $rows:expr, $columns:expr) => {
        // SAFETY: as above.
        find_other(path!($array), unsafe { crate::ffi::array($model.raw().$array, $rows * $columns) }, $columns, -1)
    };
}

/// Returns the name of a field.
#[allow(unused_macros, reason = "all fields of 2.2.2 are understood")]
macro_rules! path {
    ($field:ident) => {
        stringify!($field)
    };
    ($group:ident . $field:ident) => {
        concat!(stringify!($group), ".", stringify!($field))
    };
}

include!(concat!(env!("OUT_DIR"), "/support.rs"));

/// Returns the first element of a field with another value than the default.
#[cfg_attr(not(engine_since = "2.3.0"), allow(dead_code, reason = "all fields of 2.2.2 are understood"))]
fn find_other<T: Copy + Debug + PartialEq>(
    field: &'static str,
    values: &[T],
    columns: usize,
    default: T,
) -> Option<Fallback> {
    let at = values.iter().position(|&value| value != default)?;
    Some(Fallback::NotUnderstood { field, element: at / columns })
}

#[cfg(test)]
mod tests {
    use super::{Fallback, InverseForce, Model, Obstacles, TransitionMethod, find_other, predicates};
    use crate::enums::Integrator;

    part! { invented(model)
        value opt.timestep;
    }
    part! { array_of_joints(model)
        array jnt_stiffness: model.njnt(), 1;
        array jnt_range: model.njnt(), 2;
        ids geom_matid: model.ngeom(), 1;
        predicate noslip;
    }

    #[test]
    fn a_value_that_is_not_the_default_is_not_understood() {
        let text = r#"<mujoco><worldbody><body><joint STIFF/><geom size="1"/><joint type="slide" RANGE/></body></worldbody></mujoco>"#;
        let model = |stiff: &str, range: &str| {
            Model::from_xml_str(&text.replace("STIFF", stiff).replace("RANGE", range)).unwrap()
        };
        let not_understood = |field, element| Some(Fallback::NotUnderstood { field, element });
        assert_eq!(invented(&model("", "")), not_understood("opt.timestep", 0));
        assert_eq!(array_of_joints(&model("", "")), None);
        assert_eq!(array_of_joints(&model(r#"stiffness="3""#, "")), not_understood("jnt_stiffness", 0));
        assert_eq!(array_of_joints(&model("", r#"range="0 1" limited="true""#)), not_understood("jnt_range", 1));
        assert_eq!(find_other("f", &[-1, -1, 2], 1, -1), not_understood("f", 2));
        assert_eq!(find_other("f", &[0.0, f64::NAN], 1, 0.0), not_understood("f", 1));
    }

    #[test]
    fn a_field_without_a_statement_is_an_obstacle_to_every_computation() {
        let model = Model::from_xml_str("<mujoco/>").unwrap();
        let reason = Some(Fallback::NotUnderstood { field: "opt.timestep", element: 0 });
        let obstacles = Obstacles::with_check(&model, invented);
        for method in [TransitionMethod::Analytic, TransitionMethod::Implicit] {
            assert_eq!(obstacles.method(method), (TransitionMethod::Columns, reason));
        }
        for force in [InverseForce::Total, InverseForce::WithoutActuators] {
            assert_eq!(obstacles.to_inverse(force), reason);
        }
        assert_eq!(Obstacles::of(&model).method(TransitionMethod::Analytic), (TransitionMethod::Analytic, None));
    }

    #[test]
    fn flags_and_types_are_understood_by_name() {
        let mut model = Model::from_xml_str("<mujoco/>").unwrap();
        let obstacles = super::Obstacles::of(&model);
        assert_eq!((obstacles.step, obstacles.implicit), (None, None));
        model.edit().edit_options(|options| options.integrator = Integrator::Rk4).unwrap();
        assert_eq!(predicates::stages(&model), Some(Fallback::RungeKutta));
        for bit in 0..31 {
            let mut model = Model::from_xml_str("<mujoco/>").unwrap();
            model.edit().raw_mut().opt.enableflags = 1 << bit;
            let is_understood = predicates::enabled(&model).is_none();
            assert!(!is_understood || bit < 5, "bit {bit}");
        }
    }
}
