//! Vertices of tendons, skins and flexes.

use mujoco_safe::html::HtmlOptions;
use mujoco_safe::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use mujoco_safe::{Data, Model, RandomController, Trajectory};

use crate::page::{Page, saved};

fn recorded(model: &Model) -> (Page, Trajectory) {
    let mut data = Data::new(model.clone()).unwrap();
    let mut trajectory = Trajectory::new(model);
    trajectory.record(&mut data, &mut RandomController::new(3), 60).unwrap();
    let options = HtmlOptions::default().with_frames_per_second(f64::INFINITY);
    (saved(model, &[("", &trajectory)], &options), trajectory)
}

/// Compares the vertices of the only deformable shape with those that a function returns in each
/// record.
fn check(model: &Model, expected: impl Fn(&Data) -> Vec<[f64; 3]>) -> Page {
    let (page, trajectory) = recorded(model);
    assert!(page.left_out.is_empty(), "{:?}", page.left_out);
    assert_eq!(page.description["look"]["deformables"].as_array().unwrap().len(), 1);
    let shape = &page.description["tracks"][0]["deformables"][0];
    let step = page.description["steps"]["position"].as_f64().unwrap();
    let channels = page.channels(&shape["values"], trajectory.len(), 2);
    let mut data = Data::new(model.clone()).unwrap();
    let mut moved = 0.0_f64;
    for record in 0..trajectory.len() {
        trajectory.apply(record, &mut data).unwrap();
        data.forward().unwrap();
        let vertices = expected(&data);
        assert_eq!(channels.len(), 3 * vertices.len());
        for (found, value) in channels.iter().zip(vertices.as_flattened()) {
            let difference = found[record] as f64 * step - value;
            assert!(difference.abs() <= 0.5 * step + 1e-6, "record {record}: {difference}");
            moved = moved.max((found[record] - found[0]).abs() as f64 * step);
        }
    }
    assert!(moved > 1e-3, "the vertices move: {moved}");
    page
}

#[test]
fn segments_of_tendons_have_the_ends_of_the_engine() {
    let model = Model::from_xml_str(
        "<mujoco><worldbody><site name='a' pos='0 0 2'/>
           <body><joint type='slide' axis='0 0 1'/><joint axis='0 1 0'/><geom size='.1' pos='.2 0 0'/>
             <site name='b' pos='.1 0 0'/><site name='c' pos='.3 0 0'/></body></worldbody>
           <tendon><spatial name='rope' width='.02' rgba='1 .5 0 1'><site site='a'/><site site='b'/><site site='c'/></spatial></tendon></mujoco>",
    )
    .unwrap();
    let page = check(&model, |data| {
        let [a, b, c] = [0, 1, 2].map(|site| data.site_xpos()[site]);
        vec![a, b, b, c]
    });
    let look = &page.description["look"]["deformables"][0];
    assert!(look["faces"].is_null());
    assert!((look["radius"].as_f64().unwrap() - 0.02).abs() < 1e-8);
    assert_eq!(look["rgba"], serde_json::json!([1.0, 0.5, 0.0, 1.0]));
}

#[test]
fn vertices_of_skins_are_blended_between_their_bones() {
    let model = Model::from_xml_str(
        "<mujoco><asset><skin name='skin' vertex='0 0 0  0 .1 0  .3 0 0  .3 .1 0' face='0 2 1  1 2 3'>
           <bone body='one' bindpos='0 0 0' bindquat='1 0 0 0' vertid='0 1 2' vertweight='1 .75 .5'/>
           <bone body='two' bindpos='.2 0 0' bindquat='1 0 0 0' vertid='1 2 3' vertweight='.25 .5 1'/></skin></asset>
           <worldbody><body name='one'><joint axis='0 1 0'/><geom size='.05'/>
             <body name='two' pos='.2 0 0'><joint axis='0 0 1' springref='90' stiffness='1'/><geom size='.05' pos='.2 0 0'/></body></body></worldbody></mujoco>",
    )
    .unwrap();
    let vertices = [[0.0, 0.0, 0.0], [0.0, 0.1, 0.0], [0.3, 0.0, 0.0], [0.3, 0.1, 0.0]].map(Vector3::from);
    let weights = [[1.0, 0.0], [0.75, 0.25], [0.5, 0.5], [0.0, 1.0]];
    let page = check(&model, |data| {
        let bone = |body: usize, vertex: Vector3<f64>| {
            let [w, x, y, z] = data.xquat()[body];
            let bind = Vector3::new(if body == 2 { 0.2 } else { 0.0 }, 0.0, 0.0);
            Vector3::from(data.xpos()[body])
                + UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)) * (vertex - bind)
        };
        let blend =
            |(vertex, weight): (Vector3<f64>, [f64; 2])| weight[0] * bone(1, vertex) + weight[1] * bone(2, vertex);
        vertices.into_iter().zip(weights).map(|found| blend(found).into()).collect()
    });
    let faces = &page.description["look"]["deformables"][0]["faces"];
    assert_eq!(page.channels(faces, 6, 1), [[0, 2, 1, 1, 2, 3]]);
}

#[test]
#[cfg(engine_since = "3.0.0")]
fn vertices_of_flexes_are_those_of_the_engine() {
    for (dim, count) in [(1, "5 1 1"), (2, "3 3 1"), (3, "3 3 3")] {
        let model = Model::from_xml_str(&format!(
            "<mujoco><worldbody><body name='base' pos='0 0 1'><flexcomp name='soft' type='grid' count='{count}' dim='{dim}' spacing='.1 .1 .1'
               radius='.01' mass='1'><edge equality='true'/></flexcomp></body></worldbody></mujoco>"
        ))
        .unwrap();
        let page = check(&model, |data| {
            let vertices = data.flexvert_xpos();
            if dim > 1 {
                vertices.to_vec()
            } else {
                (0..4).flat_map(|edge| [vertices[edge], vertices[edge + 1]]).collect()
            }
        });
        assert_eq!(page.description["look"]["deformables"][0]["faces"].is_null(), dim == 1);
    }
}
