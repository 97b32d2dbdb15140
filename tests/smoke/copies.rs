//! Copies, state vectors, keyframes, resets and rows of batches against the C API, on models of all
//! attributes of the engine's schema.

use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use mujoco_safe::derivative::TransitionOptions;
use mujoco_safe::rollout::Batch;
use mujoco_safe::sys::{self, mjData};
use mujoco_safe::{Data, Error, Lineariser, Matrix, Model, StateSpec};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::schema_models::{self, Effect};

/// A data of the C API.
struct Raw(*mut mjData);

impl Drop for Raw {
    fn drop(&mut self) {
        c!(mj_deleteData(self.0));
    }
}

/// Returns a data of the C API with the same state and results.
fn twin(data: &Data) -> Raw {
    let raw = Raw(c!(mj_makeData(data.model().as_ptr())));
    c!(mj_copyData(raw.0, data.model().as_ptr(), data.as_ptr()));
    raw
}

/// Bit of the plastic deformations, which engines before 4.0 do not have.
#[cfg(engine_since = "4.0.0")]
const PLASTIC: u32 = sys::mjSTATE_PLASTIC;
#[cfg(not(engine_since = "4.0.0"))]
const PLASTIC: u32 = 0;

/// Components of the state with the engine's bits.
const PARTS: [(StateSpec, u32); 14] = [
    (StateSpec::TIME, sys::mjSTATE_TIME),
    (StateSpec::QPOS, sys::mjSTATE_QPOS),
    (StateSpec::QVEL, sys::mjSTATE_QVEL),
    (StateSpec::ACT, sys::mjSTATE_ACT),
    (StateSpec::WARMSTART, sys::mjSTATE_WARMSTART),
    (StateSpec::CTRL, sys::mjSTATE_CTRL),
    (StateSpec::QFRC_APPLIED, sys::mjSTATE_QFRC_APPLIED),
    (StateSpec::XFRC_APPLIED, sys::mjSTATE_XFRC_APPLIED),
    (StateSpec::MOCAP_POS, sys::mjSTATE_MOCAP_POS),
    (StateSpec::MOCAP_QUAT, sys::mjSTATE_MOCAP_QUAT),
    (StateSpec::USERDATA, sys::mjSTATE_USERDATA),
    (StateSpec::PLUGIN, sys::mjSTATE_PLUGIN),
    (StateSpec::PLASTIC, PLASTIC),
    (StateSpec::HISTORY, sys::mjSTATE_HISTORY),
];

/// Returns a component of the state of a data of the C API.
fn component(model: &Model, data: *const mjData, bit: u32) -> Vec<f64> {
    let mut state = vec![0.0; c!(mj_stateSize(model.as_ptr(), bit as _)) as usize];
    c!(mj_getState(model.as_ptr(), data, state.as_mut_ptr(), bit as _));
    state
}

/// Returns the bits of all components of the engine's state.
fn whole_state(model: &Model, data: *const mjData) -> Vec<u64> {
    component(model, data, (1 << sys::mjNSTATE) - 1).into_iter().map(f64::to_bits).collect()
}

/// Checks that both have the same state, and that it stays the same over steps.
fn same(what: &str, data: &mut Data, raw: &Raw) {
    let model = data.model().clone();
    for step in 0..4 {
        assert!(whole_state(&model, data.as_ptr()) == whole_state(&model, raw.0), "{what}, step {step}");
        if data.step().is_err() {
            return;
        }
        c!(mj_step(model.as_ptr(), raw.0));
    }
}

/// Compares an array of a model after a keyframe was set. A function, since the code of hundreds of
/// fields takes minutes to compile.
fn same_field(what: &str, name: &str, ours: &dyn Debug, engine: &dyn Debug) {
    assert!(format!("{ours:?}") == format!("{engine:?}"), "{what}: {name} after set_keyframe");
}

