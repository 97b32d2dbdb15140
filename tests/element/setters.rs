//! Switches, masks and the few integers of a model that may be written to: each setter writes its own element's place and nothing
//! else, refuses what the engine cannot take, and leaves a model that can be stepped.

use mujoco_safe::{Cone, Data, Error, JacobianStorage, Model, ModelMut, Solver, sample};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::{every_element, zoo};

/// Each value in turn at each element of a kind: what the engine's array has afterwards, and what the view reads.
macro_rules! round_trip {
    ($($one:ident, $one_mut:ident, $many:ident { $($field:ident, $set:ident, $array:ident, $values:expr;)* })*) => {$($(
        let mut model = every_element();
        let names: Vec<usize> = model.$many().map(|element| element.index()).collect();
        assert!(!names.is_empty(), stringify!($one));
        for index in names {
            for value in $values {
                let mut expected = model.$array().to_vec();
                expected[index] = value.into();
                model.edit().$one_mut(index).expect("it is there").$set(value);
                assert_eq!(model.$array(), expected, "{} {index}", stringify!($array));
                assert_eq!(model.$one(index).expect("it is there").$field(), value);
            }
        }
    )*)*};
}

#[test]
fn every_switch_and_mask_is_written_at_its_own_place() {
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
            directional, set_directional, light_directional, bools;
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
        equality, equality_mut, equalities {
            active, set_active, eq_active, bools;
        }
        material, material_mut, materials {
            texuniform, set_texuniform, mat_texuniform, bools;
        }
    }
}

/// The same for setters that refuse some values.
macro_rules! checked {
    ($($one:ident, $one_mut:ident, $many:ident, $field:ident, $set:ident, $array:ident: $right:expr, $wrong:expr;)*) => {$(
        let mut model = every_element();
        let count = model.$many().len();
        for index in 0..count {
            for value in $right {
                let mut expected = model.$array().to_vec();
                expected[index] = value;
                model.edit().$one_mut(index).expect("it is there").$set(value).expect("a right value");
                assert_eq!(model.$array(), expected);
                assert_eq!(model.$one(index).expect("it is there").$field(), value);
            }
            let before = model.$array().to_vec();
            for value in $wrong {
                let element = format!("{:?}", model.$one(index).expect("it is there"));
                let error = model.edit().$one_mut(index).expect("it is there").$set(value).expect_err("a wrong value");
                assert!(matches!(error, Error::Invalid { .. }), "{error:?}");
                let text = error.to_string();
                for part in [stringify!($field), &element, &value.to_string(), "one of"] {
                    assert!(text.contains(part), "{text}");
                }
                assert_eq!(model.$array(), before, "nothing is written");
            }
        }
    )*};
}

#[test]
fn wrong_dimensions_and_groups_are_errors_that_name_the_right_ones() {
    let (dimensions, wrong) = ([1, 3, 4, 6], [0, 2, 5, 7, -1, i32::MIN, i32::MAX]);
    checked! {
        geom, geom_mut, geoms, condim, set_condim, geom_condim: dimensions, wrong;
        pair, pair_mut, pairs, dim, set_dim, pair_dim: dimensions, wrong;
        skin, skin_mut, skins, group, set_group, skin_group: 0..6, [-1, 6, 1000, i32::MIN, i32::MAX];
    }
    let mut model = every_element();
    let error = model.edit().geom_mut("ball").expect("a ball").set_condim(2).expect_err("there is no such dimension");
    let text = error.to_string();
    assert!(
        text.starts_with("condim of geom ") && text.ends_with(" 'ball' is 2, but must be one of 1, 3, 4, 6"),
        "{text}"
    );
}

/// Everything that can be switched on, and every contact as large as it may be.
fn everything_on(model: &mut Model) {
    let mut edit = model.edit();
    for index in 0..edit.njnt() {
        edit.joint_mut(index).expect("a joint").set_limited(true);
    }
    for index in 0..edit.ngeom() {
        let mut geom = edit.geom_mut(index).expect("a geom");
        geom.set_contype(-1);
        geom.set_conaffinity(-1);
        geom.set_condim(6).expect("a right value");
        geom.set_priority(index as i32);
    }
    for index in 0..edit.npair() {
        edit.pair_mut(index).expect("a pair").set_dim(6).expect("a right value");
    }
    for index in 0..edit.ntendon() {
        edit.tendon_mut(index).expect("a tendon").set_limited(true);
    }
    for index in 0..edit.neq() {
        edit.equality_mut(index).expect("an equality").set_active(true);
    }
    for index in 0..edit.nu() {
        let mut actuator = edit.actuator_mut(index).expect("an actuator");
        actuator.set_ctrllimited(true);
        actuator.set_forcelimited(true);
        actuator.set_actlimited(true);
    }
}

