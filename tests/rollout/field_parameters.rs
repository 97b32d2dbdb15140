//! Numbers of any array of the model as parameters of a batch: they equal edits of a model, and
//! models that are compiled with the values.

use std::sync::Arc;

use mujoco_safe::rollout::{Distribution, Parameter, Parameters};
use mujoco_safe::{Batch, Data, Error, MatrixViewMut, Model, StateSpec};

/// Array whose numbers a program can set.
trait Array {
    fn put(self, row: usize, column: usize, value: f64);
}

macro_rules! array {
    ($($number:ident),*) => {$(
        impl Array for &mut [$number] {
            #[allow(clippy::cast_possible_truncation, clippy::unnecessary_cast, reason = "arrays of f32")]
            fn put(self, row: usize, _: usize, value: f64) {
                self[row] = value as $number;
            }
        }
        impl<const N: usize> Array for &mut [[$number; N]] {
            #[allow(clippy::cast_possible_truncation, clippy::unnecessary_cast, reason = "arrays of f32")]
            fn put(self, row: usize, column: usize, value: f64) {
                self[row][column] = value as $number;
            }
        }
    )*};
}
array!(f64, f32);

impl Array for MatrixViewMut<'_> {
    fn put(self, row: usize, column: usize, value: f64) {
        self.into_row(row)[column] = value;
    }
}

fn batch_of(model: &Arc<Model>, parameters: &[Parameter]) -> Batch<'static> {
    let all = parameters
        .iter()
        .fold(Parameters::new(), |all, parameter| all.with(model, *parameter, Distribution::Unchanged).unwrap());
    Batch::new(model, 2).unwrap().with_parameters(all).unwrap()
}

/// Compares a batch with an edited model for some numbers of each array.
macro_rules! compare {
    ($model:ident $seen:ident $($writer:ident($field:ident))*) => {$(
        for (row, column) in [(0, 0), (1, 0), (0, 1), (2, 1)] {
            let parameter = match Parameter::field(&$model, stringify!($field), row, column) {
                Ok(parameter) => parameter,
                // Too few rows or columns, or numbers that other arrays determine.
                Err(Error::Invalid { .. } | Error::Unsupported(_)) => continue,
                Err(error) => panic!("{error}"),
            };
            let mut batch = batch_of(&$model, &[parameter]);
            let value = batch.parameters()[(1, 0)] * 1.25 + 0.125;
            let written = batch.set_parameters(|index| index == 1, |_, values| values[0] = value);
            // The text of a parameter says if other quantities are derived from it.
            let has_derived = format!("{parameter:?}").contains("has_derived: true");
            let mut single = Data::new(&$model).unwrap();
            let edited = single.edit_model(|model| {
                model.$writer().put(row, column, value);
                if has_derived { model.update_constants() } else { Ok(()) }
            });
            assert_eq!(written.is_ok(), edited.is_ok(), "{parameter:?}: {written:?} {edited:?}");
            if written.is_err() {
                continue;
            }
            let (found, first) = (batch.data(1).unwrap(), batch.data(0).unwrap());
            assert_eq!(format!("{:?}", found.model().$field()), format!("{:?}", single.model().$field()), "{parameter:?}");
            assert_eq!(format!("{:?}", first.model().$field()), format!("{:?}", $model.$field()), "{parameter:?}");
            assert_ne!(format!("{:?}", found.model().$field()), format!("{:?}", $model.$field()), "{parameter:?}");
            if let (Ok(_), Ok(())) = (batch.step(|_, _| ()), single.step()) {
                assert_eq!(batch.states().row(1), single.state(StateSpec::INTEGRATION), "{parameter:?}");
            }
            $seen += 1;
        }
    )*};
}

#[test]
fn a_number_of_any_array_equals_an_edit_of_the_model() {
    let text = include_str!("../models/every_element.xml");
    let model = Arc::new(Model::from_xml_str(text).unwrap());
    let mut seen = 0;
    model_writers! { compare model seen }
    assert!(seen > 250, "{seen} numbers");
}