/// Compares all calls on one model.
fn check(what: &str, model: Model, random: &mut Xoshiro256PlusPlus) {
    let model = Arc::new(model);
    let moving = |steps| {
        let mut data = Data::new(&model).unwrap();
        schema_models::excite(&mut data);
        for _ in 0..steps {
            data.step()?;
        }
        data.userdata_mut().fill(0.5);
        Ok::<_, Error>(data)
    };
    let (Ok(data), Ok(other)) = (moving(7), moving(3)) else { return };

    same(&format!("{what}: a clone"), &mut data.clone(), &twin(&data));
    let (mut copy, raw) = (other.clone(), twin(&other));
    copy.copy_from(&data).unwrap();
    c!(mj_copyData(raw.0, model.as_ptr(), data.as_ptr()));
    same(&format!("{what}: a copy"), &mut copy, &raw);

    // Every component alone, and random signatures.
    let count = PARTS.len();
    let mut signatures: Vec<u32> = (0..count).map(|bit| 1 << bit).collect();
    signatures.extend((0..6).map(|_| random.random_range(1..1 << count)));
    for signature in signatures {
        let parts = || PARTS.iter().enumerate().filter(|(at, _)| signature >> at & 1 == 1).map(|(_, part)| part);
        let spec: StateSpec = parts().map(|(part, _)| *part).collect();
        let engine = parts().fold(0, |engine, (_, bit)| engine | bit);
        assert_eq!(model.state_size(spec), c!(mj_stateSize(model.as_ptr(), engine as _)) as usize, "{what}: {spec:?}");
        for (part, bit) in parts() {
            assert_eq!(data.state(*part), component(&model, data.as_ptr(), *bit), "{what}: {part:?}");
        }
        let (mut target, raw) = (other.clone(), twin(&other));
        target.set_state(spec, &data.state(spec)).unwrap();
        let state = component(&model, data.as_ptr(), engine);
        c!(mj_setState(model.as_ptr(), raw.0, state.as_ptr(), engine as _));
        assert!(whole_state(&model, target.as_ptr()) == whole_state(&model, raw.0), "{what}: {spec:?}");
    }

    for key in 0..model.nkey() {
        let mut stored = data.clone();
        stored.set_keyframe(key).unwrap();
        let expected = Model::clone(&model);
        c!(mj_setKeyframe(expected.as_ptr().cast_mut(), data.as_ptr(), key as _));
        macro_rules! equal {
            ($($field:ident)*) => {
                $(same_field(what, stringify!($field), &stored.model().$field(), &expected.$field());)*
            };
        }
        model_readers! { equal }
        let raw = twin(&other);
        c!(mj_resetDataKeyframe(expected.as_ptr(), raw.0, key as _));
        stored.reset_to_key(key).unwrap();
        same(&format!("{what}: a reset to a keyframe"), &mut stored, &raw);
    }
    let (mut reset, raw) = (data.clone(), twin(&data));
    reset.reset().unwrap();
    c!(mj_resetData(model.as_ptr(), raw.0));
    same(&format!("{what}: a reset"), &mut reset, &raw);

    let mut batch = match Batch::new(&model, 2) {
        Ok(batch) => batch,
        // Sleeping bodies.
        Err(Error::Unsupported(_)) => return,
        Err(error) => panic!("{what}: {error}"),
    };
    let mut single = Data::new(&model).unwrap();
    for _ in 0..5 {
        let stepped = single.step();
        if batch.step(|_, _| ()).is_err() || stepped.is_err() {
            return;
        }
        for row in 0..2 {
            assert!(
                batch.states().row(row) == &single.state(StateSpec::INTEGRATION)[..],
                "{what}: row {row} of a batch"
            );
        }
    }
}

/// A keyframe and user data for a model.
fn with_keyframe(text: &str) -> String {
    let size = if text.contains("<size") { "" } else { "<size nuserdata=\"3\"/>" };
    let key = if text.contains("<keyframe") { "" } else { "<keyframe><key name=\"state\"/></keyframe>" };
    text.replacen("</mujoco>", &format!("{size}{key}</mujoco>"), 1)
}

#[test]
fn each_component_of_the_engines_state_has_a_name() {
    let known = PARTS.iter().fold(sys::mjSTATE_EQ_ACTIVE, |known, (_, bit)| known | bit);
    assert_eq!(known, (1 << sys::mjNSTATE) - 1);
}

