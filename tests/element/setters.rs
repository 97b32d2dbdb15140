//! Setters of flags, masks and other integers of a model: each setter writes only its element's
//! value, rejects values that the engine does not support, and leaves a model that can be stepped.

use mujoco_safe::enums::{Cone, JacobianStorage, Solver};
use mujoco_safe::{Data, Error, Model, ModelMut, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::cases::cases;
use crate::installed::sample_models;
use crate::{every_element, zoo};

/// Sets each value at each element of a kind, and compares the engine's array and the view.
macro_rules! round_trip {
    ($($one:ident, $one_mut:ident, $many:ident { $($field:ident, $set:ident, $array:ident, $values:expr;)* })*) => {$($(
        let mut model = every_element();
        let names: Vec<usize> = model.$many().map(|element| element.index()).collect();
        assert!(!names.is_empty(), stringify!($one));
        for index in names {
            for value in $values {
                let mut expected = model.$array().to_vec();
                expected[index] = value.into();
                model.edit().$one_mut(index).unwrap().$set(value);
                assert_eq!(model.$array(), expected, "{} {index}", stringify!($array));
                assert_eq!(model.$one(index).unwrap().$field(), value);
            }
        }
    )*)*};
}

#[test]
fn every_setter_writes_only_its_own_value() {
    let bools = [true, false, true];
    let masks = [0, 1, -1, i32::MIN, i32::MAX, 6];
    round_trip! {
        joint, joint_mut, joints {
            limited, set_limited, jnt_limited, bools;
            group, set_group, jnt_group, masks;
        }
        geom, geom_mut, geoms {
            contype, set_contype, geom_contype, masks;
            conaffinity, set_conaffinity, geom_conaffinity, masks;
            group, set_group, geom_group, masks;
            priority, set_priority, geom_priority, masks;
        }
        site, site_mut, sites {
            group, set_group, site_group, masks;
        }
        light, light_mut, lights {
            active, set_active, light_active, bools;
            castshadow, set_castshadow, light_castshadow, bools;
        }
        tendon, tendon_mut, tendons {
            limited, set_limited, tendon_limited, bools;
            group, set_group, tendon_group, masks;
        }
        actuator, actuator_mut, actuators {
            ctrllimited, set_ctrllimited, actuator_ctrllimited, bools;
            forcelimited, set_forcelimited, actuator_forcelimited, bools;
            actlimited, set_actlimited, actuator_actlimited, bools;
            group, set_group, actuator_group, masks;
        }
        material, material_mut, materials {
            texuniform, set_texuniform, mat_texuniform, bools;
        }
    }
}

/// Sets each value at each element of a kind whose array differs between engines, and compares the
/// views.
macro_rules! flags_of_views {
    ($($one_mut:ident, $many:ident, $field:ident, $set:ident;)*) => {$(
        let mut model = every_element();
        let read = |model: &Model| model.$many().map(|element| element.$field()).collect::<Vec<bool>>();
        let count = model.$many().len();
        for index in 0..count {
            for value in [true, false, true] {
                let mut expected = read(&model);
                expected[index] = value;
                model.edit().$one_mut(index).unwrap().$set(value);
                assert_eq!(read(&model), expected, "{} {index}", stringify!($field));
            }
        }
    )*};
}

#[test]
fn every_setter_of_a_flag_whose_array_differs_between_engines_writes_only_its_own_value() {
    flags_of_views! {
        light_mut, lights, directional, set_directional;
        equality_mut, equalities, active, set_active;
    }
    #[cfg(not(engine_since = "3.0.0"))]
    {
        let mut model = every_element();
        (0..model.neq()).for_each(|index| model.edit().equality_mut(index).unwrap().set_active(index % 2 == 0));
        assert!(model.eq_active().iter().enumerate().all(|(index, active)| *active == u8::from(index % 2 == 0)));
        (0..model.nlight()).for_each(|index| model.edit().light_mut(index).unwrap().set_directional(index % 2 == 0));
        assert!(model.light_directional().iter().enumerate().all(|(index, flag)| *flag == u8::from(index % 2 == 0)));
    }
}

/// Does the same for setters that reject some values.
macro_rules! checked {
    ($($one:ident, $one_mut:ident, $many:ident, $field:ident, $set:ident, $array:ident: $right:expr, $wrong:expr;)*) => {$(
        let mut model = every_element();
        let count = model.$many().len();
        for index in 0..count {
            for value in $right {
                let mut expected = model.$array().to_vec();
                expected[index] = value;
                model.edit().$one_mut(index).unwrap().$set(value).unwrap();
                assert_eq!(model.$array(), expected);
                assert_eq!(model.$one(index).unwrap().$field(), value);
            }
            let before = model.$array().to_vec();
            for value in $wrong {
                let element = format!("{:?}", model.$one(index).unwrap());
                let error = model.edit().$one_mut(index).unwrap().$set(value).unwrap_err();
                assert!(matches!(error, Error::Invalid { .. }), "{error:?}");
                let text = error.to_string();
                for part in [stringify!($field), &element, &value.to_string(), "one of"] {
                    assert!(text.contains(part), "{text}");
                }
                assert_eq!(model.$array(), before, "a rejected value is not written");
            }
        }
    )*};
}

#[test]
fn invalid_values_are_errors_that_list_the_valid_values() {
    let (dimensions, wrong) = ([1, 3, 4, 6], [0, 2, 5, 7, -1, i32::MIN, i32::MAX]);
    checked! {
        geom, geom_mut, geoms, condim, set_condim, geom_condim: dimensions, wrong;
        pair, pair_mut, pairs, dim, set_dim, pair_dim: dimensions, wrong;
        skin, skin_mut, skins, group, set_group, skin_group: 0..6, [-1, 6, 1000, i32::MIN, i32::MAX];
    }
    let mut model = every_element();
    let error = model.edit().geom_mut("ball").unwrap().set_condim(2).unwrap_err();
    let text = error.to_string();
    assert!(
        text.starts_with("condim of geom ") && text.ends_with(" 'ball' is 2, but must be one of 1, 3, 4, 6"),
        "{text}"
    );
}

/// Enables every flag, and gives every contact the largest dimension.
fn enable_everything(model: &mut Model) {
    let mut edit = model.edit();
    for index in 0..edit.njnt() {
        edit.joint_mut(index).unwrap().set_limited(true);
    }
    for index in 0..edit.ngeom() {
        let mut geom = edit.geom_mut(index).unwrap();
        geom.set_contype(-1);
        geom.set_conaffinity(-1);
        geom.set_condim(6).unwrap();
        geom.set_priority(index as i32);
    }
    for index in 0..edit.npair() {
        edit.pair_mut(index).unwrap().set_dim(6).unwrap();
    }
    for index in 0..edit.ntendon() {
        edit.tendon_mut(index).unwrap().set_limited(true);
    }
    for index in 0..edit.neq() {
        edit.equality_mut(index).unwrap().set_active(true);
    }
    for index in 0..edit.nu() {
        let mut actuator = edit.actuator_mut(index).unwrap();
        actuator.set_ctrllimited(true);
        actuator.set_forcelimited(true);
        actuator.set_actlimited(true);
    }
}

/// Returns our models, the engine's models that step quickly, and models with small constraint
/// buffers.
fn subjects() -> Vec<Model> {
    let mut subjects = vec![(*zoo()).clone(), every_element(), sample::humanoid(), sample::cartpole()];
    subjects.extend(sample_models().into_iter().map(|(_, model)| model).filter(|model| model.nv() <= 100));
    for (njmax, nconmax) in [(0, 0), (1, 1), (7, 60), (100, 60), (300, 2)] {
        let text = include_str!("../models/every_element.xml")
            .replace("njmax=\"300\" nconmax=\"60\"", &format!("njmax=\"{njmax}\" nconmax=\"{nconmax}\""));
        assert!(text.contains(&format!("njmax=\"{njmax}\"")));
        // With a smaller buffer, a model with an adhesion actuator is rejected.
        let adhesion = "<adhesion name=\"stick\" body=\"gripper\" gain=\"3\" ctrlrange=\"0 1\"/>";
        let text = if njmax < 100 { text.replace(adhesion, "") } else { text };
        assert_eq!(text.contains("<adhesion"), njmax >= 100);
        subjects.push(Model::from_xml_str(&text).unwrap());
    }
    subjects
}

/// An error is allowed, also with an adhesion actuator and a full constraint buffer.
#[test]
fn a_model_with_everything_enabled_steps_or_returns_an_error() {
    let mut steps = 0;
    for (index, mut model) in subjects().into_iter().enumerate() {
        enable_everything(&mut model);
        let combinations = [
            (Cone::Pyramidal, JacobianStorage::Dense, Solver::Newton),
            (Cone::Elliptic, JacobianStorage::Sparse, Solver::Newton),
            (Cone::Elliptic, JacobianStorage::Dense, Solver::Pgs),
            (Cone::Pyramidal, JacobianStorage::Sparse, Solver::Cg),
        ];
        for (cone, jacobian, solver) in combinations.into_iter().skip(index % cases(8, 1)).step_by(cases(8, 1)) {
            let mut edit = model.edit();
            edit.edit_options(|options| (options.cone, options.jacobian, options.solver) = (cone, jacobian, solver))
                .unwrap();
            let mut data = Data::new(model.clone()).unwrap();
            for _ in 0..15 {
                match data.step() {
                    Ok(()) => steps += 1,
                    Err(_) => data.reset().unwrap(),
                }
            }
        }
    }
    assert!(steps > cases(25, 200), "only {steps} steps succeeded");
}

#[test]
fn random_values_set_between_steps_cause_no_crash() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut steps = 0;
    for model in subjects() {
        let mut data = Data::new(model).unwrap();
        for _ in 0..cases(6, 40) {
            data.edit_model(|model| set_random_values(model, &mut random)).unwrap();
            match data.step() {
                Ok(()) => steps += 1,
                Err(_) => data.reset().unwrap(),
            }
        }
    }
    assert!(steps > cases(28, 200), "only {steps} steps succeeded");
}