#[test]
fn fields_that_cannot_be_parameters_have_a_reason() {
    let model = mujoco_safe::sample::cartpole();
    for (array, reason) in [
        ("body_subtreemass", "update_constants"),
        ("eq_data", "update_constants"),
        ("body_parentid", "memory accesses"),
        ("nbody", "no array"),
        ("wrap_prm", "not known"),
    ] {
        let error = Parameter::field(&model, array, 0, 0).unwrap_err();
        assert!(matches!(error, Error::Unsupported(_)), "{error}");
        assert!(error.to_string().contains(array) && error.to_string().contains(reason), "{error}");
    }
    assert!(matches!(Parameter::field(&model, "body_mess", 0, 0), Err(Error::NoSuchField { .. })));
    for (row, column) in [(99, 0), (0, 2)] {
        assert!(matches!(Parameter::field(&model, "jnt_range", row, column), Err(Error::Invalid { .. })));
    }
    let range = Parameter::field(&model, "jnt_range", 0, 1).unwrap();
    let error = Parameters::new().with(&model, range, Distribution::Uniform { low: 0.0, high: f64::NAN }).unwrap_err();
    assert!(error.to_string().contains("jnt_range[1] of joint 'slider'"), "{error}");
    let twice = Parameters::new().with(&model, range, Distribution::Unchanged).unwrap();
    assert!(matches!(twice.with(&model, range, Distribution::Unchanged), Err(Error::Invalid { .. })));

    // Two parameters that would write one number.
    let joint = model.joint("slider").unwrap().id();
    let mass = Parameter::MassFactor(model.body("cart").unwrap().id());
    for (first, array, row) in [(Parameter::JointDamping(joint), "dof_damping", 0), (mass, "body_inertia", 1)] {
        let number = Parameter::field(&model, array, row, 0).unwrap();
        for [first, second] in [[first, number], [number, first]] {
            let one = Parameters::new().with(&model, first, Distribution::Unchanged).unwrap();
            assert!(matches!(one.with(&model, second, Distribution::Unchanged), Err(Error::Invalid { .. })), "{array}");
        }
    }
    // A finite number that is none as `f32`.
    let colour = Parameter::field(&model, "geom_rgba", 0, 0).unwrap();
    let error = Parameters::new().with(&model, colour, Distribution::Uniform { low: 0.0, high: 1e39 }).unwrap_err();
    assert!(error.to_string().contains("3.4e38"), "{error}");
    let force = Parameter::field(&model, "actuator_forcerange", 0, 1).unwrap();
    let names = Parameters::new().with(&model, force, Distribution::Unchanged).unwrap();
    let name = names.names().next().unwrap().to_owned();
    assert!(name.starts_with("actuator_forcerange[1] of actuator "), "{name}");
}

#[test]
#[should_panic(expected = "belongs to another model")]
fn a_number_of_another_model_panics() {
    let [model, other] = [mujoco_safe::sample::cartpole(), mujoco_safe::sample::cartpole()];
    let range = Parameter::field(&other, "jnt_range", 0, 1).unwrap();
    let _ = Parameters::new().with(&model, range, Distribution::Unchanged);
}

/// Fields of the text below: array, element, column, and the value with which it is usually
/// compiled. The values of the first have an effect on motions.
const FIELDS: [(&str, usize, usize, f64); 17] = [
    ("pair_friction", 0, 0, 0.9),
    ("pair_margin", 0, 0, 0.02),
    ("pair_solref", 0, 0, 0.03),
    ("tendon_stiffness", 0, 0, 3.0),
    ("tendon_damping", 0, 0, 0.4),
    ("tendon_range", 0, 1, 0.2),
    ("jnt_range", 0, 1, 0.08),
    ("jnt_solref", 0, 0, 0.04),
    ("eq_solref", 0, 0, 0.05),
    ("actuator_forcerange", 0, 1, 0.7),
    ("body_pos", 2, 0, 0.3),
    ("geom_rgba", 0, 1, 0.3),
    ("cam_fovy", 0, 0, 50.0),
    ("cam_pos", 0, 2, 2.0),
    ("light_diffuse", 0, 0, 0.6),
    ("light_pos", 0, 1, 1.5),
    ("site_rgba", 0, 3, 0.8),
];

