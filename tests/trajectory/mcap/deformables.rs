//! Skins and flexes of logs, read by the official reader for Python.

use mujoco_safe::mcap::Log;
use mujoco_safe::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use mujoco_safe::{Controller, Data, Model, RandomController};
use serde_json::Value;

use super::official_reader::{messages, numbers, read, vector};

/// Compares the vertices of the only entity with those that a function returns for each state.
/// Returns the last entity.
fn check(xml: &str, expected: impl Fn(&Data) -> Vec<[f64; 3]>) -> Option<Value> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.mcap");
    let mut data = Data::new(Model::from_xml_str(xml).unwrap()).unwrap();
    let mut log = Log::create(&path, data.model()).unwrap().with_display_rate(f64::INFINITY);
    let (mut random, mut results) = (RandomController::new(1), Vec::new());
    for step in 0..60 {
        random.control(&mut data).unwrap();
        // The vertices of an edited model are not those of the model before.
        if step == 30 {
            data.edit_model(|model| model.body_pos_mut()[1][2] += 0.5).unwrap();
        }
        log.step(&mut data).unwrap();
        results.push(data.clone());
    }
    data.forward().unwrap();
    log.write(&data).unwrap();
    results.push(data);
    log.finish().unwrap();
    let file = read(&path)?;
    let found = messages(&file, "/scene/deformable", "foxglove.SceneUpdate");
    assert_eq!(found.len(), 61);
    let mut first = Vec::new();
    let mut moved = 0.0_f64;
    for ((_, _, message), result) in found.iter().zip(&results) {
        let entity = &message["entities"][0];
        assert_eq!((&entity["frame_id"], &message["entities"][1]), (&Value::from("world"), &Value::Null));
        let shapes = ["triangles", "lines"].into_iter().flat_map(|kind| entity[kind].as_array().unwrap());
        let vertices: Vec<_> = shapes.flat_map(|shape| shape["points"].as_array().unwrap()).map(vector).collect();
        let expected = expected(result);
        assert_eq!(vertices.len(), expected.len());
        for (found, expected) in vertices.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
        first = if first.is_empty() { vertices.clone() } else { first };
        let distances = vertices.as_flattened().iter().zip(first.as_flattened()).map(|(a, b)| (a - b).abs());
        moved = distances.fold(moved, f64::max);
    }
    assert!(moved > 0.4, "the vertices move: {moved}");
    Some(found.last().unwrap().2["entities"][0].clone())
}

#[test]
fn vertices_of_skins_are_blended_between_their_bones() {
    let weights = [[1.0, 0.0], [0.75, 0.25], [0.5, 0.5], [0.0, 1.0]];
    let vertices = [[0.0, 0.0, 0.0], [0.0, 0.1, 0.0], [0.3, 0.0, 0.0], [0.3, 0.1, 0.0]].map(Vector3::from);
    let entity = check(
        "<mujoco><asset><skin vertex='0 0 0  0 .1 0  .3 0 0  .3 .1 0' face='0 2 1  1 2 3' rgba='.25 1 0 .5'>
           <bone body='one' bindpos='0 0 0' bindquat='1 0 0 0' vertid='0 1 2' vertweight='1 .75 .5'/>
           <bone body='two' bindpos='.2 0 0' bindquat='1 0 0 0' vertid='1 2 3' vertweight='.25 .5 1'/></skin></asset>
           <worldbody><body name='one'><joint axis='0 1 0'/><geom size='.05'/>
             <body name='two' pos='.2 0 0'><joint axis='0 0 1' springref='90' stiffness='1'/>
               <geom size='.05' pos='.2 0 0'/></body></body></worldbody></mujoco>",
        |data| {
            let bone = |body: usize, vertex: Vector3<f64>| {
                let [w, x, y, z] = data.xquat()[body];
                let bind = Vector3::new(if body == 2 { 0.2 } else { 0.0 }, 0.0, 0.0);
                let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
                Vector3::from(data.xpos()[body]) + rotation * (vertex - bind)
            };
            let blended = vertices.into_iter().zip(weights);
            blended.map(|(vertex, [one, two])| (one * bone(1, vertex) + two * bone(2, vertex)).into()).collect()
        },
    );
    let Some(entity) = entity else { return };
    assert_eq!(entity["id"], "skin0");
    assert_eq!(numbers(&entity["triangles"][0]["indices"]), [0.0, 2.0, 1.0, 1.0, 2.0, 3.0]);
    assert_eq!(numbers(&entity["triangles"][0]["color"]), [0.5, 0.0, 1.0, 0.25]); // a, b, g, r
}

#[test]
#[cfg(engine_since = "3.0.0")]
fn vertices_of_flexes_are_those_of_the_engine() {
    for (dim, count) in [(1, "5 1 1"), (2, "3 3 1"), (3, "3 3 3")] {
        let xml = format!(
            "<mujoco><worldbody><body name='base' pos='0 0 1'>
               <flexcomp name='soft' type='grid' count='{count}' dim='{dim}' spacing='.1 .1 .1' radius='.01' mass='1'>
                 <edge equality='true'/></flexcomp></body></worldbody></mujoco>"
        );
        let entity = check(&xml, |data| {
            let vertices = data.flexvert_xpos();
            let ends = (0..4).flat_map(|edge| [vertices[edge], vertices[edge + 1]]);
            if dim > 1 { vertices.to_vec() } else { ends.collect() }
        });
        let Some(entity) = entity else { return };
        assert_eq!(entity["id"], "flex0");
        if dim == 1 {
            assert!((entity["lines"][0]["thickness"].as_f64().unwrap() - 0.02).abs() < 1e-6);
            continue;
        }
        let model = Model::from_xml_str(&xml).unwrap();
        let triangles = if dim == 2 { model.flex_elem() } else { model.flex_shell() };
        let found = numbers(&entity["triangles"][0]["indices"]);
        assert!(found.iter().eq(triangles.iter().map(|&index| f64::from(index)).collect::<Vec<_>>().iter()));
    }
}