/// Sets random values on a random element of each kind.
fn set_random_values(model: &mut ModelMut<'_>, random: &mut Xoshiro256PlusPlus) {
    const DIMENSIONS: [i32; 4] = [1, 3, 4, 6];
    let mut one_of = |count: usize| random.random_range(0..count.max(1));
    let [joint, geom, pair, tendon, equality, actuator] =
        [model.njnt(), model.ngeom(), model.npair(), model.ntendon(), model.neq(), model.nu()].map(&mut one_of);
    let [on, also, dimension, bits, other_bits] = [2, 2, 4, 8, 8].map(one_of);
    if let Ok(mut joint) = model.joint_mut(joint) {
        joint.set_limited(on == 1);
    }
    if let Ok(mut geom) = model.geom_mut(geom) {
        geom.set_contype(bits as i32);
        geom.set_conaffinity(other_bits as i32);
        geom.set_condim(DIMENSIONS[dimension]).unwrap();
        geom.set_priority(bits as i32 - 4);
    }
    if let Ok(mut pair) = model.pair_mut(pair) {
        pair.set_dim(DIMENSIONS[dimension]).unwrap();
    }
    if let Ok(mut tendon) = model.tendon_mut(tendon) {
        tendon.set_limited(also == 1);
    }
    if let Ok(mut equality) = model.equality_mut(equality) {
        equality.set_active(also == 0);
    }
    if let Ok(mut actuator) = model.actuator_mut(actuator) {
        actuator.set_ctrllimited(on == 0);
        actuator.set_forcelimited(also == 1);
        actuator.set_actlimited(on == 1);
    }
}