fn text(
    [
        friction,
        margin,
        solref,
        stiffness,
        damping,
        limit,
        range,
        softness,
        equality,
        force,
        pos,
        green,
        fovy,
        camera,
        red,
        light,
        alpha,
    ]: [f64; 17],
) -> String {
    format!(
        r#"<mujoco><compiler angle="radian"/>
  <worldbody><light pos="0 {light} 3" diffuse="{red} .5 .5"/><camera pos="0 0 {camera}" fovy="{fovy}"/>
    <geom name="floor" type="plane" size="1 1 .1" rgba=".1 {green} .2 1" contype="0" conaffinity="0"/>
    <body pos="0 0 .5"><joint name="a" axis="0 1 0" limited="true" range="-1 {range}" solreflimit="{softness} 1"/><geom size=".05" pos=".2 0 0"/>
      <site rgba="1 1 1 {alpha}"/>
      <body pos="{pos} 0 0"><joint name="b" axis="0 1 0"/><geom size=".05" pos=".1 0 0" contype="0"/></body></body>
    <body name="ball" pos="1 0 .049"><joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/><geom name="ball" size=".05"/></body>
    <body pos="2 0 1"><joint name="c" axis="0 1 0"/><joint name="d" axis="1 0 0"/><geom size=".05" pos=".1 .1 0" contype="0"/></body>
  </worldbody>
  <contact><pair geom1="floor" geom2="ball" condim="3" friction="{friction} .9 .005 .0001 .0001" margin="{margin}" solref="{solref} 1"/></contact>
  <tendon><fixed limited="true" range="-1 {limit}" stiffness="{stiffness}" damping="{damping}" springlength="0"><joint joint="a" coef="1"/><joint joint="b" coef=".5"/></fixed></tendon>
  <equality><joint joint1="c" joint2="d" solref="{equality} 1"/></equality>
  <actuator><motor joint="b" forcelimited="true" forcerange="-1 {force}"/></actuator>
</mujoco>"#
    )
}

#[test]
fn numbers_of_arrays_equal_the_models_compiled_with_the_values() {
    let usual = FIELDS.map(|(.., value)| value);
    let model = Arc::new(Model::from_xml_str(&text(usual)).unwrap());
    let parameters = FIELDS.map(|(array, row, column, _)| Parameter::field(&model, array, row, column).unwrap());
    let mut batch = batch_of(&model, &parameters);
    for (value, usual) in batch.parameters().row(0).iter().zip(usual) {
        assert!((value - usual).abs() < 1e-6, "{value} {usual}");
    }
    let start = |data: &mut Data| {
        data.qvel_mut().fill(0.8);
        data.joint_mut("z").unwrap().qvel_mut()[0] = 0.0;
        data.ctrl_mut().fill(1.0);
    };
    let mut usual_end = Vec::new();
    // One value at a time, and all.
    for changed in 0..FIELDS.len() + 2 {
        let mut values = usual;
        for (at, value) in values.iter_mut().enumerate() {
            if changed > 0 && (at + 1 == changed || changed > FIELDS.len()) {
                *value *= 0.6;
            }
        }
        batch.set_parameters(|_| true, |_, written| written.copy_from_slice(&values)).unwrap();
        batch.reset_where(|_| true, |_, _, data| start(data)).unwrap();
        let mut single = Data::new(Model::from_xml_str(&text(values)).unwrap()).unwrap();
        start(&mut single);
        for _ in 0..50 {
            batch.step(|_, controls| controls.as_mut_slice().fill(1.0)).unwrap();
            single.step().unwrap();
        }
        let found = batch.data(0).unwrap();
        let end = [found.qpos(), found.qvel()].concat();
        for (found, expected) in end.iter().zip([single.qpos(), single.qvel()].concat()) {
            assert!((found - expected).abs() < 1e-9, "{changed}: {found} {expected}");
        }
        let (found, expected) = (found.model(), single.model());
        let pictures = |model: &Model| {
            format!(
                "{:?} {:?} {:?} {:?} {:?} {:?} {:?}",
                model.geom_rgba(),
                model.site_rgba(),
                model.cam_fovy(),
                model.cam_pos(),
                model.cam_pos0(),
                model.light_diffuse(),
                model.light_pos0()
            )
        };
        assert_eq!(pictures(found), pictures(expected), "{changed}");
        match changed {
            0 => usual_end = end,
            1..=11 => assert_ne!(end, usual_end, "{} has an effect", FIELDS[changed - 1].0),
            _ if changed <= FIELDS.len() => assert_eq!(end, usual_end, "{}", FIELDS[changed - 1].0),
            _ => {}
        }
    }
}