#[test]
fn a_keyframe_stores_plastic_deformations() {
    let model = schema_models::load(
        r#"<mujoco><worldbody><geom type="plane" size="2 2 .1"/>
             <flexcomp name="flex" type="grid" count="3 3 1" spacing=".1 .1 .1" dim="2" pos="0 0 .5" mass="1" radius=".01">
               <elasticity young="1e4" poisson="0.2" thickness="0.01" elastic2d="both" yield="0.01 0.01"/>
             </flexcomp></worldbody><keyframe><key name="state"/></keyframe></mujoco>"#,
    );
    // Engines before 4.0 have no such attribute.
    let Ok(model) = model else { return };
    let mut data = Data::new(model).unwrap();
    let plastic: Vec<f64> = (0..data.model().state_size(StateSpec::PLASTIC)).map(|at| 0.001 * at as f64).collect();
    assert!(plastic.len() > 3);
    data.set_state(StateSpec::PLASTIC, &plastic).unwrap();
    data.set_keyframe("state").unwrap();
    data.reset().unwrap();
    assert!(data.state(StateSpec::PLASTIC).iter().all(|&value| value == 0.0));
    data.reset_to_key("state").unwrap();
    assert_eq!(data.state(StateSpec::PLASTIC), plastic);
    // The rows of a trajectory do not contain them.
    let mut lineariser = Lineariser::new(data.model(), TransitionOptions::default()).unwrap();
    let states = Matrix::zeros(1, data.model().state_size(StateSpec::PHYSICS));
    assert!(matches!(lineariser.along(&data, &states, &Matrix::zeros(1, 0)), Err(Error::Unsupported(_))));
}

/// Compares all calls on the model of every attribute from `first`, in steps. Returns the number of
/// models.
fn campaign(first: usize, step: usize) -> usize {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(first as u64);
    let mut models = 0;
    for attribute in schema_models::attributes().into_iter().skip(first).step_by(step) {
        let Ok(case) = schema_models::case(&attribute, Effect::Stored) else { continue };
        let loaded = schema_models::load(&with_keyframe(&case.text)).or_else(|_| schema_models::load(&case.text));
        let Ok(model) = loaded else { continue };
        check(&format!("{attribute}={}", case.value), model, &mut random);
        models += 1;
    }
    models
}

#[test]
fn copies_states_keyframes_and_resets_equal_those_of_the_engine() {
    assert!(campaign(3, 40) > 5);
}

#[test]
#[ignore = "takes minutes"]
fn copies_states_keyframes_and_resets_of_every_attribute_equal_those_of_the_engine() {
    println!("{} models", campaign(0, 1));
}

/// A model with an active equality constraint, which holds a slide.
const HELD: &str =
    "<mujoco><worldbody><body><joint name='j' type='slide' axis='0 0 1'/><geom size='.1'/></body></worldbody>
    <equality><joint name='c' joint1='j'/></equality></mujoco>";

fn has_constraint(data: &mut Data) -> bool {
    data.forward().unwrap();
    data.nefc() > 0
}

/// A simulation that keeps its own model also keeps its equality constraints.
#[test]
fn equalities_agree_with_the_model_after_a_copy_and_after_a_panic() {
    let model = Arc::new(Model::from_xml_str(HELD).unwrap());
    let [mut switched, mut copy] = [(); 2].map(|()| Data::new(&model).unwrap());
    switched.edit_model(|edit| edit.equality_mut("c").unwrap().set_active(false)).unwrap();
    copy.copy_from(&switched).unwrap();
    assert!(copy.model().equality("c").unwrap().active() && has_constraint(&mut copy));
    switched.copy_from(&copy).unwrap();
    assert!(!switched.model().equality("c").unwrap().active() && !has_constraint(&mut switched));

    let panics = catch_unwind(AssertUnwindSafe(|| {
        copy.edit_model(|edit| {
            edit.equality_mut("c").unwrap().set_active(false);
            assert!(edit.nq() > 1, "in an edit");
        })
    }));
    assert!(panics.is_err());
    assert!(!copy.model().equality("c").unwrap().active() && !has_constraint(&mut copy));
}