/// The models here, those of the engine's package that are quickly stepped, and some whose constraints have next to no room.
fn subjects() -> Vec<Model> {
    let mut subjects = vec![(*zoo()).clone(), every_element(), sample::humanoid(), sample::cartpole()];
    subjects.extend(
        sample::system_models()
            .iter()
            .filter_map(|path| Model::from_xml_path(path).ok())
            .filter(|model| model.nv() <= 100),
    );
    for (njmax, nconmax) in [(0, 0), (1, 1), (7, 60), (100, 60), (300, 2)] {
        let text = include_str!("../models/every_element.xml")
            .replace("njmax=\"300\" nconmax=\"60\"", &format!("njmax=\"{njmax}\" nconmax=\"{nconmax}\""));
        assert!(text.contains(&format!("njmax=\"{njmax}\"")));
        // With less room, a model with an adhesive actuator is refused.
        let adhesion = "<adhesion name=\"stick\" body=\"gripper\" gain=\"3\" ctrlrange=\"0 1\"/>";
        let text = if njmax < 100 { text.replace(adhesion, "") } else { text };
        assert_eq!(text.contains("<adhesion"), njmax >= 100);
        subjects.push(Model::from_xml_str(&text).expect("it is valid"));
    }
    subjects
}

/// What the engine makes of such models is an error at worst, also with an adhesive actuator and a full constraint buffer.
#[test]
fn a_model_with_everything_switched_on_steps_or_gives_an_error() {
    let mut steps = 0;
    for mut model in subjects() {
        everything_on(&mut model);
        for (cone, jacobian, solver) in [
            (Cone::Pyramidal, JacobianStorage::Dense, Solver::Newton),
            (Cone::Elliptic, JacobianStorage::Sparse, Solver::Newton),
            (Cone::Elliptic, JacobianStorage::Dense, Solver::Pgs),
            (Cone::Pyramidal, JacobianStorage::Sparse, Solver::Cg),
        ] {
            let mut edit = model.edit();
            edit.options(|options| (options.cone, options.jacobian, options.solver) = (cone, jacobian, solver))
                .expect("valid options");
            let mut data = Data::new(model.clone()).expect("there is memory");
            for _ in 0..15 {
                match data.step() {
                    Ok(()) => steps += 1,
                    Err(_) => data.reset().expect("a reset"),
                }
            }
        }
    }
    assert!(steps > 200, "only {steps} steps came about");
}

#[test]
fn switches_thrown_at_random_between_steps_do_no_harm() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut steps = 0;
    for model in subjects() {
        let mut data = Data::new(model).expect("there is memory");
        for _ in 0..40 {
            data.edit_model(|model| throw_switches(model, &mut random)).expect("there is memory");
            match data.step() {
                Ok(()) => steps += 1,
                Err(_) => data.reset().expect("a reset"),
            }
        }
    }
    assert!(steps > 200, "only {steps} steps came about");
}

/// A random element of each kind gets random values.
fn throw_switches(model: &mut ModelMut<'_>, random: &mut Xoshiro256PlusPlus) {
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
        geom.set_condim(DIMENSIONS[dimension]).expect("a right value");
        geom.set_priority(bits as i32 - 4);
    }
    if let Ok(mut pair) = model.pair_mut(pair) {
        pair.set_dim(DIMENSIONS[dimension]).expect("a right value");
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
fn switches_thrown_on_a_live_simulation_change_its_next_step() {
    let mut data = Data::new(sample::humanoid()).expect("there is memory");
    for _ in 0..300 {
        data.step().expect("a step");
    }
    let contacts = data.ncon();
    assert!(contacts > 0, "the humanoid lies on the floor");
    data.edit_model(|model| {
        for index in 0..model.ngeom() {
            let mut geom = model.geom_mut(index).expect("a geom");
            geom.set_contype(0);
            geom.set_conaffinity(0);
        }
    })
    .expect("there is memory");
    data.forward().expect("forward dynamics");
    assert_eq!(data.ncon(), 0);
    data.edit_model(|model| {
        let mut floor = model.geom_mut("floor").expect("a floor");
        floor.set_contype(1);
        floor.set_conaffinity(1);
        for index in 0..model.ngeom() {
            let mut geom = model.geom_mut(index).expect("a geom");
            geom.set_conaffinity(1);
            geom.set_condim(1).expect("a right value");
        }
    })
    .expect("there is memory");
    data.forward().expect("forward dynamics");
    assert!(data.ncon() > 0);
    assert!(data.contacts().all(|contact| contact.dim() == 1));
}

#[test]
fn an_equality_that_was_compiled_inactive_holds_once_it_is_active() {
    let text = "<mujoco><option gravity='0 0 0'/><worldbody>
        <body name='a'><joint name='a' type='slide'/><geom size='0.1' contype='0' conaffinity='0'/></body>
        <body name='b'><joint name='b' type='slide'/><geom size='0.1' contype='0' conaffinity='0'/></body></worldbody>
        <equality><joint name='tie' joint1='a' joint2='b' active='false'/></equality></mujoco>";
    let mut data = Data::new(Model::from_xml_str(text).expect("it is valid")).expect("there is memory");
    let mut gap = |active| {
        data.reset().expect("a reset");
        data.edit_model(|model| model.equality_mut("tie").expect("a tie").set_active(active)).expect("there is memory");
        data.joint_mut("a").expect("a joint").qvel_mut()[0] = 1.0;
        for _ in 0..500 {
            data.step().expect("a step");
        }
        (data.qpos()[0] - data.qpos()[1]).abs()
    };
    assert!(gap(false) > 0.9);
    assert!(gap(true) < 0.01);
}
