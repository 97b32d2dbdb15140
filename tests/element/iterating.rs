//! Iteration over all elements of a kind.

use std::sync::Arc;

use mujoco_safe::kind::Kind;
use mujoco_safe::sample;

use crate::{every_element, simulation, zoo};

#[test]
fn ids_are_ordered_by_model_and_index() {
    let [first, second] = [sample::cartpole(), sample::cartpole()];
    let ids = |model: &mujoco_safe::Model| [0, 1].map(|index| model.joint(index).unwrap().id());
    let mut all = [ids(&second), ids(&first)].concat();
    all.sort();
    assert_eq!(all, [ids(&first), ids(&second)].concat());
    assert_eq!(ids(&first.clone()), ids(&first));
    assert_ne!(ids(&first), ids(&second));
}

#[test]
fn each_kind_iterates_over_all_elements_in_order() {
    macro_rules! check {
        ($model:ident: $($many:ident = $count:ident, $kind:ident;)*) => {$(
            assert_eq!($model.$many().len(), $model.$count(), stringify!($many));
            assert_eq!($model.count(Kind::$kind), $model.$count());
            assert!($model.$many().map(|element| element.index()).eq(0..$model.$count()), stringify!($many));
            let names: Vec<&str> = $model.$many().filter_map(|element| element.name()).collect();
            assert!($model.names(Kind::$kind).eq(names), stringify!($many));
        )*};
    }
    for model in [zoo(), Arc::new(every_element()), Arc::new(sample::humanoid()), Arc::new(sample::cartpole())] {
        check!(model: bodies = nbody, Body; joints = njnt, Joint; geoms = ngeom, Geom; sites = nsite, Site;
            cameras = ncam, Camera; lights = nlight, Light; tendons = ntendon, Tendon; actuators = nu, Actuator;
            sensors = nsensor, Sensor; keyframes = nkey, Keyframe; meshes = nmesh, Mesh; skins = nskin, Skin;
            height_fields = nhfield, HeightField; textures = ntex, Texture; materials = nmat, Material;
            pairs = npair, Pair; excludes = nexclude, Exclude; equalities = neq, Equality;
            numerics = nnumeric, Numeric; texts = ntext, Text; tuples = ntuple, Tuple;);
    }
}

#[test]
fn names_are_those_of_the_xml() {
    let model = zoo();
    let names = |kind| model.names(kind).collect::<Vec<_>>();
    assert_eq!(names(Kind::Body), ["world", "hand", "other_hand", "crate", "base", "shoulder", "elbow"]);
    assert_eq!(names(Kind::Tendon), ["rope", "coupling"]);
    assert_eq!(names(Kind::Camera), ["overview"]);
    assert_eq!(names(Kind::Sensor), ["acceleration", "elbow", "swing", "touch", "load", "height"]);
    assert_eq!(names(Kind::Keyframe), ["lifted"]);
    assert_eq!((model.ntendon(), model.ncam(), model.nlight(), model.nkey()), (3, 2, 3, 2));
}

#[test]
fn iterators_are_double_ended_and_exact_size() {
    let model = zoo();
    let mut joints = model.joints();
    assert_eq!(joints.next_back().map(|joint| joint.index()), Some(4));
    assert_eq!(joints.len(), 4);
    let data = simulation();
    let backwards: Vec<_> = data.bodies().rev().filter_map(|body| body.name()).collect();
    assert_eq!(backwards, ["elbow", "shoulder", "base", "crate", "other_hand", "hand", "world"]);
}

#[test]
fn joints_can_be_filtered_by_name() {
    let model = sample::humanoid();
    let left = model.joints().filter(|joint| joint.name().is_some_and(|name| name.contains("left")));
    assert_eq!(left.count(), 9);
}
