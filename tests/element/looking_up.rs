//! Lookup by name, index, id and view.

use std::collections::HashSet;
use std::sync::Arc;

use mujoco_safe::id::{BodyId, JointId, KeyframeId, SensorId};
use mujoco_safe::kind::Kind;
use mujoco_safe::{Data, Error, sample};

use crate::{every_element, zoo};

#[test]
fn a_name_an_index_an_id_and_a_view_find_the_same_element() {
    let model = zoo();
    let data = Data::new(model.clone()).unwrap();
    for (index, name) in [(0, Some("crate")), (1, Some("rail")), (2, Some("shoulder")), (3, Some("elbow")), (4, None)] {
        let by_index = model.joint(index).unwrap();
        assert_eq!((by_index.index(), by_index.name()), (index, name));
        assert_eq!(model.joint(by_index.id()).id(), by_index.id());
        assert_eq!(model.joint(by_index).id(), by_index.id());
        assert_eq!(data.joint(by_index).id(), by_index.id());
        assert_eq!(model.joint(data.joint(by_index)).id(), by_index.id());
        assert_eq!(JointId::from(by_index), by_index.id());
        if let Some(name) = name {
            assert_eq!(model.joint(name).unwrap().id(), by_index.id());
            assert_eq!(model.joint(&name.to_owned()).unwrap().id(), by_index.id());
            assert_eq!(data.joint(name).unwrap().id(), by_index.id());
            assert_eq!(model.id::<mujoco_safe::kind::Joint>(name).unwrap(), by_index.id());
            assert_eq!(model.name(by_index.id()), Some(name));
        }
    }
}

#[test]
fn every_name_finds_its_element() {
    macro_rules! check {
        ($model:ident, $data:ident: $($one:ident, $many:ident;)*) => {$(
            for element in $model.$many() {
                let Some(name) = element.name() else { continue };
                assert_eq!($model.$one(name).unwrap().id(), element.id());
                assert_eq!($data.$one(name).unwrap().id(), element.id());
            }
        )*};
    }
    macro_rules! check_in_model {
        ($model:ident: $($one:ident, $many:ident;)*) => {$(
            for element in $model.$many() {
                let Some(name) = element.name() else { continue };
                assert_eq!($model.$one(name).unwrap().id(), element.id());
                assert_eq!($model.$one(element).id(), element.id());
                assert_eq!($model.$one(element.index()).unwrap().name(), Some(name));
            }
            assert!($model.$one("no such name").is_err() && $model.$one(usize::MAX).is_err());
        )*};
    }
    for model in [zoo(), Arc::new(every_element()), Arc::new(sample::humanoid()), Arc::new(sample::cartpole())] {
        let data = Data::new(model.clone()).unwrap();
        check!(model, data: body, bodies; joint, joints; geom, geoms; site, sites; camera, cameras; light, lights;
            tendon, tendons; actuator, actuators; sensor, sensors;);
        check_in_model!(model: mesh, meshes; skin, skins; height_field, height_fields; texture, textures;
            material, materials; pair, pairs; exclude, excludes; equality, equalities; numeric, numerics; text, texts;
            tuple, tuples; keyframe, keyframes;);
    }
}

#[test]
fn elements_of_different_kinds_may_share_a_name() {
    let model = zoo();
    assert_eq!(model.body("crate").unwrap().index(), 3);
    assert_eq!(model.joint("crate").unwrap().index(), 0);
    assert_eq!(model.site("crate").unwrap().index(), 1);
    assert_eq!(model.actuator("rail").unwrap().index(), 0);
    assert_eq!(model.joint("rail").unwrap().index(), 1);
}

#[test]
fn an_index_beyond_the_last_element_is_an_error_with_the_count() {
    let model = zoo();
    let error = model.sensor(10).unwrap_err();
    assert!(matches!(error, Error::NoSuchIndex { kind: Kind::Sensor, index: 10, count: 10 }), "{error:?}");
    assert_eq!(error.to_string(), "there is no sensor 10: the model has 10, counted from 0");
    assert!(model.joint(usize::MAX).is_err());
    assert!(model.id::<mujoco_safe::kind::Body>(1_usize << 32).is_err(), "an index is not truncated to 32 bits");
}

#[test]
fn ids_can_be_stored_compared_and_hashed() {
    let model = zoo();
    let ids: HashSet<BodyId> = model.bodies().map(|body| body.id()).collect();
    assert_eq!(ids.len(), model.nbody());
    assert!(ids.contains(&model.body("base").unwrap().id()));
    let kept: SensorId = model.sensor("elbow").unwrap().id();
    assert_eq!(kept.index(), 1);
}

#[test]
fn ids_are_valid_for_clones_and_edited_models() {
    let model = zoo();
    let elbow = model.joint("elbow").unwrap().id();
    let copy = (*model).clone();
    assert_eq!(copy.joint(elbow).name(), Some("elbow"));
    let mut data = Data::new(model.clone()).unwrap();
    data.edit_model(|model| model.joint_mut(elbow).set_stiffness(4.0)).unwrap();
    assert_eq!(data.joint(elbow).in_model().stiffness(), 4.0);
}

#[test]
#[should_panic(expected = "belongs to another model")]
fn an_id_of_a_separately_loaded_model_panics() {
    let elbow = zoo().joint("elbow").unwrap().id();
    zoo().joint(elbow);
}

#[test]
fn a_reset_accepts_keyframe_names_indices_ids_and_views() {
    let model = zoo();
    let mut data = Data::new(model.clone()).unwrap();
    let lifted: KeyframeId = model.keyframe("lifted").unwrap().id();
    data.reset_to_key("lifted").unwrap();
    let by_name = data.physics_state();
    assert_eq!((data.time(), data.qpos()[2]), (1.5, 0.6));
    data.reset_to_key(1).unwrap();
    assert_ne!(data.physics_state(), by_name);
    data.reset_to_key(lifted).unwrap();
    assert_eq!(data.physics_state(), by_name);
    data.reset_to_key(model.keyframe(lifted)).unwrap();
    assert_eq!(data.physics_state(), by_name);
}

#[test]
fn an_id_of_every_kind_of_another_model_panics() {
    let (model, other) = (every_element(), every_element());
    macro_rules! check {
        ($($one:ident;)*) => {$(
            let id = other.$one(0).expect("every kind has an element").id();
            let used = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                model.$one(id);
            }));
            let message = used.unwrap_err();
            let message = message.downcast_ref::<String>().unwrap();
            assert!(message.contains("belongs to another model"), "{}: {message}", stringify!($one));
        )*};
    }
    check!(body; joint; geom; site; camera; light; tendon; actuator; sensor; keyframe; mesh; skin; height_field; texture;
        material; pair; exclude; equality; numeric; text; tuple;);
}