#[test]
fn values_set_on_a_simulation_affect_its_next_step() {
    let mut data = Data::new(sample::humanoid()).unwrap();
    for _ in 0..300 {
        data.step().unwrap();
    }
    let contacts = data.ncon();
    assert!(contacts > 0, "the humanoid lies on the floor");
    data.edit_model(|model| {
        for index in 0..model.ngeom() {
            let mut geom = model.geom_mut(index).unwrap();
            geom.set_contype(0);
            geom.set_conaffinity(0);
        }
    })
    .unwrap();
    data.forward().unwrap();
    assert_eq!(data.ncon(), 0);
    data.edit_model(|model| {
        let mut floor = model.geom_mut("floor").unwrap();
        floor.set_contype(1);
        floor.set_conaffinity(1);
        for index in 0..model.ngeom() {
            let mut geom = model.geom_mut(index).unwrap();
            geom.set_conaffinity(1);
            geom.set_condim(1).unwrap();
        }
    })
    .unwrap();
    data.forward().unwrap();
    assert!(data.ncon() > 0);
    assert!(data.contacts().all(|contact| contact.dim() == 1));
}

#[test]
fn an_equality_compiled_as_inactive_can_be_activated() {
    let text = "<mujoco><option gravity='0 0 0'/><worldbody>
        <body name='a'><joint name='a' type='slide'/><geom size='0.1' contype='0' conaffinity='0'/></body>
        <body name='b'><joint name='b' type='slide'/><geom size='0.1' contype='0' conaffinity='0'/></body></worldbody>
        <equality><joint name='tie' joint1='a' joint2='b' active='false'/></equality></mujoco>";
    let mut data = Data::new(Model::from_xml_str(text).unwrap()).unwrap();
    let mut gap = |active| {
        data.reset().unwrap();
        data.edit_model(|model| model.equality_mut("tie").unwrap().set_active(active)).unwrap();
        data.joint_mut("a").unwrap().qvel_mut()[0] = 1.0;
        for _ in 0..500 {
            data.step().unwrap();
        }
        (data.qpos()[0] - data.qpos()[1]).abs()
    };
    assert!(gap(false) > 0.9);
    assert!(gap(true) < 0.01);
}
